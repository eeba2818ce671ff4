"""The parts of a guidance, chosen by its parameters: what has nothing to do is absent."""

import math
from dataclasses import replace

import numpy as np
import pytest
from gnc_cases import (
    HEADING_RATE_MAX,
    SPEED,
    TIME_STEP,
    fly,
    make_reference,
    motion,
    paper_oscillation,
    paper_parameters,
    tracking_parameters,
)

from gnc.airspeed import PaceHold, SpeedHold
from gnc.compose import compose
from gnc.estimation.health import HealthParameters
from gnc.estimation.navigation import (
    EstimatedNavigation,
    NavigationParameters,
    SatelliteFix,
    SensorReadings,
    TrueNavigation,
)
from gnc.estimation.vessel import (
    FilterParameters,
    ReportedTarget,
    SteadyTarget,
    VesselLimits,
    VesselReport,
)
from gnc.guard.guard import GuardParameters
from gnc.mission.approach import ApproachParameters
from gnc.mission.axis_height import AxisHeight
from gnc.mission.direct_tracking import DirectTracking
from gnc.mission.mode import Mode
from gnc.mission.plume_axis import PredictedPlume
from gnc.mission.plume_following import GLIDE_ALTITUDE, FollowingParameters, PlumeFollowing
from gnc.paper import half_widths
from gnc.parameters import GuidanceParameters, ReportedVessel
from gnc.reference.moving_centre import CentreParameters
from gnc.reference.shapes.sinusoid import Sinusoid

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


def following(*, guard=GUARD, climb=0.0):
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
        joining_share=1.0,
        speed_ratio_max=0.97,
        approach=APPROACH,
        standoff=100.0,
        glide_airspeed=17.0,
        stale=12.0,
        reach=0.0,
        reach_time=9.0,
        drift_rate=1.0,
        plan_interval=PLAN_INTERVAL,
        axis=PredictedPlume(height=AxisHeight(source=60.0, climb=climb), altitude=60.0),
    )
    return GuidanceParameters(
        speed=SPEED,
        altitude=60.0,
        tracking=tracking_parameters(lag=0.4),
        airspeed_law=PaceHold(speed=SPEED, hold=SpeedHold(gain=0.3, airspeed_min=15.0, airspeed_max=25.0)),
        airspeed_bandwidth=1.3,
        airspeed_overshoot=0.1,
        navigation=NavigationParameters(
            crab_banks=(-1.0, 1.0), crab_offsets=(0.0, 0.0), airspeed_sigma=0.5, course_sigma=0.03, wind_drift=0.02,
            wind_interval=PLAN_INTERVAL, time_step=TIME_STEP,
        ),
        vessel=ReportedVessel(filter=FILTER, limits=LIMITS),
        guard=guard,
        mission=mission,
        health=HealthParameters(
            airspeed_error=2.0, speed=SPEED, heading_rate_max=HEADING_RATE_MAX, lag=0.4, time_step=TIME_STEP
        ),
    )  # fmt: skip


def reported(parameters, *, speed=8.0):
    """Return a guidance that has received a report of a vessel that goes north from the origin."""
    guidance = compose(parameters)
    guidance.target.report(VesselReport(0.0, 0.0, 0.0, speed, 0.0))
    return guidance


def readings(north, east, *, course=0.0, airspeed=SPEED, servo_error=0.0):
    """Return what exact sensors say in still air."""
    fix = SatelliteFix(north, east, SPEED * math.cos(course), SPEED * math.sin(course))
    return SensorReadings(fix, airspeed, course, 0.0, 0.0, servo_error)


def test_the_papers_guidance_has_no_parts_that_have_nothing_to_do():
    guidance = compose(paper())
    assert guidance.monitor is None
    assert guidance.guard is None
    assert (type(guidance.own), type(guidance.target), type(guidance.mission)) == (
        TrueNavigation,
        SteadyTarget,
        DirectTracking,
    )
    # No estimator among what they keep.
    assert not hasattr(guidance.own, "_navigation")
    assert not hasattr(guidance.target, "vessel")


def test_a_guidance_that_follows_a_plume_has_every_part():
    guidance = compose(following())
    assert (type(guidance.own), type(guidance.target), type(guidance.mission)) == (
        EstimatedNavigation, ReportedTarget, PlumeFollowing,
    )  # fmt: skip
    assert guidance.monitor is not None
    assert guidance.guard is not None


@pytest.mark.parametrize("part", ["guard", "health"])
def test_a_guidance_that_follows_a_plume_can_do_without(part):
    guidance = reported(replace(following(), **{part: None}))
    assert getattr(guidance, {"guard": "guard", "health": "monitor"}[part]) is None
    for step in range(50):
        guidance.step(step * TIME_STEP, readings(-300.0 + SPEED * step * TIME_STEP, 20.0))
        assert abs(guidance.heading_rate_command) <= HEADING_RATE_MAX
    assert guidance.guarding is False


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


def test_flights_share_nothing():
    parameters = paper(guard=GUARD)
    one = fly(compose(parameters), (-300.0, 40.0, 0.5), duration=20.0)
    other = fly(compose(parameters), (-300.0, 40.0, 0.5), duration=20.0)
    # Neither the reference's place nor the guard's memory: the same to the last bit.
    np.testing.assert_array_equal(one.command, other.command)
    first, second = compose(parameters), compose(parameters)
    first.step(0.0, motion(-202.0, 0.0, 0.0))
    assert (first.guard.intervening, second.guard.intervening) == (True, False)


def test_the_mission_plans_every_few_steps_and_the_papers_once(monkeypatch):
    planned = []
    for mission in (PlumeFollowing, DirectTracking):
        plan = mission.plan
        monkeypatch.setattr(
            mission, "plan", lambda self, time, plan=plan: (planned.append(time), plan(self, time))
        )
    for guidance, plans in ((reported(following()), 3), (compose(paper()), 1)):
        planned.clear()
        measurement = readings(-300.0, 0.0) if plans > 1 else motion(-300.0, 0.0, 0.0)
        for step in range(3 * PLAN_INTERVAL):
            guidance.step(step * TIME_STEP, measurement)
        assert planned == pytest.approx([i * PLAN_INTERVAL * TIME_STEP for i in range(plans)])


def test_the_altitude_commanded_rises_with_the_centres_distance_where_the_plume_rises():
    climb = math.tan(math.radians(10.0))
    guidance, level = reported(following(climb=climb)), reported(following())
    altitudes = []
    for step in range(6 * PLAN_INTERVAL + 1):
        for each in (guidance, level):
            each.step(step * TIME_STEP, readings(-900.0, 0.0))
        altitudes.append(guidance.altitude_command)
    # From the funnel's 60 m towards the axis at the centre of oscillation, 36 m higher at least, no
    # steeper than 5 %.
    assert guidance.mission.centre.distance > 203.0
    planned = np.array([60.0, *altitudes[::PLAN_INTERVAL]])
    assert np.diff(planned) == pytest.approx(0.05 * SPEED * PLAN_INTERVAL * TIME_STEP, rel=1e-12)
    assert level.altitude_command == 60.0


def test_a_vehicle_with_a_fault_leaves_and_sinks():
    guidance = reported(following())
    for step in range(60):
        guidance.step(step * TIME_STEP, readings(-400.0, 0.0, course=math.pi, servo_error=0.5))
    assert guidance.mission.mode is Mode.TERMINATING
    assert (guidance.airspeed_command, guidance.altitude_command) == (17.0, GLIDE_ALTITUDE)


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
