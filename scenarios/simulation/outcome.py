"""How a flight ended, in a word."""

from enum import Enum


class Outcome(Enum):
    """How a flight ended."""

    COMPLETED = "completed"
    NOT_SETTLED = "not_settled"
    DIVERGED = "diverged"
    INFEASIBLE = "infeasible"
    TRIM_FAILED = "trim_failed"
    FAILED = "failed"


DITCHED = "ditched"
"""Mode of a flight that came down on the water because of a fault, as its guidance meant to."""
