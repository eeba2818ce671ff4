"""What the guidance over a real sea is told beforehand, and what it may be doing."""

from dataclasses import dataclass
from enum import Enum

from gnc.airspeed.pace_hold import SpeedHold
from gnc.estimation.navigation import NavigationParameters
from gnc.reference.moving_centre import CentreParameters
from gnc.tracker import GuidanceParameters


class Mode(Enum):
    """What the guidance is doing."""

    APPROACH = "approach"
    TRACKING = "tracking"
    HOLDING = "holding off"
    DEAD_RECKONING = "dead reckoning"
    OUTRUN = "outrun"
    NO_PLUME = "no plume"
    GLIDING = "gliding"
    TERMINATING = "terminating"


@dataclass(frozen=True, slots=True, kw_only=True)
class SeaParameters:
    """Parameters of the outer loop over a real sea.

    Attributes
    ----------
    guidance : of the tracking law; it trims no airspeed and has no guard
    navigation, centre : of own motion and of the centre of oscillation
    reference_heading_rate : what the reference may turn at most [rad/s]
    roll_rate_max : that the reference may ask for [rad/s]
    speed_ratio_max : above it the vessel outruns the vehicle [-]
    blocked_radius, round_radius : a way to the centre that comes closer to the vessel than the first goes round by the second [m]
    join_distance : from the centre, within which the reference is tracked [m]
    standoff : how much further off the centre stays until it is [m]
    tracked : distance from the reference that counts as tracked [m]
    hold : how it keeps pace with its reference
    transit_airspeed : on the way to it [m/s]
    powerless : mean lack of airspeed at which thrust counts as lost [m/s]
    stale : age of vessel data beyond which the keep-out margin no longer covers where the vessel may be [s]
    vessel_acceleration : largest, of a vessel that is not heard [m/s^2]
    drift_rate : how fast dead reckoning goes wrong [m/s]
    plan_interval : guidance steps between looks at vessel and wind
    altitude, glide_airspeed : commanded as long as all is well, and while gliding [m, m/s]
    """

    guidance: GuidanceParameters
    navigation: NavigationParameters
    centre: CentreParameters
    reference_heading_rate: float
    roll_rate_max: float
    speed_ratio_max: float
    blocked_radius: float
    round_radius: float
    join_distance: float
    standoff: float
    tracked: float
    hold: SpeedHold
    transit_airspeed: float
    powerless: float
    stale: float
    vessel_acceleration: float
    drift_rate: float
    plan_interval: int
    altitude: float
    glide_airspeed: float
