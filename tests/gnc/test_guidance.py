"""The outer loop: its parts, chosen by parameters, and the commands that they make."""

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
    paper_parameters,
    tracking_parameters,
)
from hypothesis import given
from hypothesis import strategies as st
from thrust_cases import LEVEL, MODEL, accelerations

from gnc.airspeed import PaceHold, SpeedHold
from gnc.estimation.error_budget import ErrorBudget, Growth
from gnc.estimation.health import Fault, HealthParameters
from gnc.estimation.navigation import (
    EngineReadings,
    NavigationParameters,
)
from gnc.estimation.thrust import ThrustParameters
from gnc.estimation.vessel import (
    FilterParameters,
    VesselLimits,
    VesselReport,
)
from gnc.guard.guard import GuardParameters, GuardStatus
from gnc.guidance import Guidance, GuidanceParameters, ReportedVessel
from gnc.laws import CascadeLaw, LineOfSightLaw, LyapunovLaw
from gnc.mission.axis import AxisHeight, Climb, PredictedPlume
from gnc.mission.follow import FollowingParameters
from gnc.mission.mission import LOST, Mode, Order
from gnc.mission.way import ApproachParameters
from gnc.paper import PlumeAxis, distance_by_paper, half_widths
from gnc.reference.moving_centre import CentreParameters
from gnc.reference.shapes import Sinusoid
from gnc.unicycle import unicycle_move

# 0.75 of the tracking allowance of 1 m about its 200 m (scenarios/planning/missions.py).
# These vehicles answer at once.
QUICK_GUARD = GuardParameters(
    radius=200.75,
    heading_rate_max=HEADING_RATE_MAX,
    lag=0.0,
    delay=0.0,
    slow_lag=0.0,
    time_step=TIME_STEP,
)


class RecordingFilter:
    """Records the airspeeds that it has to keep out at, and lets a fixed heading rate be flown."""

    def __init__(self, answer=0.0, *, status=GuardStatus.INTERVENING, allowed=True):
        self.answer, self.status, self.allowed = answer, status, allowed
        self.consulted, self.fastest, self.slowest = [], [], []

    def allows(self, _command, _time, _own, _vessels, fastest, _slowest, _others):
        self.consulted.append(fastest)
        return self.allowed

    def limit(self, _command, _time, _own, _vessels, fastest, slowest, _others):
        self.fastest.append(fastest)
        self.slowest.append(slowest)
        return self.answer

    def replace(self, _):
        pass


class OnTheWay:
    """A mission that orders a heading rate at all times, at another airspeed than V_r."""

    def __init__(self, mission, airspeed):
        self.tracker, self._airspeed = mission.tracker, airspeed
        self.flown = []

    def plan(self, _time, _own, _vessel, **_):
        self.flown.append(self.tracker.heading_rate_command)
        return Order(0.1, self._airspeed, 60.0, Mode.APPROACH)


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
    guard=st.sampled_from([None, QUICK_GUARD]),
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
    north = reference.north + along * cos - right * sin
    east = reference.east + along * sin + right * cos
    guidance.step(0.0, motion(north, east, reference.course))
    # Rounding of 100 m.
    assert guidance.airspeed_command == pytest.approx(expected, abs=1e-12)


def test_a_turn_away_has_to_keep_off_at_v_r_and_at_the_airspeed_now(filtered_by):
    # Trimmed to less than V_r, the vehicle is back at V_r in a turn away. While a disc closes in
    # the slower vehicle may come nearer.
    heading_rates = RecordingFilter()
    guidance = filtered_by(heading_rates)
    guidance.step(0.0, motion(-300.0, 20.0, 0.7, SPEED - 1.0, 0.1))
    assert heading_rates.fastest == [SPEED]
    assert heading_rates.slowest == pytest.approx([SPEED - 1.0], rel=1e-14)


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


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("nu", [0.0, 0.1, 0.5])
def test_from_astern_a_guarded_vehicle_settles_and_keeps_out(nu, seed):
    # Starts as in scenarios/scenario/sections/flight.py: 400 to 800 m away, within 30 degrees of
    # astern, on any course.
    generator = np.random.default_rng(seed)
    distance = generator.uniform(400.0, 800.0)
    bearing = math.pi + generator.uniform(-math.pi / 6.0, math.pi / 6.0)
    start = (
        distance * math.cos(bearing),
        distance * math.sin(bearing),
        generator.uniform(-math.pi, math.pi),
    )
    flight = fly(about_a_vessel(nu, guard=QUICK_GUARD), start, duration=400.0)
    # Orbit and guard both keep more than the keep-out area's 200 m: 201 and 200.75 m.
    assert np.min(flight.to_vessel) >= 200.75
    # Settled within the half metre that holding commands leaves; see test_tracker.py.
    assert np.max(flight.distance[-600:]) < 0.5


GUARD = GuardParameters(
    radius=200.0,
    heading_rate_max=HEADING_RATE_MAX,
    lag=0.4,
    delay=0.0,
    slow_lag=0.4,
    time_step=TIME_STEP,
)
APPROACH = ApproachParameters(
    blocked_radius=203.0,
    round_radius=230.0,
    join_distance=150.0,
    tracked=12.0,
    airspeed=SPEED + 2.0,
)
PLAN_INTERVAL = 10
FILTER = FilterParameters(position_sigma=5.0, velocity_sigma=0.15, acceleration=0.02, memory=40.0)
LIMITS = VesselLimits(
    acceleration=0.25,
    speed_max=15.0,
    position_sigma=5.0,
    velocity_sigma=0.15,
    deviations=5.0,
    horizon=9.0,
)


def paper(**how):
    return paper_parameters(
        make_reference(paper_oscillation(0.5), centre=(-214.0, 0.0)),
        vessel=(0.5 * SPEED, 0.0),
        **how,
    )


def following(*, guard=GUARD, climb=0.0, thrust=None):
    """Return the guidance of a flight that follows a plume by sensors and reports."""
    widths = [
        half_widths(paper_oscillation(nu, roll_rate_max=math.radians(40.0)))
        for nu in np.linspace(0.0, 0.97, 49)
    ]
    centre = CentreParameters(
        distance_min=203.0,
        speed_ratio_max=0.97,
        along=tuple(along for along, _ in widths),
        across=tuple(across for _, across in widths),
        plume_heading=None,
        vessel_course=0.0,
        apparent_wind_min=1.0,
        speed=SPEED,
        heading_rate_max=HEADING_RATE_MAX,
    )
    mission = FollowingParameters(
        centre=centre,
        reference_heading_rate=0.985 * HEADING_RATE_MAX,
        swing=Sinusoid().swing(
            speed=SPEED, heading_rate=0.985 * HEADING_RATE_MAX, roll_rate_max=math.radians(40.0)
        ),
        turn_rate_fraction_until_tracked=1.0,
        speed_ratio_max=0.97,
        approach=APPROACH,
        standoff=100.0,
        glide_airspeed=17.0,
        stale=12.0,
        reach=0.0,
        reach_time=9.0,
        errors=ErrorBudget(drift=Growth(rate=1.0)),
        plan_interval=PLAN_INTERVAL,
        axis=PredictedPlume(
            height=AxisHeight(source=60.0, climb=climb),
            altitude=60.0,
            climb=Climb(time=20.0, gradient=0.05),
        ),
    )
    return GuidanceParameters(
        speed=SPEED,
        altitude=60.0,
        tracking=tracking_parameters(lag=0.4),
        airspeed_law=PaceHold(
            speed=SPEED, hold=SpeedHold(gain=0.3, airspeed_min=15.0, airspeed_max=25.0)
        ),
        airspeed_bandwidth=1.3,
        airspeed_overshoot=0.1,
        navigation=NavigationParameters(
            crab_banks=(-1.0, 1.0),
            crab_offsets=(0.0, 0.0),
            airspeed_sigma=0.5,
            course_sigma=0.03,
            wind_drift=0.02,
            wind_interval=PLAN_INTERVAL,
            time_step=TIME_STEP,
        ),
        vessel=ReportedVessel(filter=FILTER, limits=LIMITS),
        guard=guard,
        mission=mission,
        health=HealthParameters(
            thrust=thrust,
            heading_rate_max=HEADING_RATE_MAX,
            lag=0.4,
            time_step=TIME_STEP,
        ),
    )


def reported(parameters, *, speed=8.0):
    """Return a guidance that has received a report of a vessel that goes north from the origin."""
    guidance = Guidance(parameters)
    guidance.target.report(VesselReport(0.0, 0.0, 0.0, speed, 0.0))
    return guidance


def readings(north, east, *, course=0.0, airspeed=SPEED, servo_error=0.0):
    """Return what exact sensors say in still air."""
    return (
        (north, east, SPEED * math.cos(course), SPEED * math.sin(course)),
        airspeed,
        course,
        0.0,
        0.0,
        servo_error,
        None,
    )


def test_no_command_exceeds_its_bound_in_gusts_from_behind():
    # A gust between two looks at the wind takes a fifth of the airspeed: the same acceleration
    # turns the airframe the faster.
    guidance = reported(following())
    for step in range(50):
        airspeed = SPEED if step % PLAN_INTERVAL == 0 else 0.8 * SPEED
        guidance.step(step * TIME_STEP, readings(-400.0, 0.0, course=math.pi, airspeed=airspeed))
        assert abs(guidance.heading_rate_command) <= HEADING_RATE_MAX
    # It was in the way, and the guidance goes on from what is flown.
    assert guidance.own.air_ratio < 0.9
    assert abs(guidance.heading_rate_command) == HEADING_RATE_MAX
    assert (
        guidance.mission.tracker.heading_rate_command
        == guidance.heading_rate_command * guidance.own.air_ratio
    )


# Half of the thrust of level flight, missing for a second.
THRUST = ThrustParameters(
    model=MODEL, level=LEVEL, slow_airspeed=17.0, energy_height=SPEED * 0.5 * LEVEL
)


class Powered:
    """A vehicle that follows its guidance, with an engine at the throttle of level flight.

    Attributes
    ----------
    guidance : with a monitor of the thrust
    modes, altitudes, speeds : at each step
    """

    def __init__(self):
        self.guidance = reported(following(thrust=THRUST))
        self.modes, self.altitudes, self.speeds = [], [], []
        self._place = (-400.0, 0.0, math.pi)
        self._speed = SPEED

    def fly(self, duration, *, thrust, drag=LEVEL):
        throttle = LEVEL / MODEL.settled_thrust(SPEED, 1.0)
        guidance = self.guidance
        for _ in range(round(duration / TIME_STEP)):
            north, east, course = self._place
            speed = self._speed
            fix = (north, east, speed * math.cos(course), speed * math.sin(course))
            engine = EngineReadings(throttle, *accelerations(thrust, speed))
            turning = guidance.heading_rate_command
            time = len(self.modes) * TIME_STEP
            guidance.step(time, (fix, speed, course, 0.0, turning, 0.0, engine))
            self.modes.append(guidance.mode)
            self.altitudes.append(guidance.altitude_command)
            self.speeds.append(speed)
            command = guidance.heading_rate_command
            self._place = unicycle_move(north, east, course, speed, command, TIME_STEP)
            self._speed += 9.81 * (thrust - drag) * TIME_STEP


def test_a_vehicle_without_thrust_holds_its_height_and_goes_on_when_thrust_is_there_again():
    vehicle = Powered()
    vehicle.fly(5.0, thrust=LEVEL)
    # It is at its speed all the while: only the accelerometers say that there is no thrust.
    vehicle.fly(5.0, thrust=0.0, drag=0.0)
    vehicle.fly(10.0, thrust=LEVEL)
    retreating = [i for i, mode in enumerate(vehicle.modes) if mode is Mode.RETREATING]
    # A second without thrust, and a second with it: 20 steps, of which every fourth is looked at.
    assert 100 + 16 <= retreating[0] <= 100 + 24
    assert 200 + 16 <= retreating[-1] + 1 <= 200 + 24
    assert len(retreating) == retreating[-1] - retreating[0] + 1
    assert not set(vehicle.modes) & set(LOST)
    assert set(vehicle.altitudes) == {60.0}
    assert vehicle.guidance.monitor.fault is Fault.NONE


def test_a_turn_away_is_flown_in_full_in_gusts_from_ahead():
    # The vehicle is slower over the mean air: the guidance turns it the slower through the air, but
    # not away from the vessel.
    guidance = reported(following())
    turns = []
    for step in range(200):
        airspeed = SPEED if step % PLAN_INTERVAL == 0 else 1.2 * SPEED
        guidance.step(
            step * TIME_STEP, readings(-300.0 + SPEED * step * TIME_STEP, 0.0, airspeed=airspeed)
        )
        if guidance.guarding and guidance.own.air_ratio > 1.1:
            turns.append(abs(guidance.heading_rate_command))
            assert (
                guidance.mission.tracker.heading_rate_command
                == guidance.heading_rate_command * guidance.own.air_ratio
            )
    assert max(turns) == HEADING_RATE_MAX
