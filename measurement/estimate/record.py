"""Readings of a flight, checked and interpolated on an even time grid, in segments between gaps."""

import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from measurement.errors import MeasurementError
from measurement.gases import EXPECTED_PPB_PER_PPM, GASES
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec

CO2_LEAST, CO2_MOST = 250.0, 50_000.0
"""Range of the median CO2 in breathable air [ppm]; outside it unit or background is wrong."""

_OTHER_MOST = 1e6
"""Largest reading of the other gases [ppb]."""

_STEP_LEAST, _STEP_MOST = 1e-3, 30.0
"""Range of the median interval between samples [s] of sniffers on a flight through a plume."""

BRIDGED = 2.5
"""Longest gap that is bridged by a straight line [sample periods]; longer ones end a segment."""

_NO_GAP = 1.75
"""Interval between readings below which none is missing [sample periods]; times may be uneven."""

SHORTEST = 8
"""Fewest samples of a segment; shorter pieces between gaps are left out."""

_SATURATED_MAX, _MISSING_MAX = 0.0, 0.1
"""Largest shares of saturated and of missing samples with a verdict."""

_SAME = 1e-9
"""Largest difference of readings that count as equal, relative to the largest reading."""

_CALM, _CALM_SIGMA = 0.1, 0.1257
"""Share of the second differences that contain only noise, and that quantile of normal noise."""

_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
"""Golden section: the fractional parts of its multiples are evenly spread from 0 to 1."""

_NEGATIVE_SIGMA = 8.0
"""Number of standard deviations of noise and zero below which a reading is impossible."""

_NOX_SIGMA = 3.0
"""Number of standard deviations above the mean that a ship's NO and NO2 may have if they are not
measured.
"""

_DITHERED = 4.0
"""Largest step of other gases whose rounding counts as noise [standard deviations of their
noise].
"""

_CACHE_SIZE = 32
"""Number of results kept for a record: a change of one property of the instrument changes few of
them.
"""

_T = TypeVar("_T")


@dataclass(frozen=True)
class Record:
    """Readings on an even time grid.

    Attributes
    ----------
    step : between samples [s]
    times : of each segment, shape (n,) [s]
    values : of each segment, by gas, shape (n,) each
    resolution : by gas, smallest change between consecutive readings of the log, 0 if none changes
    scatter : by gas, standard deviation of the noise that the readings show
    problems : reasons why there can be no verdict, one sentence each
    """

    step: float
    times: tuple[Array, ...]
    values: tuple[dict[str, Array], ...]
    resolution: dict[str, float]
    scatter: dict[str, float]
    problems: tuple[str, ...]
    _cache: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    @cached_property
    def gases(self) -> tuple[str, ...]:
        """Gases of the record, in the order of ``GASES``."""
        return tuple(gas for gas in GASES if gas in self.values[0])

    @cached_property
    def time(self) -> Array:
        """Times of all samples [s]."""
        return np.concatenate(self.times)

    @property
    def duration(self) -> float:
        """Time from the first sample to the last [s]."""
        return float(self.times[-1][-1] - self.times[0][0])

    def of(self, gas: str) -> Array:
        """Return all samples of a gas."""
        return np.concatenate([segment[gas] for segment in self.values])

    def cached(self, key: Hashable, compute: Callable[[], _T]) -> _T:
        """Return ``compute()``, or the result that it had under the same key."""
        result: _T = self._cache.pop(key) if key in self._cache else compute()
        self._cache[key] = result
        if len(self._cache) > _CACHE_SIZE:
            del self._cache[next(iter(self._cache))]
        return result


def checked_record(readings: Readings, instrument: SnifferSpec) -> Record:
    """Return the readings of all gases that readings and instrument have, on an even grid.

    Raises
    ------
    MeasurementError : no CO2 or SO2, too short a record, times that do not increase or are too far
        apart, or readings that cannot be in their unit
    """
    time = np.asarray(readings.time, dtype=np.float64)
    values = np.asarray(readings.values, dtype=np.float64)
    step = _checked_step(time, values)
    columns = _measured(values, instrument)
    for gas, column in columns.items():
        check_units(instrument, gas, column)
    complete = np.flatnonzero(np.isfinite(list(columns.values())).all(axis=0))
    segments = [rows for rows in split_at_gaps(time, complete, step) if len(rows) >= SHORTEST]
    if not segments:
        raise MeasurementError(_no_segment(columns, instrument))
    grids = [_grid(time[rows], step) for rows in segments]
    parts = []
    for grid, rows in zip(grids, segments, strict=True):
        known = time[rows]
        parts.append({gas: np.interp(grid, known, column[rows]) for gas, column in columns.items()})
    # Interpolated samples lie on straight lines and show no noise.
    pieces = split_at_gaps(time, complete, step, _NO_GAP)
    unbroken = [rows for rows in pieces if len(rows) > 2] or segments
    resolution = {gas: shown_step(column) for gas, column in columns.items()}
    scatter = {
        gas: shown_scatter([column[rows] for rows in unbroken], resolution[gas])
        for gas, column in columns.items()
    }
    problems = _problems(time, values, columns, instrument)
    return Record(step, tuple(grids), tuple(parts), resolution, scatter, problems)


def _checked_step(time: Array, values: Array) -> float:
    """Return the median interval between samples [s] after checking shapes and times."""
    if time.ndim != 1 or values.shape != (len(time), len(GASES)):
        raise MeasurementError(
            f"readings have shapes {time.shape} and {values.shape};"
            f" they must be (m,) and (m, {len(GASES)})"
        )
    if len(time) < SHORTEST:
        raise MeasurementError(
            f"the record has {len(time)} samples; it needs at least {SHORTEST}, and one whole"
            " crossing of the plume"
        )
    if not np.isfinite(time).all():
        first = int(np.argmin(np.isfinite(time)))
        raise MeasurementError(
            f"time of sample {first} is not a number; give a time [s] for every sample"
        )
    check_increasing(time)
    step = float(np.median(np.diff(time)))
    if not _STEP_LEAST <= step <= _STEP_MOST:
        raise MeasurementError(
            f"samples are {step:g} s apart (median); they must be {_STEP_LEAST:g} to"
            f" {_STEP_MOST:g} s apart: check that time is in seconds, not milliseconds or hours"
        )
    return step


def _measured(values: Array, instrument: SnifferSpec) -> dict[str, Array]:
    """Return the columns of the gases that have a channel and readings, shape (m,) each."""
    columns = {}
    for i, gas in enumerate(GASES):
        if instrument.channel(gas) and np.isfinite(values[:, i]).any():
            columns[gas] = values[:, i]
    for gas in ("co2", "so2"):
        if gas not in columns:
            raise MeasurementError(
                f"the record has no {instrument.name_of(gas)} readings, or '{instrument.name}' no"
                f" such channel; an estimate needs CO2 and {instrument.name_of('so2')}: add them"
            )
    return columns


def split_at_gaps(
    time: Array, rows: npt.NDArray[np.intp], step: float, periods: float = BRIDGED
) -> list[npt.NDArray[np.intp]]:
    """Return rows in pieces between gaps that are longer than ``periods`` times ``step`` [s].

    Parameters
    ----------
    time : of all rows, shape (m,) [s]
    rows : indices of the rows that have all readings, shape (n,)
    """
    return np.split(rows, np.flatnonzero(np.diff(time[rows]) > periods * step) + 1)


def _grid(time: Array, step: float) -> Array:
    """Return even times over those of a segment; even times stay unchanged."""
    intervals = math.floor((time[-1] - time[0]) / step + 1e-6)
    grid = time[0] + step * np.arange(intervals + 1)
    even = len(grid) == len(time) and np.allclose(grid, time, rtol=0.0, atol=1e-3 * step)
    return time if even else grid


def _no_segment(columns: Mapping[str, Array], instrument: SnifferSpec) -> str:
    """Return the error of a record that has no segment with readings of all gases."""
    *names, last = (instrument.name_of(gas) for gas in columns)
    fewest = min(columns, key=lambda gas: int(np.isfinite(columns[gas]).sum()))
    remedy = ""
    if fewest not in ("so2", "co2"):
        remedy = f", or leave out the column of {instrument.name_of(fewest)}, which has fewest"
    return (
        f"no {SHORTEST} samples in a row have all of {', '.join(names)} and {last};"
        f" give a record with fewer gaps{remedy}"
    )


def check_increasing(time: Array, *, rows: npt.NDArray[np.int_] | None = None) -> None:
    """Check that times increase, shape (m,); with ``rows``, the error names the row in the file.

    Raises
    ------
    MeasurementError : they do not increase
    """
    backwards = np.flatnonzero(np.diff(time) <= 0.0)
    if not backwards.size:
        return
    i = int(backwards[0])
    row, what = ("", "record") if rows is None else (f" in row {rows[i]}", "rows by time")
    raise MeasurementError(
        f"times do not increase: {time[i]:.15g} s{row} is followed by {time[i + 1]:.15g} s;"
        f" sort the {what} and drop repeats, or, where the clock was set back, correct the times"
        " after it"
    )


def check_units(instrument: SnifferSpec, gas: str, values: Array) -> None:
    """Check that readings of a gas can be in its unit, shape (m,).

    Raises
    ------
    MeasurementError : CO2 has no background, or the readings are larger than any gas has
    """
    known = values[np.isfinite(values)]
    middle = float(np.median(known)) / instrument.known(gas).gain
    least, most = float(known.min()), float(known.max())
    if gas == "co2" and not CO2_LEAST <= middle <= CO2_MOST:
        raise MeasurementError(
            f"CO2 has a median of {middle:g} ppm; air has {CO2_LEAST:g} to {CO2_MOST:g} ppm:"
            " check the unit; keep the background"
        )
    if gas != "co2" and max(most, -least) > _OTHER_MOST:
        largest = most if most > -least else least
        unit = instrument.unit_of(gas)
        raise MeasurementError(
            f"{instrument.name_of(gas)} reaches {largest:g} {unit}; at most {_OTHER_MOST:g} {unit}"
            " of either sign can be: check its unit and its marks for missing readings"
        )


def shown_step(values: Array) -> float:
    """Return the smallest change between consecutive known readings, without rounding errors."""
    known = values[np.isfinite(values)]
    changes = np.abs(np.diff(known))
    changes = changes[changes > _SAME * float(np.abs(known).max())]
    return float(changes.min()) if len(changes) else 0.0


def shown_scatter(segments: Sequence[Array], step: float) -> float:
    """Return the standard deviation of the noise that second differences of readings show.

    It is at least half of ``step``, the resolution: a reading that moves between two neighbouring
    values has as much.
    """
    if not sum(len(segment) > 2 for segment in segments):
        return 0.5 * step
    second = np.concatenate([np.diff(segment, 2) for segment in segments])
    # Rounding hides noise: most second differences are 0. Readings that are spread evenly over a
    # step show it again.
    spread = step * ((_GOLDEN * np.arange(len(second))) % 1.0 - 0.5)
    # The variance of a second difference is 6 times that of a sample.
    shown = float(np.quantile(np.abs(second + spread), _CALM)) / _CALM_SIGMA / math.sqrt(6.0)
    return max(shown, 0.5 * step)


def stated_noise(channel: Channel, segments: Sequence[Array], step: float) -> float:
    """Return the noise of a channel as stated, or else as ``shown_scatter`` finds it."""
    return shown_scatter(segments, step) if math.isnan(channel.noise) else channel.noise


def lowest_reading(gas: str, values: Array, instrument: SnifferSpec) -> float:
    """Return the lowest possible reading of a gas, by noise, zero and the cell's response to other
    gases.

    Parameters
    ----------
    gas : gas with readings and a channel
    values : readings of all gases, shape (m, 4)
    """
    channel = instrument.known(gas)
    column = values[:, GASES.index(gas)]
    noise = stated_noise(channel, [column[np.isfinite(column)]], shown_step(column))
    explained = _NEGATIVE_SIGMA * math.hypot(noise, channel.zero_sd, 1.0) - min(channel.zero, 0.0)
    floor = -explained - channel.gain * _cross_floor(channel.cross, values, instrument)
    return max(0.0, channel.gain * CO2_LEAST + floor) if gas == "co2" else floor


def _cross_floor(cross: Mapping[str, float], values: Array, instrument: SnifferSpec) -> float:
    """Return how far other gases, as measured or as emitted, move the reading of a cell of gain 1
    below zero.
    """
    channels = [instrument.channel(gas) for gas in GASES]
    concentrations = values / [channel.gain if channel else 1.0 for channel in channels]
    co2 = concentrations[:, GASES.index("co2")]
    lowest = 0.0
    for gas, share in cross.items():
        column = concentrations[:, GASES.index(gas)]
        if share < 0.0 and np.isfinite(column).any():
            lowest += -share * max(0.0, float(np.nanmax(column)))
        elif share < 0.0 and gas in EXPECTED_PPB_PER_PPM:
            ratio, deviation = EXPECTED_PPB_PER_PPM[gas]
            co2_rise = float(np.nanmax(co2) - max(0.0, np.nanmin(co2)))
            lowest += -share * (ratio + _NOX_SIGMA * deviation) * co2_rise
    return lowest


def _problems(
    time: Array, values: Array, columns: Mapping[str, Array], instrument: SnifferSpec
) -> tuple[str, ...]:
    """Return the problems of the record that allow no verdict: missing, saturated or negative
    readings, gaps.
    """
    problems = []
    for gas, column in columns.items():
        channel = instrument.known(gas)
        name, unit = instrument.name_of(gas), instrument.unit_of(gas)
        missing = float(np.mean(~np.isfinite(column)))
        if missing > _MISSING_MAX:
            problems.append(
                f"{100.0 * missing:.0f} % of {name} is missing; at most"
                f" {100.0 * _MISSING_MAX:.0f} % may be"
            )
        # No reading reaches an infinite end of the range.
        saturated = float(np.mean(column >= channel.range_high - 0.5 * channel.resolution))
        if saturated > _SATURATED_MAX:
            problems.append(
                f"{name} is saturated at {channel.range_high:g} {unit} in"
                f" {100.0 * saturated:.1f} % of the readings"
            )
        floor = lowest_reading(gas, values, instrument)
        least = float(np.nanmin(column))
        if least < floor:
            problems.append(
                f"{name} reads {least:g} {unit}, which its noise and zero do not explain"
                f" (from {floor:.0f} {unit})"
            )
    gaps = np.diff(time)
    lost = float(np.sum(gaps[gaps > BRIDGED * np.median(gaps)])) / float(time[-1] - time[0])
    if lost > _MISSING_MAX:
        problems.append(
            f"gaps make up {100.0 * lost:.0f} % of the record; at most"
            f" {100.0 * _MISSING_MAX:.0f} % may be"
        )
    return tuple(problems)


def readings_noise(record: Record, instrument: SnifferSpec) -> dict[str, float]:
    """Return the standard deviation of each gas's readings: as stated, or as the readings show.

    Rounding to steps that are larger than the stated noise adds noise of a step over the root of
    12, where noise or passes carry the readings through several steps.
    """
    noise = {}
    for gas in record.gases:
        stated, step = instrument.known(gas).noise, record.resolution[gas]
        if math.isnan(stated):
            stated = record.scatter[gas]
        elif 0.0 < stated < step and (gas == "co2" or step <= _DITHERED * stated):
            stated = math.hypot(stated, step / math.sqrt(12.0))
        noise[gas] = stated
    return noise
