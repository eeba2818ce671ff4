"""Commands that a vehicle has been given, and what is still to come of them (docs/keepout_guard.md, "What is still to come")."""

import math
from collections import deque

from common.turn_tube import FORGOTTEN
from gnc.estimation.own_motion import AirMotion

_WHOLE = 1e-6
"""Of a step, by which a delay may exceed a whole number of them without counting as one more [-]."""


class GivenCommands:
    """Heading-rate commands, one per time step, to a vehicle that follows with a dead time and a lag.

    In the end a vehicle has turned by all of its commands. A prediction from its heading rate and the commands under way knows
    of some course to come; an aircraft in the middle of a roll, or one whose autopilot makes up for course that
    it lacks, has another course ahead of it. The difference is told. Of a vehicle with just that dead time and lag it is 0.

    Parameters
    ----------
    lag, delay : of the heading rate behind its command [s]
    time_step : for which a command is held [s]

    Attributes
    ----------
    under_way : commands that act within the delay, of the first perhaps a part [rad/s]
    since : commands since the last look; whoever commands appends to them [rad/s]
    """

    __slots__ = ("_course", "_first", "_kept", "_lack", "_lag", "_rate", "_time_step", "since", "under_way")

    def __init__(self, *, lag: float, delay: float, time_step: float) -> None:
        self._lag, self._time_step = lag, time_step
        count, self._first = commands_under_way(delay, time_step)
        self._kept = math.exp(-time_step / (FORGOTTEN * lag)) if lag > 0.0 else 0.0
        self._course = self._rate = self._lack = 0.0
        self.under_way: deque[float] = deque(maxlen=count)
        self.since: list[float] = []

    def still_to_come(self, own: AirMotion) -> float:
        """Take in the commands since the last look; return what the heading rate lacks for the course that is to come [rad/s].

        Parameters
        ----------
        own : the vehicle's motion; since the last look it has turned by less than half a turn
        """
        since, under_way, rate = self.since, self.under_way, own.heading_rate
        if not since:
            # A flight begins: the turn that is flown is under way.
            self._lack = 0.0
            under_way.extend([rate] * (under_way.maxlen or 0))
        else:
            acted = self._time_step * sum(since) + self._course_under_way()
            under_way.extend(since)
            acted -= self._course_under_way()
            turned = math.remainder(own.course - self._course, math.tau)
            self._lack = self._lack * self._kept ** len(since) + acted - turned - self._lag * (rate - self._rate)
            since.clear()
        self._course, self._rate = own.course, rate
        return self._lack / self._lag if self._lag > 0.0 else 0.0

    def _course_under_way(self) -> float:
        """Return by how much the commands under way turn the vehicle [rad]."""
        under_way = self.under_way
        return self._time_step * sum(under_way) + (self._first - self._time_step) * under_way[0] if under_way else 0.0


def commands_under_way(delay: float, time_step: float) -> tuple[int, float]:
    """Return how many commands, each held for ``time_step`` [s], act within a delay, and for how long of it the first does [s]."""
    count = math.ceil(delay / time_step - _WHOLE)
    return count, delay - (count - 1) * time_step
