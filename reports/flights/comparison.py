"""Comparisons: the same flights from the same starts, with a part changed."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from reports.document.axes import cut_words
from reports.document.blocks import Block, Fold, Section, Table, Text
from reports.document.chart import VARIANT_STYLES, Chart, Line, Panel, Style
from reports.document.palette import VARIANTS, Meaning
from reports.document.tables import number
from reports.flights.names import flight_name
from reports.flights.trials.tables import flight_table
from reports.run.columns import (
    clearance,
    column,
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

_SHOWN_BANDS = 1.2
"""Largest distance that a panel shows, over the settling band [-]."""

_LEAST_BANDS, _ROOM = 0.02, 1.05
"""The same at least, and a panel's height over the largest error in any [-]."""

_HEIGHT = 1.1
"""Height of all panels at most, over the width of the page: with heading and caption they stand on
one.
"""

_FLIGHTS_MAX = 4
"""Flights that have a panel with their comparisons."""

_TRACKING = "tracking_error_rms_m"

_ROWS_MAX = 60
"""Flights that are listed one by one; of more there is a row for each variant."""


def comparison_section(run: RunData, trials: list[Trial]) -> Section:
    """Return the section on the comparisons of a run, or one without blocks if it has none."""
    blocks: list[Block] = []
    for trial in trials:
        compared = (
            run.comparison[run.comparison["trial"] == trial.key]
            if len(run.comparison)
            else run.comparison
        )
        if len(compared):
            pairs = _pairs(trial.rows, compared)
            chart = _chart(trial, pairs)
            table = _table(trial, pairs)
            # The figure says which part is worth what, the table how much.
            more = Fold(title="The flights, a row each", blocks=[table])
            blocks += [chart, more] if chart else [table]
    text = Text(
        "The same flights, from the same starts, with parts changed. They have no part in the verdict."
    )
    return Section(
        anchor="comparison",
        title="What each part is worth",
        nav_title="Comparison",
        blocks=[text, *blocks] if blocks else [],
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


def _chart(trial: Trial, pairs: pd.DataFrame) -> Chart | None:
    """Return the tracking error of a few flights and of their comparisons over time since settling,
    or None.
    """
    # The same part of the flight for a fast aircraft, which turns slowly, as for a slow one.
    turn = 1.0 / float(pairs["heading_rate_limit_rad_s"].max())
    shown = float(f"{_SHOWN_TURNS * turn:.2g}")
    band = _SHOWN_BANDS * float(trial.setting("flight.settling_band_m"))
    variants = [
        variant for variant in dict.fromkeys(pairs["variant"]) if variant != AS_IN_THE_STUDY
    ]
    looks: dict[str, tuple[str, Style]] = {
        variant: (VARIANTS[i % len(VARIANTS)], VARIANT_STYLES[i % len(VARIANT_STYLES)])
        for i, variant in enumerate(variants)
    }
    looks[AS_IN_THE_STUDY] = (Meaning.FLOWN, "solid")
    panels: list[Panel] = []
    without: dict[tuple[str, str], list[str]] = {}
    for _, flights in pairs.groupby("base", sort=False):
        # Named as the study's flight, also where that is not in the summary.
        first = flights.iloc[0].copy()
        first["flight_id"] = first["base"]
        # The study's own flight lies over the others.
        ordered = flights.sort_values(
            "variant", key=lambda names: names == AS_IN_THE_STUDY, kind="stable"
        )
        drawn = [
            (row, _error_line(trial.run, row, looks[row["variant"]], shown))
            for _, row in ordered.iterrows()
        ]
        lines = [line for _, found in drawn for line in found]
        if lines and len(panels) < _FLIGHTS_MAX:
            for row in (row for row, found in drawn if not found):
                without.setdefault((str(row["variant"]), _why(row)), []).append(
                    flight_name(trial, first)
                )
            panels.append(
                Panel(
                    x_label="Time since settling [s]",
                    y_label="Tracking error [m]",
                    lines=lines,
                    title=flight_name(trial, first),
                )
            )
    panels = _fitted(panels, shown, band)
    caption = (
        "Tracking error, the distance to the reference, of flights of the study and with parts changed:"
        f" {_shown_words(pairs, shown)}.{_missing(without, len(panels))}{cut_words(panels)}"
    )
    name = f"{trial.name}-comparison"
    return (
        Chart(
            name=name, caption=caption, panels=panels, panel_height=min(0.2, _HEIGHT / len(panels))
        )
        if panels
        else None
    )


def _shown_words(pairs: pd.DataFrame, shown: float) -> str:
    """Return how much of the flights is drawn: what follows settling, or the first of it where any
    flight lasts longer.
    """
    lasts = column(pairs, "duration_s") - column(pairs, "settling_time_s")
    return f"the first {shown:g} s after settling" if np.any(lasts > shown) else "from settling on"


def _fitted(panels: Sequence[Panel], duration: float, band: float) -> list[Panel]:
    """Return panels with the same axes: as long as the longest line, and as high as the largest
    error, up to the limits.
    """
    x, y = (
        np.concatenate(
            [getattr(line, axis) for panel in panels for line in panel.lines] or [np.empty(0)]
        )
        for axis in "xy"
    )
    x, y = x[np.isfinite(x)], y[np.isfinite(y)]
    end = float(x.max(initial=0.0)) or duration
    height = min(band, max(_ROOM * float(y.max(initial=0.0)), _LEAST_BANDS * band))
    return [replace(panel, x_range=(0.0, end), y_range=(0.0, height)) for panel in panels]


def _why(row: "pd.Series[Any]") -> str:
    """Return why a flight has no curve: it never settled, or else has no time history."""
    ended = str(row["outcome"]).replace("_", " ")
    return (
        ended.replace("not settled", "never settled")
        if pd.isna(row["settling_time_s"])
        else "no time history"
    )


def _missing(without: Mapping[tuple[str, str], Sequence[str]], panels: int) -> str:
    """Return which variants have no curve and why, and in which panels unless in all."""
    told = []
    for (variant, why), names in without.items():
        where = f" at {', '.join(names)}" if len(names) < panels else ""
        told.append(f"{variant}{where} ({why})")
    return f" Without a curve: {'; '.join(told)}." if told else ""


def _error_line(
    run: RunData, row: "pd.Series[Any]", look: tuple[str, Style], duration: float
) -> list[Line]:
    history = run.history(str(row["flight_id"]))
    if history is None or pd.isna(row["settling_time_s"]):
        return []
    settled = history[history["time_s"] >= row["settling_time_s"]]
    time = settled["time_s"].to_numpy() - float(row["settling_time_s"])
    shown = time <= duration
    colour, style = look
    return [
        Line(
            x=time[shown],
            y=tracking_error(settled)[shown],
            label=str(row["variant"]),
            colour=colour,
            style=style,
        )
    ]


def _table(trial: Trial, pairs: pd.DataFrame) -> Table:
    """Return a row per flight; if they are too many, one per variant."""
    if len(pairs) <= _ROWS_MAX:
        names = {
            base: flight_name(trial, row)
            for base, row in trial.rows.set_index("flight_id", drop=False).iterrows()
        }
        return flight_table(
            trial.run,
            pairs,
            "Variant, flight",
            lambda row: f"{row['variant']}, {names.get(row['base'], row['base'])}",
            caption="The same flights with parts changed, a row each, with their outcome.",
        )
    beyond, tracking = trial.run.column("clearance_m"), trial.run.column(_TRACKING)
    rows = []
    for variant, flights in pairs.groupby("variant", sort=False):
        flown = flights_flown(flights)
        rows.append([
            str(variant),
            f"{len(flights)}",
            f"{total(flown, 'keepout_violations')}",
            number(least(clearance(flown)), "{:+.1f}"),
            tracking.text(flown[_TRACKING].median()),
            tracking.text(largest(column(flown, _TRACKING))),
            f"{int(np.count_nonzero(met(flights)))}",
        ])  # fmt: skip
    head = [
        "Variant", "Flights", "Keep-out violations", beyond.head,
        f"{tracking.title}, median{tracking.bracket}", f"largest{tracking.bracket}", "Met",
    ]  # fmt: skip
    return Table(
        caption="Flights beside the same flights with some keys set otherwise.",
        head=head,
        rows=rows,
        widths=[2.2, 0.8, 1.0, 1.2, 1.2, 1.0, 0.8],
    )
