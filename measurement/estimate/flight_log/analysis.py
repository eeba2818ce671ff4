"""Everything that a flight's readings are asked for: both methods, over time, as one record for
files and reports.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import pandas as pd

from measurement.errors import MeasurementError
from measurement.estimate.estimator import estimate
from measurement.estimate.over_time import ELAPSED_S, over_time, time_to_verdict
from measurement.estimate.result import FscEstimate, Method, plain
from measurement.estimate.verdict import LIMITS_PERCENT
from measurement.gases import CARBON_FRACTION
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec

POINTS = 15
"""Elapsed times, beside those of ``ELAPSED_S``, at which the estimate is found for a figure over
time.
"""


@dataclass(frozen=True, kw_only=True)
class Analysis:
    """What a flight's readings say.

    Attributes
    ----------
    estimate : by the method that was asked for
    other : by the other method, or none where it cannot be had
    table : of ``over_time``
    instrument : as the analyst knows it
    carbon : mass share of the fuel [-]
    """

    estimate: FscEstimate
    other: FscEstimate | None
    table: pd.DataFrame
    instrument: SnifferSpec
    carbon: float

    def record(self, true_percent: float | None = None) -> dict[str, Any]:
        """Return what a report reads, for JSON; ``true_percent`` is what a perfect instrument
        reads, where that is known.
        """
        verdicts = self.estimate.verdicts
        return {
            "estimate": self.estimate.record(),
            "other": None if self.other is None else self.other.record(),
            "over_time": [
                {str(key): plain(value) for key, value in row.items()}
                for row in self.table.to_dict("records")
            ],
            "time_to_verdict_s": {
                f"{v.limit_percent:g}": plain(time_to_verdict(self.table, v.limit_percent))
                for v in verdicts
            },
            "instrument": self._instrument(),
            "carbon": self.carbon,
            "true_percent": true_percent,
        }

    def _instrument(self) -> dict[str, Any]:
        """Return the instrument as it was stated, and its channels as they were used, by gas; None
        is not stated, or no limit.
        """
        stated, used = (
            {c.gas: plain(asdict(c)) for c in spec.channels}
            for spec in (self.instrument, self.estimate.instrument)
        )
        about = {
            name: getattr(self.instrument, name) for name in ("name", "title", "source", "rate_hz")
        }
        return about | {"stated": stated, "used": used}


def analyse(
    readings: Readings,
    instrument: SnifferSpec,
    *,
    method: Method = "regression",
    carbon: float = CARBON_FRACTION,
    limits_percent: Sequence[float] = LIMITS_PERCENT,
    points: int = POINTS,
) -> Analysis:
    """Return the estimate by both methods, and over time at ``points`` even times and those of
    ``ELAPSED_S``.

    Raises
    ------
    MeasurementError : as ``estimate``
    """
    found = estimate(
        readings, instrument, method=method, carbon=carbon, limits_percent=limits_percent
    )
    second: Method = "areas" if method == "regression" else "regression"
    try:
        other = estimate(
            readings, instrument, method=second, carbon=carbon, limits_percent=limits_percent
        )
    except MeasurementError:
        other = None
    duration = float(readings.time[-1] - readings.time[0])
    even = np.linspace(0.0, duration, points + 1)[1:] if points else np.empty(0)
    elapsed = sorted(
        {*(round(float(t), 3) for t in even), *(t for t in ELAPSED_S if t <= duration)}
    )
    table = over_time(
        readings,
        instrument,
        elapsed_s=elapsed,
        method=method,
        carbon=carbon,
        limits_percent=limits_percent,
    )
    return Analysis(estimate=found, other=other, table=table, instrument=instrument, carbon=carbon)
