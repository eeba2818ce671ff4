"""Commands that keep out: a heading rate by the keep-out guard, and a pace at which the vehicle can
still turn away.
"""

import math

from gnc.estimation.navigation import OwnMotion
from gnc.safety.keepout_guard import KeepoutGuard
from gnc.safety.speed_reckoning import SpeedReckoning

_UNASKED = 0.05
"""By how much the pace may exceed what the guard was asked about [m/s]: a turn away comes nearer by
less than 0.1 m for it.
"""


class GuardedCommands:
    """A keep-out guard, and what follows from it for the pace, a speed over the mean air.

    The vehicle flies faster only where the faster vehicle can turn away, too: a turn that was safe
    must remain so. And a vehicle that catches up turns the wider: so V_r is flown while the guard
    acts. For a quarter of a turn after that it still is, since the faster pace would make the guard
    act again, and so in turns.

    Parameters
    ----------
    guard : of the keep-out area
    reckoning : of the speed that turns away are predicted with
    speed : V_r [m/s]
    heading_rate_max : omega_max [rad/s]

    Attributes
    ----------
    guard : as above
    """

    __slots__ = ("_quarter_turn", "_reckoning", "_speed", "_steady_until", "guard")

    def __init__(
        self,
        guard: KeepoutGuard,
        *,
        reckoning: SpeedReckoning,
        speed: float,
        heading_rate_max: float,
    ) -> None:
        self.guard, self._reckoning, self._speed = guard, reckoning, speed
        self._quarter_turn, self._steady_until = 0.5 * math.pi / heading_rate_max, -math.inf

    def limit(
        self, command: float, pace: float, time: float, own: OwnMotion, *, leaving: bool
    ) -> tuple[float, float, bool]:
        """Return heading rate [rad/s] and pace [m/s] to command, and whether the pace is held below
        the one demanded.

        Parameters
        ----------
        command, pace : that are demanded [rad/s, m/s]
        time : now [s]
        own : the vehicle's motion
        leaving : whether the vehicle leaves for good; its pace is not held
        """
        guard, reckoning, held = self.guard, self._reckoning, False
        if time < self._steady_until and not leaving:
            pace, held = self._speed, True
        speed, fastest = own.speed, reckoning.fastest(pace)
        slowest = reckoning.slowest(pace)
        slowest = speed if speed < slowest else slowest
        faster = pace > reckoning.highest + _UNASKED and not leaving
        if faster and not guard.allows(
            command, time, own, speed if speed > fastest else fastest, slowest
        ):
            pace, held = reckoning.highest, True
            fastest = reckoning.fastest(pace)
            slowest = min(speed, reckoning.slowest(pace))
        command = guard.limit(command, time, own, speed if speed > fastest else fastest, slowest)
        if guard.intervening and not leaving:
            pace, held = self._speed, True
            self._steady_until = time + self._quarter_turn
        reckoning.note(pace if faster or pace < reckoning.highest else reckoning.highest)
        return command, pace, held

    def overruled(self, heading_rate: float, pace: float | None = None) -> None:
        """Take note of what is flown in place of the last commands: a heading rate [rad/s], and
        perhaps a pace [m/s].
        """
        self.guard.overruled(heading_rate)
        if pace is not None:
            self._reckoning.include(pace)
