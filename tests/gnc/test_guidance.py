import math

import numpy as np
import pytest
from gnc.safety.guard_parameters import GuardParameters
from gnc_cases import (
    HEADING_RATE_MAX,
    SPEED,
    TIME_STEP,
    examples,
    fly,
    make_guidance,
    make_reference,
    motion,
    paper_oscillation,
)
from hypothesis import given
from hypothesis import strategies as st

from gnc.estimation.vessel import Tube
from gnc.laws import CascadeLaw, LineOfSightLaw, LyapunovLaw
from gnc.paper import PlumeAxis, distance_by_paper

# 0.75 of the tracking allowance of 1 m about its 200 m (scenarios/planning/tracking_flight.py).
# These vehicles answer at once.
GUARD = GuardParameters(
    radius=200.75,
    heading_rate_max=HEADING_RATE_MAX,
    lag=0.0,
    delay=0.0,
    slow_lag=0.0,
    time_step=TIME_STEP,
)


class RecordingGuard:
    """Says what it was asked, and answers a fixed command."""

    def __init__(self, answer, *, intervening=True, allowed=True):
        self.answer = answer
        self.intervening, self.allowed = intervening, allowed
        self.asked, self.slowest, self.asked_to_allow, self.tubes = [], [], [], ()

    def allows(self, _command, _time, _own, speed, _slowest):
        self.asked_to_allow.append(speed)
        return self.allowed

    def limit(self, _, time, own, speed, slowest):
        self.slowest.append(slowest)
        motion = (
            own.ground_north,
            own.ground_east,
            own.wind_north,
            own.wind_east,
            own.course,
            own.heading_rate,
        )
        self.asked.append((time, *motion, speed))
        return self.answer


class OnItsWay:
    """A mission that overrides its tracker at all times, at an airspeed of its own."""

    overriding, leaving = True, False

    def __init__(self, mission, airspeed):
        self.tracker, self.altitude, self.airspeed, self.plan = (
            mission.tracker,
            mission.altitude,
            airspeed,
            mission.plan,
        )
        self.told = []

    def command(self, last_command):
        self.told.append(last_command)
        return 0.1


@pytest.fixture
def guarded_by(monkeypatch):
    """Return a function that makes the paper's guidance with another guard."""

    def guarded_by(guard, **how):
        monkeypatch.setattr("gnc.compose.KeepoutGuard", lambda _: guard)
        return make_guidance(make_reference(paper_oscillation(0.5)), guard=GUARD, **how)

    return guarded_by


def about_a_vessel(nu, *, guard):
    """Return the guidance of a flight behind a vessel that goes north from the origin, as the paper
    places it about 200 m.
    """
    oscillation = paper_oscillation(nu, reserve=0.015)
    centre = (-distance_by_paper(oscillation, PlumeAxis(heading=math.pi), 201.0), 0.0)
    return make_guidance(
        make_reference(oscillation, centre=centre), vessel=(nu * SPEED, 0.0), guard=guard
    )


@examples(200)
@given(
    law=st.sampled_from([CascadeLaw(), LyapunovLaw(), LineOfSightLaw()]),
    lag=st.sampled_from([0.0, 0.4]),
    guard=st.sampled_from([None, GUARD]),
    motions=st.lists(
        st.tuples(
            st.floats(-1e4, 1e4),
            st.floats(-1e4, 1e4),
            st.floats(-10.0, 10.0),
            st.floats(0.1, 60.0),
            st.floats(-2.0, 2.0),
        ),
        min_size=1,
        max_size=4,
    ),
)
def test_no_command_exceeds_its_bound_whatever_the_state(law, lag, guard, motions):
    reference = make_reference(paper_oscillation(0.5), centre=(-214.0, 0.0))
    guidance = make_guidance(
        reference, law=law, lag=lag, airspeed_gain=0.15, guard=guard, vessel=(0.5 * SPEED, 0.0)
    )
    for now in motions:
        guidance.step(0.0, motion(*now))
        assert abs(guidance.heading_rate_command) <= HEADING_RATE_MAX
        assert abs(guidance.airspeed_command - SPEED) <= 1.0 + 1e-14  # rounding of the sum


@pytest.mark.parametrize(
    ("along", "right", "expected"),
    [
        # Commanded airspeed is V_r plus 0.15/s of the way that the vehicle is behind, within 1 m/s
        # (AlongTrackTrim).
        (0.0, 30.0, SPEED),
        (-4.0, -30.0, SPEED + 0.6),
        (50.0, 0.0, SPEED - 1.0),
    ],
)
@pytest.mark.parametrize("lag", [0.0, 0.4])
def test_the_airspeed_is_trimmed_by_the_along_track_error_within_its_limit(
    along, right, expected, lag
):
    # The error now, whatever the lag of the heading rate.
    reference = make_reference(paper_oscillation(0.5), centre=(100.0, 50.0), vessel_course=0.8)
    guidance = make_guidance(reference, airspeed_gain=0.15, lag=lag)
    cos, sin = math.cos(reference.course), math.sin(reference.course)
    north, east = (
        reference.north + along * cos - right * sin,
        reference.east + along * sin + right * cos,
    )
    guidance.step(0.0, motion(north, east, reference.course))
    # Rounding of 100 m.
    assert guidance.airspeed_command == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("answer", [0.2, -0.3, 0.0])
def test_the_guards_answer_is_what_is_commanded(guarded_by, answer):
    guidance = guarded_by(RecordingGuard(answer))
    guidance.step(0.0, motion(-300.0, 0.0, 0.0))
    assert guidance.heading_rate_command == answer
    # The tracker's preview goes on from it.
    assert guidance.mission.tracker.heading_rate_command == answer


@pytest.mark.parametrize("lag", [0.0, 0.4])
def test_the_guard_is_asked_about_the_motion_now_and_gets_a_disc_without_width(guarded_by, lag):
    guidance = guarded_by(RecordingGuard(0.0), lag=lag, vessel=(3.0, -2.0))
    guidance.step(5.0, motion(-300.0, 20.0, 0.7, SPEED + 0.5, 0.1))
    # Course and speed come back from the velocities: roundings.
    assert guidance.guard.asked[0] == pytest.approx(
        (5.0, -300.0, 20.0, 0.0, 0.0, 0.7, 0.1, SPEED + 0.5), rel=1e-14
    )
    # From the origin at time 0, and known exactly for good.
    assert guidance.guard.tubes == (Tube(0.0, 0.0, 0.0, 3.0, -2.0, 0.0, 0.0, 0.0),)


def test_the_guard_reckons_with_the_airspeed_that_comes_back(guarded_by):
    # Trimmed to less than V_r, the vehicle is back at V_r in a turn away; the guard takes it to be
    # there.
    guidance = guarded_by(RecordingGuard(0.0))
    guidance.step(0.0, motion(-300.0, 20.0, 0.7, SPEED - 1.0, 0.1))
    assert guidance.guard.asked[0][-1] == SPEED
    # And to be as slow as it is, for against a disc that closes in the slower vehicle may come
    # nearer.
    assert guidance.guard.slowest[0] == pytest.approx(SPEED - 1.0, rel=1e-14)


def test_an_airspeed_that_is_flown_in_place_of_the_one_commanded_is_reckoned_with(guarded_by):
    guard = RecordingGuard(0.0)
    guard.overruled = lambda _: None
    guidance = guarded_by(guard)
    guidance.step(0.0, motion(-300.0, 20.0, 0.7))
    guidance.overruled(0.1, SPEED + 3.0)
    guidance.step(TIME_STEP, motion(-300.0, 20.0, 0.7))
    assert guard.asked[-1][-1] == SPEED + 3.0


@pytest.mark.parametrize("allowed", [True, False])
def test_on_the_way_it_flies_faster_only_where_the_guard_allows_that(guarded_by, allowed):
    guard = RecordingGuard(0.0, intervening=False, allowed=allowed)
    guidance = guarded_by(guard)
    guidance.mission = OnItsWay(guidance.mission, SPEED + 2.0)
    for step in range(3):
        guidance.step(step * TIME_STEP, motion(-300.0, 20.0, 0.7))
        assert guidance.airspeed_command == (SPEED + 2.0 if allowed else SPEED)
    # Once allowed it need not be asked again; what it is asked with, it goes on with.
    assert guard.asked_to_allow == [SPEED + 2.0] * (1 if allowed else 3)
    assert [asked[-1] for asked in guard.asked] == [SPEED + 2.0 if allowed else SPEED] * 3


@pytest.mark.parametrize(
    ("intervening", "allowed", "airspeed"),
    [(True, True, SPEED), (False, False, SPEED), (False, True, SPEED + 1.0)],
)
def test_it_catches_up_only_where_the_guard_allows_that_and_does_not_intervene(
    guarded_by, intervening, allowed, airspeed
):
    guidance = guarded_by(
        RecordingGuard(0.0, intervening=intervening, allowed=allowed), airspeed_gain=0.15
    )
    # Far behind the reference: trimmed by all of 1 m/s.
    reference = guidance.mission.tracker.reference
    behind = (
        reference.north - 60.0 * math.cos(reference.course),
        reference.east - 60.0 * math.sin(reference.course),
    )
    guidance.step(0.0, motion(*behind, reference.course))
    assert (guidance.airspeed_command, guidance.guarding) == (airspeed, intervening)


def test_it_catches_up_once_the_guard_has_been_free_for_a_quarter_of_a_turn(guarded_by):
    guard = RecordingGuard(0.0)
    guidance = guarded_by(guard, airspeed_gain=0.15)
    guidance.step(0.0, motion(-300.0, 0.0, 0.0))
    guard.intervening = False
    commanded = []
    for step in range(1, 100):
        reference = guidance.mission.tracker.reference
        behind = (
            reference.north - 60.0 * math.cos(reference.course),
            reference.east - 60.0 * math.sin(reference.course),
        )
        guidance.step(step * TIME_STEP, motion(*behind, reference.course))
        commanded.append(guidance.airspeed_command)
    waiting = math.ceil(0.5 * math.pi / HEADING_RATE_MAX / TIME_STEP) - 1
    assert commanded == [SPEED] * waiting + [SPEED + 1.0] * (99 - waiting)


@pytest.mark.parametrize("nu", [0.1, 0.5, 0.8])
def test_from_ahead_of_the_vessel_only_the_guard_keeps_the_vehicle_out(nu):
    # paper-notes, care 13: nothing in the law avoids the keep-out area, and from ahead of the
    # vessel the way leads through it.
    unguarded, guarded = (
        np.min(
            fly(about_a_vessel(nu, guard=guard), (600.0, 30.0, math.pi), duration=400.0).to_vessel
        )
        for guard in (None, GUARD)
    )
    # Straight through: measured, 2 to 14 m.
    assert unguarded < 50.0
    # The guard's radius, at the steps at least; it is good to its looks everywhere.
    assert guarded >= 200.75


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("nu", [0.0, 0.1, 0.5])
def test_from_astern_a_guarded_vehicle_settles_and_keeps_out(nu, seed):
    # Starts as in scenarios/schema/sections/flight.py: 400 to 800 m away, within 30 degrees of
    # astern, on any course.
    generator = np.random.default_rng(seed)
    distance, bearing = (
        generator.uniform(400.0, 800.0),
        math.pi + generator.uniform(-math.pi / 6.0, math.pi / 6.0),
    )
    start = (
        distance * math.cos(bearing),
        distance * math.sin(bearing),
        generator.uniform(-math.pi, math.pi),
    )
    flight = fly(about_a_vessel(nu, guard=GUARD), start, duration=400.0)
    # Orbit and guard both keep more than the keep-out area's 200 m: 201 and 200.75 m.
    assert np.min(flight.to_vessel) >= 200.75
    # Settled within the half metre that the commands' being held leaves; see test_tracker.py.
    assert np.max(flight.distance[-600:]) < 0.5


def test_a_mission_that_overrides_is_told_what_was_flown_and_not_what_the_law_demands_meanwhile():
    guidance = make_guidance(make_reference(paper_oscillation(0.5)), lag=0.4)
    guidance.mission = OnItsWay(guidance.mission, SPEED)
    for step in range(3):
        guidance.step(step * TIME_STEP, motion(-300.0, 0.0, 2.0))
    assert abs(guidance.mission.tracker.heading_rate_demand - 0.1) > 0.1
    assert guidance.mission.told == [0.0, 0.1, 0.1]
