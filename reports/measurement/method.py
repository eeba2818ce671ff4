"""What many flights with a sniffer show of the method: verdicts right, wrong and open, the relative
error of each instrument, and how often the stated interval holds the truth.
"""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from common.intervals import CONFIDENCE, clopper_pearson, percent
from measurement.estimate.verdict import ABOVE, OPEN
from measurement.gases import MASS_PERCENT, limit_words
from reports.document.blocks import Block, Card, Heading, Table, Text, UndecidedCard
from reports.document.tables import Cell, rows_table
from reports.measurement.data import share_read
from reports.measurement.flight_charts import error_chart, operating_curve, trajectory_chart
from reports.measurement.flight_tables import (
    accuracy_table,
    calls_table,
    flight_table,
    hit_table,
)
from reports.run.columns import Mask, column, flights_flown
from reports.run.run_data import RunData
from reports.run.trials import Name

_FEW = 8
"""Flights of which figures are not spread: of so few there are no statistics."""

_VERDICTS = (
    "Verdicts on the sulphur limit from {flights:,} flights: {right:,} right, {wrong:,} wrong,"
    " {open:,} open, {without:,} without a result"
)

_COMPARED = (
    "Each result is compared with what a perfect instrument would read. That is less than the fuel"
    " holds, because some sulphur leaves as sulphate. Share read: mean result / mean truth."
    " Predicted: by the closed form of passes that overlap in the slow channel. Covered: share of"
    " intervals that contain the truth."
)


def measured_flights(run: RunData) -> pd.DataFrame:
    """Return the rows of the flights that have a result."""
    rows = run.summary
    return rows[rows["fsc_percent"].notna()] if "fsc_percent" in rows else rows.iloc[:0]


def is_of_the_method(run: RunData) -> bool:
    """Return whether a run shows the method: several of its flights have a result."""
    return len(measured_flights(run)) > 1


def method_headline(run: RunData) -> str:
    """Return how many verdicts were right, wrong and open."""
    return _VERDICTS.format(**sulphur_verdicts(run))


def sulphur_verdicts(run: RunData) -> dict[str, int]:
    """Return the numbers of flights whose verdict on the fuel is ``right``, ``wrong`` or ``open``,
    of those ``without`` a result, and of all with a sniffer (``flights``).
    """
    rows = measured_flights(run)
    right, wrong, is_open = _verdicts(rows)
    sniffed = len(flights_flown(run.summary))
    return {
        "flights": sniffed,
        "right": int(right.sum()),
        "wrong": int(wrong.sum()),
        "open": int(is_open.sum()),
        "without": sniffed - len(rows),
    }


def _verdicts(rows: pd.DataFrame) -> tuple[Mask, Mask, Mask]:
    """Return which verdicts are right, wrong and open; a fuel at the limit is not above it."""
    called = rows["sulphur_verdict"].to_numpy()
    fuel, limit = (column(rows, name) for name in ("fsc_fuel_percent", "sulphur_limit_percent"))
    is_open = called == OPEN
    right = ~is_open & ((called == ABOVE) == (fuel > limit))
    return right, ~is_open & ~right, is_open


def method_cards(run: RunData) -> list[Card]:
    """Return how many verdicts were wrong and open, the relative error of each instrument with the
    flight that has the largest, and how many intervals hold the truth.
    """
    rows, counts = measured_flights(run), sulphur_verdicts(run)
    decided = counts["right"] + counts["wrong"]
    most = clopper_pearson(counts["wrong"], decided, CONFIDENCE).high
    held = int(_held(rows).sum())
    wrong = Card(
        "Wrong verdicts",
        f"{counts['wrong']:,} of {decided:,}",
        note=f"rate below {percent(most)} at {percent(CONFIDENCE)}" if decided else "",
    )
    limits = sorted(rows["sulphur_limit_percent"].unique())
    of_limits = " and ".join(map(limit_words, limits))
    is_open = UndecidedCard("Open verdicts", f"{counts['open']:,} of {len(rows):,}", of_limits)
    name = "95 % intervals that hold what a perfect instrument reads"
    return [
        wrong,
        *([is_open] if counts["open"] else []),
        *_errors(rows),
        Card(name, f"{held:,} of {len(rows):,}"),
    ]


def _held(rows: pd.DataFrame) -> Mask:
    names = ("fsc_low_percent", "fsc_expected_percent", "fsc_high_percent")
    low, expected, high = (column(rows, name) for name in names)
    held: Mask = (low <= expected) & (expected <= high)
    return held


def _errors(rows: pd.DataFrame) -> Iterator[Card]:
    """Yield the median relative error of each instrument, and the flight with the largest."""
    for sensor, group in rows.groupby("sensor"):
        shares = share_read(column(group, "fsc_percent"), column(group, "fsc_expected_percent"))
        errors = np.abs(shares - 1.0)
        known = np.isfinite(errors)
        if not known.any():
            continue
        worst = group[known].iloc[int(np.argmax(errors[known]))]
        yield Card(
            f"Relative error, {sensor}, median",
            percent(float(np.median(errors[known]))),
            note=f"largest {percent(float(errors[known].max()))}: {worst['flight_id']}",
        )


def verdict_table(rows: pd.DataFrame) -> Table:
    """Return how many verdicts were right, wrong and open, by limit and instrument."""
    groups = []
    for (limit, sensor), group in rows.groupby(["sulphur_limit_percent", "sensor"]):
        right, wrong, is_open = (int(of.sum()) for of in _verdicts(group))
        groups.append(
            {"limit": limit, "sensor": sensor, "right": right, "wrong": wrong, "open": is_open}
        )
    return rows_table(
        groups,
        [
            Cell(f"Limit [{MASS_PERCENT}]", "limit", "{:g}"),
            Cell("Sensor", "sensor", width=2.0),
            *(Cell(name.capitalize(), name, "{:,.0f}") for name in ("right", "wrong", "open")),
        ],
        caption="Verdicts by limit: right where they agree with the fuel. A fuel at the limit is"
        " not above it.",
        left_columns=2,
    )


def method_blocks(run: RunData, name: Name) -> list[Block]:
    """Return verdicts and errors of the flights that measured the fuel; ``name`` is that of a
    flight.
    """
    rows, statistics = measured_flights(run), run.sulphur
    if len(rows) < _FEW or statistics is None:
        return [verdict_table(rows), flight_table(rows, name)]
    trajectories = trajectory_chart(run, rows)
    designed: list[Block] = [] if trajectories is None else [Heading("Trajectories"), trajectories]
    curve = operating_curve(statistics)
    return [
        verdict_table(rows),
        Text(_COMPARED),
        accuracy_table(statistics),
        error_chart(rows),
        *designed,
        Heading("Ships called above the limit"),
        *([curve] if curve is not None else []),
        calls_table(statistics),
        Heading("How well the plume was hit"),
        hit_table(rows),
    ]
