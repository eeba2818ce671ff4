"""Sections on flights that searched for their plume: all of them beside their comparisons, and a
typical and the worst one.
"""

from typing import Any

import numpy as np
import pandas as pd

from measurement.estimate.verdict import COVERAGE
from measurement.plume.fluctuating_plume import FOUND_WITHIN
from reports.document.blocks import Block, Heading, Section, Text
from reports.finding.flight_charts import height_chart, section_chart
from reports.finding.search_view import SearchView, search_view
from reports.finding.tables import height_table, search_table
from reports.finding.trial_charts import finding_charts
from reports.finding.variants import variants_of
from reports.run.columns import column, recorded_at
from reports.run.run_data import RunData
from reports.run.trials import Name, Trial

_LATE = "axis_height_error_3min_m"
"""Error of the axis' height by which flights are chosen."""

_NAMED_MAX = 12
"""Flights without their plume that are named."""


def finding_sections(run: RunData, trials: list[Trial], name: Name) -> list[Section]:
    """Return the sections of a run whose flights searched for a plume, and none of any other;
    ``name`` is that of a flight.
    """
    found = [trial for trial in trials if len(searched(trial.rows))]
    whole = [block for trial in found for block in _whole(trial, name, only=len(found) == 1)]
    single = [block for trial in found for block in _single(run, trial, name)]
    sections = [
        Section(anchor="finding", title="Search for the plume", nav_title="Search", blocks=whole),
        Section(
            anchor="searches", title="Searches one by one", nav_title="Searches", blocks=single
        ),
    ]
    return [section for section in sections if section.blocks]


def searched(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the flights that reached their orbit and had an estimate of the plume."""
    return rows[rows["axis_height_end_m"].notna()] if "axis_height_end_m" in rows else rows.iloc[:0]


def _whole(trial: Trial, name: Name, *, only: bool) -> list[Block]:
    """Return figures and tables of all flights of a trial, beside its comparisons."""
    variants = variants_of(trial)
    if not variants:
        return []
    heights = height_table(variants)
    missed = variants[0].rows[variants[0].times > FOUND_WITHIN]
    unfound = (
        f"Not found within {FOUND_WITHIN:g} s:"
        f" {'; '.join(name(row) for _, row in missed[:_NAMED_MAX].iterrows())}"
    )
    more = f" and {len(missed) - _NAMED_MAX} more" if len(missed) > _NAMED_MAX else ""
    return [
        *([] if only else [Heading(trial.title)]),
        search_table(variants),
        *([heights] if heights is not None else []),
        *finding_charts(trial, variants),
        *([Text(f"{unfound}{more}.")] if len(missed) else []),
    ]


def _single(run: RunData, trial: Trial, name: Name) -> list[Block]:
    """Return the figures of a typical search and of the one with the largest error."""
    blocks: list[Block] = []
    for row, why in _picked(run, searched(trial.rows)):
        view = search_view(run, row)
        if view is not None:
            file = str(row["flight_id"]).replace("_", "-")
            blocks += [Heading(f"{name(row)}: {why}"), Text(_told(row)), *_charts(view, file)]
    return blocks


def _charts(view: SearchView, name: str) -> list[Block]:
    section = section_chart(view, name)
    return [height_chart(view, name), *([section] if section is not None else [])]


def _picked(run: RunData, rows: pd.DataFrame) -> list[tuple["pd.Series[Any]", str]]:
    """Return the flights to be shown, of those with a time history, and why each is: none twice."""
    kept, judged = rows[run.with_history(rows)], rows[np.isfinite(column(rows, _LATE))]
    errors, recorded = np.abs(column(judged, _LATE)), run.with_history(judged)
    if not recorded.any():
        return [(kept.iloc[0], "the first with a time history")] if len(kept) else []
    # The median of all flights: among those with a time history is every one that failed.
    typical, median = recorded_at(errors, recorded, (len(errors) - 1) // 2)
    worst = int(np.argmax(np.where(recorded, errors, -1.0)))
    picked = [
        (
            judged.iloc[typical],
            f"{'' if median else 'nearest to '}the median error of the height after 3 minutes",
        )
    ]
    return picked + (
        [(judged.iloc[worst], "the largest error of the height after 3 minutes")]
        if worst != typical
        else []
    )


def _told(row: "pd.Series[Any]") -> str:
    """Return when the plume was found and what was believed of it, in words."""
    time, error = float(row.get("time_to_find_s", np.nan)), float(row.get(_LATE, np.nan))
    words = [
        f"Found {time:.0f} s after the orbit was reached"
        if np.isfinite(time)
        else "The plume was not found"
    ]
    if np.isfinite(error):
        believed = f"believed {abs(error):.1f} m too {'high' if error > 0.0 else 'low'}"
        sure = f"± {COVERAGE * row['axis_height_deviation_3min_m']:.1f} m (95 %)"
        words.append(
            f"after 3 minutes its height of {row['axis_height_3min_m']:.1f} m was {believed},"
            f" {sure}"
        )
    if np.isfinite(hits := float(row.get("hit_rate_found", np.nan))):
        words.append(f"{100.0 * hits:.0f} % of the passes since then hit it")
    enough = row.get("enough")
    words += [f"the flight ended with {enough}"] if isinstance(enough, str) and enough else []
    return f"{'; '.join(words)}."
