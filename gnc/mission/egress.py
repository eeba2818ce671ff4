"""The way straight out from the vessel, for a vehicle that has to leave."""

import math

from gnc.mission.approach import COURSE_GAIN
from gnc.numeric import limited, wrap

_EITHER_WAY = 0.95 * math.pi
"""Course left to turn beyond which it is as far either way, and the turn that is flown already is
the quicker one [rad].
"""


class Egress:
    """Leads away from the vessel.

    From a course towards it either turn would do, and the vehicle keeps to the one that it has
    begun: to decide at every step would lead straight on.

    Parameters
    ----------
    heading_rate_max : omega_max [rad/s]
    """

    __slots__ = ("_limit", "_side")

    def __init__(self, heading_rate_max: float) -> None:
        self._limit, self._side = heading_rate_max, 0.0

    def command(self, x: float, y: float, course: float, heading_rate: float) -> float:
        """Return the heading rate to fly [rad/s].

        Parameters
        ----------
        x, y : of the vehicle, north and east of the vessel [m]
        course : that the vehicle will have by the time the command acts [rad]
        heading_rate : now [rad/s]
        """
        to_turn = wrap(math.atan2(y, x) - course)
        if abs(to_turn) < 0.5 * math.pi:
            self._side = 0.0
            return limited(COURSE_GAIN * self._limit * to_turn, self._limit)
        if not self._side:
            self._side = math.copysign(1.0, heading_rate if abs(to_turn) > _EITHER_WAY else to_turn)
        return self._side * self._limit
