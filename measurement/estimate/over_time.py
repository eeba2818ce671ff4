"""The estimate after any part of a flight, and the time that a verdict takes."""

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from measurement.errors import MeasurementError
from measurement.estimate.estimator import check_parameters, estimate
from measurement.estimate.record import checked_record
from measurement.estimate.result import FscEstimate, Method
from measurement.estimate.verdict import LIMITS_PERCENT, OPEN
from measurement.gases import CARBON_FRACTION
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec

ELAPSED_S = (60.0, 120.0, 300.0, 600.0)
"""Times after which the estimate is reported [s]."""


def over_time(
    readings: Readings,
    instrument: SnifferSpec,
    *,
    elapsed_s: Sequence[float] = ELAPSED_S,
    method: Method = "regression",
    carbon: float = CARBON_FRACTION,
    limits_percent: Sequence[float] = LIMITS_PERCENT,
) -> pd.DataFrame:
    """Return what is known after each elapsed time within the record: a row per time.

    Columns: ``elapsed_s``, ``fsc_percent``, ``noise_percent``, ``total_percent``, ``low_percent``,
    ``high_percent``, ``quality``, ``passes``, and for each limit ``verdict_0.1`` and
    ``probability_above_0.1``. Times at which there is no estimate yet have a quality of C and
    values that are not numbers.

    Raises
    ------
    MeasurementError : a parameter is out of range, or the whole record is not one of a flight, as
        for ``estimate``
    """
    check_parameters(method, carbon, limits_percent)
    checked_record(readings, instrument)
    start, end = float(readings.time[0]), float(readings.time[-1])
    rows = []
    for elapsed in elapsed_s:
        if elapsed > end - start + 1e-6:
            continue
        until = int(np.searchsorted(readings.time, start + elapsed + 1e-6))
        part = Readings(readings.time[:until], readings.values[:until])
        try:
            found = estimate(
                part, instrument, method=method, carbon=carbon, limits_percent=limits_percent
            )
        except MeasurementError:
            found = None
        rows.append(_row(elapsed, found, limits_percent))
    return pd.DataFrame(rows, columns=list(_row(0.0, None, limits_percent)))


def _row(
    elapsed: float, found: FscEstimate | None, limits: Sequence[float]
) -> dict[str, float | str]:
    row: dict[str, float | str] = {"elapsed_s": elapsed}
    for name in ("fsc_percent", "noise_percent", "total_percent", "low_percent", "high_percent"):
        row[name] = math.nan if found is None else getattr(found, name)
    row["quality"] = "C" if found is None else found.quality
    row["passes"] = 0 if found is None else found.figures.passes
    for i, limit in enumerate(limits):
        row[f"verdict_{limit:g}"] = OPEN if found is None else found.verdicts[i].verdict
        row[f"probability_above_{limit:g}"] = (
            math.nan if found is None else found.verdicts[i].probability_above
        )
    return row


def time_to_verdict(table: pd.DataFrame, limit_percent: float) -> float:
    """Return the elapsed time from which on the verdict on a limit is no longer open and stays the
    same [s]; not a number if open.

    Parameters
    ----------
    table : of ``over_time``
    limit_percent : one of its limits [% m/m]
    """
    verdicts = table[f"verdict_{limit_percent:g}"].tolist()
    if not verdicts or verdicts[-1] == OPEN:
        return math.nan
    first = len(verdicts)
    while first > 0 and verdicts[first - 1] == verdicts[-1]:
        first -= 1
    return float(table["elapsed_s"].iloc[first])
