"""Tables of a comparison: figures of whole runs, differences of pairs, flights whose criteria
changed.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from reports.compare.figures import MEASURES, Difference
from reports.compare.pairs import Pairs
from reports.compare.runs import Run
from reports.document.axes import mark_text
from reports.document.blocks import Table
from reports.document.tables import ending, number
from reports.monte_carlo.names import Figure
from reports.run.columns import (
    Array,
    Mask,
    column,
    completed,
    count,
    kept_out,
    lost,
    met,
    was_flown,
)

LISTED_MAX = 40
"""Flights that are listed one by one."""

_DIGITS_MAX = 5
"""Digits after the point at most of figures that are nearly 0."""

_COUNTS: dict[str, Callable[[pd.DataFrame], Mask]] = {
    "Flights that were flown": was_flown,
    "Flights that met every criterion": met,
    "Flights that are known to have kept out": kept_out,
    "Missions completed": completed,
    "Aircraft lost": lost,
    "Flights in which the guard intervened": lambda rows: column(rows, "guard_interventions") > 0.0,
}
"""What is counted of each run."""


@dataclass(frozen=True, slots=True)
class _Whole:
    """A figure of a whole run: its words, the measure that it is of, and what is taken of the
    flights' figures.
    """

    words: str
    measure: str
    taken: Callable[[Array], np.floating]


_WHOLE = (
    _Whole("Keep-out violations, all flights", "keepout_violations", np.sum),
    _Whole("Closest approach of any flight", "min_distance_m", np.min),
    _Whole("Distance kept beyond r_min, least", "clearance_m", np.min),
    _Whole("Mean crossing interval off π/ω₀, worst", "crossing_interval_error", np.max),
    _Whole("Tracking error, rms after settling, median", "tracking_error_rms_m", np.median),
    _Whole("Tracking error, rms after settling, worst", "tracking_error_rms_m", np.max),
    _Whole("Settling time, median", "settling_time_s", np.median),
    _Whole("Settling time, longest", "settling_time_s", np.max),
    _Whole("Plume crossings after settling, all flights", "crossing_count", np.sum),
    _Whole("Time guarded, all flights", "guard_time_s", np.sum),
    _Whole("Flight time, all flights", "duration_s", np.sum),
    _Whole("Error of the sulphur content, median", "fsc_error_percent", np.median),
    _Whole("Uncertainty of the sulphur content, 1σ, median", "fsc_uncertainty_percent", np.median),
)


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
        counts = [count(chosen(table)) for table in tables]
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
    for whole in _WHOLE:
        figure = MEASURES[whole.measure].figure
        known = [_known(whole, table) for table in tables]
        values = [float(whole.taken(of)) if len(of) else None for of in known]
        if any(value is not None for value in values):
            unit = "" if figure.unit == "-" else f" [{figure.unit}]"
            digits = _digits(figure, values)
            changes = [
                _change(value, values[0], digits) if same and len(of) == len(known[0]) else "–"
                for value, of, same in zip(values[1:], known[1:], alike, strict=True)
            ]
            rows.append(
                [
                    f"{whole.words}{unit}",
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


def _known(whole: _Whole, rows: pd.DataFrame) -> Array:
    """Return the figure of the flights that have it."""
    measure = MEASURES[whole.measure]
    values: Array = measure.figure.scale * measure.values(rows)
    return values[np.isfinite(values)]


def _change(value: float | None, first: float | None, digits: int) -> str:
    return "–" if value is None or first is None else signed(value - first, digits)


def _digits(figure: Figure, values: Sequence[float | None]) -> int:
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
            figure.name if figure.unit == "-" else f"{figure.name} [{figure.unit}]",
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
        "Figure", "Pairs", f"Median in {first}", f"in {other}", f"Median of {other} − {first}", "95 % interval",
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
