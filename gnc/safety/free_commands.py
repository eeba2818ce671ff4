"""What the keep-out guard lets pass between two of its looks ahead: as much as the turn away that
it found can lose.
"""

_LESS = 0.5
"""By how much commands may be less of that turn than the one that was judged, over omega_max [-].
The more, the more has to be kept for rolling; the less, the sooner a command is looked at."""


class FreeCommands:
    """Commands that leave the turn away safe that was found at the last look, in whatever order
    they come.

    A command that is less of the turn than omega_max takes course from it. How much the turn can
    lose is known; what is given is counted.

    Parameters
    ----------
    heading_rate_max : omega_max [rad/s]
    time_step : for which a command is held [s]

    Attributes
    ----------
    steps : for how many more nothing need be looked at, at most
    """

    __slots__ = (
        "_fastest", "_highest", "_kept", "_left", "_lowest", "_rate", "_slowest", "_time_step", "_towards", "_whole", "steps",
    )  # fmt: skip

    def __init__(self, heading_rate_max: float, time_step: float) -> None:
        self._rate, self._time_step = heading_rate_max, time_step
        # Course of a step at omega_max; as much is kept beside it, for a command that is cut after
        # it has passed.
        self._whole = heading_rate_max * time_step
        self._kept = 2.0 * self._whole
        # Course that may be lost, and what of it a command spares per rad/s.
        self.steps, self._left, self._towards = 0, 0.0, 0.0
        self._lowest = self._highest = self._slowest = self._fastest = 0.0

    def cover(self, command: float, speed: float, slowest: float) -> bool:
        """Return whether a command needs no look, and count it if it does not.

        Parameters
        ----------
        command : [rad/s]
        speed, slowest : between which the vehicle's speed stays [m/s]
        """
        left = self._left + self._towards * command
        if (
            self.steps > 0
            and self._lowest <= command <= self._highest
            and speed <= self._fastest
            and slowest >= self._slowest
            and left >= self._kept
        ):
            self.steps -= 1
            self._left = left - self._whole
            return True
        return False

    def least(self, side: float, command: float) -> float:
        """Return how little of a turn to a side commands may be if this one is given [rad/s]."""
        return max(min(side * command, self._rate) - _LESS * self._rate, -self._rate)

    def begin(
        self, time: float, side: float, to_lose: float, command: float, last: float, change: float
    ) -> None:
        """Begin with what a look has found.

        Parameters
        ----------
        time : for which commands are free; negative if no turn was found [s]
        side : of the turn away; 0 where none was needed
        to_lose : course that the turn can lose [rad]
        command, last : that was judged, and at the look before [rad/s]
        change : of all commands from the last on, over a full reversal, that is counted for the
            turn's deviation [-]
        """
        self.steps, self._left, self._towards = (
            max(0, int(time / self._time_step) - 1),
            to_lose,
            side * self._time_step,
        )
        middle, half, least = (
            0.5 * (last + command),
            change * self._rate,
            self.least(side, command) if side else -self._rate,
        )
        self._lowest = max(middle - half, least if side > 0.0 else -self._rate)
        self._highest = min(middle + half, -least if side < 0.0 else self._rate)

    def at_speeds(self, slowest: float, fastest: float) -> None:
        """Let commands be free while the vehicle's speed stays between these [m/s]."""
        self._slowest, self._fastest = slowest, fastest

    def repeat(self, command: float) -> None:
        """Have the command that was judged pass once more [rad/s]."""
        self.steps += 1
        self._left += self._whole - self._towards * command

    def replace(self, command: float, flown: float) -> None:
        """Count what is flown in place of a command that has passed [rad/s]."""
        self._left -= max(0.0, self._towards * (command - flown))
        if not self._lowest <= flown <= self._highest:
            self.steps = 0
