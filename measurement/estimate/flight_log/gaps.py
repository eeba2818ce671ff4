"""What a log lacks: missing readings, and the gaps that the analysis bridges or leaves out."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from measurement.gases import GASES, UNITS
from measurement.sniffer.lag import Array
from measurement.sniffer.sniffer import Readings

APART = 1.5
"""Samples that are farther apart, over their period, have a gap between them: the analysis bridges shorter ones."""

_WITHIN = 0.5
"""A sample that no reading is as near as this to, over the period, is interpolated."""


@dataclass(frozen=True, kw_only=True)
class Gaps:
    """What a log lacks.

    Attributes
    ----------
    rows : of the log
    missing : readings that are missing in them, by gas, of the gases that the analysis uses
    interpolated : samples in short gaps, which are bridged by a straight line
    gaps : beginning and end of each longer one, which is left out [s] since the first row
    """

    rows: int
    missing: dict[str, int]
    interpolated: int
    gaps: list[tuple[float, float]]

    def record(self) -> dict[str, Any]:
        """Return it for JSON."""
        return asdict(self)

    @property
    def missing_words(self) -> str:
        """How many readings are missing."""
        told = [f"{count:,} of {gas.upper()}" for gas, count in self.missing.items() if count]
        return f"{', '.join(told)} in {self.rows:,} rows" if told else f"none in {self.rows:,} rows"

    @property
    def gap_words(self) -> str:
        """How many gaps there are, how long, and which part of them is interpolated."""
        told = []
        if self.gaps:
            start, end = max(self.gaps, key=lambda gap: gap[1] - gap[0])
            longest = f"{end - start:.0f} s from {start:.0f} s on"
            whole = sum(end - start for start, end in self.gaps)
            told.append(f"{len(self.gaps)} of {whole:.0f} s in all, the longest {longest}" if self.gaps[1:] else f"1 of {longest}")
        if self.interpolated:
            samples = f"{self.interpolated:,} sample{'s' * (self.interpolated > 1)}"
            told.append(f"{samples} in short ones interpolated, not shown as readings")
        return "; ".join(told) or "none"


def found_gaps(readings: Readings, signals: pd.DataFrame) -> Gaps:
    """Return what the readings of a log lack, given the signals that an estimate made of them."""
    used = [gas for gas in GASES if f"{gas}_{UNITS[gas]}" in signals]
    values = readings.values[:, [GASES.index(gas) for gas in used]]
    first, time = float(readings.time[0]), signals["time_s"].to_numpy()
    ends = np.concatenate([[first], time, [float(readings.time[-1])]])
    apart = np.flatnonzero(np.diff(ends) > APART * _period(readings))
    return Gaps(
        rows=len(readings.time),
        missing={gas: int(np.sum(~np.isfinite(column))) for gas, column in zip(used, values.T, strict=True)},
        interpolated=int(np.sum(interpolated(readings, signals))),
        gaps=[(float(ends[i]) - first, float(ends[i + 1]) - first) for i in apart],
    )


def interpolated(readings: Readings, signals: pd.DataFrame) -> npt.NDArray[np.bool_]:
    """Return which samples of an estimate no row with readings of all gases is near to, shape (n,)."""
    used = [i for i, gas in enumerate(GASES) if f"{gas}_{UNITS[gas]}" in signals]
    complete: Array = readings.time[np.isfinite(readings.values[:, used]).all(axis=1)]
    time = signals["time_s"].to_numpy()
    after = np.searchsorted(complete, time).clip(1, len(complete) - 1)
    nearest = np.minimum(np.abs(time - complete[after - 1]), np.abs(time - complete[after]))
    far: npt.NDArray[np.bool_] = nearest > _WITHIN * _period(readings)
    return far


def _period(readings: Readings) -> float:
    return float(np.median(np.diff(readings.time)))
