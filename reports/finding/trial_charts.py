"""Figures of the searches of a trial: how soon plumes were found, and how often they were hit."""

import numpy as np
import pandas as pd

from measurement.plume.fluctuating_plume import FOUND_WITHIN, HIT, passes
from reports.document.chart import Chart, Line, Panel
from reports.finding.variants import Variant
from reports.run.columns import Array, column
from reports.run.trials import Trial

_HISTORIES_MAX = 40
"""Flights of a variant whose passes are counted at most: their time histories are read for it."""

_STRETCH = 30.0
"""Time over which the hits of all flights are counted together [s]."""


def finding_charts(trial: Trial, variants: list[Variant]) -> list[Chart]:
    """Return how soon plumes were found, and how often they were hit from then on."""
    panels = [_found_panel(variants), *_hits_panel(trial, variants)]
    name = f"{trial.name}-detection"
    return [Chart(name=name, caption=_FOUND, panels=panels, columns=len(panels), panel_height=0.38)]


_FOUND = (
    "Share of flights that have found their plume over the time since they reached their orbit, and"
    f" share of the passes that hit it, peak above {HIT:g} of the plume's axis, in stretches of"
    f" {_STRETCH:g} s."
)


def _found_panel(variants: list[Variant]) -> Panel:
    lines = []
    for variant in variants:
        times = np.sort(variant.times)
        within = times <= FOUND_WITHIN
        # A step at each flight, and level up to the end.
        found = int(np.count_nonzero(within))
        share = np.linspace(0.0, found / len(times), found + 1)
        x = np.concatenate([[0.0], np.repeat(times[within], 2), [FOUND_WITHIN]])
        lines.append(
            Line(
                x=x,
                y=np.repeat(share, 2),
                label=variant.name,
                colour=variant.colour,
                style=variant.style,
            )
        )
    return Panel(
        x_label="Time since the orbit was reached [s]",
        y_label="Plume found [-]",
        lines=lines,
        x_range=(0.0, FOUND_WITHIN),
        y_range=(0.0, 1.03),
    )


def _hits_panel(trial: Trial, variants: list[Variant]) -> list[Panel]:
    lines = []
    for variant in variants:
        times, hits = hits_over_time(trial, variant.rows)
        if len(times):
            middle = _STRETCH * (np.floor(times / _STRETCH) + 0.5)
            shares = (
                pd.DataFrame({"middle": middle, "hit": hits})
                .groupby("middle", as_index=False)
                .mean()
            )
            x, y = column(shares, "middle"), column(shares, "hit")
            lines.append(
                Line(x=x, y=y, label=variant.name, colour=variant.colour, style=variant.style)
            )
    panel = Panel(
        x_label="Time since the orbit was reached [s]",
        y_label="Passes that hit [-]",
        lines=lines,
        y_range=(0.0, 1.03),
    )
    return [panel] if lines else []


def hits_over_time(trial: Trial, rows: pd.DataFrame) -> tuple[Array, Array]:
    """Return the time of each pass since the orbit was reached [s], and 1 if it hit the plume, else
    0; of flights with a record.
    """
    kept = rows[[trial.run.has_history(str(flight_id)) for flight_id in rows["flight_id"]]]
    times, hits = [], []
    for _, row in kept.iloc[:: max(1, -(-len(kept) // _HISTORIES_MAX))].iterrows():
        history = trial.run.history(str(row["flight_id"]))
        if history is None:
            continue
        orbit = history[history["time_s"] >= float(row["orbit_at_s"])]
        time, fraction = (
            column(orbit, "time_s") - float(row["orbit_at_s"]),
            column(orbit, "plume_fraction"),
        )
        for at in passes(column(orbit, "plume_across_m")):
            times.append(float(time[(at.start + at.stop) // 2 if at.stop < len(time) else -1]))
            hits.append(float(np.max(fraction[at]) > HIT))
    return np.array(times), np.array(hits)
