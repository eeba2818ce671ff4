"""Turbulence filters against spectra of MIL-F-8785C; gusts in the linear model against JSBSim.

The spectra are written out here from the standard. In JSBSim air is made to move past an aircraft
that is held where it is.
"""

import math

import numpy as np
import pytest

from aircraft.state import course_rate
from aircraft.weather import low_altitude_turbulence
from common.physics import METRES_PER_FOOT
from innerloop.gusts import GUSTS, aircraft_in_gusts, dryden_filters, gust_loop, velocity_by_polar
from innerloop.schedule import LEVEL_GAINS
from innerloop.synthesis import quasi_static

AIRSPEED, SPAN = 19.42, 2.1
MIDDLE = 2
STEEP = 4  # 45 degrees of bank
WIND = 0.05  # m/s, small against 20 m/s, large against rounding
LIGHT = low_altitude_turbulence(60.0, 7.717)  # 15 knots at 20 ft


def spectrum(name, frequency, air=LIGHT):
    """Power spectral density over positive frequencies [unit^2 s/rad].

    MIL-F-8785C 3.7.1.2 with Omega = omega/V; p after Yeager.
    """
    v = AIRSPEED
    along, down = air.horizontal_length / v * frequency, air.vertical_length / v * frequency
    transverse = {
        "gust_right": air.horizontal**2
        * air.horizontal_length
        / (math.pi * v)
        * (1 + 3 * along**2)
        / (1 + along**2) ** 2,
        "gust_down": air.vertical**2
        * air.vertical_length
        / (math.pi * v)
        * (1 + 3 * down**2)
        / (1 + down**2) ** 2,
    }
    if name in transverse:
        return transverse[name]
    if name == "gust_along":
        return air.horizontal**2 * 2.0 * air.horizontal_length / (math.pi * v) / (1 + along**2)
    if name == "gust_p":
        reach = math.sqrt(air.vertical_length * SPAN)
        sigma, length = 1.9 * air.vertical / reach, reach / 2.6
        return sigma**2 * 2.0 * length / (math.pi * v) / (1 + (length * frequency / v) ** 2)
    source, share = {"gust_q": ("gust_down", 4.0), "gust_r": ("gust_right", 3.0)}[name]
    slope = (frequency / v) ** 2 / (1 + (share * SPAN * frequency / (math.pi * v)) ** 2)
    return slope * transverse[source]


@pytest.fixture(scope="module")
def filters():
    return dryden_filters(LIGHT, airspeed=AIRSPEED, span=SPAN)


@pytest.mark.parametrize("name", GUSTS)
def test_a_filter_has_the_spectrum_of_the_standard(filters, name):
    frequencies = np.logspace(-3, 2, 11)
    response = filters(1j * frequencies)[GUSTS.index(name)]
    # White noise of intensity 1 has the density 1/pi over positive frequencies. Same formula, so
    # rounding alone.
    found = np.sum(np.abs(response) ** 2, axis=0) / math.pi
    assert found == pytest.approx([spectrum(name, w) for w in frequencies], rel=1e-9)


def in_gusts(schedule, bank_index):
    models = schedule.models[MIDDLE]
    return aircraft_in_gusts(
        models[bank_index], schedule.gain_trim(MIDDLE, bank_index), models[LEVEL_GAINS]
    )


def read_in_wind(fdm, trim, wind_ned):
    """Accelerations, angular accelerations and heading rate of an aircraft held heading north."""
    fdm.command(dict(trim.inputs))
    fdm.place(trim.state(yaw=-trim.course_offset()))
    with fdm.frozen():
        for name, value in zip(("north", "east", "down"), wind_ned, strict=True):
            fdm.write(f"atmosphere/wind-{name}-fps", value / METRES_PER_FOOT)
        fdm.step()
        assert fdm.settle(3e-8)
        velocity = [METRES_PER_FOOT * fdm.read(f"velocities/{name}-aero-fps") for name in "uvw"]
        rates = np.array([fdm.read(f"velocities/{name}-rad_sec") for name in "pqr"])
        dot = np.array(fdm.acceleration_body())
        # Held in inertial motion: omega x v is that of the body's own velocity, which the wind has
        # been taken out of.
        own = np.array(trim.state().velocity_body)
        against_earth = dot + np.cross(rates, own)
        measured = course_rate(velocity, tuple(against_earth), trim.roll, trim.pitch)
        return np.array([*dot, *fdm.angular_acceleration(), measured])


@pytest.mark.parametrize("bank_index", [LEVEL_GAINS, STEEP])
def test_a_steady_wind_past_a_held_aircraft_does_in_jsbsim_what_the_linear_model_says(
    x8_schedule, x8_fdm, bank_index
):
    trim = x8_schedule.gain_trim(MIDDLE, bank_index)
    model = quasi_static(in_gusts(x8_schedule, bank_index))
    columns = [model.input_labels.index(name) for name in GUSTS[:3]]
    polar, outputs = model.B[:3, columns], list(model.output_labels)
    at = velocity_by_polar(trim.airspeed, trim.alpha, trim.beta)
    predicted = np.vstack(
        [at @ polar, model.B[3:6, columns], model.D[outputs.index("heading_rate"), columns]]
    )
    for j in range(3):
        wind = WIND * np.eye(3)[j]
        change = (read_in_wind(x8_fdm, trim, wind) - read_in_wind(x8_fdm, trim, -wind)) / (
            2.0 * WIND
        )
        # Differences of differences: a thousandth of the largest entry of a kind, and 0.5 % where
        # it is large, for the curvature between the steps of the model (0.05 m/s, 0.04 m/s by an
        # angle) and this one.
        sizes = np.repeat(
            [np.abs(predicted[:3]).max(), np.abs(predicted[3:6]).max(), np.abs(predicted[6]).max()],
            [3, 3, 1],
        )
        assert np.all(
            np.abs(change - predicted[:, j]) < 1e-3 * sizes + 5e-3 * np.abs(predicted[:, j])
        ), GUSTS[j]


def test_in_air_that_has_come_to_move_along_its_course_the_aircraft_is_as_much_faster(x8_schedule):
    loop = gust_loop(x8_schedule, MIDDLE, LEVEL_GAINS)
    # A hundred thousand times slower than the slowest pole, 0.3 rad/s: steady to 1e-8.
    gain = np.real(loop(1e-9j))
    along, outputs = loop.input_labels.index("gust_along"), list(loop.output_labels)
    assert gain[outputs.index("speed"), along] == pytest.approx(1.0, abs=1e-6)
    assert gain[outputs.index("airspeed"), along] == pytest.approx(0.0, abs=1e-6)
