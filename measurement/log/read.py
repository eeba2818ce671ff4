"""A logged flight in a table: its readings, places and times, checked row by row.

Rows are counted as in an editor: they are lines of the file.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import UTC, date, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from common.tables import (
    Moments,
    Table,
    TableError,
    find_jumps,
    first_columns,
    longitude_within,
    read_table,
    unit_factor,
    unit_in,
)
from measurement.errors import MeasurementError, naming
from measurement.estimate.gas import GasReadings, nox_of, placed
from measurement.estimate.record import check_increasing, check_units, lowest_reading, shown_step
from measurement.gases import GASES, UNITS
from measurement.log.config import COLUMNS, HUMIDITY, FlightDetails, LogConfig
from measurement.log.ship import LoggedPlaces, ShipTrack, distance_words
from measurement.sniffer.lag import Array
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import channel_of
from measurement.species import SPECIES, Species

TRUE_COLUMNS = {f"{gas}_true_{UNITS[gas]}": gas for gas in GASES}
"""Columns of the true concentrations of a simulated flight: shown, but not used by the estimate."""

FROM_LOG, FROM_CONFIGURATION = "log", "configuration"
"""Sources of the times of a flight."""

_REQUIRED = ("time", "so2", "co2")
"""Columns without which there is no estimate; others are needed if the configuration has them."""

Position = tuple[float, float]
"""Latitude and longitude [deg]."""

Rows = npt.NDArray[np.intp]
"""Indices of rows, shape (n,)."""


@dataclass(frozen=True, kw_only=True)
class FlightRecord:
    """Details of a logged flight, and how its log was read.

    Attributes
    ----------
    readings : number of rows of the log
    details : in the configuration
    first_utc, last_utc : of the first and the last reading, or None where neither log nor
        configuration has a time
    utc_from : ``FROM_LOG``, ``FROM_CONFIGURATION`` or empty
    offset : whether the log's times have an offset from UTC; times without one count as UTC
    first_position, last_position : first and last known place of the log, or None where it has none
    place_remark : places that count as missing, or empty
    ships : distance of the log from each known place or track of its ship, in words
    columns, scale, missing : as the log was read
    table : how the log was read, in one line
    stated : keys of the instrument's channels in the configuration, same as in ``LogConfig``
    """

    readings: int
    details: FlightDetails
    first_utc: datetime | None
    last_utc: datetime | None
    utc_from: str
    offset: bool
    first_position: Position | None
    last_position: Position | None
    place_remark: str
    ships: tuple[str, ...]
    columns: Mapping[str, str]
    scale: Mapping[str, float]
    missing: tuple[float, ...]
    table: str
    stated: Mapping[str, tuple[str, ...]] | None

    def record(self) -> dict[str, Any]:
        """Return the details for JSON, with times in ISO 8601."""
        found = asdict(self)
        details = found.pop("details")
        details |= {"day": _iso_text(self.details.day), "start": _iso_text(self.details.start)}
        found |= {"first_utc": _iso_text(self.first_utc), "last_utc": _iso_text(self.last_utc)}
        return found | {"details": details}


@dataclass(frozen=True)
class LoggedFlight:
    """A flight as it was logged.

    Attributes
    ----------
    readings : of the sniffer, each once where the log's rows are faster
    place : ``time_s``, and those of ``north_m``, ``east_m``, ``height_m`` and the true
        concentrations that the file has
    about : details of the flight and its log
    gases : other gases that can be compared with CO2, in the form that the fit takes
    humidity : relative humidity by row, shape (n,), or None where the log has none [%]
    """

    readings: Readings
    place: pd.DataFrame
    about: FlightRecord
    gases: tuple[GasReadings, ...] = ()
    humidity: Array | None = None


def read_flight(path: Path, config: LogConfig, ships: Sequence[ShipTrack] = ()) -> LoggedFlight:
    """Return the flight in a table with a row per reading, or with rows faster than the sensors.

    ``common.tables`` lists the formats of the table. Times are seconds, or dates and times.
    ``ships`` are the places of its ship, by a file or the configuration.

    Raises
    ------
    MeasurementError : the file cannot be read, has no readings, lacks a column or has it twice, has
        words in it, a gas without a unit, readings out of range or too low, times that do not
        increase, longer rows than its head line, places that no aircraft can have, or places far
        from its ship
    """
    with naming(path):
        try:
            return _flight(_read_table(path, config), config, ships)
        except TableError as error:
            raise MeasurementError(str(error)) from None


def _flight(table: Table, config: LogConfig, ships: Sequence[ShipTrack]) -> LoggedFlight:
    """Return the flight in the table of a log."""
    time, moments, kept = _times(table, config)
    scale = {gas: _factor(table, gas, config) for gas in GASES if config.columns[gas] in table}
    values = np.full((int(kept.sum()), len(GASES)), np.nan)
    for gas, factor in scale.items():
        numbers = _known_numbers(table, config.columns[gas], config)[kept]
        values[:, GASES.index(gas)] = factor * numbers
    rows = np.array(table.lines)[kept]
    _check_range(values, rows, config)
    readings = new_readings(Readings(time, values), config.instrument.gases)
    _check_negative(values, rows, readings, config)
    places = {
        key: _known_numbers(table, config.columns[key], config)[kept]
        for key in _PLACES
        if config.columns[key] in table
    }
    _check_angles(places, rows)
    if "longitude" in places:
        places["longitude"] = longitude_within(places["longitude"])
    places, remark = _without_missing_fixes(places, rows)
    plane = _on_a_plane(places)
    _check_jumps(places, plane, time, rows)
    true = {name: table.numbers(name)[kept] for name in TRUE_COLUMNS if name in table}
    logged = None
    if moments.dated:
        known = moments.seconds[kept]
        logged = _utc(known[0]), _utc(known[-1])
    first_utc, last_utc, utc_from = _utc_times(config.flight, logged, float(time[-1] - time[0]))
    first_position, last_position = _end_positions(places)
    start = first_utc.timestamp() if first_utc else None
    logged_places = _logged_places(places, start, time, rows)
    about = FlightRecord(
        readings=len(values),
        details=config.flight,
        first_utc=first_utc,
        last_utc=last_utc,
        utc_from=utc_from,
        offset=moments.offset,
        first_position=first_position,
        last_position=last_position,
        place_remark=remark,
        ships=tuple(distance_words(logged_places, ship) for ship in ships),
        columns={key: name for key, name in config.columns.items() if name in table},
        scale={gas: factor for gas, factor in scale.items() if factor != 1.0},
        missing=config.missing,
        table=_described(table, moments),
        stated=config.stated,
    )
    return LoggedFlight(
        readings,
        pd.DataFrame({"time_s": time, **plane, **true}),
        about,
        tuple(_gases(table, kept, Readings(time, values), rows, config)),
        _humidity(table, kept, config),
    )


# Other gases


def _gases(
    table: Table,
    kept: npt.NDArray[np.bool_],
    logged: Readings,
    rows: Rows,
    config: LogConfig,
) -> Iterator[GasReadings]:
    """Yield the gases beside SO2 that the log has, declared or found by their names and units.

    NOx of NO and NO2 is found where no column has NOx itself.
    """
    for gas, species in config.species.items():
        name = config.columns.get(gas) or _named(table, species)
        if name is None:
            if gas in config.channels:
                raise MeasurementError(
                    f"[channels] has {gas}, and the log no column of it: name it in [columns], as"
                    f' {gas} = "..."'
                )
            if gas == "nox" and (found := nox_of(logged, config.instrument)) is not None:
                yield _new_gas(found)
            continue
        column = _known_numbers(table, name, config)[kept]
        column *= _factor_of(table, gas, name, species.unit, config)
        remarks: tuple[str, ...] = (f"column '{name}'",)
        if gas not in config.channels:
            remarks += (
                "its channel is not declared: t90, delay and noise are those of the record",
            )
        channel = config.channels.get(gas) or channel_of(gas)
        found = placed(species, channel, column, logged, config.instrument, remarks=remarks)
        slot = replace(config, instrument=found.instrument)
        _check_range(found.readings.values, rows, slot)
        values, found = found.readings.values, _new_gas(found)
        _check_negative(values, rows, found.readings, slot)
        yield found


def _new_gas(found: GasReadings) -> GasReadings:
    """Return a gas with each reading once, where the log's rows are faster."""
    return replace(found, readings=new_readings(found.readings, found.instrument.gases))


def _named(table: Table, species: Species) -> str | None:
    """Return the column of a gas by its name before a unit, or None.

    Raises
    ------
    MeasurementError : two columns are
    """
    names = [
        name
        for name in table.names
        if species_name(name) in species.columns and table.units.get(name)
    ]
    if len(names) > 1:
        raise MeasurementError(
            f"columns '{names[0]}' and '{names[1]}' are both of {species.title}; name one of them"
            f" in [columns] as {species.name}"
        )
    return names[0] if names else None


def species_name(column: str) -> str:
    """Return the words before the unit in a column's name, as "ch4" of "CH4 [ppm]"."""
    words = column
    if unit := unit_in(column):
        words = column[: column.rindex(unit)]
    return words.rstrip(" _([").strip().lower().replace("_", " ")


def _humidity(table: Table, kept: npt.NDArray[np.bool_], config: LogConfig) -> Array | None:
    """Return the relative humidity by row [%], or None.

    Raises
    ------
    MeasurementError : the column does not exist, or has values that are no humidity
    """
    name = config.columns.get(HUMIDITY)
    if name is None:
        names = [of for of in table.names if of.lower() in _HUMIDITY_COLUMNS]
        name = names[0] if names else None
    elif name not in table:
        raise MeasurementError(_missing_column(HUMIDITY, name, table.names))
    if name is None:
        return None
    humidity = _known_numbers(table, name, config)[kept]
    wrong = np.flatnonzero((humidity < 0.0) | (humidity > _HUMIDITY_MOST))
    if wrong.size:
        raise MeasurementError(
            f"column '{name}' is {humidity[wrong[0]]:g} in row"
            f" {np.array(table.lines)[kept][wrong[0]]}; a relative humidity is 0 to"
            f" {_HUMIDITY_MOST:g} %"
        )
    return humidity


_HUMIDITY_COLUMNS = ("humidity_percent", "rh_percent", "humidity [%]", "rh [%]")
"""Names of columns with the relative humidity, in lower case."""

_HUMIDITY_MOST = 110.0
"""Largest relative humidity that a sensor shows [%]."""


def _described(table: Table, moments: Moments) -> str:
    """Return how the table was read, in one line, with the rows that were left out."""
    leap = f"; leap seconds left out: {moments.leap}" if moments.leap else ""
    return table.described() + leap


def _factor(table: Table, gas: str, config: LogConfig) -> float:
    """Return the factor of a gas's column to its unit of ``UNITS``."""
    return _factor_of(table, gas, config.columns[gas], UNITS[gas], config)


def _factor_of(table: Table, gas: str, name: str, own: str, config: LogConfig) -> float:
    """Return the factor of the column ``name`` of a gas to the unit ``own``.

    Raises
    ------
    MeasurementError : the column's unit is unknown, or it is not a unit of a gas
    """
    if gas in config.scale:
        return config.scale[gas]
    unit = config.units.get(gas) or table.units.get(name, "")
    if not unit:
        raise MeasurementError(
            f"column '{name}' does not say its unit; give it in the configuration, as in [units]"
            f' {gas} = "{own}", or in the column\'s name'
        )
    try:
        temperature, pressure = config.air
        return unit_factor(unit, own, gas=gas, temperature_c=temperature, pressure_hpa=pressure)
    except TableError as error:
        raise MeasurementError(f"column '{name}': {error}") from None


# The table

_NUMBER = re.compile(r"[-+]?[\d.]+(e[-+]?\d+)?", re.IGNORECASE)


def _read_table(path: Path, config: LogConfig) -> Table:
    """Return the table of a file after checking its columns."""
    try:
        names = tuple(name for name in config.columns.values() if name)
        table = read_table(path, config.table, head=names)
    except OSError as error:
        raise MeasurementError(f"cannot be read: {error.strerror or error}; give a table") from None
    for name in (*names, *TRUE_COLUMNS):
        if name in table:
            table.column(name)
    for key, name in config.columns.items():
        if key == "so2" and not config.with_sulphur:
            continue
        if name not in table and (key in _REQUIRED or name != COLUMNS.get(key)):
            raise MeasurementError(_missing_column(key, name, table.names))
    if not len(table):
        raise MeasurementError("a head line and 0 readings; it needs a row per reading")
    return table


def _missing_column(key: str, name: str, names: Sequence[str]) -> str:
    """Return the problem of a table without the column ``name`` for the quantity ``key``."""
    numbers = sum(bool(_NUMBER.fullmatch(column)) for column in names)
    if 2 * numbers > len(names):
        needed = ", ".join(COLUMNS[required] for required in _REQUIRED)
        return (
            "no head line, but numbers in the first line; add one that names every column, as in"
            f" {needed}"
        )
    quantity = key.upper() if key in (*GASES, *SPECIES) else key
    remedy = f'name it in [columns] of the configuration: {key} = "..."'
    if name != COLUMNS.get(key):
        remedy = f'correct {key} = "{name}" in [columns] of the configuration'
    return f"no {quantity} column '{name}', but {first_columns(names)}; {remedy}"


def _known_numbers(table: Table, name: str, config: LogConfig) -> Array:
    """Return a column as numbers, NaN where it is empty or has a mark for missing values."""
    numbers = table.numbers(name)
    return np.where(np.isin(numbers, config.missing), np.nan, numbers)


# Times


def _times(table: Table, config: LogConfig) -> tuple[Array, Moments, npt.NDArray[np.bool_]]:
    """Return the times [s], the table's description of them, and which rows are kept: all but those
    of a leap second.
    """
    moments = table.times(config.columns["time"], day=config.flight.day)
    missing = np.flatnonzero(~np.isfinite(moments.seconds))
    cells = table.column(config.columns["time"])
    empty = [row for row in missing.tolist() if not moments.leap or not cells[row]]
    if empty:
        raise MeasurementError(
            f"no time in row {table.lines[empty[0]]}; give a time in every row, or remove the row"
        )
    kept = np.isfinite(moments.seconds)
    time = moments.seconds[kept]
    if moments.dated and not moments.plain:
        time = time - time[0]
    check_increasing(time, rows=np.array(table.lines)[kept])
    return time, moments, kept


def _utc(seconds: float) -> datetime:
    return datetime.fromtimestamp(round(seconds, 6), UTC)


def _utc_times(
    details: FlightDetails, logged: tuple[datetime, datetime] | None, duration_s: float
) -> tuple[datetime | None, datetime | None, str]:
    """Return first and last time and their source: log, or configuration and duration [s]."""
    start = details.start
    if logged is None:
        if start is None:
            return None, None, ""
        try:
            return start, start + timedelta(seconds=duration_s), FROM_CONFIGURATION
        except OverflowError:
            raise MeasurementError(
                f"the log lasts {duration_s:g} s from flight.date on, beyond the year 9999; give"
                " its times in seconds"
            ) from None
    first = logged[0]
    apart = start is not None and abs((first - start).total_seconds()) >= 1.0
    if apart or (details.day is not None and first.date() != details.day):
        raise MeasurementError(
            f"flight.date is {_iso_text(start or details.day)}, but the log begins at"
            f" {_iso_text(first)}; correct it, or leave it out"
        )
    return (*logged, FROM_LOG)


def _iso_text(value: date | datetime | None) -> str | None:
    """Return a date or a time of UTC in ISO 8601, to a millisecond if it has a fraction."""
    if isinstance(value, datetime):
        timespec = "milliseconds" if value.microsecond else "seconds"
        return value.isoformat(timespec=timespec).replace("+00:00", "Z")
    return None if value is None else value.isoformat()


# Readings


def _check_range(values: Array, rows: Rows, config: LogConfig) -> None:
    """Check that no reading is beyond the end of its channel's range, where the sensor stops."""
    for gas in config.instrument.gases:
        channel, column = config.instrument.known(gas), values[:, GASES.index(gas)]
        if gas == "co2" and np.isfinite(column).any():
            # In another unit, or without its background, the whole column is wrong.
            check_units(config.instrument, gas, column)
        beyond = np.flatnonzero(column > channel.range_high + channel.resolution)
        if beyond.size:
            name, unit = config.instrument.name_of(gas), config.instrument.unit_of(gas)
            more = f", and {beyond.size - 1} more" if beyond.size > 1 else ""
            raise MeasurementError(
                f"{name} is {column[beyond[0]]:g} {unit} in row {rows[beyond[0]]}{more}; its"
                f" sensor reads {channel.range_high:g} {unit} at most (range_high): leave such a"
                " cell empty, or correct the column's unit ([scale]) or the range"
            )


def _check_negative(values: Array, rows: Rows, readings: Readings, config: LogConfig) -> None:
    """Check that no reading is lower than in clean air: a mark, a calibration or a wrong sign."""
    for gas in config.instrument.gases:
        column = values[:, GASES.index(gas)]
        if not np.isfinite(column).any():
            continue
        lowest = lowest_reading(gas, readings.values, config.instrument)
        low = np.flatnonzero(column < lowest)
        if low.size:
            name, unit = config.instrument.name_of(gas), config.instrument.unit_of(gas)
            least = float(column[low[0]])
            more = f", and {low.size - 1} more are as low" if low.size > 1 else ""
            air = "air, " if gas == "co2" else ""
            raise MeasurementError(
                f"{name} is {least:g} {unit} in row {rows[low[0]]}{more}; {air}noise, zero"
                f" and other gases explain {lowest:.0f} {unit} at least: where it stands for a"
                " missing reading, or is of a calibration from which the sensor has not recovered,"
                " leave it empty or name it in the configuration, as in missing = [-9999];"
                " otherwise check the sign, and state the channel's noise, zero and cross"
            )


_FEWEST = 10
"""Least number of intervals between new readings that determine the number of rows per reading."""

_LOW = 0.1
"""Share of these intervals that counts as the shortest; equal readings make others longer."""

_OFF, _REGULAR = 0.25, 0.8
"""Deviation from a whole number of sensor intervals, and least share of intervals as near."""

_LARGER = 0.25
"""Least share of the changes that are larger than a step of the readings."""


def new_readings(logged: Readings, gases: Sequence[str]) -> Readings:
    """Return each reading of a log once, at the time of its first row.

    A log with a row per reading is returned as it is. Otherwise the times are those of the slowest
    of the instrument's gases; the others are interpolated between their readings.
    """
    columns = logged.values.T
    rows_each = [rows_per_reading(column) for column in columns]
    slowest = max((GASES.index(gas) for gas in gases), key=lambda i: rows_each[i])
    if rows_each[slowest] == 1.0:
        return logged
    time = logged.time[_first_rows(columns[slowest], rows_each[slowest])]
    values = np.full((len(time), len(columns)), np.nan)
    for i, (column, rows) in enumerate(zip(columns, rows_each, strict=True)):
        own = _first_rows(column, rows)
        values[:, i] = np.interp(time, logged.time[own], column[own])
    return Readings(time, values)


def rows_per_reading(column: Array) -> float:
    """Return the mean number of rows that a reading of a gas has; 1 where they are not repeated.

    Readings in coarse steps may change as rarely and as evenly as passes occur, and mostly by one
    step: they count as not repeated.

    Parameters
    ----------
    column : readings by row, NaN where there is none, shape (n,)
    """
    changes = _changes(column)
    between = np.diff(changes)
    if len(between) < _FEWEST:
        return 1.0
    larger = np.abs(np.diff(column[changes])) > 1.5 * shown_step(column)
    if np.mean(larger) < _LARGER:
        return 1.0
    rows = float(np.mean(between[between <= 1.5 * np.quantile(between, _LOW)]))
    off = np.abs(between / rows - np.round(between / rows))
    return rows if float(np.mean(off <= _OFF)) >= _REGULAR else 1.0


def _changes(column: Array) -> Rows:
    """Return the rows with another reading than the last one before them."""
    known = np.flatnonzero(np.isfinite(column))
    return known[np.concatenate([[True], np.diff(column[known]) != 0.0])] if len(known) else known


def _first_rows(column: Array, rows: float) -> Rows:
    """Return the first row of each reading, by rows per reading; equal ones count as several."""
    starts = np.unique(np.concatenate([[0], _changes(column)]))
    parts = []
    for start, end in zip(starts, [*starts[1:], len(column)], strict=True):
        count = max(1, round((end - start) / rows))
        parts.append(start + np.round(rows * np.arange(count)).astype(np.intp))
    return np.concatenate(parts)


# Places

_PLACES = ("latitude", "longitude", "north", "east", "height")
"""Keys of the columns of places."""

EARTH_RADIUS_M = 6_371_000.0
"""Mean radius [m], for a track of a few kilometres on a plane."""

_SPEED_MOST = 340.0
"""Largest speed of an aircraft that measures exhaust [m/s]: the speed of sound."""

_ERROR_M = 100.0
"""Largest error of a place [m]."""


def _check_angles(places: Mapping[str, Array], rows: Rows) -> None:
    """Check that latitude and longitude are in range, shape (n,) each [deg]."""
    for name, most in (("latitude", 90.0), ("longitude", 360.0)):
        if name not in places:
            continue
        beyond = np.flatnonzero(np.abs(places[name]) > most)
        if beyond.size:
            row = int(beyond[0])
            raise MeasurementError(
                f"{name} is {places[name][row]:g} deg in row {rows[row]}; it must be {-most:g} to"
                f" {most:g}: correct it, leave it empty, or name what stands for a missing one in"
                " the configuration, as in missing = [-9999]"
            )


def _without_missing_fixes(places: dict[str, Array], lines: Rows) -> tuple[dict[str, Array], str]:
    """Return places without latitude and longitude 0 of receivers without a fix, and a remark."""
    if not {"latitude", "longitude"} <= set(places):
        return places, ""
    missing = (places["latitude"] == 0.0) & (places["longitude"] == 0.0)
    rows = lines[missing]
    if not len(rows):
        return places, ""
    named = f"row {rows[0]} is"
    if len(rows) > 1:
        named = f"{len(rows):,} rows, from row {rows[0]} to row {rows[-1]}, are"
    kept = {name: np.where(missing, np.nan, places[name]) for name in ("latitude", "longitude")}
    return places | kept, (
        f"{named} at latitude 0 and longitude 0, as from a receiver without a fix: taken as missing"
    )


def _check_jumps(
    places: Mapping[str, Array], plane: Mapping[str, Array], time: Array, lines: Rows
) -> None:
    """Check that an aircraft can fly between places in the time [s], shape (n,) each: on the plane,
    and by latitude and longitude where the plane has others.
    """
    degrees = None
    tracks = [plane] if "north_m" in plane else []
    if {"latitude", "longitude"} <= set(places):
        degrees = places["latitude"], places["longitude"]
        if {"north", "east"} <= set(places):
            tracks.append(_on_a_plane({key: places[key] for key in ("latitude", "longitude")}))
    for track in tracks:
        if "north_m" not in track:
            continue
        place = np.column_stack([track["north_m"], track["east_m"]])
        jumps = find_jumps(time, place, speed_max=_SPEED_MOST, error=_ERROR_M, degrees=degrees)
        if jumps:
            raise MeasurementError(
                f"{jumps[0].described(lines)}: correct the places that are wrong, or leave them"
                " empty"
            )


def _logged_places(
    places: Mapping[str, Array], start: float | None, time: Array, lines: Rows
) -> LoggedPlaces:
    """Return the places of the aircraft; ``start`` is the time of the first row since 1970 [s]."""
    nowhere = np.full(len(time), np.nan)
    return LoggedPlaces(
        latitude=places.get("latitude", nowhere),
        longitude=places.get("longitude", nowhere),
        time=None if start is None else start + time - time[0],
        lines=lines,
    )


def _known_positions(places: Mapping[str, Array]) -> Rows:
    """Return the rows that have a latitude and a longitude."""
    if not {"latitude", "longitude"} <= set(places):
        return np.empty(0, dtype=np.intp)
    return np.flatnonzero(np.isfinite(places["latitude"] + places["longitude"]))


def _on_a_plane(places: Mapping[str, Array]) -> dict[str, Array]:
    """Return ``north_m``, ``east_m`` and ``height_m``, on a plane at the first known place."""
    plane = {}
    known = _known_positions(places)
    if {"north", "east"} <= set(places):
        plane = {"north_m": places["north"], "east_m": places["east"]}
    elif len(known):
        latitude, longitude = np.radians(places["latitude"]), np.radians(places["longitude"])
        first = known[0]
        east = (longitude - longitude[first] + math.pi) % math.tau - math.pi
        plane = {
            "north_m": EARTH_RADIUS_M * (latitude - latitude[first]),
            "east_m": EARTH_RADIUS_M * math.cos(latitude[first]) * east,
        }
    if "height" in places:
        plane["height_m"] = places["height"]
    return plane


def _end_positions(places: Mapping[str, Array]) -> tuple[Position | None, Position | None]:
    """Return the first and the last known latitude and longitude, or None for both."""
    known = _known_positions(places)
    if not len(known):
        return None, None
    first, last = (
        (float(places["latitude"][i]), float(places["longitude"][i])) for i in known[[0, -1]]
    )
    return first, last
