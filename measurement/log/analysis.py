"""Analysis of a flight's readings by both methods and over time, and what the log lacks."""

from collections.abc import Container, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from measurement.errors import MeasurementError
from measurement.estimate.estimator import ELAPSED_S, estimate, over_time, time_to_verdict
from measurement.estimate.gas import GasEstimate, GasReadings, estimate_gas
from measurement.estimate.record import BRIDGED, SHORTEST, split_at_gaps
from measurement.estimate.result import FscEstimate, Method, plain
from measurement.estimate.verdict import LIMITS_PERCENT, Decision, decide
from measurement.gases import CARBON_FRACTION, GASES, UNITS
from measurement.log.read import LoggedFlight
from measurement.rules import DecisionRule
from measurement.sniffer.lag import Array
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec

POINTS = 15
"""Even elapsed times of the figure over time, in addition to ``ELAPSED_S``."""

_NEAR = 0.5
"""Distance from the next reading beyond which a sample is interpolated [sample periods]."""


@dataclass(frozen=True, kw_only=True)
class Analysis:
    """Analysis of a flight's readings.

    Attributes
    ----------
    estimate : by the chosen method
    other : by the other method, or None where it is not possible
    table : of ``over_time``
    instrument : as the analyst states it
    carbon : mass share of the fuel [-]
    decision : by the rule, or None without one
    gases : figures of the other gases that are compared with CO2
    gas_remarks : for gases of the log that cannot be estimated, the reason
    """

    estimate: FscEstimate
    other: FscEstimate | None
    table: pd.DataFrame
    instrument: SnifferSpec
    carbon: float
    decision: Decision | None = None
    gases: tuple[GasEstimate, ...] = ()
    gas_remarks: tuple[str, ...] = ()

    def sampled(self, flight: LoggedFlight) -> tuple[pd.DataFrame, Readings]:
        """Return the signals of the estimate, and their readings."""
        return self.estimate.signals, flight.readings

    def record(self, true_percent: float | None = None) -> dict[str, Any]:
        """Return the content of a report, for JSON.

        Parameters
        ----------
        true_percent : result of a perfect instrument, where it is known [% m/m]
        """
        limits = [verdict.limit_percent for verdict in self.estimate.verdicts]
        return {
            "estimate": self.estimate.record(),
            "other": None if self.other is None else self.other.record(),
            "over_time": [
                {str(key): plain(value) for key, value in row.items()}
                for row in self.table.to_dict("records")
            ],
            "time_to_verdict_s": {
                f"{limit:g}": plain(time_to_verdict(self.table, limit)) for limit in limits
            },
            "instrument": _instrument(self.instrument, self.estimate.instrument),
            "carbon": self.carbon,
            "decision": None if self.decision is None else plain(asdict(self.decision)),
            "true_percent": true_percent,
        }


@dataclass(frozen=True, kw_only=True)
class GasAnalysis:
    """Analysis of a flight that did not measure SO2.

    Attributes
    ----------
    gases, gas_remarks, instrument : see ``Analysis``
    """

    gases: tuple[GasEstimate, ...]
    gas_remarks: tuple[str, ...]
    instrument: SnifferSpec

    def sampled(self, flight: LoggedFlight) -> tuple[pd.DataFrame, Readings]:
        """Return the signals of the first gas, and their readings."""
        first = self.gases[0]
        readings = next(of.readings for of in flight.gases if of.species.name == first.gas)
        return first.signals, readings

    def record(self) -> dict[str, Any]:
        """Return the content of a report, for JSON."""
        return {
            "estimate": None,
            "instrument": _instrument(self.instrument, self.instrument),
            "true_percent": None,
        }


def _instrument(stated: SnifferSpec, used: SnifferSpec) -> dict[str, Any]:
    """Return an instrument as it is stated, and as it was used, for JSON."""
    return {
        "name": stated.name,
        "title": stated.title,
        "source": stated.source,
        "rate_hz": stated.rate_hz,
        "stated": _channels(stated),
        "used": _channels(used),
    }


def _channels(instrument: SnifferSpec) -> dict[str, Any]:
    """Return the channels of an instrument by gas, for JSON; None is not stated, or no limit."""
    return {channel.gas: plain(asdict(channel)) for channel in instrument.channels}


def analyse(
    readings: Readings,
    instrument: SnifferSpec,
    *,
    method: Method = "regression",
    carbon: float = CARBON_FRACTION,
    limits_percent: Sequence[float] = LIMITS_PERCENT,
    points: int = POINTS,
    rule: DecisionRule | None = None,
    problems: Sequence[str] = (),
    gases: Sequence[GasEstimate] = (),
    gas_remarks: Sequence[str] = (),
) -> Analysis:
    """Return the estimate by both methods, and over time.

    Parameters
    ----------
    readings, instrument, method, carbon, limits_percent : same as for ``estimate``
    points : even times of the estimate over time, in addition to those of ``ELAPSED_S``
    rule : by which the ship is reported, if there is one
    problems : further reasons why there can be no verdict
    gases, gas_remarks : see ``Analysis``

    Raises
    ------
    MeasurementError : same as ``estimate``
    """
    chosen: dict[str, Any] = {
        "carbon": carbon,
        "limits_percent": limits_percent,
        "problems": problems,
    }
    found = estimate(readings, instrument, method=method, **chosen)
    second: Method = "areas" if method == "regression" else "regression"
    try:
        other = estimate(readings, instrument, method=second, **chosen)
    except MeasurementError:
        other = None
    duration = float(readings.time[-1] - readings.time[0])
    even = np.linspace(0.0, duration, points + 1)[1:]
    elapsed = {round(float(t), 3) for t in even} | {t for t in ELAPSED_S if t <= duration}
    table = over_time(readings, instrument, elapsed_s=sorted(elapsed), method=method, **chosen)
    decision = None
    if rule is not None:
        admitted = found.quality != "C"
        decision = decide(rule, found.fsc_percent, found.total_percent, admitted=admitted)
    return Analysis(
        estimate=found,
        other=other,
        table=table,
        instrument=instrument,
        carbon=carbon,
        decision=decision,
        gases=tuple(gases),
        gas_remarks=tuple(gas_remarks),
    )


# Other gases


def estimate_gases(
    gases: Sequence[GasReadings], declared: Container[str], **chosen: Any
) -> tuple[list[GasEstimate], list[str]]:
    """Return the figures of gases, and for gases without a figure that are not declared, the
    reason.

    Parameters
    ----------
    gases : of a log
    declared : those whose errors are errors of the log
    chosen : same as for ``estimate_gas``; ``problems`` and ``carbon`` by gas

    Raises
    ------
    MeasurementError : a declared gas cannot be estimated
    """
    found, remarks = [], []
    problems, carbon = chosen.pop("problems", {}), chosen.pop("carbon", {})
    for gas in gases:
        name = gas.species.name
        try:
            found.append(
                estimate_gas(
                    gas, problems=problems.get(name, ()), carbon=carbon.get(name), **chosen
                )
            )
        except MeasurementError as error:
            if name in declared:
                raise
            remarks.append(f"not estimated: {error}")
    return found, remarks


# Gaps


@dataclass(frozen=True, kw_only=True)
class Gaps:
    """Missing readings and gaps of a log.

    Attributes
    ----------
    log_rows : of the log
    rows : rows with a new reading, where the log is faster than the sensors; otherwise all rows
    missing : number of readings that are missing in these rows, by gas that the analysis uses
    interpolated : samples in short gaps, which are bridged by a straight line
    gaps : beginning and end of each longer gap, which is left out [s] since the first row
    unused : complete rows that are also left out, because too few of them are consecutive
    """

    log_rows: int
    rows: int
    missing: dict[str, int]
    interpolated: int
    gaps: list[tuple[float, float]]
    unused: int

    @property
    def remarks(self) -> dict[str, str]:
        """Remarks on what the log lacks, by title; empty for a complete log."""
        found = {}
        if self.log_rows > self.rows:
            found["Rows"] = (
                f"{self.log_rows:,}, of which {self.rows:,} have a new reading; the others repeat"
                " one, or have none, and do not count"
            )
        if any(self.missing.values()):
            found["Missing readings"] = self.missing_words
        if self.gaps or self.interpolated or self.unused:
            found["Gaps"] = self.gap_words
        return found

    @property
    def missing_words(self) -> str:
        """Number of missing readings by gas, in words."""
        counts = [f"{count:,} of {gas.upper()}" for gas, count in self.missing.items() if count]
        return f"{', '.join(counts) or 'none'} in {self.rows:,} rows"

    @property
    def gap_words(self) -> str:
        """Number and length of the gaps, and what is interpolated or left out, in words."""
        words = []
        if self.gaps:
            start, end = max(self.gaps, key=lambda gap: gap[1] - gap[0])
            longest = f"{end - start:.0f} s from {start:.0f} s on"
            whole = sum(end - start for start, end in self.gaps)
            several = f"{len(self.gaps)} of {whole:.0f} s in all, the longest {longest}"
            words.append(several if len(self.gaps) > 1 else f"1 of {longest}")
        if self.interpolated:
            samples = f"{self.interpolated:,} sample{'s' * (self.interpolated > 1)}"
            words.append(f"{samples} in short ones interpolated, not shown as readings")
        if self.unused:
            rows = f"{self.unused:,} row{'s' * (self.unused > 1)}"
            words.append(
                f"{rows} beside gaps left out, as fewer than {SHORTEST} in a row are too few to use"
            )
        return "; ".join(words) or "none"


def find_gaps(readings: Readings, signals: pd.DataFrame, log_rows: int) -> Gaps:
    """Return the gaps of a log, by its readings, each once, and the signals of an estimate."""
    used = _used_gases(signals)
    known, period = np.isfinite(readings.values), _period(readings)
    complete = np.flatnonzero(known[:, used].all(axis=1))
    times = [readings.time[:1], readings.time[complete], readings.time[-1:]]
    since = np.concatenate(times) - readings.time[0]
    long = np.flatnonzero(np.diff(since) > BRIDGED * period)
    pieces = [len(rows) for rows in split_at_gaps(readings.time, complete, period)]
    return Gaps(
        log_rows=log_rows,
        rows=len(readings.time),
        missing={GASES[i]: int(np.sum(~known[:, i])) for i in used},
        interpolated=int(np.sum(interpolated(readings, signals))),
        gaps=[(float(since[i]), float(since[i + 1])) for i in long],
        unused=sum(rows for rows in pieces if rows < SHORTEST),
    )


def interpolated(readings: Readings, signals: pd.DataFrame) -> npt.NDArray[np.bool_]:
    """Return which samples of an estimate are not near a row with all readings, shape (n,)."""
    complete: Array = readings.time[
        np.isfinite(readings.values[:, _used_gases(signals)]).all(axis=1)
    ]
    time = signals["time_s"].to_numpy()
    after = np.searchsorted(complete, time).clip(1, len(complete) - 1)
    nearest = np.minimum(np.abs(time - complete[after - 1]), np.abs(time - complete[after]))
    far: npt.NDArray[np.bool_] = nearest > _NEAR * _period(readings)
    return far


def _used_gases(signals: pd.DataFrame) -> list[int]:
    """Return the indices in ``GASES`` of the gases in the signals of an estimate."""
    return [i for i, gas in enumerate(GASES) if f"{gas}_{UNITS[gas]}" in signals]


def _period(readings: Readings) -> float:
    return float(np.median(np.diff(readings.time)))
