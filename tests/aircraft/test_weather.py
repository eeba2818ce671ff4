"""Turbulence against MIL-F-8785C and gusts against 1 - cosine, as formulas and in JSBSim."""

import math

import numpy as np
import pytest

from aircraft.fdm import TIME_STEP
from aircraft.spec import AircraftError
from aircraft.state import RigidBodyState
from aircraft.weather import (
    TURBULENCE,
    Gust,
    Turbulence,
    Weather,
    begin_weather,
    end_weather,
    low_altitude_turbulence,
)

FOOT = 0.3048
LEVEL = RigidBodyState(altitude=60.0, roll=0.0, pitch=0.0, velocity_body=(20.0, 0.0, 0.0))
SIGMAS = 3.0
"""Tolerance of what is estimated from a sample, in its own standard deviations: the seed is fixed,
so nothing fails by chance.
"""


@pytest.mark.parametrize("altitude", [305.0, math.nan])
def test_above_1000_feet_the_low_altitude_laws_are_refused(altitude):
    with pytest.raises(AircraftError, match=rf"{altitude:g} m; it holds up to 304\.8 m"):
        low_altitude_turbulence(altitude, 10.0)


@pytest.fixture
def blown(x8_fdm):
    """A function from a weather to the turbulence that a held X8 meets, shape (steps, 3): north,
    east, down [m/s].
    """

    def blow(weather, steps, altitude, airspeed):
        x8_fdm.place(
            RigidBodyState(
                altitude=altitude, roll=0.0, pitch=0.0, velocity_body=(airspeed, 0.0, 0.0)
            ),
            (0.0, 0.0),
        )
        begin_weather(x8_fdm, weather)
        return met(x8_fdm, x8_fdm.run, steps, "turb")

    return blow


@pytest.mark.slow
def test_jsbsim_shakes_as_strongly_as_the_standard_says_and_has_the_spectra_of_dryden(blown):
    # Fast, so that many scale lengths go by.
    altitude, airspeed, steps = 60.0, 200.0, 160_000
    log = blown(
        Weather(turbulence=Turbulence(wind_at_20ft=10.0), seed=2), steps, altitude, airspeed
    )
    duration = steps / 120.0
    air = low_altitude_turbulence(altitude, 10.0)
    sigmas = (air.horizontal, air.horizontal, air.vertical)
    lengths = (air.horizontal_length, air.horizontal_length, air.vertical_length)
    for measured, sigma, length in zip(log.std(axis=0), sigmas, lengths, strict=True):
        # Of a process with the correlation exp(-t/tau), a standard deviation over T is known to
        # sqrt(tau / 2T) of itself (Bendat and Piersol, Random Data, 8.2); those across and down
        # forget sooner. The start from smooth air is within that.
        assert measured == pytest.approx(
            sigma, rel=SIGMAS * math.sqrt(0.5 * length / airspeed / duration)
        )
    # And its spectra are those of Dryden: with wind toward the north, after x scale lengths the
    # wind along has the correlation exp(-x), those across and down have exp(-x) (1 - x/2):
    # transforms of the spectra of MIL-F-8785C. First-order filters, as of JSBSim's type 3, would
    # have exp(-2x) there: at half a scale length 0.37 in place of 0.45.
    for wind, length, factor in zip(log.T, lengths, (1.0, 0.75, 0.75), strict=True):
        lag = round(0.5 * 120.0 * length / airspeed)
        correlation = np.mean(wind[:-lag] * wind[lag:]) / np.mean(wind**2)
        # A correlation is known to about sqrt(tau / T) or better (Bendat and Piersol, 8.4): 0.03
        # along and across, 0.015 down.
        tolerance = SIGMAS * math.sqrt(length / airspeed * 120.0 / steps)
        assert correlation == pytest.approx(factor * math.exp(-0.5), abs=tolerance)


@pytest.mark.parametrize(
    ("wind", "toward"),
    [((0.0, 7.0), 90.0), ((0.0, -7.0), 270.0), ((-5.0, 0.0), 180.0), ((0.0, 0.0), 0.0)],
)
def test_turbulence_has_its_axes_in_the_wind_wherever_it_blows(x8_fdm, wind, toward):
    x8_fdm.place(LEVEL, wind)
    x8_fdm.step()
    # JSBSim leaves its axes where they were in a wind that has no north at all; 1e-6 ft/s of it
    # turn 7 m/s by 5e-8 rad.
    assert x8_fdm.read("atmosphere/psiw-rad") == pytest.approx(math.radians(toward), abs=1e-7)


def test_a_seed_gives_its_own_turbulence_each_time(blown, x8_fdm):
    weather = Weather(turbulence=TURBULENCE["light"], seed=5)
    first = blown(weather, 200, 60.0, 20.0)
    end_weather(x8_fdm)
    np.testing.assert_array_equal(blown(weather, 200, 60.0, 20.0), first)
    end_weather(x8_fdm)
    # Of 0.8 m/s.
    other = blown(Weather(turbulence=TURBULENCE["light"], seed=6), 200, 60.0, 20.0)
    assert np.abs(other - first).max() > 0.1


FIRST = Gust(start=0.5, rise=1.0, hold=0.5, fall=0.25, velocity_ned=(3.0, -4.0, 1.0))
SECOND = Gust(start=3.0, rise=0.5, fall=0.5, velocity_ned=(0.0, 2.0, 0.0))


def one_minus_cosine(gust, times):
    """The discrete gust of MIL-F-8785C: V/2 (1 - cos(pi t / rise)), held, and the same down."""
    up = np.clip((times - gust.start) / gust.rise, 0.0, 1.0)
    down = np.clip((times - gust.start - gust.rise - gust.hold) / gust.fall, 0.0, 1.0)
    return np.outer(
        0.5 * (1.0 - np.cos(np.pi * up)) * 0.5 * (1.0 + np.cos(np.pi * down)), gust.velocity_ned
    )


def met(fdm, run, steps, kind="total-wind"):
    """Wind [m/s] that a held aircraft meets at each step, shape (steps, 3): north, east, down."""
    nodes = [fdm.node(f"atmosphere/{kind}-{way}-fps") for way in ("north", "east", "down")]
    log = np.empty((steps, 3))
    with fdm.frozen():
        for row in log:
            run()
            row[:] = [node.get_double_value() for node in nodes]
    return log * FOOT


@pytest.fixture
def held(x8_fdm):
    x8_fdm.place(LEVEL, (0.0, 0.0))
    return x8_fdm


def test_two_gusts_blow_one_after_the_other_in_their_own_directions(held):
    steps = round(5.0 / TIME_STEP)
    wind = met(held, begin_weather(held, Weather(gusts=(SECOND, FIRST))), steps)
    times = TIME_STEP * np.arange(steps)
    # JSBSim adds up time steps to know where a gust is, and the least north wind is 1e-6 ft/s.
    np.testing.assert_allclose(
        wind, one_minus_cosine(FIRST, times) + one_minus_cosine(SECOND, times), atol=1e-6
    )


def test_a_gust_that_was_cut_short_leaves_nothing_for_the_next(held):
    met(held, begin_weather(held, Weather(gusts=(FIRST,))), round(1.2 / TIME_STEP))
    end_weather(held)
    held.place(LEVEL, (0.0, 0.0))
    wind = met(held, begin_weather(held, Weather(gusts=(SECOND,))), round(3.5 / TIME_STEP) + 1)
    # SECOND at its height, and eastward all the while; the least north wind is 1e-6 ft/s.
    assert wind[-1] == pytest.approx([0.0, 2.0, 0.0], abs=1e-6)
    assert np.abs(wind[:, [0, 2]]).max() < 1e-6


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ({"start": -1.0}, "start is -1.0 s"),
        ({"rise": 0.0}, "rise is 0.0 s"),
        ({"velocity_ned": (0.0, 0.0, 0.0)}, "not 0"),
    ],
)
def test_a_gust_out_of_range_is_refused(value, message):
    with pytest.raises(AircraftError, match=message):
        Gust(**({"start": 0.0, "rise": 1.0, "fall": 1.0, "velocity_ned": (1.0, 0.0, 0.0)} | value))
