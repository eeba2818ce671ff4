"""Calibration of a sniffer by zero and span gas, and its use in an estimate.

A log of a calibration has, for each gas, the reading and the concentration at the inlet, in steps:
zero, span, zero, and so on. Each channel is fitted as

    y(t) = (g + g' t) x(t) + o + o' t + noise,   x the supplied steps, late by d, through a lag  (1)

so that gain, offset, their drift, t90 and delay come from one fit, with their covariance. A leak
dilutes the span gas, or leaves a slow tail behind each step: the span is not reached, or (1) does
not describe the readings within their noise.
"""

import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from common.tables import TableError, TableFormat, read_table, unit_factor, unit_in
from measurement.errors import MeasurementError, naming
from measurement.estimate.record import shown_scatter, shown_step
from measurement.estimate.result import plain
from measurement.gases import UNITS
from measurement.log.hashed import HashedFile, content_hash, write_hashed
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array
from measurement.species import SPECIES

FORMAT = 1
"""Version of a calibration's file."""

KIND = "plume-flight calibration"
"""Entry of a calibration's file with its kind."""

SUPPLIED = "_supplied"
"""Suffix of a gas in the name of the column with the supplied concentration, as in
so2_supplied_ppb.
"""

HOURS_MOST = 24.0
"""Default age at which a calibration becomes stale [h]."""

SPAN_SD = 0.01
"""Relative standard deviation of the span gas unless it is stated [-]; an assumption: see the
bottle's certificate."""

_REACHED = 0.15
"""Largest deviation of a gain from 1 with which the span counts as reached [-]; an assumption."""

_SLOW_MOST = 0.015
"""Largest slow part of the residuals, over the span [-]; an assumption."""

_BLOCK_S = 15.0
"""Time over which residuals are averaged to find their slow part [s]."""

_SIGNIFICANT = 3.0
"""Least drift that is shown [standard deviations]."""

_FEWEST = 30
"""Fewest readings of a gas."""

_HOUR = 3600.0

_UNITS = {**{name: of.unit for name, of in SPECIES.items()}, **UNITS}


@dataclass(frozen=True, kw_only=True)
class CalibratedChannel:
    """The result of a calibration for a channel; drifts are per hour.

    Attributes
    ----------
    unit : of readings
    span : largest supplied concentration [unit]
    gain, gain_sd : reading over concentration, at the middle of the calibration [-]
    offset, offset_sd : reading of zero gas [unit]
    gain_drift, gain_drift_sd, offset_drift, offset_drift_sd : [1/h, unit/h]
    t90_s, t90_sd_s, delay_s, delay_sd_s : response and delay [s]
    noise : standard deviation of a reading [unit]
    misfit : root mean square of the residuals over the noise [-]
    slow : standard deviation of the part of the residuals that noise does not explain, over the
        span [-]
    problems : reasons why it must not be used, such as a leak
    remarks : other findings, such as a drift
    """

    unit: str
    span: float
    gain: float
    gain_sd: float
    offset: float
    offset_sd: float
    gain_drift: float
    gain_drift_sd: float
    offset_drift: float
    offset_drift_sd: float
    t90_s: float
    t90_sd_s: float
    delay_s: float
    delay_sd_s: float
    noise: float
    misfit: float
    slow: float
    problems: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """A calibration of an instrument.

    Attributes
    ----------
    instrument, serial : name of the instrument in a configuration, and its serial number or empty
    time_utc : middle of the calibration
    source, source_sha256 : log that it was made of
    channels : by gas
    """

    instrument: str
    serial: str
    time_utc: datetime
    source: str
    source_sha256: str
    channels: Mapping[str, CalibratedChannel]

    def content(self) -> dict[str, Any]:
        """Return the content for JSON."""
        return {
            "format": FORMAT,
            "kind": KIND,
            "instrument": {"name": self.instrument, "serial": self.serial},
            "time_utc": self.time_utc.isoformat(timespec="seconds").replace("+00:00", "Z"),
            "source": self.source,
            "source_sha256": self.source_sha256,
            "channels": {gas: plain(asdict(of)) for gas, of in self.channels.items()},
        }

    @property
    def sha256(self) -> str:
        """Hash of the content."""
        return content_hash(self.content())


# From a log of zero and span to a calibration


def calibrate(
    path: Path,
    *,
    instrument: str,
    serial: str = "",
    time_utc: datetime | None = None,
    span_sd: float = SPAN_SD,
) -> Calibration:
    """Return the calibration in a log of zero and span gas.

    Parameters
    ----------
    instrument, serial : of the calibrated sniffer
    time_utc : of the first reading, for a log of seconds without a date
    span_sd : relative standard deviation of the span gas [-]

    Raises
    ------
    MeasurementError : the log cannot be read, has no gas with a supplied concentration, or no step
        of it; or no time is known
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise MeasurementError(
            f"'{path}' cannot be read: {error.strerror}; give a log of zero and span gas"
        ) from None
    with naming(path):
        try:
            table = read_table(path, TableFormat(), head=("time_s",))
            moments = table.times("time_s" if "time_s" in table else table.names[0])
            seconds = moments.seconds
            if not len(table) or not np.isfinite(seconds).all() or (np.diff(seconds) <= 0.0).any():
                raise MeasurementError("times are missing or do not increase; correct them")
            start = datetime.fromtimestamp(float(seconds[0]), UTC) if moments.dated else time_utc
            if start is None:
                raise MeasurementError(
                    "the log counts seconds of no date; give --time, as 2026-06-01T09:00:00Z"
                )
            time = seconds - seconds[0]
            channels = {}
            for gas, (reading, supplied) in _pairs(table.names).items():
                columns = [
                    table.numbers(name) * _factor(table.units.get(name, ""), gas, name)
                    for name in (reading, supplied)
                ]
                channels[gas] = _channel(gas, time, columns[0], columns[1], span_sd)
        except TableError as error:
            raise MeasurementError(str(error)) from None
    if not channels:
        raise MeasurementError(
            f"'{path}' has no gas with what was supplied; it needs two columns of a gas, as"
            " so2_ppb and so2_supplied_ppb"
        )
    middle = start.timestamp() + 0.5 * float(time[-1])
    return Calibration(
        instrument=instrument,
        serial=serial,
        time_utc=datetime.fromtimestamp(round(middle), UTC),
        source=path.name,
        source_sha256=hashlib.sha256(content).hexdigest(),
        channels=channels,
    )


def _pairs(names: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Return the columns of reading and supply by gas."""
    found = {}
    for name in names:
        words = name.lower().replace(" ", "_")
        for gas in _UNITS:
            if words.startswith(f"{gas}{SUPPLIED}"):
                own = [
                    of
                    for of in names
                    if of.lower().startswith(gas)
                    and not of.lower()[len(gas) : len(gas) + 1].isalnum()
                    and SUPPLIED not in of.lower().replace(" ", "_")
                ]
                if not own:
                    raise MeasurementError(f"column '{name}' has no reading beside it; add it")
                found[gas] = own[0], name
    return found


def _factor(unit: str, gas: str, name: str) -> float:
    """Return the factor of a column to the unit of its gas."""
    if not (unit or unit_in(name)):
        raise MeasurementError(f"column '{name}' does not say its unit; name it {name}_ppb")
    return unit_factor(unit or unit_in(name), _UNITS[gas], gas=gas)


@dataclass(frozen=True)
class _Steps:
    """Readings of a channel beside what was supplied in steps.

    Attributes
    ----------
    time, reading : where both are known, shape (n,)
    span, first : largest supply, and that at first [unit]
    begins, sizes : of each step of the supply, shape (k,) [s, unit]
    """

    time: Array
    reading: Array
    span: float
    first: float
    begins: Array
    sizes: Array

    @property
    def period(self) -> float:
        """Median time between readings [s]."""
        return float(np.median(np.diff(self.time)))

    def columns(self, properties: Array) -> Array:
        """Return the columns of gain, its drift, offset and its drift in (1), shape (n, 4).

        Parameters
        ----------
        properties : logarithm of the time constant [s], and delay [s]
        """
        constant, delay = math.exp(float(properties[0])), float(properties[1])
        since = self.time[:, np.newaxis] - self.begins - delay
        risen = -np.expm1(-np.maximum(since, 0.0) / constant)
        x = self.first + (self.sizes * risen).sum(axis=1)
        hours = (self.time - 0.5 * (self.time[0] + self.time[-1])) / _HOUR
        return np.stack([x, hours * x, np.ones_like(self.time), hours], axis=1)

    def coefficients(self, design: Array) -> Array:
        """Return the coefficients of columns that fit the readings best."""
        return np.asarray(np.linalg.lstsq(design, self.reading, rcond=None)[0], dtype=np.float64)

    def residuals(self, properties: Array) -> Array:
        """Return what (1) leaves of the readings, shape (n,)."""
        design = self.columns(properties)
        return np.asarray(self.reading - design @ self.coefficients(design))

    def derivatives(self, properties: Array, linear: Array) -> Array:
        """Return the changes of (1) with the logarithm of its time constant, and with its delay."""
        found = []
        for i, step in enumerate((1e-3, 1e-2)):
            moved = np.array(properties, dtype=np.float64)
            moved[i] += step
            found.append((self.columns(moved) - self.columns(properties)) @ linear / step)
        return np.stack(found, axis=1)


@dataclass(frozen=True, kw_only=True)
class _Errors:
    """Standard deviations of the parameters of (1), in the order of its columns."""

    gain: float
    gain_drift: float
    offset: float
    offset_drift: float
    log_constant: float
    delay: float


def _channel(
    gas: str, time: Array, reading: Array, supplied: Array, span_sd: float
) -> CalibratedChannel:
    """Return the result for a channel: the fit of (1)."""
    name, unit = gas.upper(), _UNITS[gas]
    steps = _steps(name, time, reading, supplied)
    properties = _fitted_response(steps)
    design = steps.columns(properties)
    linear = steps.coefficients(design)
    left = steps.reading - design @ linear
    noise = shown_scatter([steps.reading], shown_step(steps.reading))
    whole = np.hstack([design, steps.derivatives(properties, linear)])
    errors = _errors(whole, left, noise)
    slow = _slow_part(left, noise, max(1, round(_BLOCK_S / steps.period))) / steps.span
    gain, gain_drift, offset, offset_drift = (float(value) for value in linear)
    t90 = math.log(10.0) * math.exp(float(properties[0]))
    return CalibratedChannel(
        unit=unit,
        span=steps.span,
        gain=gain,
        gain_sd=math.hypot(errors.gain, span_sd * abs(gain), slow),
        offset=offset,
        offset_sd=errors.offset,
        gain_drift=gain_drift,
        gain_drift_sd=errors.gain_drift,
        offset_drift=offset_drift,
        offset_drift_sd=errors.offset_drift,
        t90_s=t90,
        t90_sd_s=t90 * errors.log_constant,
        delay_s=float(properties[1]),
        delay_sd_s=errors.delay,
        noise=noise,
        misfit=math.sqrt(float(np.mean(left**2))) / noise if noise > 0.0 else 1.0,
        slow=slow,
        problems=tuple(_leaks(name, gain, slow)),
        remarks=tuple(_drifts(name, unit, gain_drift, offset_drift, errors)),
    )


def _steps(name: str, time: Array, reading: Array, supplied: Array) -> _Steps:
    """Return the known readings of a gas, and the steps of its supply.

    Raises
    ------
    MeasurementError : there are too few of either
    """
    known = np.isfinite(reading) & np.isfinite(supplied)
    t, given = time[known], supplied[known]
    changes = np.flatnonzero(np.diff(given)) + 1
    if known.sum() < _FEWEST or len(changes) < 2:
        raise MeasurementError(
            f"{name} has {int(known.sum())} readings and {len(changes)} steps of what was supplied;"
            f" it needs {_FEWEST} and 2, as zero, span, zero"
        )
    return _Steps(
        time=t,
        reading=reading[known],
        span=max(0.0, float(given.max())),
        first=float(given[0]),
        begins=t[changes],
        sizes=np.diff(given)[changes - 1],
    )


def _fitted_response(steps: _Steps) -> Array:
    """Return the logarithm of the time constant [s] and the delay [s] that fit best, shape (2,)."""
    from scipy.optimize import least_squares

    period = steps.period
    starts = [(math.log(c), d) for c in (0.5, 2.0, 8.0, 25.0) for d in (0.5 * period, 2.0, 8.0)]
    start = min(starts, key=lambda of: float(np.sum(steps.residuals(np.array(of)) ** 2)))
    fit = least_squares(
        steps.residuals,
        start,
        bounds=([math.log(0.05 * period), 0.0], [math.log(120.0), 60.0]),
        x_scale=[0.1, 0.2],
        diff_step=[1e-4, 1e-4],
    )
    return np.asarray(fit.x, dtype=np.float64)


def _errors(derivatives: Array, left: Array, noise: float) -> _Errors:
    """Return the standard deviations of the parameters of (1).

    Parameters
    ----------
    derivatives : of (1) by its parameters, shape (n, 6)
    left : residuals, shape (n,)
    noise : standard deviation of a reading
    """
    free = max(1, derivatives.shape[0] - derivatives.shape[1])
    variance = max(float(left @ left) / free, noise**2)
    covariance = variance * np.linalg.pinv(derivatives.T @ derivatives, hermitian=True)
    deviations = np.sqrt(np.maximum(np.diagonal(covariance), 0.0))
    names = ("gain", "gain_drift", "offset", "offset_drift", "log_constant", "delay")
    return _Errors(**dict(zip(names, deviations.tolist(), strict=True)))


def _drifts(
    name: str, unit: str, gain_drift: float, offset_drift: float, errors: _Errors
) -> list[str]:
    """Return remarks on drifts that are shown."""
    return [
        f"{what} of {name} drifts by {value:+.3g} {per} per hour"
        for what, value, sd, per in (
            ("the gain", gain_drift, errors.gain_drift, "of 1"),
            ("the zero", offset_drift, errors.offset_drift, unit),
        )
        if abs(value) > _SIGNIFICANT * sd
    ]


def _slow_part(left: Array, noise: float, block: int) -> float:
    """Return the standard deviation of residuals over blocks of readings, less that by noise."""
    count = len(left) // block
    if count < 2:
        return 0.0
    means = left[: count * block].reshape(count, block).mean(axis=1)
    return math.sqrt(max(0.0, float(np.mean(means**2)) - noise**2 / block))


def _leaks(name: str, gain: float, slow: float) -> list[str]:
    """Return the signs of a leak."""
    found = []
    if abs(gain - 1.0) > _REACHED:
        found.append(
            f"{name} reads {100.0 * gain:.0f} % of the span, {100.0 * (1.0 - _REACHED):.0f} to"
            f" {100.0 * (1.0 + _REACHED):.0f} % are expected: a leak, a wrong bottle, or a cell to"
            " be replaced"
        )
    if slow > _SLOW_MOST:
        found.append(
            f"{name} does not follow the steps as one lag, but {100.0 * slow:.1f} % of the span"
            f" beside it, and {100.0 * _SLOW_MOST:g} % are allowed: a leak, a dead volume, a second"
            " pole, or a supply that was not what the log says"
        )
    return found


# The file


_FILE = HashedFile(
    name="calibration",
    kind=("kind", KIND),
    version=("format", FORMAT),
    version_words="the format",
    made_by="a file of plume-flight calibrate",
    remedy="calibrate again",
)


def write_calibration(path: Path, calibration: Calibration) -> None:
    """Write a calibration with the hash of its content.

    Raises
    ------
    MeasurementError : the file cannot be written
    """
    try:
        write_hashed(path, calibration.content())
    except OSError as error:
        raise MeasurementError(f"'{path}' cannot be written: {error.strerror}") from None


def read_calibration(path: Path) -> Calibration:
    """Return the calibration of a file.

    Raises
    ------
    MeasurementError : it cannot be read, is none, is of another version, or was changed
    """
    content = _FILE.read(path)
    try:
        channels = {gas: _channel_from(values) for gas, values in content["channels"].items()}
        return Calibration(
            instrument=content["instrument"]["name"],
            serial=content["instrument"]["serial"],
            time_utc=datetime.fromisoformat(content["time_utc"]),
            source=content["source"],
            source_sha256=content["source_sha256"],
            channels=channels,
        )
    except (KeyError, TypeError, ValueError) as error:
        raise MeasurementError(f"'{path}' lacks or mistakes {error}; calibrate again") from None


def _channel_from(record: Mapping[str, Any]) -> CalibratedChannel:
    """Return a channel from its record in JSON, where tuples are lists."""
    values: dict[str, Any] = {
        key: tuple(of) if isinstance(of, list) else of for key, of in record.items()
    }
    return CalibratedChannel(**values)


# Use in an estimate


@dataclass(frozen=True, kw_only=True)
class Applied:
    """Calibrations that hold for a flight, the earlier first, and the time of the flight's middle.

    Attributes
    ----------
    calibrations : one, or one before and one after
    time_utc : middle of the flight
    """

    calibrations: tuple[Calibration, ...]
    time_utc: datetime

    @property
    def gases(self) -> set[str]:
        """Gases that all calibrations have."""
        return set.intersection(*(set(of.channels) for of in self.calibrations))

    def problems(self, gas: str) -> tuple[str, ...]:
        """Return the reasons why these calibrations allow no verdict on a gas."""
        return tuple(
            f"calibration of {of.time_utc:%Y-%m-%d %H:%M}: {problem}"
            for of in self.calibrations
            if gas in of.channels
            for problem in of.channels[gas].problems
        )

    def channel(self, gas: str, channel: Channel) -> Channel:
        """Return a channel as it was during the flight, between calibrations or near one.

        Gain and offset are interpolated in time. Their uncertainty includes half of their change
        between two calibrations, assumed to be even, or the drift since a single one, and all that
        a leak takes away.
        """
        if gas not in self.gases:
            return channel
        found = [of.channels[gas] for of in self.calibrations]
        shares = self._shares()
        gain, offset, t90, delay = (
            sum(share * getattr(of, name) for share, of in zip(shares, found, strict=True))
            for name in ("gain", "offset", "t90_s", "delay_s")
        )
        gain_sd, offset_sd = self._spread("gain", found), self._spread("offset", found)
        if any(of.problems for of in found):
            gain_sd = math.hypot(gain_sd, gain - 1.0)
        t90_sd = max(of.t90_sd_s for of in found) + abs(found[-1].t90_s - found[0].t90_s) / 2.0
        delay_sd = max(of.delay_sd_s for of in found)
        delay_sd += abs(found[-1].delay_s - found[0].delay_s) / 2.0
        return replace(
            channel,
            gain=gain,
            gain_sd=gain_sd / gain,
            zero=offset,
            zero_sd=offset_sd,
            t90_s=t90,
            t90_sd=t90_sd / t90,
            second_pole=0.0,
            delay_s=delay,
            delay_sd_s=delay_sd,
        )

    def _shares(self) -> list[float]:
        """Return the weight of each calibration at the time of the flight."""
        if len(self.calibrations) == 1:
            return [1.0]
        first, last = (of.time_utc.timestamp() for of in self.calibrations)
        share = (self.time_utc.timestamp() - first) / (last - first)
        return [1.0 - share, share]

    def _spread(self, name: str, found: Sequence[CalibratedChannel]) -> float:
        """Return the standard deviation of gain or offset during the flight."""
        by_fit = max(getattr(of, f"{name}_sd") for of in found)
        if len(found) == 2:
            change = getattr(found[1], name) - getattr(found[0], name)
            return math.hypot(by_fit, change / math.sqrt(12.0))
        since = self.time_utc - self.calibrations[0].time_utc
        hours = abs(since.total_seconds()) / _HOUR
        drift = math.hypot(
            getattr(found[0], f"{name}_drift"), getattr(found[0], f"{name}_drift_sd")
        )
        return math.hypot(by_fit, drift * hours)


def applied(
    calibrations: Sequence[Calibration],
    *,
    instrument: str,
    serial: str,
    begin: datetime | None,
    end: datetime | None,
    hours_most: float = HOURS_MOST,
) -> Applied:
    """Return calibrations for a flight, after checking that they are of its instrument and time.

    Parameters
    ----------
    instrument, serial : of the flight; an empty serial number is not compared
    begin, end : of the flight, or None where its time is not known
    hours_most : largest time between a calibration and the flight [h]

    Raises
    ------
    MeasurementError : there are more than two, or one is of another instrument, is stale, or has no
        time to compare; or two are on the same side of the flight
    """
    if len(calibrations) > 2:
        raise MeasurementError(
            f"{len(calibrations)} calibrations are given; give one, or one before and one after"
        )
    if begin is None or end is None:
        raise MeasurementError(
            "the log has no date to compare with that of the calibration; give flight.date"
        )
    for of in calibrations:
        if of.instrument != instrument or (serial and of.serial != serial):
            names = [
                f"'{name}'{f' number {number}' if number else ''}"
                for name, number in ((of.instrument, of.serial), (instrument, serial))
            ]
            raise MeasurementError(
                f"the calibration '{of.source}' is of {names[0]}, and the flight of {names[1]};"
                " give one of the flight's instrument"
            )
        away = max((begin - of.time_utc).total_seconds(), (of.time_utc - end).total_seconds())
        if away > hours_most * _HOUR:
            raise MeasurementError(
                f"the calibration '{of.source}' is {away / _HOUR:.1f} h from the flight; at most"
                f" {hours_most:g} h count (calibration_hours)"
            )
    ordered = tuple(sorted(calibrations, key=lambda of: of.time_utc))
    if len(ordered) == 2 and not (ordered[0].time_utc <= begin and end <= ordered[1].time_utc):
        raise MeasurementError(
            "two calibrations are given, and they are not before and after the flight; give one, or"
            " one of either side"
        )
    return Applied(calibrations=ordered, time_utc=begin + (end - begin) / 2)
