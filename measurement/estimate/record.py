"""Readings, checked and laid on an even grid, in segments between gaps."""

import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from measurement.errors import MeasurementError
from measurement.gases import EXPECTED_PPB_PER_PPM, GASES, UNITS
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec

CO2_LEAST, CO2_MOST = 250.0, 50_000.0
"""Median CO2 of a record in air that can be breathed [ppm]: outside it the unit, or the background,
is wrong.
"""

_OTHER_MOST = 1e6
"""Largest reading of the other gases [ppb]."""

_STEP_LEAST, _STEP_MOST = 1e-3, 30.0
"""Median interval between samples [s]: no sniffer reads faster, and the slowest cell of the presets
has answered by the longest, in which an aircraft has crossed a plume and left it."""

BRIDGED = 2.5
"""Gaps of up to so many sample periods are bridged by a straight line; longer ones part the record.
"""

_WHOLE = 1.75
"""Between readings that are fewer sample periods apart none is missing, even if their times are
uneven by three quarters.
"""

SHORTEST = 8
"""Fewest samples of a segment: pieces between gaps that have fewer are left out."""

_SATURATED_MAX, _MISSING_MAX = 0.0, 0.1
"""Shares of saturated and of missing samples from which on there is no verdict."""

_SAME = 1e-9
"""Readings that differ by less, relative to the largest, are the same."""

_CALM, _CALM_SIGMA = 0.1, 0.1257
"""Share of the second differences that are noise alone, and the largest of them over their standard
deviation: the quantile of the size of normal noise."""

_EVEN = 0.5 * (math.sqrt(5.0) - 1.0)
"""Multiples of the golden section, less their whole numbers, lie evenly within 0 to 1 however many
there are.
"""

_NEGATIVE_SIGMA = 8.0
"""A reading lower than zero by so many standard deviations of noise and zero is no reading."""

_NOX_SIGMA = 3.0
"""A ship that is not measured for NO or NO2 may emit the expected by so many standard deviations
more.
"""

_KEPT = 32
"""What is worked out of a record and kept, at most: to move one property of the instrument changes
little of it.
"""

_T = TypeVar("_T")


@dataclass(frozen=True)
class Record:
    """An even record.

    Attributes
    ----------
    step : between samples [s]
    times : of each segment, shape (n,) [s]
    values : of each segment, by gas, shape (n,) each
    resolution : of the readings as they were logged, by gas: the smallest change from one to the
        next, 0 where none changes
    scatter : standard deviation of the readings that they show themselves, likewise
    problems : why there can be no verdict, a sentence each
    """

    step: float
    times: tuple[Array, ...]
    values: tuple[dict[str, Array], ...]
    resolution: dict[str, float]
    scatter: dict[str, float]
    problems: tuple[str, ...]
    _kept: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    @cached_property
    def time(self) -> Array:
        """Times of all samples."""
        return np.concatenate(self.times)

    def once(self, key: Hashable, make: Callable[[], _T]) -> _T:
        """Return what ``make`` makes of the record, kept from the last time that it was asked for
        by ``key``.
        """
        made: _T = self._kept.pop(key) if key in self._kept else make()
        self._kept[key] = made
        if len(self._kept) > _KEPT:
            del self._kept[next(iter(self._kept))]
        return made

    def of(self, gas: str) -> Array:
        """Return all samples of a gas."""
        return np.concatenate([segment[gas] for segment in self.values])

    @property
    def duration(self) -> float:
        """From the first sample to the last [s]."""
        return float(self.times[-1][-1] - self.times[0][0])


def checked_record(readings: Readings, instrument: SnifferSpec) -> Record:
    """Return the readings of SO2, CO2 and, where they and their channels exist, NO and NO2, on an
    even grid.

    Raises
    ------
    MeasurementError : no CO2 or SO2, too short, times that do not increase or are too far apart, or
        units that cannot be
    """
    time, values = (
        np.asarray(readings.time, dtype=np.float64),
        np.asarray(readings.values, dtype=np.float64),
    )
    if time.ndim != 1 or values.shape != (len(time), len(GASES)):
        raise MeasurementError(
            f"readings have shapes {time.shape} and {values.shape}; they must be (m,) and (m, {len(GASES)})"
        )
    if len(time) < SHORTEST:
        raise MeasurementError(
            f"the record has {len(time)} samples; it needs at least {SHORTEST}, and one whole crossing of the plume"
        )
    if not np.isfinite(time).all():
        raise MeasurementError(
            f"time of sample {int(np.argmin(np.isfinite(time)))} is not a number; give a time [s] for every sample"
        )
    check_increasing(time)
    step = float(np.median(np.diff(time)))
    if not _STEP_LEAST <= step <= _STEP_MOST:
        raise MeasurementError(
            f"samples are {step:g} s apart (median); they must be {_STEP_LEAST:g} to {_STEP_MOST:g} s apart: check that time is in"
            " seconds, not milliseconds or hours"
        )
    gases = _used(values, instrument)
    logged = {gas: values[:, GASES.index(gas)] for gas in gases}
    for gas, column in logged.items():
        check_units(instrument.known(gas), column)
    problems = _problems(time, values, gases, instrument)
    known = np.isfinite(list(logged.values())).all(axis=0)
    segments = [
        segment for segment in pieces(time, np.flatnonzero(known), step) if len(segment) >= SHORTEST
    ]
    times, parts = [], []
    for segment in segments:
        grid = time[segment[0]] + step * np.arange(
            math.floor((time[segment[-1]] - time[segment[0]]) / step + 1e-6) + 1
        )
        # A grid of the record's own times is left as it is.
        grid = (
            time[segment]
            if len(grid) == len(segment)
            and np.allclose(grid, time[segment], rtol=0.0, atol=1e-3 * step)
            else grid
        )
        times.append(grid)
        parts.append(
            {gas: np.interp(grid, time[segment], column[segment]) for gas, column in logged.items()}
        )
    if not times:
        *names, last = (gas.upper() for gas in gases)
        fewest = min(gases, key=lambda gas: int(np.isfinite(logged[gas]).sum()))
        remedy = (
            ""
            if fewest in ("so2", "co2")
            else f", or leave out the column of {fewest.upper()}, which has fewest"
        )
        every = f"no {SHORTEST} samples in a row have all of {', '.join(names)} and {last}"
        raise MeasurementError(f"{every}; give a record with fewer gaps{remedy}")
    # Samples that are interpolated lie on straight lines, and show no noise.
    whole = [
        run for run in pieces(time, np.flatnonzero(known), step, _WHOLE) if len(run) > 2
    ] or segments
    resolution = {gas: shown_step(column) for gas, column in logged.items()}
    scatter = {
        gas: shown_scatter([column[run] for run in whole], resolution[gas])
        for gas, column in logged.items()
    }
    return Record(step, tuple(times), tuple(parts), resolution, scatter, problems)


def pieces(
    time: Array, rows: npt.NDArray[np.intp], step: float, periods: float = BRIDGED
) -> list[npt.NDArray[np.intp]]:
    """Return the rows that have all readings, shape (n,), in pieces between gaps of so many periods
    of the log, ``step`` [s].
    """
    return np.split(rows, np.flatnonzero(np.diff(time[rows]) > periods * step) + 1)


def _used(values: Array, instrument: SnifferSpec) -> list[str]:
    used = [
        gas
        for i, gas in enumerate(GASES)
        if instrument.channel(gas) and np.isfinite(values[:, i]).any()
    ]
    for gas, why in (
        ("co2", "the fuel that it burnt is not known without"),
        ("so2", "there is nothing to estimate without"),
    ):
        if gas not in used:
            raise MeasurementError(
                f"the record has no {gas.upper()} readings, or '{instrument.name}' no such channel; {why} them: add them"
            )
    return used


def check_increasing(time: Array, path: Path | None = None) -> None:
    """Refuse times that do not increase, shape (m,); of a file it is told where, by rows of which
    the head line is the first.

    Raises
    ------
    MeasurementError : they do not
    """
    late = np.flatnonzero(np.diff(time) <= 0.0)
    if not late.size:
        return
    at = int(late[0])
    where, row, what = (
        ("", "", "record") if path is None else (f"'{path}': ", f" in row {at + 2}", "rows by time")
    )
    raise MeasurementError(
        f"{where}times do not increase: {time[at]:.15g} s{row} is followed by {time[at + 1]:.15g} s; sort the {what} and drop"
        " repeats, or, where the clock was set back, correct the times after it"
    )


def check_units(channel: Channel, values: Array) -> None:
    """Refuse readings of a channel that cannot be in its gas's unit, shape (m,).

    Raises
    ------
    MeasurementError : they are CO2 without its background, or no gas has them
    """
    gas, known = channel.gas, values[np.isfinite(values)]
    middle, least, most = (
        float(np.median(known)) / channel.gain,
        float(known.min()),
        float(known.max()),
    )
    if gas == "co2" and not CO2_LEAST <= middle <= CO2_MOST:
        raise MeasurementError(
            f"CO2 has a median of {middle:g} ppm; air has {CO2_LEAST:g} to {CO2_MOST:g} ppm: check the unit; keep the background"
        )
    if gas != "co2" and max(most, -least) > _OTHER_MOST:
        far = most if most > -least else least
        raise MeasurementError(
            f"{gas.upper()} reaches {far:g} ppb; at most {_OTHER_MOST:g} ppb of either sign can be: check its unit and its marks"
            " for missing readings"
        )


def shown_step(values: Array) -> float:
    """Return the smallest change from one known reading to the next; what is rounding of
    floating-point numbers is no change.
    """
    known = values[np.isfinite(values)]
    changes = np.abs(np.diff(known))
    changes = changes[changes > _SAME * float(np.abs(known).max())]
    return float(changes.min()) if len(changes) else 0.0


def shown_scatter(segments: Sequence[Array], step: float) -> float:
    """Return the standard deviation of readings in these steps that their second differences show.

    It is half the step at least: so much has a reading that moves between two neighbouring marks.
    """
    if not sum(len(segment) > 2 for segment in segments):
        return 0.5 * step
    second = np.concatenate([np.diff(segment, 2) for segment in segments])
    # Whole numbers hide their noise: most of these differences are 0. Spread evenly over a step,
    # they show it again.
    spread = step * ((_EVEN * np.arange(len(second))) % 1.0 - 0.5)
    # The variance of a second difference is 6 times that of a sample.
    shown = float(np.quantile(np.abs(second + spread), _CALM)) / _CALM_SIGMA / math.sqrt(6.0)
    return max(shown, 0.5 * step)


def lowest_reading(gas: str, values: Array, instrument: SnifferSpec) -> float:
    """Return how low a gas may read for its noise, its zero and what the cell makes of other gases;
    CO2 is in all air.

    Parameters
    ----------
    gas : of which there are readings, and that the instrument has
    values : readings of all gases, shape (m, 4)
    instrument : as the analyst knows it; noise that it does not state is what the readings show
    """
    channel, column = instrument.known(gas), values[:, GASES.index(gas)]
    noise = channel.noise
    if math.isnan(noise):
        noise = shown_scatter([column[np.isfinite(column)]], shown_step(column))
    explained = _NEGATIVE_SIGMA * math.hypot(noise, channel.zero_sd, 1.0) - min(channel.zero, 0.0)
    floor = -explained - channel.gain * _cross_floor(channel.cross, values, instrument)
    return max(0.0, channel.gain * CO2_LEAST + floor) if gas == "co2" else floor


def _problems(
    time: Array, values: Array, gases: list[str], instrument: SnifferSpec
) -> tuple[str, ...]:
    problems = []
    for gas in gases:
        channel, column = instrument.known(gas), values[:, GASES.index(gas)]
        name, unit = gas.upper(), UNITS[gas]
        missing = float(np.mean(~np.isfinite(column)))
        if missing > _MISSING_MAX:
            problems.append(
                f"{100.0 * missing:.0f} % of {name} is missing; at most {100.0 * _MISSING_MAX:.0f} % may be"
            )
        full = (
            float(np.mean(column >= channel.range_high - 0.5 * channel.resolution))
            if math.isfinite(channel.range_high)
            else 0.0
        )
        if full > _SATURATED_MAX:
            problems.append(
                f"{name} is saturated at {channel.range_high:g} {unit} in {100.0 * full:.1f} % of the readings"
            )
        floor = lowest_reading(gas, values, instrument)
        if (least := float(np.nanmin(column))) < floor:
            problems.append(
                f"{name} reads {least:g} {unit}, which its noise and zero do not explain (from {floor:.0f} {unit})"
            )
    gaps = np.diff(time)
    lost = float(np.sum(gaps[gaps > BRIDGED * np.median(gaps)])) / float(time[-1] - time[0])
    if lost > _MISSING_MAX:
        problems.append(
            f"gaps make up {100.0 * lost:.0f} % of the record; at most {100.0 * _MISSING_MAX:.0f} % may be"
        )
    return tuple(problems)


def _cross_floor(cross: Mapping[str, float], values: Array, instrument: SnifferSpec) -> float:
    """Return how far below zero a cell of gain 1 may truly read: what it makes of other gases,
    measured or as ships emit them.
    """
    channels = [instrument.channel(gas) for gas in GASES]
    concentrations = values / [channel.gain if channel else 1.0 for channel in channels]
    lowest, co2 = 0.0, concentrations[:, GASES.index("co2")]
    for gas, share in cross.items():
        column = concentrations[:, GASES.index(gas)]
        if share < 0.0 and np.isfinite(column).any():
            lowest += -share * max(0.0, float(np.nanmax(column)))
        elif share < 0.0 and gas in EXPECTED_PPB_PER_PPM:
            ratio, deviation = EXPECTED_PPB_PER_PPM[gas]
            lowest += (
                -share
                * (ratio + _NOX_SIGMA * deviation)
                * float(np.nanmax(co2) - max(0.0, np.nanmin(co2)))
            )
    return lowest
