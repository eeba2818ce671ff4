"""How a flight ended, in a word."""

from enum import Enum

from common import premises


class Outcome(Enum):
    """How a flight ended.

    A flight completed if its aircraft was not lost, and its mission was flown: it settled, and made
    the required number of crossings, at least one. A flight without a vessel only has to last.
    ``NOT_SETTLED`` and ``INCOMPLETE`` are missions that were not flown; ``AIRCRAFT_LOST`` and
    ``DIVERGED`` are aircraft that do not come back. ``UNEXPLAINED_VIOLATION`` is an aircraft that
    was not lost and entered the keep-out area although every premise of the guard's theorem held:
    an error of the theorem or of its code.
    """

    COMPLETED = "completed"
    NOT_SETTLED = "not_settled"
    INCOMPLETE = "incomplete"
    AIRCRAFT_LOST = "aircraft_lost"
    DIVERGED = "diverged"
    UNEXPLAINED_VIOLATION = premises.UNEXPLAINED_VIOLATION
    INFEASIBLE = "infeasible"
    TRIM_FAILED = "trim_failed"
    FAILED = "failed"
