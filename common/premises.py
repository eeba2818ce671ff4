"""The premises of the keep-out guard's theorem as a run's tables have them: their names, columns,
and what is said of a violation that none of them explains. ``scenarios.metrics.premises`` measures
them.
"""

from collections.abc import Mapping

TERMS: Mapping[str, str] = {
    "position": "own position",
    "wind": "wind and own velocity",
    "vessel": "vessel within its discs",
    "airspeed": "airspeed range",
    "response": "response of turns",
    "turning": "turns in turbulence",
    "drift": "drift of dead reckoning",
}
"""Terms of the error budget that are measured, and what each is called."""

EXCEEDED = "premises_exceeded"
"""Column that names the terms whose ratio is above 1, separated by commas, or says ``HELD``."""

HELD = "none"
"""What it says where every premise held."""

UNEXPLAINED_VIOLATION = "unexplained_violation"
"""Outcome of a flight that entered the keep-out area although every premise held."""

UNEXPLAINED = "every premise of the keep-out theorem held: an error of the theorem or of its code"
"""What is said of such a flight."""


def ratio_column(term: str) -> str:
    """Return the column of a term's largest ratio."""
    return f"premise_{term}_ratio_max"


def time_column(term: str) -> str:
    """Return the column of the time of that ratio."""
    return f"{ratio_column(term)}_s"


PREMISE_COLUMNS = (
    EXCEEDED,
    *(column for term in TERMS for column in (ratio_column(term), time_column(term))),
)
"""Columns of a flight's row."""


def exceeded_terms(row: Mapping[str, object]) -> list[str]:
    """Return the terms whose premise did not hold in a flight, by its row."""
    said = row.get(EXCEEDED)
    return said.split(", ") if isinstance(said, str) and said != HELD else []
