"""The outer loop: its parts, chosen by parameters, and the commands that they make."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from gnc_cases import (
    HEADING_RATE_MAX,
    SPEED,
    TIME_STEP,
    centre_parameters,
    examples,
    fly,
    make_guidance,
    make_reference,
    motion,
    paper_oscillation,
    tracking_parameters,
)
from hypothesis import given
from hypothesis import strategies as st
from thrust_cases import LEVEL, MODEL, accelerations
from vessel_cases import LIMITS

from gnc.airspeed import PaceHold, SpeedHold
from gnc.estimation.error_budget import ErrorBudget, Growth
from gnc.estimation.health import Fault, HealthParameters
from gnc.estimation.navigation import EngineReadings, NavigationParameters
from gnc.estimation.thrust import ThrustParameters
from gnc.estimation.vessel import FilterParameters, VesselReport
from gnc.guard.guard import GuardParameters, GuardStatus
from gnc.guidance import Guidance, GuidanceParameters, ReportedVessel
from gnc.laws import CascadeLaw, LineOfSightLaw, LyapunovLaw
from gnc.mission.axis import AxisHeight, Climb, PredictedPlume
from gnc.mission.follow import FollowingParameters
from gnc.mission.mission import LOST, Mode
from gnc.mission.way import ApproachParameters
from gnc.paper import PlumeAxis, distance_by_paper
from gnc.reference.shapes import Sinusoid
from gnc.unicycle import unicycle_move

# 0.75 of the tracking allowance of 1 m about its 200 m (scenarios/planning/missions.py).
# These vehicles answer at once.
QUICK_GUARD = GuardParameters(
    radius=200.75, heading_rate_max=HEADING_RATE_MAX, lag=0.0, time_step=TIME_STEP
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


@pytest.mark.parametrize("lag", [0.0, 0.4])
def test_the_airspeed_is_trimmed_by_the_along_track_error_now_with_any_lag(lag):
    # V_r plus 0.15/s of the way that the vehicle is behind.
    along, right, expected = -4.0, -30.0, SPEED + 0.6
    reference = make_reference(paper_oscillation(0.5), centre=(100.0, 50.0), vessel_course=0.8)
    guidance = make_guidance(reference, airspeed_gain=0.15, lag=lag)
    cos, sin = math.cos(reference.course), math.sin(reference.course)
    north = reference.north + along * cos - right * sin
    east = reference.east + along * sin + right * cos
    guidance.step(0.0, motion(north, east, reference.course))
    # Rounding of 100 m.
    assert guidance.airspeed_command == pytest.approx(expected, abs=1e-12)


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
    monkeypatch, status, allowed, airspeed
):
    heading_rates = SimpleNamespace(
        status=status, allows=lambda *_: allowed, limit=lambda *_: 0.0, replace=lambda _: None
    )
    monkeypatch.setattr("gnc.guard.guard.HeadingRateFilter", lambda _: heading_rates)
    reference = make_reference(paper_oscillation(0.5))
    guidance = make_guidance(reference, guard=GUARD, airspeed_gain=0.15)
    # 60 m behind the reference: trimmed by all of 1 m/s.
    cos, sin = math.cos(reference.course), math.sin(reference.course)
    place = reference.north - 60.0 * cos, reference.east - 60.0 * sin
    guidance.step(0.0, motion(*place, reference.course))
    assert guidance.airspeed_command == airspeed
    assert guidance.guarding == (status is not GuardStatus.FREE)


@pytest.mark.parametrize(("nu", "seed"), [(0.0, 0), (0.1, 1), (0.5, 0)])
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
    oscillation = paper_oscillation(nu, reserve=0.015)
    centre = (-distance_by_paper(oscillation, PlumeAxis(heading=math.pi), 201.0), 0.0)
    reference = make_reference(oscillation, centre=centre)
    guidance = make_guidance(reference, vessel=(nu * SPEED, 0.0), guard=QUICK_GUARD)
    flight = fly(guidance, start, duration=400.0)
    # Orbit and guard both keep more than the keep-out area's 200 m: 201 and 200.75 m.
    assert np.min(flight.to_vessel) >= 200.75
    # Settled within the half metre that holding commands leaves; see test_tracker.py.
    assert np.max(flight.distance[-600:]) < 0.5


GUARD = GuardParameters(
    radius=200.0, heading_rate_max=HEADING_RATE_MAX, lag=0.4, time_step=TIME_STEP
)
APPROACH = ApproachParameters(
    blocked_radius=203.0, round_radius=230.0, join_distance=150.0, tracked=12.0, airspeed=SPEED + 2
)
PLAN_INTERVAL = 10
FILTER = FilterParameters(position_sigma=5.0, velocity_sigma=0.15, acceleration=0.02, memory=40.0)


def following(*, thrust=None):
    """Return the guidance of a flight that follows a plume by sensors, beside a vessel that has
    reported that it goes north from the origin.
    """
    mission = FollowingParameters(
        centre=centre_parameters(heading_rate_max=HEADING_RATE_MAX),
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
            height=AxisHeight(source=60.0), altitude=60.0, climb=Climb(time=20.0, gradient=0.05)
        ),
    )
    parameters = GuidanceParameters(
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
        guard=GUARD,
        mission=mission,
        health=HealthParameters(
            thrust=thrust, heading_rate_max=HEADING_RATE_MAX, lag=0.4, time_step=TIME_STEP
        ),
    )
    guidance = Guidance(parameters)
    guidance.target.report(VesselReport(0.0, 0.0, 0.0, 8.0, 0.0))
    return guidance


def readings(north, *, course=0.0, airspeed=SPEED):
    """Return what exact sensors say in still air."""
    fix = (north, 0.0, SPEED * math.cos(course), SPEED * math.sin(course))
    return (fix, airspeed, course, 0.0, 0.0, 0.0, None)


def test_no_command_exceeds_its_bound_in_gusts_from_behind():
    # A gust between two looks at the wind takes a fifth of the airspeed: the same acceleration
    # turns the airframe the faster.
    guidance = following()
    for step in range(50):
        airspeed = SPEED if step % PLAN_INTERVAL == 0 else 0.8 * SPEED
        guidance.step(step * TIME_STEP, readings(-400.0, course=math.pi, airspeed=airspeed))
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


def test_a_vehicle_without_thrust_holds_its_height_and_goes_on_when_thrust_is_there_again():
    guidance, place, modes = following(thrust=THRUST), (-400.0, 0.0, math.pi), []
    throttle = LEVEL / MODEL.settled_thrust(SPEED, 1.0)
    for step in range(400):
        north, east, course = place
        fix = (north, east, SPEED * math.cos(course), SPEED * math.sin(course))
        # It is at its speed all the while: only the accelerometers say that there is no thrust.
        thrust = 0.0 if 100 <= step < 200 else LEVEL
        engine = EngineReadings(throttle, *accelerations(thrust, SPEED))
        turning = guidance.heading_rate_command
        guidance.step(step * TIME_STEP, (fix, SPEED, course, 0.0, turning, 0.0, engine))
        modes.append(guidance.mode)
        assert guidance.altitude_command == 60.0
        place = unicycle_move(*place, SPEED, guidance.heading_rate_command, TIME_STEP)
    retreating = [i for i, mode in enumerate(modes) if mode is Mode.RETREATING]
    # A second without thrust, and a second with it: 20 steps, of which every fourth is looked at.
    assert 100 + 16 <= retreating[0] <= 100 + 24
    assert 200 + 16 <= retreating[-1] + 1 <= 200 + 24
    assert len(retreating) == retreating[-1] - retreating[0] + 1
    assert not set(modes) & set(LOST)
    assert guidance.monitor.fault is Fault.NONE


def test_a_turn_away_is_flown_in_full_in_gusts_from_ahead():
    # The vehicle is slower over the mean air: the guidance turns it the slower through the air, but
    # not away from the vessel.
    guidance = following()
    turns = []
    for step in range(200):
        airspeed = SPEED if step % PLAN_INTERVAL == 0 else 1.2 * SPEED
        time = step * TIME_STEP
        guidance.step(time, readings(-300.0 + SPEED * time, airspeed=airspeed))
        if guidance.guarding and guidance.own.air_ratio > 1.1:
            turns.append(abs(guidance.heading_rate_command))
            assert (
                guidance.mission.tracker.heading_rate_command
                == guidance.heading_rate_command * guidance.own.air_ratio
            )
    assert max(turns) == HEADING_RATE_MAX
