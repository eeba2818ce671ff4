"""Tables of a comparison: figures of whole runs, differences of pairs, flights whose criteria
changed.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

from common.columns import Column
from reports.compare.figures import Difference, measures
from reports.compare.pairs import Pairs
from reports.compare.runs import Run
from reports.document.axes import mark_text
from reports.document.blocks import Table
from reports.document.tables import ending, number
from reports.run.columns import (
    Array,
    Mask,
    column,
    count,
    judged,
    worst,
)

LISTED_MAX = 40
"""Flights that are listed one by one."""

_DIGITS_MAX = 5
"""Digits after the point at most of figures that are nearly 0."""

_COUNTS: dict[str, Callable[[Run], int]] = {
    "Flights that were flown": lambda run: run.data.verdict.counts.flown,
    "Flights that met every criterion": lambda run: run.data.verdict.counts.met,
    "Flights that are known to have kept out": lambda run: run.data.verdict.counts.kept_out,
    "Flights that violated the keep-out area": lambda run: run.data.verdict.counts.violated,
    "Flights of which that is unknown": lambda run: run.data.verdict.counts.unknown,
    "Missions completed": lambda run: run.data.verdict.counts.completed,
    "Aircraft lost": lambda run: run.data.verdict.counts.lost,
    "Flights in which the guard intervened": lambda run: count(
        column(run.data.summary, "guard_interventions") > 0.0
    ),
}
"""What is counted of each run."""


def _over_flights(figure: Column) -> dict[str, Callable[[Array], float]]:
    """Return what is taken of a figure over all flights, by the words for it: the sum, where that
    means something, else the median and, where there is a worse side, the worst.
    """
    if figure.adds_up:
        return {"all flights": lambda values: float(values.sum())}
    taken: dict[str, Callable[[Array], float]] = {"median": lambda values: float(np.median(values))}
    if figure.worse:
        end = "least" if figure.worse == "lower" else "worst"
        taken[end] = lambda values: worst(values, figure)
    return taken


def side_by_side(runs: Sequence[Run]) -> Table:
    """Return figures of each run, of all of its flights, and their differences from the first where
    as many flights have them.
    """
    tables = [run.data.summary for run in runs]
    sizes = [len(rows) for rows in tables]
    alike = [size == sizes[0] for size in sizes[1:]]
    rows = [
        [
            "Flights",
            *(f"{size:,}" for size in sizes),
            *(signed(size - sizes[0], 0) for size in sizes[1:]),
        ]
    ]
    for words, chosen in _COUNTS.items():
        counts = [chosen(run) for run in runs]
        changes = [
            signed(found - counts[0], 0) if same else "–"
            for found, same in zip(counts[1:], alike, strict=True)
        ]
        rows.append(
            [
                words,
                *(f"{found:,} of {size:,}" for found, size in zip(counts, sizes, strict=True)),
                *changes,
            ]
        )
    for name, figure in measures(run.data for run in runs).items():
        known = [_known(table, name, figure) for table in tables]
        for words, taken in _over_flights(figure).items():
            values = [taken(of) if len(of) else None for of in known]
            if all(value is None for value in values):
                continue
            digits = _digits(figure, values)
            changes = [
                _change(value, values[0], digits) if same and len(of) == len(known[0]) else "–"
                for value, of, same in zip(values[1:], known[1:], alike, strict=True)
            ]
            rows.append(
                [
                    f"{figure.title}, {words}{figure.bracket}",
                    *(number(value, _pattern(digits)) for value in values),
                    *changes,
                ]
            )
    letters = [run.letter for run in runs]
    return Table(
        head=["", *letters, *(f"{letter} − {letters[0]}" for letter in letters[1:])],
        rows=rows,
        widths=[3.0, *(1.0 for _ in rows[0][1:])],
        print_size_pt=8.0,
    )


def _known(rows: pd.DataFrame, name: str, figure: Column) -> Array:
    """Return the figure of the flights that have it, in its unit."""
    values: Array = figure.scale * judged(rows, name, figure)
    return values[np.isfinite(values)]


def _change(value: float | None, first: float | None, digits: int) -> str:
    return "–" if value is None or first is None else signed(value - first, digits)


def _digits(figure: Column, values: Sequence[float | None]) -> int:
    """Return how many digits after the point show two of the least value: of 0.003 and 0.006, not
    0.00 and 0.01.
    """
    known = [abs(value) for value in values if value]
    if not known or not figure.digits:
        return figure.digits
    return max(figure.digits, min(_DIGITS_MAX, 1 - math.floor(math.log10(min(known)))))


def signed(value: float, digits: int) -> str:
    """Return a difference with its sign: 0 where it is none at all, and two digits of one that is
    smaller than ``digits`` show.
    """
    if value == 0.0:
        return "0"
    if abs(value) >= 0.5 * 10.0**-digits:
        return number(value, _pattern(digits, "+"))
    small = number(value, "{:+.2g}")
    mantissa, _, exponent = small.partition("e")
    return f"{mantissa}·{mark_text(10.0 ** int(exponent))}" if exponent else small


def _pattern(digits: int, sign: str = "") -> str:
    """Return how a figure is written; the median of counts may lie between two of them."""
    return f"{{:{sign},.{digits}f}}" if digits else f"{{:{sign},.9g}}"


def difference_table(pairs: Pairs, found: dict[str, Difference]) -> Table:
    """Return how figures differ between the flights of a pair, of those that do: median, its
    interval, least and greatest.
    """
    rows, bold = [], []
    for i, difference in enumerate(
        of for name, of in found.items() if name == "keepout_violations" or not of.is_none
    ):
        figure, known = difference.figure, difference.known
        both = np.isfinite(difference.change)
        medians = [
            float(np.median(values[both])) for values in (difference.before, difference.after)
        ]
        digits = _digits(figure, medians)
        interval = (
            f"{signed(difference.low, digits)} to {signed(difference.high, digits)}"
            if np.isfinite([difference.low, difference.high]).all()
            else "–"
        )
        rows.append([
            figure.row,
            f"{len(known):,}",
            *(number(median, _pattern(digits)) for median in medians),
            signed(difference.median, digits),
            interval,
            f"{signed(float(known.min()), digits)} to {signed(float(known.max()), digits)}",
            f"{count(known < 0.0):,}, {count(known > 0.0):,}",
        ])  # fmt: skip
        bold += [(i, 5)] if difference.excludes_zero else []
    first, other = pairs.first.letter, pairs.other.letter
    head = [
        "Figure", "Pairs", f"Median in {first}", f"in {other}", f"Median of {other} − {first}",
        "95 % interval",
        "Least to greatest", "Lower, higher",
    ]  # fmt: skip
    return Table(head=head, rows=rows, widths=[2.7, 0.6, 0.9, 0.8, 1.0, 1.5, 1.6, 0.9], bold=bold)


def changed(pairs: Pairs) -> Mask:
    """Return which flights met, kept out or completed in one run alone."""
    either: Mask = np.logical_or.reduce([pairs.no_longer, *pairs.in_other_alone.values()])
    return either


def _in_one_alone(pairs: Pairs, i: int) -> str:
    """Return what a flight is in one run alone: where it is met there, nothing else."""
    found = [
        f"{words} in {run.letter} alone"
        for run, states in (
            (pairs.first, pairs.in_first_alone),
            (pairs.other, pairs.in_other_alone),
        )
        for words, mask in states.items()
        if mask[i]
    ]
    met_alone = [words for words in found if words.startswith("met ")]
    return ", ".join(met_alone or found)


def changed_table(pairs: Pairs) -> Table | None:
    """Return the flights that met, kept out or completed in one run alone, those that are no longer
    met first; None without any.
    """
    worse, all_of_them = pairs.no_longer, changed(pairs)
    order = (pairs.no_longer_met, worse & ~pairs.no_longer_met, all_of_them & ~worse)
    places = [int(i) for mask in order for i in np.flatnonzero(mask)]
    if not places:
        return None
    first, other = pairs.first.letter, pairs.other.letter
    rows = [
        [
            pairs.names[i],
            _in_one_alone(pairs, i),
            ending(pairs.before.iloc[i]),
            ending(pairs.after.iloc[i]),
        ]
        for i in places[:LISTED_MAX]
    ]
    return Table(
        head=["Flight", "Criteria", f"How it ended in {first}", f"How it ended in {other}"],
        rows=rows,
        widths=[1.3, 1.1, 2.8, 3.4],
        left_columns=4,
        prose=True,
        breakable=True,
    )
