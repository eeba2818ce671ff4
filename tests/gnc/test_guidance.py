import math

import numpy as np
import pytest
from gnc_cases import (
    HEADING_RATE_MAX,
    LOOK_AHEAD,
    SPEED,
    examples,
    fly,
    guidance_parameters,
    make_guidance,
    paper_oscillation,
)
from hypothesis import given
from hypothesis import strategies as st

from gnc.laws.cascade import CascadeLaw, cascade_law
from gnc.laws.delta import relative_state, relative_velocity
from gnc.laws.line_of_sight import LineOfSightLaw, line_of_sight_law
from gnc.laws.lyapunov import LyapunovLaw, lyapunov_law
from gnc.reference.oscillating import OscillatingReference, start_reference
from gnc.reference.placement import PlumeAxis, distance_by_paper
from gnc.safety.keepout_guard import KeepoutGuard

TIME_STEP = 0.05
NOWHERE = (0.0, 0.0, 0.0, 0.0)
"""A disc about the origin, at rest."""
LAWS = pytest.mark.parametrize("law", [CascadeLaw(), LyapunovLaw(), LineOfSightLaw()], ids=["cascade", "lyapunov", "line_of_sight"])


def law_command(law, reference, north, east, course, speed):
    """The steering laws by themselves, with the parameters of ``guidance_parameters``."""
    to_north, to_east = reference.north - north, reference.east - east
    if isinstance(law, LineOfSightLaw):
        return line_of_sight_law(to_north, to_east, course, 1.5)
    state = relative_state(LOOK_AHEAD, to_north, to_east, reference.course, course)
    _, omega_rho = relative_velocity(LOOK_AHEAD, state, SPEED, speed, reference.heading_rate)
    if isinstance(law, CascadeLaw):
        return cascade_law(state.phi, omega_rho, 1.5, 0.4)
    return lyapunov_law(state, speed, omega_rho, 0.001)


def make_guard():
    # 0.75 of the tracking allowance of 1 m about its 200 m (scenarios/planning/planner.py). These vehicles answer at once.
    return KeepoutGuard(radius=200.75, heading_rate_max=HEADING_RATE_MAX, lag=0.0, time_step=TIME_STEP)


class RecordingGuard:
    """Says what it was asked, and answers a fixed command."""

    def __init__(self, answer, *, intervening=True):
        self.answer = answer
        self.intervening = intervening
        self.asked = []

    def limit(self, _, *motion):
        self.asked.append(motion)
        return self.answer


@examples(200)
@given(
    law=st.sampled_from([CascadeLaw(), LyapunovLaw(), LineOfSightLaw()]),
    lag=st.sampled_from([0.0, 0.4]),
    guarded=st.booleans(),
    motions=st.lists(
        st.tuples(st.floats(-1e4, 1e4), st.floats(-1e4, 1e4), st.floats(-10.0, 10.0), st.floats(0.1, 60.0), st.floats(-2.0, 2.0)),
        min_size=1,
        max_size=4,
    ),
)
def test_no_command_exceeds_its_bound_whatever_the_state(law, lag, guarded, motions):
    parameters = guidance_parameters(law=law, lag=lag, airspeed_gain=0.15)
    guidance = make_guidance(parameters, paper_oscillation(0.5), centre=(-214.0, 0.0), guard=make_guard() if guarded else None)
    for motion in motions:
        guidance.step(*motion, disc=(0.0, 0.0, 0.5 * SPEED, 0.0))
        # What the guard mixes of two commands rounds.
        assert abs(guidance.heading_rate_command) <= HEADING_RATE_MAX * (1.0 + 1e-15)
        assert abs(guidance.airspeed_command - SPEED) <= 1.0 + 1e-14  # rounding of the sum


@LAWS
@examples(100)
@given(
    north=st.floats(-400.0, 400.0),
    east=st.floats(-400.0, 400.0),
    course=st.floats(-math.pi, math.pi),
    speed=st.floats(15.0, 25.0),
    heading_rate=st.floats(-1.0, 1.0),
)
def test_without_lag_the_command_is_the_law_now_whatever_the_measured_heading_rate(law, north, east, course, speed, heading_rate):
    oscillation = paper_oscillation(0.5)
    guidance = make_guidance(guidance_parameters(law=law), oscillation, phase=0.4)
    # The reference as it is before the step moves it on.
    wanted = law_command(law, guidance.reference, north, east, course, speed)
    guidance.step(north, east, course, speed, heading_rate)
    # The same arithmetic.
    assert guidance.heading_rate_command == min(max(wanted, -HEADING_RATE_MAX), HEADING_RATE_MAX)
    assert guidance.saturated == (abs(wanted) > HEADING_RATE_MAX)


@pytest.mark.parametrize("heading_rate", [-0.3, 0.0, 0.3])
def test_with_lag_the_command_is_the_law_as_it_will_stand_then(heading_rate):
    oscillation = paper_oscillation(0.5)
    lag = 0.4
    guidance = make_guidance(guidance_parameters(lag=lag), oscillation)
    ahead = OscillatingReference(
        oscillation,
        start_reference(oscillation, phase=0.0, centre_north=0.0, centre_east=0.0, vessel_course=0.0),
        phase=0.0,
        time_step=TIME_STEP,
    )
    for _ in range(8):
        ahead.step()
    # Nearly towards the end of the look-ahead, where h is within its bound.
    guidance.step(-30.0, 10.0, 1.1, SPEED, heading_rate)
    # No command yet, so the heading rate falls from the measured one to 0 at constant rate: integrated finely here.
    north, east, course = -30.0, 10.0, 1.1
    pieces = 4000
    for piece in range(pieces):
        north += SPEED * math.cos(course) * lag / pieces
        east += SPEED * math.sin(course) * lag / pieces
        course += heading_rate * (1.0 - (piece + 0.5) / pieces) * lag / pieces
    # The guidance goes straight along the mean course; the bend, half the variance of 3e-4 rad^2, shortens 7.8 m by 1 mm, which
    # is 2e-5 of the look-ahead. Measured, 3e-6 rad/s, and as much from the pieces here.
    wanted = law_command(CascadeLaw(), ahead, north, east, course, SPEED)
    assert guidance.heading_rate_command == pytest.approx(wanted, rel=0.0, abs=2e-5)
    # Well within both bounds, of h and of the command.
    assert abs(wanted) < 0.2


@pytest.mark.parametrize("delay", [0.1, 0.3, 0.5])
@pytest.mark.parametrize("law", [CascadeLaw(), LyapunovLaw()], ids=["cascade", "lyapunov"])
@pytest.mark.parametrize("nu", [0.1, 0.5])
def test_preview_makes_up_for_a_vehicle_that_answers_late(nu, law, delay):
    oscillation = paper_oscillation(nu, reserve=0.1)
    errors = []
    for lag in (0.0, delay):
        guidance = make_guidance(guidance_parameters(law=law, lag=lag), oscillation)
        flight = fly(guidance, (-60.0, 40.0, 0.5), duration=120.0, delay=delay)
        errors.append(float(np.sqrt(np.mean(flight.distance[-1000:] ** 2))))
    without, with_preview = errors
    # Late by delay, the heading rate is wrong by up to A omega_0 delay. Measured, preview reduces the error five to forty times.
    assert with_preview < without / 4.0
    # What is left is the vehicle holding its command over a guidance step, half of which is another 0.025 s late.
    assert with_preview < 0.3


@LAWS
@pytest.mark.parametrize("delay", [0.0, 0.3])
def test_mirrored_flights_are_commanded_mirrored(law, delay):
    # Without a guard: riding along its edge, the guard's choices hang on roundings. Its own mirror is in test_keepout_guard.py.
    oscillation = paper_oscillation(0.5, reserve=0.1)
    parameters = guidance_parameters(law=law, lag=delay, airspeed_gain=0.15)
    flights = []
    # The mirror image of the course eta cos(omega_0 t + phi_0) is that with phi_0 + pi.
    for side, phase in ((1.0, 0.4), (-1.0, 0.4 + math.pi)):
        guidance = make_guidance(parameters, oscillation, phase=phase, centre=(-214.0, side * 10.0), vessel_course=side * 0.2)
        flights.append(fly(guidance, (350.0, side * 60.0, side * 3.0), duration=90.0, delay=delay))
    one, other = flights
    # Roundings of 1e-13 m at first, which the loop, being stable, does not amplify much.
    np.testing.assert_allclose(other.command, -one.command, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(other.north, one.north, rtol=0.0, atol=1e-7)
    np.testing.assert_allclose(other.east, -one.east, rtol=0.0, atol=1e-7)
    # And there was something to mirror.
    assert np.ptp(one.command) > 0.1


@pytest.mark.parametrize("nu", [0.0, 0.5, 0.8])
@pytest.mark.parametrize("law", [CascadeLaw(), LyapunovLaw()], ids=["cascade", "lyapunov"])
def test_a_kinematic_vehicle_settles_on_the_reference_at_20_hertz(nu, law):
    guidance = make_guidance(guidance_parameters(law=law), paper_oscillation(nu, reserve=0.1), centre=(-214.0, 0.0))
    flight = fly(guidance, (-300.0, 60.0, 2.0), duration=200.0)
    # Held over a step of 0.05 s, the command is 0.025 s late; that leaves up to 0.6 m, measured at nu = 0.8 under the Lyapunov law.
    assert np.max(flight.distance[-1000:]) < 0.8
    assert flight.distance[0] > 100.0


@pytest.mark.parametrize(
    ("along", "right", "expected"),
    [
        # Commanded airspeed is V_r plus 0.15/s of the way that the vehicle is behind, within 1 m/s (GuidanceParameters).
        (-4.0, 0.0, SPEED + 0.6),
        (4.0, 0.0, SPEED - 0.6),
        (0.0, 30.0, SPEED),
        (-4.0, -30.0, SPEED + 0.6),
        (-50.0, 0.0, SPEED + 1.0),
        (50.0, 0.0, SPEED - 1.0),
    ],
)
@pytest.mark.parametrize("lag", [0.0, 0.4])
def test_the_airspeed_is_trimmed_by_the_along_track_error_within_its_limit(along, right, expected, lag):
    # The error now, whatever the lag of the heading rate.
    parameters = guidance_parameters(airspeed_gain=0.15, lag=lag)
    guidance = make_guidance(parameters, paper_oscillation(0.5), centre=(100.0, 50.0), vessel_course=0.8)
    reference = guidance.reference
    cos, sin = math.cos(reference.course), math.sin(reference.course)
    guidance.step(
        reference.north + along * cos - right * sin, reference.east + along * sin + right * cos, reference.course, SPEED, 0.0
    )
    # Rounding of 100 m.
    assert guidance.airspeed_command == pytest.approx(expected, abs=1e-12)


def test_without_an_airspeed_gain_the_airspeed_stays():
    guidance = make_guidance(guidance_parameters(airspeed_gain=0.0), paper_oscillation(0.5))
    for _ in range(3):
        guidance.step(-300.0, 0.0, 0.0, SPEED, 0.0)
        assert guidance.airspeed_command == SPEED


@pytest.mark.parametrize("lag", [0.0, 0.4])
def test_the_reference_shown_is_the_one_now_also_with_preview(lag):
    oscillation = paper_oscillation(0.3)
    guidance = make_guidance(guidance_parameters(lag=lag), oscillation, phase=0.7, centre=(-214.0, 5.0), vessel_course=0.3)
    start = start_reference(oscillation, phase=0.7, centre_north=-214.0, centre_east=5.0, vessel_course=0.3)
    alone = OscillatingReference(oscillation, start, phase=0.7, time_step=TIME_STEP)
    for _ in range(100):
        shown = guidance.reference
        # The same arithmetic.
        assert (shown.north, shown.east, shown.course, shown.heading_rate) == (
            alone.north,
            alone.east,
            alone.course,
            alone.heading_rate,
        )
        guidance.step(0.0, 0.0, 0.0, SPEED, 0.0)
        alone.step()


@pytest.mark.parametrize("answer", [0.2, -0.3, 0.0])
def test_the_guards_answer_is_what_is_commanded(answer):
    guidance = make_guidance(guidance_parameters(), paper_oscillation(0.5), guard=RecordingGuard(answer))
    guidance.step(-300.0, 0.0, 0.0, SPEED, 0.0, NOWHERE)
    assert guidance.heading_rate_command == answer


@pytest.mark.parametrize("lag", [0.0, 0.4])
def test_the_guard_is_asked_about_the_motion_now_relative_to_the_disc(lag):
    guidance = make_guidance(guidance_parameters(lag=lag), paper_oscillation(0.5), guard=RecordingGuard(0.0))
    guidance.step(-300.0, 20.0, 0.7, SPEED + 0.5, 0.1, (10.0, 5.0, 3.0, -2.0))
    assert guidance.guard.asked == [(-310.0, 15.0, 3.0, -2.0, 0.7, SPEED + 0.5, 0.1)]


def test_the_guard_reckons_with_the_airspeed_that_comes_back():
    # Trimmed to less than V_r, the vehicle is back at V_r in a turn away; the guard takes it to be there.
    guidance = make_guidance(guidance_parameters(), paper_oscillation(0.5), guard=RecordingGuard(0.0))
    guidance.step(-300.0, 20.0, 0.7, SPEED - 1.0, 0.1, NOWHERE)
    assert guidance.guard.asked[0][5] == SPEED


@pytest.mark.parametrize(("intervening", "airspeed"), [(True, SPEED), (False, SPEED + 1.0)])
def test_while_the_guard_intervenes_the_airspeed_is_not_trimmed(intervening, airspeed):
    guard = RecordingGuard(0.0, intervening=intervening)
    guidance = make_guidance(guidance_parameters(airspeed_gain=0.15), paper_oscillation(0.5), guard=guard)
    # Far behind the reference: trimmed by all of 1 m/s.
    reference = guidance.reference
    behind = (reference.north - 60.0 * math.cos(reference.course), reference.east - 60.0 * math.sin(reference.course))
    guidance.step(*behind, reference.course, SPEED, 0.0, NOWHERE)
    assert guidance.airspeed_command == airspeed


def test_a_guard_that_is_not_told_where_the_disc_is_is_refused():
    guidance = make_guidance(guidance_parameters(), paper_oscillation(0.5), guard=make_guard())
    with pytest.raises(ValueError, match="was not told where the disc is"):
        guidance.step(-300.0, 0.0, 0.0, SPEED, 0.0)


def test_flights_do_not_share_the_guards_memory():
    guard = make_guard()
    guidance = make_guidance(guidance_parameters(), paper_oscillation(0.5), guard=guard)
    guidance.step(-230.0, 0.0, 0.0, SPEED, 0.0, NOWHERE)
    assert guidance.guard.interventions == 1
    assert guard.interventions == 0


@pytest.mark.parametrize("nu", [0.1, 0.5, 0.8])
def test_from_ahead_of_the_vessel_only_the_guard_keeps_the_vehicle_out(nu):
    # paper-notes, care 13: nothing in the law avoids the keep-out area, and from ahead of the vessel the way leads through it.
    oscillation = paper_oscillation(nu, reserve=0.015)
    centre = (-distance_by_paper(oscillation, PlumeAxis(heading=math.pi), 201.0), 0.0)
    closest = []
    for guard in (None, make_guard()):
        guidance = make_guidance(guidance_parameters(), oscillation, centre=centre, guard=guard)
        flight = fly(guidance, (600.0, 30.0, math.pi), duration=400.0, vessel=(nu * SPEED, 0.0))
        times = TIME_STEP * np.arange(flight.north.size)
        closest.append(float(np.min(np.hypot(flight.north - nu * SPEED * times, flight.east))))
    unguarded, guarded = closest
    # Straight through: measured, 2 to 14 m.
    assert unguarded < 50.0
    # The guard's radius, at the steps at least; it is good to its looks everywhere.
    assert guarded >= 200.75


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("nu", [0.0, 0.1, 0.5])
def test_from_astern_a_guarded_vehicle_settles_and_keeps_out(nu, seed):
    # Starts as in scenarios/schema/config.py: 400 to 800 m away, within 30 degrees of astern, on any course.
    generator = np.random.default_rng(seed)
    distance, bearing = generator.uniform(400.0, 800.0), math.pi + generator.uniform(-math.pi / 6.0, math.pi / 6.0)
    start = (distance * math.cos(bearing), distance * math.sin(bearing), generator.uniform(-math.pi, math.pi))
    oscillation = paper_oscillation(nu, reserve=0.015)
    centre = (-distance_by_paper(oscillation, PlumeAxis(heading=math.pi), 201.0), 0.0)
    guidance = make_guidance(guidance_parameters(), oscillation, centre=centre, guard=make_guard())
    flight = fly(guidance, start, duration=400.0, vessel=(nu * SPEED, 0.0))
    times = TIME_STEP * np.arange(flight.north.size)
    # Orbit and guard both keep more than the keep-out area's 200 m: 201 and 200.75 m.
    assert np.min(np.hypot(flight.north - nu * SPEED * times, flight.east)) >= 200.75
    # Settled within the half metre that the commands' being held leaves; see above.
    assert np.max(flight.distance[-600:]) < 0.5
