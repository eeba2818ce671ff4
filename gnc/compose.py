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
from gnc.guidance import Guidance
from gnc.mission.direct_tracking import DirectTracking
from gnc.mission.mission import Mission
from gnc.mission.plume_following import FollowingParameters, PlumeFollowing
from gnc.mission.standoff import StandoffOrbit, StandoffParameters
from gnc.parameters import GuidanceParameters, ReportedVessel
from gnc.safety.guarded_commands import GuardedCommands
from gnc.safety.keepout_guard import KeepoutGuard
from gnc.safety.speed_reckoning import SpeedReckoning


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
    guard = KeepoutGuard(p.guard) if p.guard else None
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
        keep_out=_guarded_commands(guard, p) if guard else None,
        airspeed_law=p.airspeed_law,
        monitor=HealthMonitor(p.health) if p.health else None,
        speed=p.speed,
        heading_rate_max=p.tracking.heading_rate_max,
        altitude=p.altitude,
        plan_interval=p.mission.plan_interval,
    )


def _guarded_commands(guard: KeepoutGuard, p: GuidanceParameters) -> GuardedCommands:
    reckoning = SpeedReckoning(
        speed=p.speed,
        bandwidth=p.airspeed_bandwidth,
        overshoot=p.airspeed_overshoot,
        time_step=p.tracking.time_step,
    )
    return GuardedCommands(
        guard, reckoning=reckoning, speed=p.speed, heading_rate_max=p.tracking.heading_rate_max
    )
