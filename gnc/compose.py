"""The one place where the parts of the guidance are chosen, from frozen parameters."""

from gnc.estimation.health import HealthMonitor
from gnc.estimation.navigation import EstimatedNavigation, OwnMotion, TrueNavigation
from gnc.estimation.vessel import (
    ReachableSet,
    ReportedTarget,
    SteadyTarget,
    TargetMotion,
    VesselFilter,
)
from gnc.guard.guard import KeepoutGuard, SpeedRange
from gnc.guidance import Guidance
from gnc.mission.direct_tracking import DirectTracking
from gnc.mission.mission import Mission
from gnc.mission.plume_following import FollowingParameters, PlumeFollowing
from gnc.mission.standoff import StandoffOrbit, StandoffParameters
from gnc.parameters import GuidanceParameters, ReportedVessel


def compose(parameters: GuidanceParameters) -> Guidance:
    """Return the guidance of one flight, fresh."""
    p = parameters
    own: OwnMotion = EstimatedNavigation(p.navigation) if p.navigation else TrueNavigation()
    target: TargetMotion
    if isinstance(p.vessel, ReportedVessel):
        target = ReportedTarget(
            VesselFilter(p.vessel.filter), ReachableSet(p.vessel.limits), p.tracking.time_step
        )
    else:
        target = SteadyTarget(*p.vessel)
    guard = None
    if p.guard:
        speeds = SpeedRange(
            speed=p.speed,
            bandwidth=p.airspeed_bandwidth,
            overshoot=p.airspeed_overshoot,
            time_step=p.tracking.time_step,
        )
        guard = KeepoutGuard(p.guard, speeds)
    mission: Mission
    if isinstance(p.mission, FollowingParameters):
        mission = PlumeFollowing(p.mission, p.tracking, own=own, target=target, guard=guard)
    elif isinstance(p.mission, StandoffParameters):
        mission = StandoffOrbit(p.mission, p.tracking, own=own, target=target)
    else:
        mission = DirectTracking(
            p.mission, p.tracking, own=own, target=target, guard=guard, altitude=p.altitude
        )
    return Guidance(
        own=own,
        target=target,
        mission=mission,
        guard=guard,
        airspeed_law=p.airspeed_law,
        monitor=HealthMonitor(p.health) if p.health else None,
        speed=p.speed,
        heading_rate_max=p.tracking.heading_rate_max,
        altitude=p.altitude,
        plan_interval=p.mission.plan_interval,
    )
