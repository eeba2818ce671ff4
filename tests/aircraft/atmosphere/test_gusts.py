"""Discrete gusts through JSBSim's cosine gust."""

import numpy as np
import pytest

from aircraft.atmosphere.gusts import Gust, gusty_run
from aircraft.atmosphere.weather import end_weather
from aircraft.errors import AircraftError
from aircraft.simulation.fdm import TIME_STEP
from aircraft.simulation.state import RigidBodyState

FOOT = 0.3048
FIRST = Gust(start=0.5, rise=1.0, hold=0.5, fall=0.25, velocity_ned=(3.0, -4.0, 1.0))
SECOND = Gust(start=3.0, rise=0.5, fall=0.5, velocity_ned=(0.0, 2.0, 0.0))


def one_minus_cosine(gust, times):
    """The discrete gust of MIL-F-8785C: V/2 (1 - cos(pi t / rise)), held; and the same downwards."""
    up = np.clip((times - gust.start) / gust.rise, 0.0, 1.0)
    down = np.clip((times - gust.start - gust.rise - gust.hold) / gust.fall, 0.0, 1.0)
    return np.outer(
        0.5 * (1.0 - np.cos(np.pi * up)) * 0.5 * (1.0 + np.cos(np.pi * down)), gust.velocity_ned
    )


def met(fdm, run, steps):
    """The wind [m/s] that a held aircraft meets at each step, shape (steps, 3): north, east, down."""
    nodes = [
        fdm.node(f"atmosphere/total-wind-{component}-fps")
        for component in ("north", "east", "down")
    ]
    log = np.empty((steps, 3))
    with fdm.frozen():
        for row in log:
            run()
            row[:] = [node.get_double_value() for node in nodes]
    return log * FOOT


@pytest.fixture
def held(x8_fdm):
    x8_fdm.place(
        RigidBodyState(altitude=60.0, roll=0.0, pitch=0.0, velocity_body=(20.0, 0.0, 0.0)),
        (0.0, 0.0),
    )
    return x8_fdm


def test_two_gusts_blow_one_after_the_other_in_their_own_directions(held):
    steps = round(5.0 / TIME_STEP)
    wind = met(held, gusty_run(held, [SECOND, FIRST]), steps)
    times = TIME_STEP * np.arange(steps)
    # JSBSim adds up time steps to know where a gust is, and the least north wind is 1e-6 ft/s.
    np.testing.assert_allclose(
        wind, one_minus_cosine(FIRST, times) + one_minus_cosine(SECOND, times), atol=1e-6
    )


def test_a_gust_that_was_cut_short_leaves_nothing_for_the_next(held):
    met(held, gusty_run(held, [FIRST]), round(1.2 / TIME_STEP))
    end_weather(held)
    held.place(
        RigidBodyState(altitude=60.0, roll=0.0, pitch=0.0, velocity_body=(20.0, 0.0, 0.0)),
        (0.0, 0.0),
    )
    wind = met(held, gusty_run(held, [SECOND]), round(3.5 / TIME_STEP) + 1)
    # SECOND at its height, and eastward all the while; the least north wind is 1e-6 ft/s.
    assert wind[-1] == pytest.approx([0.0, 2.0, 0.0], abs=1e-6)
    assert np.abs(wind[:, [0, 2]]).max() < 1e-6


def test_without_gusts_nothing_stands_between_the_flight_and_jsbsim(held):
    assert gusty_run(held, ()) == held.run


def test_gusts_that_overlap_are_refused(held):
    late = Gust(start=2.2, rise=1.0, fall=1.0, velocity_ned=(1.0, 0.0, 0.0))
    with pytest.raises(
        AircraftError, match=r"one starts at 2\.2 s, before the one from 0\.5 to 2\.25 s is over"
    ):
        gusty_run(held, [FIRST, late])


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
