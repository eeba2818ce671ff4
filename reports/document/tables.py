"""Tables that every report has, and how their cells are written."""

import math
import re
from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from reports.document.blocks import Card, Table
from reports.run.columns import Array
from reports.run.run_data import RunData


class Cell(NamedTuple):
    """How a table of rows writes one of its columns.

    Attributes
    ----------
    head : title of the column
    value : key of its value in a row, or the function that returns it; text stands as it is, and
        what is missing is a dash
    pattern : of its numbers
    width : relative, in print
    """

    head: str
    value: str | Callable[[Any], object]
    pattern: str = "{}"
    width: float = 1.0


def rows_table(rows: Iterable[Any], cells: Sequence[Cell], **others: Any) -> Table:
    """Return a table with a row for each of ``rows``, which are mappings or rows of a data frame.

    Parameters
    ----------
    rows, cells : what is written, and how
    others : further attributes of ``Table``
    """
    return Table(
        head=[cell.head for cell in cells],
        rows=[[_written(row, cell) for cell in cells] for row in rows],
        widths=[cell.width for cell in cells],
        **others,
    )


def _written(row: Any, cell: Cell) -> str:
    value = cell.value(row) if callable(cell.value) else row.get(cell.value)
    return value if isinstance(value, str) else number(value, cell.pattern)


def pairs_table(
    rows: list[list[str]], *, widths: tuple[float, float] = (1.0, 4.0), **others: Any
) -> Table:
    """Return a table without a head, of names and values; other parameters are those of
    ``Table``.
    """
    return Table(
        head=["", ""], rows=rows, widths=list(widths), left_columns=2, prose=True, **others
    )


def figure_table(figures: Sequence[Card]) -> Table:
    """Return figures of a verdict, those that page 1 has no tile for."""
    rows = [[card.name, card.note, card.value, card.required, card.result] for card in figures]
    return Table(
        head=["Figure", "Flight", "Value", "Required", ""],
        rows=rows,
        widths=[3.0, 2.0, 1.4, 1.4, 0.6],
        left_columns=2,
        caption="Figures beside those of page 1; a dash where nothing is required.",
    )


def run_config(run: RunData) -> dict[str, Any]:
    """Return the configuration of the run, or of its first trial: the vehicle is the same in all of
    them.
    """
    return dict(next(iter(run.manifest.get("trials", {}).values()), run.manifest["config"]))


def kinematic(run: RunData) -> str:
    """Return what the kinematic vehicle of a run is: equation (1), with a lag if it has one."""
    lag = float((run_config(run).get("kinematic") or {}).get("heading_rate_lag_s", 0.0))
    return f"eq. (1) with a heading-rate lag of {lag:g} s" if lag else "eq. (1)"


def length(metres: float) -> str:
    """Return a distance in the unit that suits its size."""
    if metres >= 0.1:
        return f"{metres:.2f} m"
    return f"{1000.0 * metres:.1f} mm" if metres >= 1e-4 else "< 0.1 mm"


def limit(value: float) -> str:
    """Return a limit to three digits: one that is fitted to an aircraft has many."""
    return f"{float(f'{value:.3g}'):g}"


def approach(distance: float, radius: float, sign: str = "") -> str:
    """Return a closest approach to 0.1 m; where that contradicts its judgement, rounded down, with
    as many digits as it takes.

    Parameters
    ----------
    distance, radius : what was kept, and what was to be kept [m]; a dash without a distance
    sign : "+" for one with its sign
    """
    if not math.isfinite(distance):
        return "–"
    down = (
        f"{math.floor(distance * 10.0**places) / 10.0**places:{sign}.{places}f}"
        for places in (1, 2, 3)
    )
    texts = (f"{distance:{sign}.1f}", *down)
    shown = (
        text
        for text in texts
        if (float(text) >= float(f"{radius:g}")) == (distance >= radius) and text != "-0.0"
    )
    return minus(next(shown, f"{distance:{sign}.6f}"))


def beside_limit(value: float, bound: float, digits: int = 3) -> str:
    """Return a figure to as many digits as show it on that side of its bound on which it lies; no
    exponent.
    """
    for places in range(digits, 12):
        text = f"{float(f'{value:.{places}g}'):.{max(places, 6)}g}"
        if (float(text) > bound, float(text) < bound) == (value > bound, value < bound) or float(
            text
        ) == value:
            break
    return minus(text)


def vehicle_flown(run: RunData) -> str:
    """Return the vehicle of a run, to go on a sentence with."""
    fidelity = run_config(run).get("fidelity")
    name = run.innerloop["title"] if run.innerloop else run_config(run).get("aircraft", "aircraft")
    aircraft = f"the {name} in six degrees of freedom"
    if fidelity == "kinematic":
        return f"the kinematic vehicle, {kinematic(run)}"
    return f"{aircraft} and of the kinematic vehicle" if fidelity == "both" else aircraft


def minus(text: str) -> str:
    """Return figures with a minus sign for their hyphen; that of an exponent stays."""
    return re.sub(r"(?<!\w)-", "−", text)


def number(value: Any, pattern: str) -> str:
    """Return a value by its pattern, and a dash if there is none."""
    return "–" if value is None or pd.isna(value) else minus(pattern.format(float(value)))


def span(values: Array, pattern: str) -> str:
    """Return the least and the largest of some values, or the only one; a dash without any."""
    if not np.isfinite(values).any():
        return "–"
    ends = [number(np.nanmin(values), pattern), number(np.nanmax(values), pattern)]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


_SYMBOLS = {
    r"\bpi/omega_0\b": "π/ω₀",
    r"\bomega_0\b": "ω₀",
    r"\bomega_max\b": "ω_max",
    r"\bnu (?=is |= )": "ν ",
}
"""How documents and messages, which are plain, write symbols; and how figures and tables do."""


def in_symbols(text: str) -> str:
    """Return a text with its quantities written as figures and tables write them."""
    for plain, symbol in _SYMBOLS.items():
        text = re.sub(plain, symbol, text)
    return text


def outcome(row: "pd.Series[Any]") -> str:
    """Return how a flight ended, in words, and which criteria it failed."""
    if row["criteria_met"]:
        return "met"
    ended = str(row["outcome"]).replace("_", " ")
    message = first_sentence(in_symbols(str(row["message"])))
    return f"{ended}: {message}" if message else ended


def first_sentence(message: str) -> str:
    """Return the message of a flight without the advice that follows it."""
    return re.split(r"\. (?=[A-Z])", message, maxsplit=1)[0]


_ADVICE = ": allow more time"
"""How the advice begins that follows why a flight was not completed."""


def ending(row: "pd.Series[Any]") -> str:
    """Return how a flight ended: every criterion that it failed, or why it was not completed,
    without the advice that follows.
    """
    words = outcome(row)
    return (
        words if row["outcome"] == "completed" else re.split(f";|{_ADVICE}", words, maxsplit=1)[0]
    )
