"""What the guidance of a flight knows beforehand: frozen, and chosen in one place
(``gnc.compose``).
"""

from dataclasses import dataclass

from gnc.airspeed import AirspeedLaw
from gnc.estimation.health import HealthParameters
from gnc.estimation.navigation import NavigationParameters
from gnc.estimation.vessel import FilterParameters, VesselLimits
from gnc.guard.guard import GuardParameters
from gnc.mission.direct_tracking import DirectParameters
from gnc.mission.plume_following import FollowingParameters
from gnc.mission.standoff import StandoffParameters
from gnc.tracker import TrackingParameters


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportedVessel:
    """A vessel that is known from its reports.

    Attributes
    ----------
    filter : of the reports
    limits : what the vessel and its reports keep within
    """

    filter: FilterParameters
    limits: VesselLimits


@dataclass(frozen=True, slots=True, kw_only=True)
class GuidanceParameters:
    """What the guidance of a flight consists of. What is None is absent.

    Attributes
    ----------
    speed, altitude : V_r, and the altitude to hold [m/s, m]
    tracking : of the tracker
    airspeed_law : keeps the vehicle beside its reference
    airspeed_bandwidth, airspeed_overshoot : of the airspeed behind its command, and over a rise of
        it [rad/s, -]
    navigation : of the estimated own motion; None where it is known exactly, in still air
    vessel : how it is known from reports, or its velocity north and east where that is known
        exactly and steady [m/s]
    guard : of the keep-out area
    mission : following a plume, circling the vessel, or tracking a reference that is known in
        advance
    health : of the vehicle
    """

    speed: float
    altitude: float
    tracking: TrackingParameters
    airspeed_law: AirspeedLaw
    airspeed_bandwidth: float
    airspeed_overshoot: float
    navigation: NavigationParameters | None
    vessel: ReportedVessel | tuple[float, float]
    guard: GuardParameters | None
    mission: FollowingParameters | StandoffParameters | DirectParameters
    health: HealthParameters | None
