"""Results of an arena: means with intervals by condition and over all conditions, and the tuning of
each law.
"""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
import numpy.typing as npt

from common.intervals import CONFIDENCE
from extensions.arena import ALL, TRACKING
from extensions.arena.entrants import Entrant
from extensions.arena.keys import ArenaConfig
from extensions.arena.paired_bootstrap import paired_estimates
from extensions.arena.window import MEASURED_COLUMNS, WINDOW_COLUMNS
from scenarios.engine.task import Row
from scenarios.planning.theory import crossing_limit
from scenarios.scenario.sections.guidance import GuidanceConfig
from scenarios.statistics.estimates import without_nan

Array = npt.NDArray[np.float64]

FIGURES = (
    "error_rms_m",
    "effort_rms_rad_s",
    "excess_rms_rad_s",
    "saturated_share",
    "crossing_distance_mean_m",
    "crossings_per_minute",
    *MEASURED_COLUMNS,
)
"""Figures of the end of a flight by which laws are compared; their columns define which direction
is worse.
"""

_TRACKING_ONLY = ("error_rms_m", "effort_rms_rad_s", "excess_rms_rad_s", "saturated_share")
"""Figures that compare laws of one task alone: their references differ between the tasks."""


def tuned_record(entrants: Sequence[Entrant], rows: Iterable[Row]) -> list[dict[str, Any]]:
    """Return the tuning of each law: its parameters by default and after tuning, and the cost of
    each.

    A row without a cost stands for a tuning whose process was lost.
    """
    of: dict[str, list[Row]] = {entrant.name: [] for entrant in entrants}
    for row in rows:
        of[row["entrant"]].append(row)
    record = []
    for entrant in entrants:
        tried = sorted(
            (row for row in of[entrant.name] if "cost_m" in row), key=lambda row: row["evaluation"]
        )
        entry = asdict(entrant) | {
            "defaults": dict(entrant.defaults),
            "evaluations": len(tried),
            "tuned": dict(entrant.defaults),
        }
        if tried:
            least = min(tried, key=lambda row: row["cost_m"])
            entry |= {
                "tuned": json.loads(least["parameters"]),
                "cost_default_m": tried[0]["cost_m"],
                "cost_tuned_m": least["cost_m"],
                "message": least["message"],
            }
        record.append(entry)
    return record


def estimates(
    entrants: Sequence[Entrant], rows: Mapping[str, Sequence[Row]], arena: ArenaConfig, seed: int
) -> list[dict[str, Any]]:
    """Return an estimate for each figure, condition and entrant.

    Parameters
    ----------
    entrants : of the arena
    rows : for each condition, figures of flights, entrant after entrant, the same number for each
    arena : number of resamples
    seed : of the resampling
    """
    found: list[dict[str, Any]] = []
    conditions = [(name, [name]) for name in rows] + ([(ALL, list(rows))] if len(rows) > 1 else [])
    columns = WINDOW_COLUMNS | MEASURED_COLUMNS
    for figure in FIGURES:
        for group in _groups(entrants, figure):
            for condition, members in conditions:
                tables = [_table(rows[name], figure, len(entrants))[group] for name in members]
                strata = np.repeat(np.arange(len(tables)), [table.shape[1] for table in tables])
                for i, estimate in zip(
                    group,
                    paired_estimates(
                        np.concatenate(tables, axis=1),
                        strata,
                        greater_is_better=columns[figure].worse == "lower",
                        resamples=arena.resamples,
                        confidence=CONFIDENCE,
                        seed=seed,
                    ),
                    strict=True,
                ):
                    entry = {"figure": figure, "condition": condition, "entrant": entrants[i].name}
                    found.append(entry | without_nan(asdict(estimate)))
    return found


def limits(
    rows: Mapping[str, Sequence[Row]], arena: ArenaConfig, guidance: GuidanceConfig
) -> dict[str, float]:
    """Return the most crossings per minute that any path allows, in the mean over a condition's
    flights.

    They are those that the arena gives, or those of the optimum, where it was solved for the
    aircraft's bank and roll rate.
    """
    if arena.limits:
        ratios, most = (np.array(values) for values in zip(*sorted(arena.limits), strict=True))
    elif solved := crossing_limit(guidance):
        ratios, most = (
            np.array(solved["limit_nu"]),
            60.0 / np.array(solved["crossing_interval_limit_s"]),
        )
    else:
        return {}
    found = {}
    for condition, of in rows.items():
        flown = [row["speed_ratio_mean"] for row in of if "speed_ratio_mean" in row]
        if flown:
            found[condition] = float(np.mean(np.interp(flown, ratios, most)))
    return found


def _groups(entrants: Sequence[Entrant], figure: str) -> list[list[int]]:
    """Return which entrants are compared with each other in a figure, by their indices."""
    if figure not in _TRACKING_ONLY:
        return [list(range(len(entrants)))]
    tracking = [i for i, entrant in enumerate(entrants) if entrant.task == TRACKING]
    others = [i for i, entrant in enumerate(entrants) if entrant.task != TRACKING]
    return [group for group in (tracking, others) if group]


def _table(rows: Sequence[Row], figure: str, entrants: int) -> Array:
    """Return a figure of a condition's flights, shape (entrants, flights)."""
    values = [float(value) if (value := row.get(figure)) is not None else math.nan for row in rows]
    return np.array(values, dtype=np.float64).reshape(entrants, -1)
