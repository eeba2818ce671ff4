"""The mission's Protocol: it orders a heading rate, or orders to track the reference."""

from enum import Enum
from typing import NamedTuple, Protocol

from gnc.estimation.health import Fault
from gnc.estimation.navigation import OwnMotion
from gnc.estimation.vessel import TargetMotion
from gnc.tracker import ReferenceTracker


class Mode(Enum):
    """The mode of the guidance.

    Attributes
    ----------
    number : in a record: its index among all modes
    """

    number: int

    APPROACH = "approach"
    TRACKING = "tracking"
    HOLDING = "holding off"
    DEAD_RECKONING = "dead reckoning"
    OUTRUN = "outrun"
    NO_PLUME = "no plume"
    GLIDING = "gliding"
    TERMINATING = "terminating"
    SEARCHING = "searching"
    FOUND = "found"
    LOST_AGAIN = "lost again"
    SENSOR_FAILED = "sensor failed"
    DEPARTING = "departing"
    RETREATING = "retreating"
    YIELDING = "yielding to traffic"


for _i, _mode in enumerate(Mode):
    _mode.number = _i

LOST = (Mode.GLIDING, Mode.TERMINATING)
"""Modes in which an aircraft sinks to the sea, away from the vessel. It returns only if lost thrust
is there again."""

FAULTY = (*LOST, Mode.RETREATING)
"""Modes of a vehicle with a fault. It retreats without thrust for as long as it can hold its
height, and continues the mission if thrust is there again."""

LEAVING = (*FAULTY, Mode.DEPARTING)
"""Modes in which the vehicle leaves the vessel, and tracks no reference."""

TRACK = None
"""Stands for an ordered heading rate: the tracker commands the rate."""


class Order:
    """The mission's order for this step of the guidance.

    This is a plain class, as ``RelativeMotion`` is: one is made at each step.

    Attributes
    ----------
    heading_rate : to fly, positive to the right [rad/s]; ``TRACK`` to track the reference
    airspeed : to fly with an ordered heading rate; an airspeed law sets it during tracking [m/s]
    altitude : above the sea [m]
    mode : mode of the guidance
    """

    def __init__(
        self, heading_rate: float | None, airspeed: float, altitude: float, mode: Mode
    ) -> None:
        self.heading_rate = heading_rate
        self.airspeed = airspeed
        self.altitude = altitude
        self.mode = mode


class Centre(NamedTuple):
    """A centre of oscillation; NaN for a reference without a vessel.

    Attributes
    ----------
    x, y : north and east of the vessel [m]
    speed_ratio : nu, the vessel's speed through the air over V_r [-]
    """

    x: float = float("nan")
    y: float = float("nan")
    speed_ratio: float = float("nan")


NO_CENTRE = Centre()
"""The centre of a reference without a vessel."""


class OrbitStatus(NamedTuple):
    """The place of the reference's orbit.

    Attributes
    ----------
    centre : of oscillation
    error : distance of the orbit's centre from that centre [m]
    in_place : whether the orbit is at its final distance from the vessel
    """

    centre: Centre
    error: float
    in_place: bool


class Mission(Protocol):
    """Plans the motion of the reference, and takes over where tracking would lead the wrong way.

    Attributes
    ----------
    tracker : of the reference; it exists after the first plan
    orbit : of the reference; None before the first plan has placed it
    """

    orbit: OrbitStatus | None

    @property
    def tracker(self) -> ReferenceTracker:
        """Tracker of the reference."""

    def plan(
        self, time: float, own: OwnMotion, vessel: TargetMotion, *, renew: bool, guarding: bool
    ) -> Order:
        """Return the order for this step of the guidance.

        Parameters
        ----------
        time : now [s]
        own, vessel : motion of the vehicle and of the vessel
        renew : whether to make a new plan, or to continue the last one
        guarding : whether the keep-out guard turned the vehicle away in the last step
        """

    def react(self, fault: Fault) -> None:
        """Leave the vessel from the next order on because of a fault of the vehicle; with
        ``Fault.NONE``, go on: the fault is over.
        """
