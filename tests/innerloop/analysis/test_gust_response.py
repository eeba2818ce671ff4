"""Gusts in the linear model against JSBSim, whose air is made to move past an aircraft that is held
where it is.
"""

import numpy as np
import pytest

from aircraft.state import course_rate
from common.physics.units import METRES_PER_FOOT
from innerloop.analysis.gust_response import GUSTS, aircraft_in_gusts, gust_loop, velocity_by_polar
from innerloop.synthesis.quasi_static import quasi_static
from innerloop.synthesis.schedule import LEVEL_GAINS

MIDDLE = 2
STEEP = 4  # 45 degrees of bank
WIND = 0.05  # m/s, small against 20 m/s, large against rounding
KG_M2_PER_SLUG_FT2 = 1.3558179483314


def in_gusts(schedule, bank_index):
    models = schedule.models[MIDDLE]
    return aircraft_in_gusts(
        models[bank_index], schedule.gain_trim(MIDDLE, bank_index), models[LEVEL_GAINS]
    )


def read_in_wind(fdm, trim, wind_ned):
    """Accelerations of velocity and rates, and measured heading rate, of a held aircraft that heads
    north.
    """
    fdm.command(dict(trim.inputs))
    fdm.place(trim.state(yaw=-trim.course_offset()))
    with fdm.frozen():
        for name, value in zip(("north", "east", "down"), wind_ned, strict=True):
            fdm.write(f"atmosphere/wind-{name}-fps", value / METRES_PER_FOOT)
        fdm.step()
        assert fdm.settle(3e-8)
        velocity, rates = fdm.velocity_body(), np.array(fdm.rates_body())
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


def test_moments_by_rates_hardly_depend_on_bank(x8_schedule, x8_fdm):
    trim = x8_schedule.gain_trim(MIDDLE, STEEP)
    names = list(x8_schedule.models[MIDDLE][STEEP].state_labels)
    rows = [names.index(name) for name in "pqr"]
    steep, level = (
        x8_schedule.models[MIDDLE][i].A[np.ix_(rows, rows)] for i in (STEEP, LEVEL_GAINS)
    )
    x8_fdm.place(trim.state())
    xx, yy, zz, xz = (
        x8_fdm.read(f"inertia/i{axes}-slugs_ft2") * KG_M2_PER_SLUG_FT2
        for axes in ("xx", "yy", "zz", "xz")
    )
    inertia = np.array(
        [[xx, 0.0, xz], [0.0, yy, 0.0], [xz, 0.0, zz]]
    )  # JSBSim's ixz is that of the matrix, its sign included
    rates = np.array(trim.rates_body)
    gyroscopic = -np.linalg.solve(inertia, cross(rates) @ inertia - cross(inertia @ rates))
    # What is left in a steep turn is what the model takes from level flight. Measured 0.029 1/s, by
    # the propeller and the larger angle of attack, of dampings of 3.9 to 24 1/s; the gyroscopic
    # moments themselves are up to 0.26 1/s.
    assert np.abs(steep - gyroscopic - level).max() < 0.04
    assert np.abs(gyroscopic).max() > 0.2


def cross(vector):
    """The matrix that makes the cross product of a vector with another."""
    return -np.cross(np.eye(3), vector).T


def test_in_air_that_has_come_to_move_along_its_course_the_aircraft_is_as_much_faster(x8_schedule):
    loop = gust_loop(x8_schedule, MIDDLE, LEVEL_GAINS)
    gain = np.real(
        loop(1e-9j)
    )  # a hundred thousand times slower than the slowest pole, 0.3 rad/s: steady to 1e-8
    along, outputs = loop.input_labels.index("gust_along"), list(loop.output_labels)
    assert gain[outputs.index("speed"), along] == pytest.approx(1.0, abs=1e-6)
    assert gain[outputs.index("airspeed"), along] == pytest.approx(0.0, abs=1e-6)


def test_in_a_turn_the_air_ahead_of_the_course_slows_the_turn_over_the_mean_air(x8_schedule):
    trim = x8_schedule.gain_trim(MIDDLE, STEEP)
    loop = gust_loop(x8_schedule, MIDDLE, STEEP)
    gain = np.real(loop(1e-9j))
    along, outputs = loop.input_labels.index("gust_along"), list(loop.output_labels)
    # The autopilot holds a_right/V_air; the motion that is 1 m/s faster with the same acceleration
    # turns by omega/V less.
    assert gain[outputs.index("heading_rate"), along] == pytest.approx(0.0, abs=1e-6)
    assert gain[outputs.index("course_rate"), along] == pytest.approx(
        -trim.yaw_rate / trim.airspeed, rel=1e-6
    )
