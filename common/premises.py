"""Names and columns of the measured premises of the keep-out guard's theorem.

``scenarios.measures.premises`` measures them.
"""

from collections.abc import Mapping

from common.columns import Column, described

TERMS: Mapping[str, str] = {
    "position": "own position",
    "wind": "wind and own velocity",
    "vessel": "vessel within its discs",
    "airspeed": "airspeed range",
    "response": "response of turns",
    "turning": "turns in turbulence",
    "drift": "drift of dead reckoning",
}
"""Measured terms of the error budget, and their titles."""

TRAFFIC_TERM, TRAFFIC_TITLE = "traffic", "other ships within their discs"
"""The same of flights with ships besides the one that is measured."""

TITLES: Mapping[str, str] = {**TERMS, TRAFFIC_TERM: TRAFFIC_TITLE}
"""What all of them are called."""

EXCEEDED = "premises_exceeded"
"""Column with the terms whose ratio is above 1, separated by commas, or ``HELD``."""

HELD = "none"
"""Value of ``EXCEEDED`` if every premise held."""

UNEXPLAINED_VIOLATION = "unexplained_violation"
"""Outcome of a flight that entered the keep-out area although every premise held."""

UNEXPLAINED = "every premise of the keep-out theorem held: an error of the theorem or of its code"
"""Explanation of such a flight in messages."""


def ratio_column(term: str) -> str:
    """Return the column with a term's largest ratio."""
    return f"premise_{term}_ratio_max"


def time_column(term: str) -> str:
    """Return the column with the time of a term's largest ratio."""
    return f"{ratio_column(term)}_s"


def _columns_of(term: str, title: str) -> dict[str, Column]:
    return {
        ratio_column(term): Column(
            f"largest error over the guard's allowance: {title}",
            title=f"Error over the guard's allowance: {title}",
            worse="higher",
        ),
        time_column(term): Column(
            "time of that ratio; for turns, the time at which the turn began",
            title=f"Time of that ratio: {title}",
            digits=1,
        ),
    }


PREMISE_COLUMNS = described(
    {
        EXCEEDED: Column(
            "premises of the guard's theorem that did not hold: terms with a ratio above 1,"
            " or none",
            kind="text",
        ),
        **{
            name: column
            for term, title in TERMS.items()
            for name, column in _columns_of(term, title).items()
        },
    }
)
"""Columns of a flight's row about the premises of the guard's theorem."""


TRAFFIC_PREMISE_COLUMNS = described(_columns_of(TRAFFIC_TERM, TRAFFIC_TITLE))
"""The same of flights with ships besides the one that is measured."""


def exceeded_terms(row: Mapping[str, object]) -> list[str]:
    """Return the terms whose premise did not hold, from a flight's row."""
    said = row.get(EXCEEDED)
    return said.split(", ") if isinstance(said, str) and said != HELD else []
