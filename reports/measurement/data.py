"""What a measured flight's directory holds."""

import json
from typing import Any

import numpy as np
import pandas as pd

from common.files import is_file
from common.run_layout import ESTIMATE, SAMPLES
from reports.errors import ReportError
from reports.run.columns import Array, Mask, column
from reports.run.flight_config import flight_configs
from reports.run.run_data import RunData

Record = dict[str, Any]
"""What ``estimate.json`` holds: ``estimate``, ``other``, ``over_time``, ``time_to_verdict_s``,
``instrument``, ``true_percent``, and of a logged flight ``flight``."""

METHODS = {"regression": "equalise and regress", "areas": "areas of passes"}
"""Methods of an estimate, in words."""

_APART = 1.5
"""Samples that are farther apart, over their period, have a gap between them: shorter ones are
bridged.
"""

SINCE = "the record began"
"""What the time of an estimate is counted from, where nothing else is said."""


def read_estimate(run: RunData) -> Record:
    """Return the estimate of a measured flight.

    Raises
    ------
    ReportError : there is none that can be read, without which there is nothing to report
    """
    try:
        record = json.loads((run.path / ESTIMATE).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise ReportError(
            f"'{run.path}': {ESTIMATE} cannot be read: {error}; measure the flight again"
        ) from None
    if not (
        isinstance(record, dict)
        and (isinstance(record.get("estimate"), dict) or record.get("gases"))
    ):
        raise ReportError(f"'{run.path}': {ESTIMATE} holds no estimate; measure the flight again")
    return record


def read_samples(run: RunData) -> pd.DataFrame | None:
    """Return readings and signals by time, or None if there are none that can be read."""
    if not is_file(run.path / SAMPLES):
        return None
    try:
        table = pd.read_csv(run.path / SAMPLES)
        return table.astype(np.float64) if "time_s" in table else None
    except (ValueError, OSError):
        run.unread.add(SAMPLES)
        return None


def value(record: Record, name: str) -> float:
    """Return a figure of an estimate; not a number where it is not known."""
    found = record.get(name)
    return float("nan") if found is None else float(found)


def over_time(record: Record) -> pd.DataFrame:
    """Return the estimate over time, a row per elapsed time at which there is one."""
    table = pd.DataFrame(record["over_time"])
    return table[column(table, "total_percent") > 0.0] if len(table) else table


def errors(record: Record) -> list[tuple[str, float]]:
    """Return the parts of the uncertainty by their words, the largest first, noise among them
    [% m/m].
    """
    found = record["estimate"]
    parts = {"noise": value(found, "noise_percent"), **found["common_percent"]}
    named = [
        (WORDS.get(name, name), float(part))
        for name, part in parts.items()
        if part is not None and np.isfinite(part)
    ]
    return sorted(named, key=lambda item: -item[1])


WORDS = {
    "noise": "noise",
    "calibration": "calibration of SO2, CO2",
    "no": "correction for NO",
    "no2": "correction for NO2",
    "response": "response and delay",
    "carbon": "carbon content",
    "overlap": "overlapping passes",
    "sampling": "time between readings",
}
"""Parts of the uncertainty."""


def share_read(found: Array, expected: Array) -> Array:
    """Return what was found over what a perfect instrument reads [-]; not a number for a fuel
    without sulphur.
    """
    return found / np.where(expected > 0.0, expected, np.nan)


def measured_minutes(run: RunData, rows: pd.DataFrame) -> Array:
    """Return for how long each flight's readings were evaluated [min]: its last
    ``flight.measured_s``, or since it had settled.
    """
    duration = column(rows, "duration_s")
    windows = [config.get("flight", {}).get("measured_s") for config in flight_configs(run, rows)]
    window = np.array([np.nan if seconds is None else float(seconds) for seconds in windows])
    measured = np.where(
        np.isnan(window), duration - column(rows, "settling_time_s"), np.fmin(window, duration)
    )
    minutes: Array = measured / 60.0
    return minutes


def after_gap(samples: pd.DataFrame) -> Mask:
    """Return which samples follow a gap of the log: they are farther than others from the one
    before.
    """
    steps = np.diff(column(samples, "time_s"))
    return (
        np.concatenate([[False], steps > _APART * np.median(steps)])
        if len(steps)
        else np.zeros(len(samples), dtype=np.bool_)
    )


def in_parts(samples: pd.DataFrame) -> pd.DataFrame:
    """Return samples with an empty row in each gap of the log, where a line through them ends."""
    order = np.arange(len(samples), dtype=np.float64)
    return samples.set_axis(order).reindex(
        np.sort(np.concatenate([order, order[after_gap(samples)] - 0.5]))
    )


def finite(*columns: Array) -> bool:
    """Return whether each column has a number."""
    return all(bool(np.isfinite(values).any()) for values in columns)
