import copy
import math

import numpy as np
import pytest
from gnc_cases import (
    HEADING_RATE_MAX,
    LOOK_AHEAD,
    SPEED,
    examples,
    fly,
    make_guidance,
    make_reference,
    paper_oscillation,
    tracking_parameters,
)
from hypothesis import given
from hypothesis import strategies as st

from gnc.laws import CascadeLaw, LineOfSightLaw, LyapunovLaw, line_of_sight_law
from gnc.paper import cascade_law, lyapunov_law, relative_state, relative_velocity
from gnc.tracker import Tracker


def law_command(law, reference, north, east, course, speed):
    """The steering laws by themselves, with the parameters of ``tracking_parameters``."""
    to_north, to_east = reference.north - north, reference.east - east
    if isinstance(law, LineOfSightLaw):
        return line_of_sight_law(to_north, to_east, course, 1.5)
    state = relative_state(LOOK_AHEAD, to_north, to_east, reference.course, course)
    _, omega_rho = relative_velocity(LOOK_AHEAD, state, SPEED, speed, reference.heading_rate)
    if isinstance(law, CascadeLaw):
        return cascade_law(state.phi, omega_rho, 1.5, 0.4)
    return lyapunov_law(state, speed, omega_rho, 0.001)


@pytest.mark.parametrize("law", [CascadeLaw(), LyapunovLaw(), LineOfSightLaw()])
@examples(100)
@given(
    north=st.floats(-400.0, 400.0),
    east=st.floats(-400.0, 400.0),
    course=st.floats(-math.pi, math.pi),
    speed=st.floats(15.0, 25.0),
    heading_rate=st.floats(-1.0, 1.0),
)
def test_without_lag_the_command_is_the_law_now_whatever_the_measured_heading_rate(
    law, north, east, course, speed, heading_rate
):
    tracker = Tracker(
        tracking_parameters(law=law), make_reference(paper_oscillation(0.5), phase=0.4)
    )
    # The reference as it is before the step moves it on.
    demand = law_command(law, tracker.reference, north, east, course, speed)
    command = tracker.step(north, east, course, speed, heading_rate)
    # The same arithmetic.
    assert tracker.heading_rate_demand == demand
    assert (
        command
        == tracker.heading_rate_command
        == min(max(demand, -HEADING_RATE_MAX), HEADING_RATE_MAX)
    )
    assert tracker.saturated == (abs(demand) > HEADING_RATE_MAX)


@pytest.mark.parametrize("heading_rate", [-0.3, 0.0, 0.3])
def test_with_lag_the_command_is_the_law_as_it_will_stand_then(heading_rate):
    lag = 0.4
    reference = make_reference(paper_oscillation(0.5))
    tracker = Tracker(tracking_parameters(lag=lag), copy.copy(reference))
    for _ in range(8):
        reference.step()
    # Nearly towards the end of the look-ahead, where h is within its bound.
    command = tracker.step(-30.0, 10.0, 1.1, SPEED, heading_rate)
    # No command yet, so the heading rate falls from the measured one to 0 at constant rate:
    # integrated finely here.
    north, east, course = -30.0, 10.0, 1.1
    pieces = 4000
    for piece in range(pieces):
        north += SPEED * math.cos(course) * lag / pieces
        east += SPEED * math.sin(course) * lag / pieces
        course += heading_rate * (1.0 - (piece + 0.5) / pieces) * lag / pieces
    # The tracker goes straight along the mean course; the bend, half the variance of 3e-4 rad^2,
    # shortens 7.8 m by 1 mm, which is 2e-5 of the look-ahead. Measured, 3e-6 rad/s, and as much
    # from the pieces here.
    demand = law_command(CascadeLaw(), reference, north, east, course, SPEED)
    assert command == pytest.approx(demand, rel=0.0, abs=2e-5)
    # Well within both bounds, of h and of the command.
    assert abs(demand) < 0.2


@pytest.mark.parametrize(
    ("nu", "law", "delay"),
    [(0.1, CascadeLaw(), 0.1), (0.5, CascadeLaw(), 0.5), (0.5, LyapunovLaw(), 0.3)],
)
def test_preview_makes_up_for_a_vehicle_that_answers_late(nu, law, delay):
    errors = []
    for lag in (0.0, delay):
        guidance = make_guidance(
            make_reference(paper_oscillation(nu, reserve=0.1)), law=law, lag=lag
        )
        flight = fly(guidance, (-60.0, 40.0, 0.5), duration=120.0, delay=delay)
        errors.append(float(np.sqrt(np.mean(flight.distance[-1000:] ** 2))))
    without, with_preview = errors
    # Late by delay, the heading rate is wrong by up to A omega_0 delay. Measured, preview reduces
    # the error five to forty times.
    assert with_preview < without / 4.0
    # What is left is the vehicle holding its command over a guidance step, half of which is another
    # 0.025 s late.
    assert with_preview < 0.3
