import math

import numpy as np
import pytest
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
from gnc.guard.guard import Guarded, GuardParameters, GuardStatus
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
    """Records what it has to filter, and returns the same commands at each step."""

    def __init__(self, guarded):
        self.guarded = guarded
        self.intervening = False
        self.demands, self.motions, self.vessels, self.replaced = [], [], [], []

    def filter(self, demand, own, vessels):
        self.demands.append(demand)
        place = (own.ground_north, own.ground_east, own.course, own.heading_rate, own.speed)
        self.motions.append((*place, own.wind_north, own.wind_east))
        self.vessels.append(vessels)
        return self.guarded

    def replace(self, heading_rate, pace=None):
        self.replaced.append((heading_rate, pace))


class RecordingFilter:
    """Records the airspeeds that it has to keep out at, and lets a fixed heading rate be flown."""

    def __init__(self, answer=0.0, *, status=GuardStatus.INTERVENING, allowed=True):
        self.answer, self.status, self.allowed = answer, status, allowed
        self.consulted, self.fastest, self.slowest = [], [], []

    def allows(self, _command, _time, _own, _vessels, fastest, _slowest):
        self.consulted.append(fastest)
        return self.allowed

    def limit(self, _command, _time, _own, _vessels, fastest, slowest):
        self.fastest.append(fastest)
        self.slowest.append(slowest)
        return self.answer

    def replace(self, _):
        pass


class OnTheWay:
    """A mission that overrides its tracker at all times, at another airspeed."""

    overriding, leaving = True, False

    def __init__(self, mission, airspeed):
        self.tracker, self.altitude, self.plan = mission.tracker, mission.altitude, mission.plan
        self.airspeed = airspeed
        self.last_commands = []

    def command(self, last_command):
        self.last_commands.append(last_command)
        return 0.1


@pytest.fixture
def guarded_by(monkeypatch):
    """Return a function that makes the paper's guidance with another guard."""

    def guarded_by(guard, **how):
        monkeypatch.setattr("gnc.compose.KeepoutGuard", lambda *_: guard)
        return make_guidance(make_reference(paper_oscillation(0.5)), guard=GUARD, **how)

    return guarded_by


@pytest.fixture
def filtered_by(monkeypatch):
    """Return a function that makes the paper's guidance with another filter of heading rates."""

    def filtered_by(heading_rates, **how):
        monkeypatch.setattr("gnc.guard.guard.HeadingRateFilter", lambda _: heading_rates)
        return make_guidance(make_reference(paper_oscillation(0.5)), guard=GUARD, **how)

    return filtered_by


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
def test_no_command_exceeds_its_bound_in_any_state(law, lag, guard, motions):
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
    # The error now, with any lag of the heading rate.
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
def test_the_guards_heading_rate_is_commanded(guarded_by, answer):
    guidance = guarded_by(RecordingGuard(Guarded(answer, SPEED, True, GuardStatus.INTERVENING)))
    guidance.step(0.0, motion(-300.0, 0.0, 0.0))
    assert guidance.heading_rate_command == answer
    assert guidance.guarding
    # The tracker's preview goes on from it.
    assert guidance.mission.tracker.heading_rate_command == answer


@pytest.mark.parametrize("lag", [0.0, 0.4])
def test_the_guard_gets_the_motion_now_and_a_disc_without_width(guarded_by, lag):
    guard = RecordingGuard(Guarded(0.0, SPEED, False, GuardStatus.FREE))
    guidance = guarded_by(guard, lag=lag, vessel=(3.0, -2.0))
    guidance.step(5.0, motion(-300.0, 20.0, 0.7, SPEED + 0.5, 0.1))
    (demand,), (now,) = guard.demands, guard.motions
    assert (demand.time, demand.pace, demand.leaving) == (5.0, SPEED, False)
    # Course and speed come back from the velocities: roundings.
    assert now == pytest.approx((-300.0, 20.0, 0.7, 0.1, SPEED + 0.5, 0.0, 0.0), rel=1e-14)
    # From the origin at time 0, and known exactly for good.
    assert guard.vessels == [(Tube(0.0, 0.0, 0.0, 3.0, -2.0, 0.0, 0.0, 0.0),)]


def test_the_guard_takes_note_of_commands_that_are_flown_in_place_of_its_own(guarded_by):
    guard = RecordingGuard(Guarded(2.0 * HEADING_RATE_MAX, SPEED, False, GuardStatus.FREE))
    guidance = guarded_by(guard)
    guidance.step(0.0, motion(-300.0, 20.0, 0.7))
    # More than omega_max is not flown.
    assert guidance.heading_rate_command == HEADING_RATE_MAX
    guidance.overruled(0.1, SPEED + 3.0)
    assert guard.replaced == [(HEADING_RATE_MAX, None), (0.1, SPEED + 3.0)]


def test_a_turn_away_has_to_keep_off_at_v_r_and_at_the_airspeed_now(filtered_by):
    # Trimmed to less than V_r, the vehicle is back at V_r in a turn away. While a disc closes in
    # the slower vehicle may come nearer.
    heading_rates = RecordingFilter()
    guidance = filtered_by(heading_rates)
    guidance.step(0.0, motion(-300.0, 20.0, 0.7, SPEED - 1.0, 0.1))
    assert heading_rates.fastest == [SPEED]
    assert heading_rates.slowest == pytest.approx([SPEED - 1.0], rel=1e-14)


def test_a_turn_away_has_to_keep_off_at_an_airspeed_that_is_flown_in_place_of_the_commanded_one(
    filtered_by,
):
    heading_rates = RecordingFilter()
    guidance = filtered_by(heading_rates)
    guidance.step(0.0, motion(-300.0, 20.0, 0.7))
    guidance.overruled(0.1, SPEED + 3.0)
    guidance.step(TIME_STEP, motion(-300.0, 20.0, 0.7))
    assert heading_rates.fastest[-1] == SPEED + 3.0


@pytest.mark.parametrize("allowed", [True, False])
def test_on_the_way_it_flies_faster_only_where_the_guard_allows_that(filtered_by, allowed):
    heading_rates = RecordingFilter(status=GuardStatus.FREE, allowed=allowed)
    guidance = filtered_by(heading_rates)
    guidance.mission = OnTheWay(guidance.mission, SPEED + 2.0)
    flown = SPEED + 2.0 if allowed else SPEED
    for step in range(3):
        guidance.step(step * TIME_STEP, motion(-300.0, 20.0, 0.7))
        assert guidance.airspeed_command == flown
    # Once a pace is flown it need not be allowed again.
    assert heading_rates.consulted == [SPEED + 2.0] * (1 if allowed else 3)
    assert heading_rates.fastest == [flown] * 3


def behind(reference):
    """Return the place and course of a vehicle 60 m behind a reference: trimmed by all of 1 m/s."""
    cos, sin = math.cos(reference.course), math.sin(reference.course)
    return reference.north - 60.0 * cos, reference.east - 60.0 * sin, reference.course


@pytest.mark.parametrize(
    ("status", "allowed", "airspeed"),
    [
        (GuardStatus.INTERVENING, True, SPEED),
        (GuardStatus.LOST, True, SPEED),
        (GuardStatus.FREE, False, SPEED),
        (GuardStatus.FREE, True, SPEED + 1.0),
    ],
)
def test_it_catches_up_only_where_the_guard_allows_that_and_does_not_intervene(
    filtered_by, status, allowed, airspeed
):
    guidance = filtered_by(RecordingFilter(status=status, allowed=allowed), airspeed_gain=0.15)
    guidance.step(0.0, motion(*behind(guidance.mission.tracker.reference)))
    assert guidance.airspeed_command == airspeed
    assert guidance.guarding == (status is not GuardStatus.FREE)


def test_it_catches_up_once_the_guard_has_been_free_for_a_quarter_of_a_turn(filtered_by):
    heading_rates = RecordingFilter()
    guidance = filtered_by(heading_rates, airspeed_gain=0.15)
    guidance.step(0.0, motion(-300.0, 0.0, 0.0))
    heading_rates.status = GuardStatus.FREE
    commanded = []
    for step in range(1, 100):
        guidance.step(step * TIME_STEP, motion(*behind(guidance.mission.tracker.reference)))
        commanded.append(guidance.airspeed_command)
    waiting = math.ceil(0.5 * math.pi / HEADING_RATE_MAX / TIME_STEP) - 1
    assert commanded == [SPEED] * waiting + [SPEED + 1.0] * (99 - waiting)


@pytest.mark.parametrize("nu", [0.1, 0.5, 0.8])
def test_from_ahead_of_the_vessel_only_the_guard_keeps_the_vehicle_out(nu):
    # Nothing in the paper's law avoids the keep-out area, and from ahead of the vessel the way
    # leads through it.
    unguarded, guarded = (
        np.min(
            fly(about_a_vessel(nu, guard=guard), (600.0, 30.0, math.pi), duration=400.0).to_vessel
        )
        for guard in (None, GUARD)
    )
    # Straight through: measured, 2 to 14 m.
    assert unguarded < 50.0
    # The guard's radius.
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
    # Settled within the half metre that holding commands leaves; see test_tracker.py.
    assert np.max(flight.distance[-600:]) < 0.5


def test_a_mission_that_overrides_gets_the_last_command_that_was_flown():
    # And not what the law demands meanwhile.
    guidance = make_guidance(make_reference(paper_oscillation(0.5)), lag=0.4)
    guidance.mission = OnTheWay(guidance.mission, SPEED)
    for step in range(3):
        guidance.step(step * TIME_STEP, motion(-300.0, 0.0, 2.0))
    assert abs(guidance.mission.tracker.heading_rate_demand - 0.1) > 0.1
    assert guidance.mission.last_commands == [0.0, 0.1, 0.1]
