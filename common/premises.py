"""The premises of the keep-out guard's theorem as a run's tables have them: their names, columns,
and what is said of a violation that none of them explains. ``scenarios.measures.premises`` measures
them.
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
"""Terms of the error budget that are measured, and what each is called."""

TRAFFIC_TERM, TRAFFIC_TITLE = "traffic", "other ships within their discs"
"""The same of flights with ships besides the one that is measured."""

TITLES: Mapping[str, str] = {**TERMS, TRAFFIC_TERM: TRAFFIC_TITLE}
"""What all of them are called."""

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


def _columns_of(term: str, title: str) -> dict[str, Column]:
    return {
        ratio_column(term): Column(
            f"largest error over what the guard reckons with: {title}",
            title=f"Error over what the guard reckons with: {title}",
            worse="higher",
        ),
        time_column(term): Column(
            "time of that ratio; of turns, at which the turn began",
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
"""Columns of a flight's row: how the premises of the guard's theorem held."""


TRAFFIC_PREMISE_COLUMNS = described(_columns_of(TRAFFIC_TERM, TRAFFIC_TITLE))
"""The same of flights with ships besides the one that is measured."""


def exceeded_terms(row: Mapping[str, object]) -> list[str]:
    """Return the terms whose premise did not hold in a flight, by its row."""
    said = row.get(EXCEEDED)
    return said.split(", ") if isinstance(said, str) and said != HELD else []
