"""Figures that users' instruments and studies add: tables, and panels over what was swept or
counted.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from common.columns import Column
from common.run_layout import SUMMARY
from reports.document.blocks import Block, Section, Table, Text
from reports.document.chart import Chart, Panel
from reports.document.palette import Meaning
from reports.document.panels import histogram
from reports.document.tables import number
from reports.flights.names import swept_words
from reports.flights.trials.charts import PanelsOver, by_violation
from reports.run.columns import column, is_figure, judged, worst
from reports.run.run_data import RunData
from reports.run.trials import Name, Trial

_LISTED_MAX = 40
"""Flights that have a row each; of more there are only the figures over all of them."""

_IN_ROW, _ROWS = 2, 6
"""Panels beside each other, and columns of figures that fit the width of a page."""


def added_sections(run: RunData, trials: Sequence[Trial], name: Name) -> list[Section]:
    """Return a section for each instrument or study that adds figures to the flights.

    Parameters
    ----------
    run, trials : the run, and its trials
    name : what a flight is called, by its row
    """
    parts: dict[str, dict[str, Column]] = {}
    for key, of in run.added(SUMMARY).items():
        if key in run.summary:
            parts.setdefault(of.part, {})[key] = of
    return [
        Section(
            anchor=f"added{i}",
            title=f"Figures of {part}",
            nav_title=part.rpartition(":")[2],
            blocks=_blocks(run, trials, columns, f"added{i}", name),
        )
        for i, (part, columns) in enumerate(parts.items(), start=1)
    ]


def _blocks(
    run: RunData, trials: Sequence[Trial], columns: dict[str, Column], anchor: str, name: Name
) -> list[Block]:
    meanings = "; ".join(f"{of.title}: {of.meaning}" for of in columns.values() if of.meaning)
    numbers = {key: of for key, of in columns.items() if is_figure(run.summary, key)}
    several = len(trials) > 1
    panels = [
        replace(panel, title=trial.title if several else panel.title)
        for trial in trials
        for key, of in numbers.items()
        for panel in _panels(trial, key, of)
    ]
    chart = Chart(
        name=f"{anchor}figures",
        caption="Each figure over what was swept, or the flights counted by it.",
        panels=panels,
        columns=min(_IN_ROW, max(1, len(panels))),
        panel_height=0.32,
    )
    return [
        *([Text(f"{meanings}.")] if meanings else []),
        *([_over_flights(run.summary, numbers)] if numbers else []),
        *([chart] if panels else []),
        *_each_flight(run.summary, columns, name),
    ]


def _panels(trial: Trial, key: str, of: Column) -> list[Panel]:
    """Return a figure over each number that was swept; where there is none, the flights counted."""
    if not is_figure(trial.flown, key):
        return []
    words = swept_words(trial)
    swept = [name for name in trial.swept if name not in words]
    if swept:
        over = [PanelsOver(trial, name, by_violation(trial)).figure(key) for name in swept]
        return [panel for panel in over if panel is not None]
    values = of.scale * column(trial.flown, key)
    counted = histogram([(values, "flights", Meaning.FLOWN)], of.label)
    return [] if counted is None else [counted]


def _over_flights(rows: pd.DataFrame, columns: dict[str, Column]) -> Table:
    """Return a row per figure: of how many flights it is known, its median, its ends, its sum where
    that means something, and the flight with the worst value.
    """
    cells = []
    for key, of in columns.items():
        values, sizes = column(rows, key), judged(rows, key, of)
        known = values[np.isfinite(values)]
        flight = ""
        if of.worse:
            at = sizes == worst(sizes[np.isfinite(sizes)], of)
            flight = str(rows["flight_id"][at].iloc[0])
        cells.append(
            [
                of.row,
                f"{len(known):,} of {len(rows):,}",
                of.text(float(known.min())),
                of.text(float(np.median(known))),
                of.text(float(known.max())),
                of.text(float(known.sum())) if of.adds_up else "–",
                flight or "–",
            ]
        )
    return Table(
        caption="The figures over all flights that have them.",
        head=["Figure", "Flights", "Least", "Median", "Largest", "Sum", "Worst in flight"],
        rows=cells,
        widths=[2.6, 1.0, 0.9, 0.9, 0.9, 0.9, 1.4],
    )


def _each_flight(rows: pd.DataFrame, columns: dict[str, Column], name: Name) -> list[Block]:
    """Return the figures of each flight, of few flights, so many columns to a table as fit."""
    if len(rows) > _LISTED_MAX:
        return []
    keys = list(columns)
    return [
        Table(
            caption="The same figures, a row per flight.",
            head=["Flight", *(columns[key].head for key in keys[i : i + _ROWS])],
            rows=[
                [name(row), *(_cell(row[key], columns[key]) for key in keys[i : i + _ROWS])]
                for _, row in rows.iterrows()
            ],
            widths=[1.6, *(1.2 for _ in keys[i : i + _ROWS])],
            breakable=True,
        )
        for i in range(0, len(keys), _ROWS)
    ]


def _cell(value: Any, of: Column) -> str:
    """Return what a flight has, a number in its digits and anything else as it is."""
    if isinstance(value, str | bool | np.bool_):
        return str(value)
    if value is None or pd.isna(value):
        return "–"
    return number(of.scale * float(value), f"{{:.{of.digits}f}}")
