"""What a mission is: it orders a heading rate, or that the reference is tracked."""

from enum import Enum
from typing import NamedTuple, Protocol

from gnc.estimation.health import Fault
from gnc.estimation.navigation import OwnMotion
from gnc.estimation.vessel import TargetMotion
from gnc.tracker import ReferenceTracker


class Mode(Enum):
    """What the guidance is doing.

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
"""Modes in which an aircraft sinks to the sea, away from the vessel. It comes back from there only
if thrust that was lost is there again."""

FAULTY = (*LOST, Mode.RETREATING)
"""Modes of a vehicle with a fault. It retreats without thrust for as long as it can hold its
height, and goes on if thrust is there again."""

LEAVING = (*FAULTY, Mode.DEPARTING)
"""Modes in which the vehicle leaves the vessel, and tracks no reference."""

TRACK = None
"""In place of an ordered heading rate: the tracker commands it."""


class Order:
    """What the guidance is to do in this step.

    A plain class, same as ``RelativeMotion``: one is made at each step.

    Attributes
    ----------
    heading_rate : to fly, positive to the right [rad/s]; ``TRACK`` to track the reference
    airspeed : to fly with an ordered heading rate; an airspeed law sets that of tracking [m/s]
    altitude : above the sea [m]
    mode : what is being done
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
    """Where the reference's orbit is.

    Attributes
    ----------
    centre : of oscillation
    error : distance of the orbit's centre from that [m]
    in_place : whether the orbit is as near to the vessel as it will come
    """

    centre: Centre
    error: float
    in_place: bool


class Mission(Protocol):
    """Plans where the reference goes, and takes over where tracking would lead the wrong way.

    Attributes
    ----------
    tracker : of the reference; there is one once the first plan is made
    orbit : of the reference; None before the first plan has placed it
    """

    orbit: OrbitStatus | None

    @property
    def tracker(self) -> ReferenceTracker:
        """Tracker of the reference."""

    def plan(
        self, time: float, own: OwnMotion, vessel: TargetMotion, *, renew: bool, guarding: bool
    ) -> Order:
        """Return what to do in this step of the guidance.

        Parameters
        ----------
        time : now [s]
        own, vessel : motion of the vehicle and of the vessel
        renew : whether the plan is made anew, or the last one is carried on
        guarding : whether the keep-out guard turned the vehicle away in the last step
        """

    def react(self, fault: Fault) -> None:
        """Leave the vessel from the next order on because of a fault of the vehicle; with
        ``Fault.NONE``, go on: the fault is over.
        """
