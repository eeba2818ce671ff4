"""What a log lacks: missing readings, and the gaps that the analysis bridges or leaves out."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from measurement.estimate.record import BRIDGED, SHORTEST, pieces
from measurement.gases import GASES, UNITS
from measurement.sniffer.lag import Array
from measurement.sniffer.sniffer import Readings

_WITHIN = 0.5
"""A sample that no reading is as near as this to, over the period, is interpolated."""


@dataclass(frozen=True, kw_only=True)
class Gaps:
    """What a log lacks.

    Attributes
    ----------
    log_rows : of the log
    rows : of them that have a new reading, where the log is faster than the sensors; otherwise all
    missing : readings that are missing in them, by gas, of the gases that the analysis uses
    interpolated : samples in short gaps, which are bridged by a straight line
    gaps : beginning and end of each longer one, which is left out [s] since the first row
    unused : rows with all readings that are left out, too, as there are too few of them in a row
    """

    log_rows: int
    rows: int
    missing: dict[str, int]
    interpolated: int
    gaps: list[tuple[float, float]]
    unused: int

    def record(self) -> dict[str, Any]:
        """Return it for JSON."""
        return asdict(self)

    @property
    def told(self) -> dict[str, str]:
        """What the log lacks, in words by what it is; nothing of a log that is whole."""
        found = {"Rows": self.row_words} if self.log_rows > self.rows else {}
        found |= {"Missing readings": self.missing_words} if any(self.missing.values()) else {}
        return found | (
            {"Gaps": self.gap_words} if self.gaps or self.interpolated or self.unused else {}
        )

    @property
    def row_words(self) -> str:
        """How many rows of a log that is faster than its sensors have a new reading."""
        return f"{self.log_rows:,}, of which {self.rows:,} have a new reading; the others repeat one, or have none, and do not count"

    @property
    def missing_words(self) -> str:
        """How many readings are missing."""
        told = [f"{count:,} of {gas.upper()}" for gas, count in self.missing.items() if count]
        return f"{', '.join(told)} in {self.rows:,} rows" if told else f"none in {self.rows:,} rows"

    @property
    def gap_words(self) -> str:
        """How many gaps there are, how long, which part of them is interpolated, and what is left
        out beside them.
        """
        told = []
        if self.gaps:
            start, end = max(self.gaps, key=lambda gap: gap[1] - gap[0])
            longest = f"{end - start:.0f} s from {start:.0f} s on"
            whole = sum(end - start for start, end in self.gaps)
            told.append(
                f"{len(self.gaps)} of {whole:.0f} s in all, the longest {longest}"
                if self.gaps[1:]
                else f"1 of {longest}"
            )
        if self.interpolated:
            samples = f"{self.interpolated:,} sample{'s' * (self.interpolated > 1)}"
            told.append(f"{samples} in short ones interpolated, not shown as readings")
        if self.unused:
            rows = f"{self.unused:,} row{'s' * (self.unused > 1)}"
            told.append(
                f"{rows} beside gaps left out, as fewer than {SHORTEST} in a row are too few to use"
            )
        return "; ".join(told) or "none"


def found_gaps(readings: Readings, signals: pd.DataFrame, log_rows: int) -> Gaps:
    """Return what the readings of a log of so many rows lack, given the signals that an estimate
    made of them.
    """
    used = _used(signals)
    known, period = np.isfinite(readings.values), _period(readings)
    complete = np.flatnonzero(known[:, used].all(axis=1))
    times = (
        np.concatenate([readings.time[:1], readings.time[complete], readings.time[-1:]])
        - readings.time[0]
    )
    parts = [len(piece) for piece in pieces(readings.time, complete, period)]
    return Gaps(
        log_rows=log_rows,
        rows=len(readings.time),
        missing={GASES[i]: int(np.sum(~known[:, i])) for i in used},
        interpolated=int(np.sum(interpolated(readings, signals))),
        gaps=[
            (float(times[i]), float(times[i + 1]))
            for i in np.flatnonzero(np.diff(times) > BRIDGED * period)
        ],
        unused=sum(rows for rows in parts if rows < SHORTEST),
    )


def interpolated(readings: Readings, signals: pd.DataFrame) -> npt.NDArray[np.bool_]:
    """Return which samples of an estimate no row with readings of all gases is near to, shape (n,)."""
    complete: Array = readings.time[np.isfinite(readings.values[:, _used(signals)]).all(axis=1)]
    time = signals["time_s"].to_numpy()
    after = np.searchsorted(complete, time).clip(1, len(complete) - 1)
    nearest = np.minimum(np.abs(time - complete[after - 1]), np.abs(time - complete[after]))
    far: npt.NDArray[np.bool_] = nearest > _WITHIN * _period(readings)
    return far


def _used(signals: pd.DataFrame) -> list[int]:
    """Return the places in ``GASES`` of those that an estimate made signals of."""
    return [i for i, gas in enumerate(GASES) if f"{gas}_{UNITS[gas]}" in signals]


def _period(readings: Readings) -> float:
    return float(np.median(np.diff(readings.time)))
