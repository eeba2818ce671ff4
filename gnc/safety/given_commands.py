"""Commands that a vehicle has been given, and what is still to come of them.

docs/keepout_guard.md, "Course that earlier commands still bring", says how that is known.
"""

import math
from collections import deque

from common.physics.turn_tube import CHANGED, FORGOTTEN, LEAST_CHANGE, SLOW_LAG_ERROR
from gnc.numeric import limited

_WHOLE = 1e-6
"""Of a step, by which a delay may exceed a whole number of them without counting as one more [-].
"""


class GivenCommands:
    """Heading-rate commands, one per time step, to a vehicle that follows with a dead time and a
    lag.

    In the end a vehicle has turned by all of its commands. A prediction from its heading rate and
    the commands under way knows of some course to come; an aircraft in the middle of a roll, or one
    whose autopilot makes up for course that it lacks, has another course ahead of it. The
    difference is told. Of a vehicle with just that dead time and lag it is 0.

    Parameters
    ----------
    lag, delay : of the heading rate behind its command [s]
    slow_lag : by which the vehicle is behind slow commands; ``delay`` + ``lag`` where it has just
        those [s]
    time_step : for which a command is held [s]
    heading_rate_max : omega_max [rad/s]

    Attributes
    ----------
    under_way : commands that act within the delay, of the first perhaps a part [rad/s]
    change : largest change of command of late, over a full reversal, which counts the less the
        older it is [-]
    last : command at the last look [rad/s]
    since, rates : commands since the last look, and the heading rate at each; whoever commands
        appends to them [rad/s]
    """

    __slots__ = (
        "_at_end", "_begun", "_changing", "_doubt", "_fading", "_first", "_kept", "_lack", "_lack_max", "_lag", "_reversal",
        "_slow", "_time_step", "change", "last", "rates", "since", "under_way",
    )  # fmt: skip

    def __init__(
        self,
        *,
        lag: float,
        delay: float,
        slow_lag: float,
        time_step: float,
        heading_rate_max: float,
    ) -> None:
        self._lag, self._time_step = lag, time_step
        # Commands count from when they act.
        self._slow = slow_lag - delay
        self._doubt = SLOW_LAG_ERROR * slow_lag
        # Of a full reversal none of which has come yet.
        self._reversal = 2.0 * heading_rate_max
        self._lack_max = self._reversal * (delay + lag)
        self._fading = math.exp(-time_step / (CHANGED * lag)) if lag > 0.0 else 0.0
        self.change, self.last = LEAST_CHANGE, 0.0
        count, self._first = commands_under_way(delay, time_step)
        self._kept = math.exp(-time_step / (FORGOTTEN * lag)) if lag > 0.0 else 0.0
        # Course turned in a step in which a lag follows one command, from the heading rates at its
        # ends; and what is to be added where another command begins to act within the step. So it
        # is exact for a vehicle with just that dead time and lag.
        self._at_end = self._changing = 0.0
        if lag > 0.0:
            turned = time_step / -math.expm1(-time_step / lag)
            self._at_end = turned - lag
            self._changing = (
                time_step - self._first + turned * math.expm1((self._first - time_step) / lag)
            )
        self._lack, self._begun = 0.0, False
        self.under_way: deque[float] = deque(maxlen=count)
        self.since: list[float] = []
        self.rates: list[float] = []

    def still_to_come(self, rate: float) -> float:
        """Take in the commands since the last look; return what the heading rate lacks for the
        course that is to come [rad/s].

        Parameters
        ----------
        rate : of heading, now [rad/s]. Course is its sum, and not that of the motion over the mean
            air: what a gust or a better estimate of the wind does to that no autopilot makes up for
        """
        since, rates, under_way = self.since, self.rates, self.under_way
        if not (since or self._begun):
            # A flight begins: the turn that is flown is under way.
            self.last = rate
            under_way.extend([rate] * (under_way.maxlen or 0))
        elif since:
            self._begun = True
            acting = under_way[0] if under_way else 0.0
            acted = self._time_step * sum(since) + self._course_under_way()
            under_way.extend(since)
            acted -= self._course_under_way()
            changed = rate - rates[0]
            turned = self._time_step * sum(rates) + self._at_end * changed
            if under_way:
                turned += self._changing * (under_way[0] - acting)
            lack = self._lack * self._kept ** len(since) + acted - turned - self._slow * changed
            self._lack = limited(lack, self._lack_max)
            # What changed little by little between two looks counts as if it had changed at once.
            since.append(self.last)
            changed = (max(since) - min(since)) / self._reversal
            self.change = max(changed, self.change * self._fading ** len(rates), LEAST_CHANGE)
            self.last = since[-2]
            since.clear()
            rates.clear()
        if self._lag == 0.0:
            return 0.0
        # As much as slow commands may be followed sooner or later than said is none of it.
        lack, doubt = self._lack, self._doubt * abs(rate)
        return (lack - math.copysign(doubt, lack)) / self._lag if abs(lack) > doubt else 0.0

    def changed_by(self, command: float) -> float:
        """Return what ``change`` is if a command [rad/s] is given now."""
        now = abs(command - self.last) / self._reversal
        return now if now > self.change else self.change

    def _course_under_way(self) -> float:
        """Return by how much the commands under way turn the vehicle [rad]."""
        under_way = self.under_way
        return (
            self._time_step * sum(under_way) + (self._first - self._time_step) * under_way[0]
            if under_way
            else 0.0
        )


def commands_under_way(delay: float, time_step: float) -> tuple[int, float]:
    """Return how many commands, each held for ``time_step`` [s], act within a delay, and for how
    long of it the first does [s].
    """
    count = math.ceil(delay / time_step - _WHOLE)
    return count, delay - (count - 1) * time_step
