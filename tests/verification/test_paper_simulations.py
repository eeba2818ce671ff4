"""The paper's three simulations (section V), flown with a kinematic vehicle.

The paper prints neither gains nor starts; what is tested is what it says of each figure.
"""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from gnc.delta import look_ahead, relative_state, relative_velocity
from gnc.guidance import Guidance, GuidanceParameters, Law
from gnc.laws import cascade_law, line_of_sight_law
from gnc.oscillation import design_oscillation
from gnc.placement import PlumeAxis, distance_by_paper
from gnc.reference import start_reference
from gnc.unicycle import unicycle_move

SPEED = 19.42
HEADING_RATE_MAX = 0.503
CIRCLE = 0.15


@dataclass(frozen=True, slots=True, kw_only=True)
class Pursuit:
    """Histories of a pursuit of a reference on a circle."""

    command: np.ndarray
    distance: np.ndarray
    phi: np.ndarray
    phi_r: np.ndarray


def pursue_on_a_circle(start, *, line_of_sight=False, duration=400.0, time_step=0.01):
    parameters = look_ahead(0.005, 200.0)
    reference, vehicle = (0.0, 0.0, 0.0), start
    rows = []
    for _ in range(round(duration / time_step)):
        north, east = reference[0] - vehicle[0], reference[1] - vehicle[1]
        state = relative_state(parameters, north, east, reference[2], vehicle[2])
        if line_of_sight:
            command = line_of_sight_law(north, east, vehicle[2], 1.5)
        else:
            _, omega_rho = relative_velocity(parameters, state, SPEED, SPEED, CIRCLE)
            command = cascade_law(state.phi, omega_rho, 1.5, 0.1)
        rows.append((command, math.hypot(north, east), state.phi, state.phi_r))
        vehicle = unicycle_move(*vehicle, SPEED, command, time_step)
        reference = unicycle_move(*reference, SPEED, CIRCLE, time_step)
    command, distance, phi, phi_r = np.array(rows).T
    return Pursuit(command=command, distance=distance, phi=phi, phi_r=phi_r)


def test_sim_1_converges_onto_the_circle_from_an_opposite_heading():
    pursuit = pursue_on_a_circle((-60.0, 80.0, math.pi - 0.2))
    # Figures 4 and 5: phi goes to zero first, phi_r and the distance after it. On a circle a held command leaves no error, and
    # 400 s are ample: measured, 2e-6 m and 1e-8 rad.
    assert abs(pursuit.phi[0]) > 2.0
    assert abs(pursuit.phi[-1]) < 1e-6
    assert abs(pursuit.phi_r[-1]) < 1e-6
    assert pursuit.distance[-1] < 1e-3
    settled_phi = np.nonzero(np.abs(pursuit.phi) > 0.05)[0][-1]
    settled_distance = np.nonzero(pursuit.distance > 5.0)[0][-1]
    assert settled_phi < settled_distance


def test_sim_1_comes_no_farther_away_once_phi_is_within_phi_r():
    pursuit = pursue_on_a_circle((-60.0, 80.0, math.pi - 0.2))
    rises = np.diff(pursuit.distance) > 0.0
    inside = np.abs(pursuit.phi[:-1]) < np.abs(pursuit.phi_r[:-1])
    # Section V on figure 5, and equation (35): where cos phi > cos phi_r the distance does not rise. The command is held over
    # 0.01 s, so the sign may lag by a step where the two are equal.
    assert np.count_nonzero(rises & inside) <= 1
    # Before, it did rise.
    assert np.count_nonzero(rises & ~inside) > 100


@pytest.mark.parametrize("aside", [2.0, -2.0])
def test_sim_2_the_line_of_sight_saturates_the_vehicle_and_the_delta_formulation_does_not(aside):
    # Figures 6 and 7: from in front of the reference, moving the opposite way.
    start = (80.0, aside, math.pi)
    line_of_sight, delta = pursue_on_a_circle(start, line_of_sight=True), pursue_on_a_circle(start)
    assert np.max(np.abs(line_of_sight.command)) > 2.0 * HEADING_RATE_MAX
    assert np.max(np.abs(delta.command)) <= HEADING_RATE_MAX
    # The other one is near sooner, for good ("fast convergence"), but only the delta formulation gets it onto the reference.
    sooner, later = (np.nonzero(pursuit.distance > 30.0)[0][-1] for pursuit in (line_of_sight, delta))
    assert sooner < later
    assert delta.distance[-1] < 0.01
    assert line_of_sight.distance[-1] > 10.0


def fly_sim_3(time_step):
    oscillation = design_oscillation(nu=0.5, speed=SPEED, heading_rate_max=HEADING_RATE_MAX)
    distance = distance_by_paper(oscillation, PlumeAxis(heading=math.pi), 200.0)
    start = start_reference(oscillation, phase=0.0, centre_north=-distance, centre_east=0.0, vessel_course=0.0)
    parameters = GuidanceParameters(
        law=Law.CASCADE,
        look_ahead=look_ahead(0.005, 60.0),
        gain=1.5,
        rate_max=0.4,
        k_1=0.001,
        heading_rate_max=HEADING_RATE_MAX,
        time_step=time_step,
        lag=0.0,
        guard_distance=15.0,
        airspeed_gain=0.0,
        airspeed_trim_max=1.0,
    )
    guidance = Guidance(parameters, oscillation, start, phase=0.0)
    north, east, course = -500.0, -150.0, 1.0
    rows = []
    for step in range(round(300.0 / time_step)):
        time = step * time_step
        rows.append((time, north - 0.5 * SPEED * time, east, guidance.heading_rate_command))
        guidance.step(north, east, course, SPEED, 0.0)
        north, east, course = unicycle_move(north, east, course, SPEED, guidance.heading_rate_command, time_step)
    return np.array(rows).T


def test_sim_3_crosses_the_plume_every_9_5_s_at_214_m_and_never_enters_the_keep_out_area():
    time, north, east, command = fly_sim_3(0.01)
    # Section V. The vessel is the origin and the plume lies straight astern, on east = 0.
    at = np.nonzero(east[:-1] * east[1:] < 0.0)[0]
    share = east[at] / (east[at] - east[at + 1])
    times = time[at] + share * (time[at + 1] - time[at])
    distances = -(north[at] + share * (north[at + 1] - north[at]))
    # The last crossings, settled. Printed: 9.5 s and 214 m; the notes: 9.5006 s and 213.953 m. The command, held over 0.01 s, is
    # late by half of that, which leaves 3 cm.
    assert np.diff(times)[-8:] == pytest.approx(np.full(8, 9.5006), abs=1e-3)
    assert distances[-8:] == pytest.approx(np.full(8, 213.953), abs=0.05)
    # Figure 9: never inside 200 m.
    assert np.min(np.hypot(north, east)) >= 200.0
    assert np.max(np.abs(command)) <= HEADING_RATE_MAX
