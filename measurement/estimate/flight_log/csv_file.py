"""A logged flight in a CSV file."""

import lzma
import re
import warnings
import zipfile
import zlib
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np
import pandas as pd

from measurement.errors import MeasurementError
from measurement.estimate.flight_log.clock import check_seconds
from measurement.estimate.flight_log.config import COLUMNS, LogConfig
from measurement.estimate.flight_log.details import FlightRecord, times_of
from measurement.estimate.flight_log.places import PLACES, ends, on_a_plane, places_of
from measurement.estimate.flight_log.repeats import new_readings
from measurement.estimate.record import check_increasing, check_units, lowest_reading
from measurement.gases import GASES, UNITS
from measurement.sniffer.lag import Array
from measurement.sniffer.sniffer import Readings
from measurement.tables import other_separator

_REQUIRED = ("time", "so2", "co2")
"""Columns without which there is no estimate; any other may be left out, unless the configuration
names it.
"""

_HEAD_TOLD = 60
"""Letters of a head line that are told."""

_LONG_ROW = re.compile(r"Expected \d+ fields in line (\d+), saw \d+")
"""What pandas says of a row that is longer than the first ones."""

_OPEN_QUOTE = re.compile(r"EOF inside string starting at row (\d+)")
"""What pandas says of a quotation mark that is not closed, by a row of which the head line is row
0.
"""

_NUMBER, _DECIMAL_COMMA = (
    re.compile(r"[-+]?[\d.]+(e[-+]?\d+)?(\.\d+)?", re.IGNORECASE),
    re.compile(r"[-+]?\d+,\d+"),
)
"""A number, with what pandas adds to one that is there twice; and one with a decimal comma."""

TRUE_COLUMNS = {f"{gas}_true_{UNITS[gas]}": gas for gas in GASES}
"""Columns of the true concentrations, which a simulated flight may have; they are shown, and take
no part in the estimate.
"""


@dataclass(frozen=True)
class LoggedFlight:
    """A flight as it was logged.

    Attributes
    ----------
    readings : of the sniffer, each once where the log's rows are faster
    place : ``time_s``, and of ``north_m``, ``east_m``, ``height_m`` and the true concentrations
        those that the file has
    about : which flight it is
    """

    readings: Readings
    place: pd.DataFrame
    about: FlightRecord


def read_flight(path: Path, config: LogConfig) -> LoggedFlight:
    """Return the flight in a CSV file with a row per reading, or with rows that are faster than the
    sensors.

    Times are seconds, or dates and times that pandas reads. Rows may end in a comma.

    Raises
    ------
    MeasurementError : the file cannot be read, has no readings, lacks a column or has it twice, has
        words in it or readings lower than those of no gas or beyond the sensor's range, has times
        that do not increase, is separated by something else than commas, has rows with more values
        than its head line has names, or places that no aircraft has
    """
    try:
        head = _checked_head(path)
        # Without ``index_col`` rows that end in a comma would move every column by one; what would
        # be lost by it is refused.
        with warnings.catch_warnings(action="error", category=pd.errors.ParserWarning):
            table = pd.read_csv(path, skipinitialspace=True, low_memory=False, index_col=False)
            # As they stand there: pandas gives the second of a name a number.
            names = pd.read_csv(
                path, skipinitialspace=True, header=None, nrows=1, dtype=str, index_col=False
            ).iloc[0]
    except MeasurementError:
        raise
    except (pd.errors.ParserWarning, pd.errors.ParserError, pd.errors.EmptyDataError) as error:
        raise MeasurementError(f"'{path}' {_fault(error, head)}") from None
    except (EOFError, lzma.LZMAError, zipfile.BadZipFile, zlib.error) as error:
        raise MeasurementError(
            f"'{path}' cannot be unpacked: {error}; give a whole file, or the CSV file itself"
        ) from None
    except OSError as error:
        # A file that is no archive, as its name says, has no number of an error.
        raise MeasurementError(
            f"'{path}' cannot be read: {error.strerror or error}; give a CSV file"
        ) from None
    except UnicodeDecodeError:
        raise MeasurementError(f"'{path}' is not text in UTF-8; save it as CSV in UTF-8") from None
    except ValueError as error:
        raise MeasurementError(
            f"'{path}' is not CSV: {str(error).splitlines()[0].strip()}; give a CSV file with a head line"
        ) from None
    table.columns = table.columns.map(str).str.strip()
    names = names.dropna().str.strip()
    if len(
        twice := names[names.duplicated() & names.isin([*config.columns.values(), *TRUE_COLUMNS])]
    ):
        raise MeasurementError(
            f"'{path}' has the column '{twice.iloc[0]}' twice; rename or remove one of them"
        )
    if table.empty:
        raise MeasurementError(
            f"'{path}' has a head line and 0 readings; it needs a row per reading"
        )
    for key, name in config.columns.items():
        if name not in table and (key in _REQUIRED or name != COLUMNS[key]):
            raise MeasurementError(
                _missing(path, key.upper() if key in GASES else key, key, name, table)
            )
    time, logged = _time(table, config.columns["time"], path)
    _check_time(time, path)
    values = np.full((len(table), len(GASES)), np.nan)
    for i, gas in enumerate(GASES):
        name = config.columns[gas]
        if name in table:
            values[:, i] = config.scale.get(gas, 1.0) * _readings(table, name, path, config)
    _check_range(values, config, path)
    readings = new_readings(Readings(time, values), config.instrument.gases)
    _check_negative(values, readings, config, path)
    found, remark = places_of(
        {
            key: _readings(table, name, path, config)
            for key in PLACES
            if (name := config.columns[key]) in table
        },
        time,
        path,
    )
    place = {"time_s": time, **on_a_plane(found)}
    place |= {name: _numbers(table, name, path) for name in TRUE_COLUMNS if name in table}
    first_utc, last_utc, utc_from = times_of(config.flight, logged, float(time[-1] - time[0]), path)
    positions = ends(found)
    about = FlightRecord(
        readings=len(table),
        details=config.flight,
        first_utc=first_utc,
        last_utc=last_utc,
        utc_from=utc_from,
        offset=logged is not None and _has_offset(table[config.columns["time"]]),
        first_position=positions[0],
        last_position=positions[1],
        place_remark=remark,
        columns={key: name for key, name in config.columns.items() if name in table},
        scale=config.scale,
        missing=config.missing,
        stated=config.stated,
    )
    return LoggedFlight(readings, pd.DataFrame(place), about)


def _fault(error: Exception, head: str) -> str:
    """Return what pandas refuses in a table that is CSV or nearly so, and the remedy, given its
    head line as it is told.
    """
    if isinstance(error, pd.errors.EmptyDataError):
        return "is empty; it needs a head line and a row per reading"
    if opened := _OPEN_QUOTE.search(str(error)):
        return f"has a quotation mark in line {int(opened[1]) + 1} that is not closed; remove it"
    line = _LONG_ROW.search(str(error))
    if not line and not isinstance(error, pd.errors.ParserWarning):
        return f"is not CSV: {str(error).splitlines()[0].strip()}; give a CSV file with a head line"
    where = f"has in line {line[1]}" if line else "has rows with"
    return (
        f"{where} more values than its head line has names{head}: the first line has to name every column; remove lines above it,"
        " and write decimals with a point"
    )


def _checked_head(path: Path) -> str:
    """Return the head line as it is told in a refusal, empty for a packed log; refuse a log that is
    not separated by commas.
    """
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        head = file.readline().strip()
    if not head.replace("\t", "").isprintable():
        # It may be compressed, which pandas reads.
        return ""
    if words := other_separator(head):
        raise MeasurementError(f"'{path}' {words}")
    return f" ('{head[:_HEAD_TOLD]}{'...' * (len(head) > _HEAD_TOLD)}')"


def _missing(path: Path, what: str, key: str, name: str, table: pd.DataFrame) -> str:
    if 2 * sum(bool(_NUMBER.fullmatch(column)) for column in table.columns) > len(table.columns):
        columns = ", ".join(COLUMNS[needed] for needed in _REQUIRED)
        return f"'{path}' has no head line, but numbers in its first line; add one that names every column, as in {columns}"
    there = ", ".join(f"'{column}'" for column in list(table.columns)[:12])
    remedy = f'name it in [columns] of the configuration: {key} = "..."'
    if name != COLUMNS[key]:
        remedy = f'correct {key} = "{name}" in [columns] of the configuration'
    return f"'{path}' has no {what} column '{name}', but {there}; {remedy}"


def _numbers(table: pd.DataFrame, name: str, path: Path) -> Array:
    numbers = pd.to_numeric(table[name], errors="coerce")
    words = numbers.isna() & table[name].notna() & (table[name].astype(str).str.strip() != "")
    if words.any():
        row = int(np.argmax(words.to_numpy()))
        value = str(table[name].iloc[row])
        raise MeasurementError(
            f"'{path}': column '{name}' has {value!r} in row {row + 2}; it must hold numbers, or be empty{_with_a_point(value)}"
        )
    if np.isinf(numbers).any():
        row = int(np.argmax(np.isinf(numbers)))
        raise MeasurementError(
            f"'{path}': column '{name}' is infinite in row {row + 2}; where it stands for a reading out of range, leave the record"
            " out from there, or leave the cell empty"
        )
    return numbers.to_numpy(dtype=np.float64)


def _with_a_point(value: str) -> str:
    """Return the remedy for a number with a decimal comma, and nothing for other words."""
    return (
        f"; write decimals with a point, as in {value.strip().replace(',', '.')}"
        if _DECIMAL_COMMA.fullmatch(value.strip())
        else ""
    )


def _readings(table: pd.DataFrame, name: str, path: Path, config: LogConfig) -> Array:
    numbers = _numbers(table, name, path)
    return np.where(np.isin(numbers, config.missing), np.nan, numbers)


def _check_range(values: Array, config: LogConfig, path: Path) -> None:
    """Refuse readings beyond the end of the channel's range, where the sensor itself would have
    stopped.
    """
    for gas in config.instrument.gases:
        channel, column = config.instrument.known(gas), values[:, GASES.index(gas)]
        if gas == "co2" and np.isfinite(column).any():
            # In another unit, or without its background, none of it is right, and not a reading
            # here or there.
            check_units(channel, column)
        beyond = np.flatnonzero(column > channel.range_high + channel.resolution)
        if beyond.size:
            unit, more = UNITS[gas], f", and {beyond.size - 1} more" if beyond.size > 1 else ""
            raise MeasurementError(
                f"'{path}': {gas.upper()} is {column[beyond[0]]:g} {unit} in row {beyond[0] + 2}{more}; its sensor reads"
                f" {channel.range_high:g} {unit} at most (range_high): leave such a cell empty, or correct the column's unit"
                f" ([scale]) or the range"
            )


def _check_negative(values: Array, readings: Readings, config: LogConfig, path: Path) -> None:
    """Refuse values of rows that are lower than readings of clean air: marks for missing ones,
    calibrations, or a wrong sign.
    """
    for gas in config.instrument.gases:
        column, unit = values[:, GASES.index(gas)], UNITS[gas]
        if not np.isfinite(column).any():
            continue
        lowest = lowest_reading(gas, readings.values, config.instrument)
        low = np.flatnonzero(column < lowest)
        if low.size:
            least, more = (
                float(column[low[0]]),
                f", and {low.size - 1} more are as low" if low.size > 1 else "",
            )
            air = "air, " if gas == "co2" else ""
            raise MeasurementError(
                f"'{path}': {gas.upper()} is {least:g} {unit} in row {low[0] + 2}{more}; {air}noise, zero and other gases explain"
                f" {lowest:.0f} {unit} at least: where it stands for a missing reading, or is of a calibration from which the"
                f" sensor has not recovered, leave it empty or name it in the configuration, as in missing = [-9999]; otherwise"
                f" check the sign, and state the channel's noise, zero and cross"
            )


def _time(
    table: pd.DataFrame, name: str, path: Path
) -> tuple[Array, tuple[datetime, datetime] | None]:
    """Return the times [s], and of a log with dates and times those of its first and last row in
    UTC.
    """
    column = table[name]
    if pd.api.types.is_numeric_dtype(column):
        seconds = column.to_numpy(dtype=np.float64)
        check_seconds(seconds, name, path)
        return seconds, None
    try:
        moments = pd.to_datetime(column, utc=True, format="ISO8601")
    except (ValueError, TypeError):
        row = _unreadable(column)
        told = str(column.iloc[row])
        raise MeasurementError(
            f"'{path}': time '{told}' in column '{name}' cannot be read (row {row + 2}); give seconds, or 2024-05-01T12:00:00.0"
            f"{_with_a_point(told)}"
        ) from None
    time = np.asarray((moments - moments.iloc[0]).dt.total_seconds(), dtype=np.float64)
    return time, None if moments.isna().any() else (
        moments.iloc[0].to_pydatetime(),
        moments.iloc[-1].to_pydatetime(),
    )


def _unreadable(column: pd.Series) -> int:
    """Return the first row whose time is not of the kind that most rows have: seconds, or dates and
    times.
    """
    seconds = pd.to_numeric(column, errors="coerce").notna()
    dates = pd.to_datetime(column, utc=True, format="ISO8601", errors="coerce").notna()
    return int(np.argmin(seconds if seconds.sum() > dates.sum() else dates))


def _check_time(time: Array, path: Path) -> None:
    """Refuse times that are missing, or do not increase."""
    if (missing := np.flatnonzero(~np.isfinite(time))).size:
        raise MeasurementError(
            f"'{path}' has no time in row {missing[0] + 2}; give a time in every row, or remove the row"
        )
    check_increasing(time, path)


def _has_offset(column: pd.Series) -> bool:
    """Return whether times in words say how far they are from UTC."""
    return pd.Timestamp(str(column.iloc[0]).strip()).tzinfo is not None
