"""Comparisons: the same flights from the same starts, with a part changed."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from reports.document.axes import cut_words
from reports.document.blocks import Block, Section, Table, Text
from reports.document.chart import VARIANT_STYLES, Chart, Line, Panel, Style
from reports.document.palette import VARIANTS, Meaning
from reports.document.tables import Cell, rows_table
from reports.flights.names import flight_name
from reports.run.columns import (
    clearance,
    column,
    count,
    flights_flown,
    largest,
    least,
    met,
    study_flight,
    total,
)
from reports.run.run_data import RunData
from reports.run.time_history import tracking_error
from reports.run.trials import AS_IN_THE_STUDY, Trial

_SHOWN_TURNS = 45.5
"""How much of a flight a panel shows after settling, over the time to turn by one radian at
omega_max [-].
"""

_SHOWN_BANDS, _ROOM = 1.2, 1.05
"""Largest distance that a panel shows, over the settling band; and over the largest error [-]."""

_FLIGHTS_MAX = 4
"""Flights that have a panel with their comparisons."""

_TRACKING = "tracking_error_rms_m"

_SAME = (
    "The same flights, from the same starts, with parts changed. They have no part in the verdict."
)
_ERRORS = (
    "Tracking error, the distance to the reference, of flights of the study and with parts changed:"
    " up to {shown:g} s after settling. What has no curve never settled, or has no time history."
)


def comparison_section(run: RunData, trials: list[Trial]) -> Section:
    """Return the section on the comparisons of a run, or one without blocks if it has none."""
    blocks: list[Block] = []
    for trial in trials if len(run.comparison) else []:
        compared = run.comparison[run.comparison["trial"] == trial.key]
        if len(compared):
            pairs = _pairs(trial.rows, compared)
            chart = _chart(trial, pairs)
            blocks += [*([chart] if chart.panels else []), _table(run, pairs)]
    return Section(
        anchor="comparison",
        title="What each part is worth",
        nav_title="Comparison",
        blocks=[Text(_SAME), *blocks] if blocks else [],
    )


def _pairs(rows: pd.DataFrame, compared: pd.DataFrame) -> pd.DataFrame:
    """Return compared flights and those of the study; ``base`` is the name of the study's flight of
    each pair.
    """
    bases = study_flight(compared)
    names = [
        str(variant).replace("_", " ").replace("keepout", "keep-out")
        for variant in compared["variant"]
    ]
    study = rows[rows["flight_id"].isin(bases)]
    study = study.assign(base=study["flight_id"], variant=AS_IN_THE_STUDY)
    return pd.concat([study, compared.assign(base=bases, variant=names)]).sort_values(
        "base", kind="stable"
    )


def _chart(trial: Trial, pairs: pd.DataFrame) -> Chart:
    """Return the tracking error of a few flights and of their comparisons over time since settling,
    in panels with the same axes.
    """
    # The same part of the flight for a fast aircraft, which turns slowly, as for a slow one.
    shown = float(f"{_SHOWN_TURNS / pairs['heading_rate_limit_rad_s'].max():.2g}")
    looks = _looks(pairs)
    panels: list[Panel] = []
    for _, flights in pairs.groupby("base", sort=False):
        # The study's own flight lies over the others.
        own = flights["variant"] == AS_IN_THE_STUDY
        ordered = pd.concat([flights[~own], flights[own]])
        lines = [
            line
            for _, row in ordered.iterrows()
            for line in _error_line(trial.run, row, looks[row["variant"]], shown)
        ]
        # Named as the study's flight, also where that is not in the summary.
        first = flights.iloc[0].copy()
        first["flight_id"] = first["base"]
        if lines and len(panels) < _FLIGHTS_MAX:
            panels.append(
                Panel(
                    x_label="Time since settling [s]",
                    y_label="Tracking error [m]",
                    lines=lines,
                    title=flight_name(trial, first),
                )
            )
    every = [line for panel in panels for line in panel.lines]
    longest = max((float(line.x.max(initial=0.0)) for line in every), default=shown)
    most = max((float(np.nanmax(line.y, initial=0.0)) for line in every), default=1.0)
    highest = min(_ROOM * most, _SHOWN_BANDS * float(trial.setting("flight.settling_band_m")))
    x_range, y_range = (0.0, longest), (0.0, highest or 1.0)
    panels = [replace(panel, x_range=x_range, y_range=y_range) for panel in panels]
    return Chart(
        name=f"{trial.name}-comparison",
        caption=_ERRORS.format(shown=shown) + cut_words(panels),
        panels=panels,
        panel_height=0.2,
    )


def _looks(pairs: pd.DataFrame) -> Mapping[str, tuple[str, Style]]:
    """Return colour and style of each variant."""
    names = [name for name in dict.fromkeys(pairs["variant"]) if name != AS_IN_THE_STUDY]
    looks: dict[str, tuple[str, Style]] = {
        name: (VARIANTS[i % len(VARIANTS)], VARIANT_STYLES[i % len(VARIANT_STYLES)])
        for i, name in enumerate(names)
    }
    return looks | {AS_IN_THE_STUDY: (Meaning.FLOWN, "solid")}


def _error_line(
    run: RunData, row: "pd.Series[Any]", look: tuple[str, Style], duration: float
) -> list[Line]:
    """Return the curve of a flight; none of one that never settled, or without a time history."""
    history = run.history(str(row["flight_id"]))
    if history is None or pd.isna(row["settling_time_s"]):
        return []
    settled = history[history["time_s"] >= row["settling_time_s"]]
    time = settled["time_s"].to_numpy() - float(row["settling_time_s"])
    shown = time <= duration
    error = tracking_error(settled)[shown]
    colour, style = look
    return [Line(x=time[shown], y=error, label=str(row["variant"]), colour=colour, style=style)]


def _table(run: RunData, pairs: pd.DataFrame) -> Table:
    """Return a row per variant."""
    beyond, tracking = run.column("clearance_m"), run.column(_TRACKING)
    groups = [
        {"variant": variant, "rows": rows, "flown": flights_flown(rows)}
        for variant, rows in pairs.groupby("variant", sort=False)
    ]
    cells = [
        Cell("Variant", "variant", width=2.2),
        Cell("Flights", lambda of: len(of["rows"]), "{:,.0f}", 0.8),
        Cell("Keep-out violations", lambda of: total(of["flown"], "keepout_violations"), "{:,.0f}"),
        Cell(beyond.head, lambda of: least(clearance(of["flown"])), "{:+.1f}", 1.2),
        Cell(
            f"{tracking.title}, median{tracking.bracket}",
            lambda of: tracking.text(of["flown"][_TRACKING].median()),
            width=1.2,
        ),
        Cell(
            f"largest{tracking.bracket}",
            lambda of: tracking.text(largest(column(of["flown"], _TRACKING))),
        ),
        Cell("Met", lambda of: count(met(of["rows"])), "{:,.0f}", 0.8),
    ]
    caption = "Flights beside the same flights with some keys set otherwise."
    return rows_table(groups, cells, caption=caption)
