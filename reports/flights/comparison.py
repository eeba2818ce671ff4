"""Comparisons: the same flights from the same starts, with a part changed."""

import pandas as pd

from reports.document.blocks import Block, Section, Table, Text
from reports.document.tables import Cell, rows_table
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
from reports.run.trials import AS_IN_THE_STUDY, Trial

_TRACKING = "tracking_error_rms_m"

_SAME = (
    "The same flights, from the same starts, with parts changed. They have no part in the verdict."
)


def comparison_section(run: RunData, trials: list[Trial]) -> Section:
    """Return the section on the comparisons of a run, or one without blocks if it has none."""
    blocks: list[Block] = []
    for trial in trials if len(run.comparison) else []:
        compared = run.comparison[run.comparison["trial"] == trial.key]
        if len(compared):
            blocks.append(_table(run, _pairs(trial.rows, compared)))
    return Section(
        anchor="comparison",
        title="What each part is worth",
        nav_title="Comparison",
        blocks=[Text(_SAME), *blocks] if blocks else [],
    )


def _pairs(rows: pd.DataFrame, compared: pd.DataFrame) -> pd.DataFrame:
    """Return compared flights, after those of the study that they are beside."""
    bases = study_flight(compared)
    names = [
        str(variant).replace("_", " ").replace("keepout", "keep-out")
        for variant in compared["variant"]
    ]
    study = rows[rows["flight_id"].isin(bases)]
    study = study.assign(variant=AS_IN_THE_STUDY)
    return pd.concat([study, compared.assign(variant=names)])


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
