"""What a mission is: which way the guidance goes, and when it leaves the reference alone."""

from typing import Protocol

from gnc.estimation.health import Fault
from gnc.mission.mode import Mode


class Placed(Protocol):
    """Where a reference is; attributes as of ``gnc.reference.reference.Reference``."""

    north: float
    east: float
    course: float
    heading_rate: float


class Centre(Protocol):
    """A centre of oscillation.

    Attributes
    ----------
    x, y : north and east of the vessel [m]
    speed_ratio : nu, vessel through the air over V_r [-]
    """

    @property
    def x(self) -> float:
        """North of the vessel."""

    @property
    def y(self) -> float:
        """East of the vessel."""

    @property
    def speed_ratio(self) -> float:
        """Speed ratio."""


class Tracking(Protocol):
    """What tracks the reference.

    Attributes
    ----------
    reference : the reference point now
    heading_rate_demand, heading_rate_command, saturated : as of ``gnc.tracker.Tracker``
    """

    heading_rate_demand: float
    heading_rate_command: float
    saturated: bool

    @property
    def reference(self) -> Placed:
        """Reference point."""

    def step(
        self, north: float, east: float, course: float, speed: float, heading_rate: float
    ) -> float:
        """Return the heading rate to command [rad/s]; parameters are those of
        ``gnc.tracker.Tracker``.
        """


class Mission(Protocol):
    """Plans every few steps where the reference goes; overrides the tracker where that would be the
    wrong way.

    Attributes
    ----------
    started : whether there is a reference, and its tracker
    tracker : of the reference, once started
    mode : what it is doing
    centre : of oscillation; not a number where there is none
    centre_error : distance of the orbit's centre from its place [m]
    in_place : whether the centre is as near to the vessel as it will come
    overriding : whether ``command`` replaces the tracker's heading rate
    leaving : whether the vehicle leaves for good, and sinks
    airspeed, altitude : to command, the airspeed only while overriding [m/s, m]
    """

    started: bool
    mode: Mode
    centre_error: float
    leaving: bool
    airspeed: float
    altitude: float

    @property
    def tracker(self) -> Tracking:
        """Tracker of the reference."""

    @property
    def centre(self) -> Centre:
        """Centre of oscillation."""

    @property
    def in_place(self) -> bool:
        """Whether the centre is in its place."""

    @property
    def overriding(self) -> bool:
        """Whether the mission commands the heading rate."""

    def plan(self, time: float) -> None:
        """Look at own motion and target, and decide what to do."""

    def command(self, last_command: float) -> float:
        """Return the heading rate to fly while overriding, after the last one that was flown
        [rad/s].
        """

    def leave(self, fault: Fault) -> None:
        """Leave the vessel for good, because of a fault of the vehicle."""
