"""What the guidance is doing."""

from enum import Enum


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


LOST = (Mode.GLIDING, Mode.TERMINATING)
"""Modes from which an aircraft does not come back: it glides, or flies away from the vessel, until
it is down.
"""

LEAVING = (*LOST, Mode.DEPARTING)
"""Modes in which the vehicle leaves for good, and tracks no reference."""

for _i, _mode in enumerate(Mode):
    _mode.number = _i
