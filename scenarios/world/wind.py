"""The air of a flight: its mean wind, constant or from a table or netCDF (such as ERA5 of the
Copernicus Climate Data Store, read by xarray), turbulence and discrete gusts.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from aircraft.fdm import TIME_STEP
from aircraft.weather import STEPS_BETWEEN_GUSTS, TURBULENCE, Gust, Weather
from aircraft.wind import CALM, WindField, constant_wind, over_the_sea
from common.physics import wind_velocity
from common.tables import FOUND, MISTAKES, Table, TableError, TableFormat, read_table, unit_factor
from common.text import install_words, other_units, utc_text
from scenarios.errors import InputError
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.world import WindConfig
from scenarios.world.vessel import Place

STILL_AIR = Weather(wind=CALM, turbulence=None, gusts=(), seed=0)

_BETWEEN = (STEPS_BETWEEN_GUSTS + 1.0) * TIME_STEP
"""Least time from the end of one gust to the next [s]."""


def wind_ned(wind: WindConfig) -> tuple[float, float]:
    """Return north and east velocity of the air mass [m/s], the direction to which the wind
    blows.
    """
    return wind_velocity(wind.speed_mps, wind.from_deg)


def wind_of(scenario: Scenario, place: Place) -> WindField:
    """Return the mean wind of a flight that begins at a place, timed from its start.

    Raises
    ------
    InputError : its table cannot be read, or does not cover the longest flight
    """
    wind = scenario.wind
    if wind.table is not None:
        duration = scenario.flight.duration_max_s
        return tabled_wind(wind, place, duration, scenario.table.of("wind.table", wind.table))
    if wind.roughness_m is None or not wind.blows:
        return constant_wind(*wind_ned(wind))
    return over_the_sea(
        np.array([wind_ned(wind)]), [0.0], roughness=wind.roughness_m, height=wind.height_m
    )


def sampled_weather(scenario: Scenario, wind: WindField, generator: np.random.Generator) -> Weather:
    """Return the air of the flight with a mean wind."""
    turbulence = scenario.turbulence
    rise = turbulence.gust_length_s
    gusts: list[Gust] = []
    for i in range(turbulence.gusts):
        # One gust in each equal part of the flight, after the end of the one before: JSBSim has one
        # at a time.
        part = scenario.flight.duration_max_s / turbulence.gusts
        start = i * part + float(generator.uniform(0.0, max(0.0, part - 2.0 * rise)))
        start = max(start, gusts[-1].end + _BETWEEN) if gusts else start
        towards = float(generator.uniform(-math.pi, math.pi))
        speed = float(generator.uniform(0.5, 1.0)) * turbulence.gust_speed_mps
        velocity = (speed * math.cos(towards), speed * math.sin(towards), 0.0)
        gusts.append(Gust(start=start, rise=rise, fall=rise, velocity_ned=velocity))
    return Weather(
        wind=wind,
        turbulence=None if turbulence.level == "none" else TURBULENCE[turbulence.level],
        gusts=tuple(gusts),
        seed=int(generator.integers(2**31 - 1)),
    )


Array = npt.NDArray[np.float64]

_FROM = "from_deg"

_TIME_AND_HEIGHT, _SPEED_AND_DIRECTION = ("time_utc", "height_m"), ("speed_mps", _FROM)

COLUMNS = (*_TIME_AND_HEIGHT, *_SPEED_AND_DIRECTION)
"""Columns of a table; one of the first two may be missing."""

_TO = "to_deg"
"""Column of the direction to which the wind blows."""

_SPEED_MAX = 100.0
"""Fastest wind that a table may have: a hurricane's is 90 m/s [m/s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TabledWind:
    """The wind of a file on a grid.

    Attributes
    ----------
    times : since 1970 in UTC, shape (n,); empty where it does not change with time [s]
    heights : above the sea, shape (m,); empty where it does not change with height [m]
    velocity : of the air, north and east, shape (max(n, 1), max(m, 1), 2) [m/s]
    lines : of a table: the first and the last with a wind
    read : how the file was read, in words
    """

    times: tuple[float, ...]
    heights: tuple[float, ...]
    velocity: Array
    lines: tuple[int, int] | None = None
    read: str = ""

    def record(self) -> dict[str, Any]:
        """Return a record for JSON: how the file was read, and its contents."""
        return {"read": self.read, "times": len(self.times), "heights_m": list(self.heights)}

    def described(self) -> str:
        """Return the file's contents and how it was read, in a line."""
        words = []
        if self.times:
            first, last = utc_text(self.times[0]), utc_text(self.times[-1])
            words.append(f"wind at {len(self.times)} times from {first} to {last}")
        if self.heights:
            heights = ", ".join(f"{height:g}" for height in self.heights[:_HEIGHTS_SHOWN])
            more = ", ..." if len(self.heights) > _HEIGHTS_SHOWN else ""
            words.append(f"{'at' if words else 'wind at'} heights of {heights}{more} m")
        return f"{' '.join(words)}; {self.read}"


_HEIGHTS_SHOWN = 8
"""Largest number of heights in a line."""


def tabled_wind(
    config: WindConfig, place: Place, duration: float, written: TableFormat = FOUND
) -> WindField:
    """Return the wind of a scenario that has it from a file, timed from the flight's start.

    Parameters
    ----------
    config : the ``[wind]`` section, with a table
    place : where and when the flight begins
    duration : of the longest flight [s]
    written : how the table is written, as far as it is given

    Raises
    ------
    InputError : the file cannot be read, or does not cover the flight
    """
    found, name = wind_file(str(config.table), place, written), config.table
    if found.times:
        first, last = found.times[0], found.times[-1]
        if not first <= place.utc <= place.utc + duration <= last:
            at = [f" (line {line})" for line in found.lines] if found.lines else ["", ""]
            raise InputError(
                f"wind.table: {name} goes from {utc_text(first)}{at[0]} to {utc_text(last)}{at[1]};"
                f" the longest flight goes from {utc_text(place.utc)} to"
                f" {utc_text(place.utc + duration)}: give a longer table, or set place.utc or"
                " flight.duration_max_s"
            )
    found = _where_it_blows(found, place, duration, str(name))
    times = [time - place.utc for time in found.times] or [0.0]
    if config.roughness_m is None:
        return WindField(found.velocity, times, found.heights or (10.0,))
    if found.heights:
        raise InputError(
            f"wind.roughness_m is given beside heights in {name}; leave one of them out"
        )
    return over_the_sea(
        found.velocity[:, 0], times, roughness=config.roughness_m, height=config.height_m
    )


def _where_it_blows(found: TabledWind, place: Place, duration: float, name: str) -> TabledWind:
    """Return a wind without the times at which it is unknown, after a check that the flight needs
    none of these.

    Raises
    ------
    InputError : the flight needs one of them
    """
    known: npt.NDArray[np.bool_] = np.asarray(np.isfinite(found.velocity).all(axis=(1, 2)))
    if known.all():
        return found
    times = np.array(found.times)
    # A flight needs the last time before it, and the first one after it.
    first = int(np.searchsorted(times, place.utc, side="right")) - 1
    last = int(np.searchsorted(times, place.utc + duration))
    missing = [time for time in range(first, last + 1) if not known[time]]
    if missing:
        more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        raise InputError(
            f"wind.table: {name} has no wind at {utc_text(times[missing[0]])}{more}, which the"
            " flight needs; give another file, another place or another time (place.utc)"
        )
    return replace(
        found, times=tuple(times[known].tolist()), velocity=found.velocity[known], lines=None
    )


def first_time(table: str, place: Place, written: TableFormat = FOUND) -> float:
    """Return the first time of a file of wind, since 1970 [s]; NaN where it has none.

    Raises
    ------
    InputError : the file cannot be read
    """
    times = wind_file(table, place, written).times
    return times[0] if times else math.nan


def wind_file(table: str, place: Place, written: TableFormat = FOUND) -> TabledWind:
    """Return the wind of a file; for a netCDF file, that at a place.

    Parameters
    ----------
    table : the file's name
    place : where the flight begins
    written : how a table is written, as far as it is given

    Raises
    ------
    InputError : the file cannot be read
    """
    path = Path(table)
    try:
        stamp = path.stat().st_mtime_ns, path.stat().st_size
    except OSError as error:
        raise InputError(
            f"wind.table: {path}: cannot be read: {error.strerror}; check the path"
        ) from None
    if path.suffix.lower() != ".nc":
        return _read_table(path, stamp, written)
    if not math.isfinite(place.latitude):
        raise InputError(
            f"wind.table: {path} has winds of many places; say which: place.latitude_deg,"
            " place.longitude_deg"
        )
    return _read_netcdf(path, stamp, math.degrees(place.latitude), math.degrees(place.longitude))


@lru_cache(maxsize=8)
def _read_netcdf(
    path: Path, _stamp: tuple[int, int], latitude_deg: float, longitude_deg: float
) -> TabledWind:
    times, heights, velocity = read_netcdf(path, latitude_deg, longitude_deg)
    return TabledWind(times=times, heights=heights, velocity=velocity, read="netCDF")


@lru_cache(maxsize=8)
def _read_table(path: Path, _stamp: tuple[int, int], written: TableFormat) -> TabledWind:
    try:
        table = read_table(path, written, head=COLUMNS)
        return replace(_on_grid(path, list(_rows(path, table))), read=table.described())
    except OSError as error:
        raise InputError(
            f"wind.table: {path}: cannot be read: {error.strerror}; check the path"
        ) from None
    except TableError as error:
        raise InputError(f"wind.table: {path}: {error}") from None


class _Row(NamedTuple):
    """A row of a table of wind; NaN for values without a column.

    Attributes
    ----------
    line : in the file
    time, height : [s], [m]
    north, east : velocity of the air [m/s]
    """

    line: int
    time: float
    height: float
    north: float
    east: float


def _rows(path: Path, table: Table) -> Iterator[_Row]:
    """Yield the rows of a table.

    Raises
    ------
    InputError : a column is missing or twice, or a row has no wind or one that cannot be
    TableError : a cell is no number or no time
    """
    names = [name.lower() for name in table.names]
    if not set(_SPEED_AND_DIRECTION) <= set(names) or not set(_TIME_AND_HEIGHT) & set(names):
        remedy = other_units(names, _SPEED_AND_DIRECTION) or "rename the columns to these"
        if _TO in names and _FROM not in names:
            remedy = (
                f"{_FROM} is where the wind comes from: add 180 deg to '{_TO}', less 360 where it"
                " is more, and rename it"
            )
        raise InputError(
            f"wind.table: {path}, line {table.head_line}: the header is {','.join(names)[:80]!r};"
            f" it must be {','.join(COLUMNS)}, where time_utc or height_m may be missing:"
            f" {remedy}"
        )
    if twice := [column for column in COLUMNS if names.count(column) > 1]:
        raise InputError(
            f"wind.table: {path}, line {table.head_line}: the header has '{twice[0]}' twice; leave"
            " one of the columns out"
        )
    there = {column: table.names[names.index(column)] for column in COLUMNS if column in names}
    nothing = np.full(len(table), math.nan)
    times = table.dated_times(there["time_utc"]) if "time_utc" in there else nothing
    heights = table.numbers(there["height_m"]) if "height_m" in there else nothing
    speeds, directions = (table.numbers(there[column]) for column in _SPEED_AND_DIRECTION)
    # Without wind the direction does not count.
    directions = np.where((speeds == 0.0) & np.isnan(directions), 0.0, directions)
    good = (
        (speeds >= 0.0)
        & (speeds <= _SPEED_MAX)
        & (np.abs(directions) <= 360.0)
        & (np.isfinite(times) | ("time_utc" not in there))
        & (((heights > 0.0) & (heights <= 20e3)) | ("height_m" not in there))
    )
    if not good.all():
        row = int(np.argmin(good))
        raise InputError(
            f"wind.table: {path}, line {table.lines[row]}: {','.join(table.rows[row])[:80]!r};"
            f" every row has its columns: speeds go from 0 to {_SPEED_MAX:g} m/s, directions from"
            " 0 to 360 deg, heights are above 0: correct the line, or delete it"
        )
    for row, line in enumerate(table.lines):
        wind = wind_velocity(float(speeds[row]), float(directions[row]))
        yield _Row(line, float(times[row]), float(heights[row]), *wind)


def _on_grid(path: Path, rows: list[_Row]) -> TabledWind:
    if not rows:
        raise InputError(f"wind.table: {path}: no row below the header; give one at least")
    timed, layered = math.isfinite(rows[0].time), math.isfinite(rows[0].height)
    at: dict[float, dict[float, tuple[float, float]]] = {}
    before = -math.inf
    for line, time, height, north, east in rows:
        key = time if timed else 0.0
        if key < before:
            raise InputError(
                f"wind.table: {path}, line {line}: {utc_text(time)} is before the line above; sort"
                " the table by time"
            )
        layers = at.setdefault(key, {})
        if (layer := height if layered else 0.0) in layers:
            raise InputError(
                f"wind.table: {path}, line {line}: the time and height of a line above once more;"
                " delete one of them"
            )
        layers[layer], before = (north, east), key
    heights = tuple(sorted(next(iter(at.values()))))
    for time, layers in at.items():
        if tuple(sorted(layers)) != heights:
            raise InputError(
                f"wind.table: {path}: at {utc_text(time)} heights are {sorted(layers)} m, at first"
                f" {list(heights)}; give the same at all times"
            )
    velocity = np.array([[layers[height] for height in heights] for layers in at.values()])
    return TabledWind(
        times=tuple(at) if timed else (),
        heights=heights if layered else (),
        velocity=velocity,
        lines=(rows[0][0], rows[-1][0]),
    )


_PAIRS = ((10.0, "u10", "v10"), (100.0, "u100", "v100"))
"""Height [m] and names of ERA5's wind near the surface, eastward and northward."""

_TIMES = ("valid_time", "time")

_PLACES = ("latitude", "longitude")

_OTHER_NAMES = {"lat": "latitude", "lon": "longitude"}
"""Names of places in other files than ERA5's."""

_CALENDARS = ("standard", "gregorian", "proleptic_gregorian")
"""CF's names of the calendar of clocks."""

_STANDARD_NAMES = {"u": "eastward_wind", "v": "northward_wind"}
"""CF's standard names of a wind; its variables may have any name."""

_CLOSED = 1e-3
"""Largest gap to 360 deg after the last step of a grid that goes round the earth [deg]: its
longitudes may be single precision.
"""


def read_netcdf(
    path: Path, latitude_deg: float, longitude_deg: float
) -> tuple[tuple[float, ...], tuple[float, ...], Array]:
    """Return times since 1970 [s], heights [m], and north and east velocity at each, shape (n, m,
    2) [m/s].

    The wind is that of ``u10``, ``v10`` and ``u100``, ``v100``, or of ``u`` and ``v`` over a
    coordinate ``height`` in metres; between points of the grid of ``latitude`` and ``longitude`` it
    is interpolated.

    Raises
    ------
    InputError : xarray is missing, the file cannot be read or has no such wind, or the place is
        beyond its grid
    """
    try:
        import xarray
    except ImportError:
        raise InputError(
            f"wind.table: {path}: netCDF needs xarray and h5netcdf; install the extra:"
            f" {install_words('weather')}"
        ) from None
    try:
        with xarray.open_dataset(path) as data:
            return _wind_at(path, data, latitude_deg, longitude_deg)
    except (OSError, ValueError, KeyError) as error:
        if isinstance(error, InputError):
            raise
        # xarray's advice after its first sentence is for programmers.
        reason = str(error).splitlines()[0].partition(". ")[0][:160]
        raise InputError(
            f"wind.table: {path}: cannot be read as netCDF ({reason}); check the file"
        ) from None


def _wind_at(
    path: Path, data: Any, latitude_deg: float, longitude_deg: float
) -> tuple[tuple[float, ...], tuple[float, ...], Array]:
    data = _in_cf_names(_of_one_version(_along_steps(data)))
    time = next((name for name in _TIMES if name in data.dims), None)
    pairs = [(height, u, v) for height, u, v in _PAIRS if u in data and v in data]
    if time is None or not (pairs or {"u", "v", "height"} <= {*data.variables}):
        raise InputError(
            f"wind.table: {path}: it has {', '.join(sorted(map(str, data.variables)))[:120]};"
            " it needs a time and u10 with v10, or u and v over height"
        )
    data = data.rename(
        {
            other: name
            for other, name in _OTHER_NAMES.items()
            if other in data.dims and name not in data.variables
        }
    )
    names = [name for _, *pair in pairs for name in pair] or ["u", "v"]
    _check_wind(path, data, time, names)
    data = _in_metres_per_second(path, data, names).sortby(time)
    if set(_PLACES) <= set(data.dims):
        data = _at_place(path, data, latitude_deg, longitude_deg)
    if pairs:
        heights = tuple(height for height, _, _ in pairs)
        layers = [
            (data[v].transpose(time).values, data[u].transpose(time).values) for _, u, v in pairs
        ]
        velocity = np.stack([np.stack(layer, axis=-1) for layer in layers], axis=1)
    else:
        data = data.sortby("height")
        heights = tuple(float(height) for height in data["height"].values)
        velocity = np.stack(
            [data[name].transpose(time, "height").values for name in ("v", "u")], axis=-1
        )
    data_times = data[time].values.astype("datetime64[ms]").astype(np.int64) / 1000.0
    if not np.isfinite(velocity).any():
        raise InputError(
            f"wind.table: {path}: it has no wind at {latitude_deg:.3f}, {longitude_deg:.3f} deg;"
            " give another place"
        )
    return tuple(float(t) for t in data_times), heights, np.asarray(velocity, dtype=np.float64)


def _of_one_version(data: Any) -> Any:
    """Return the data of all versions as one: ERA5's final hours (``expver`` 1), and the
    preliminary ones (ERA5T, ``expver`` 5) where there are no final ones yet.
    """
    if "expver" not in data.dims:
        return data
    whole = data.isel(expver=0, drop=True)
    for number in range(1, data.sizes["expver"]):
        whole = whole.combine_first(data.isel(expver=number, drop=True))
    return whole


def _along_steps(data: Any) -> Any:
    """Return the data of a forecast over its valid times, not over its steps."""
    if "step" not in data.dims or "time" in data.dims:
        return data
    valid = data["time"] + data["step"] if "time" in data.coords else data["step"]
    return (
        data.drop_vars("valid_time", errors="ignore")
        .assign_coords(valid_time=("step", valid.values))
        .swap_dims(step="valid_time")
    )


def _in_cf_names(data: Any) -> Any:
    """Return the data with a wind of CF's standard names, over a height, as u and v."""
    if any(u in data for _, u, _ in _PAIRS) or "u" in data:
        return data
    names = {
        name: short
        for short, standard in _STANDARD_NAMES.items()
        for name in data.data_vars
        if data[name].attrs.get("standard_name") == standard
    }
    data = data.rename(names)
    if "u" in data and "height" in data.coords and "height" not in data.dims:
        data = data.expand_dims("height")
    return data


def _in_metres_per_second(path: Path, data: Any, names: list[str]) -> Any:
    """Return the data with a wind in m/s."""
    for name in names:
        unit = str(data[name].attrs.get("units", "m/s")).strip()
        try:
            factor = unit_factor(unit, "m/s")
        except TableError as error:
            raise InputError(f"wind.table: {path}: {name}: {error}") from None
        if factor != 1.0:
            data = data.assign({name: factor * data[name]})
    return data


def _check_wind(path: Path, data: Any, time: str, names: list[str]) -> None:
    """Refuse a wind without a time, with a calendar that no clock uses, or with dimensions other
    than time and place.
    """
    for name in names:
        if others := [str(of) for of in data[name].dims if of not in (time, "height", *_PLACES)]:
            raise InputError(
                f"wind.table: {path}: {name} has the dimension '{others[0]}' beside time and place;"
                f" select one of its {data.sizes[others[0]]} values, and write that to a file"
            )
    calendar = data[time].encoding.get("calendar") or getattr(
        data[time].values.flat[0] if data.sizes[time] else None, "calendar", "standard"
    )
    if calendar not in _CALENDARS:
        raise InputError(
            f"wind.table: {path}: its times are of the calendar '{calendar}', and a flight's are"
            " of the Gregorian one; convert them"
        )
    if not np.issubdtype(data[time].dtype, np.datetime64):
        raise InputError(
            f"wind.table: {path}: its times have no unit and origin, as 'hours since 2026-06-01';"
            f" give {time} such units"
        )
    if not data.sizes[time]:
        raise InputError(
            f"wind.table: {path}: it has no times; give a file with the time of the flight"
        )


def _at_place(path: Path, data: Any, latitude_deg: float, longitude_deg: float) -> Any:
    """Return the data of one place, by bilinear interpolation."""
    mistake = _mistake(data, latitude_deg, longitude_deg)
    data, longitude_deg = _round_the_earth(data, longitude_deg)
    for name, value in zip(_PLACES, (latitude_deg, longitude_deg), strict=True):
        low, high = float(data[name].min()), float(data[name].max())
        if not low <= value <= high:
            fits = f"; with {mistake} it would be within it" if mistake else ""
            raise InputError(
                f"wind.table: {path}: {name}s go from {low:g} to {high:g} deg, and the flight"
                f" begins at {value:.3f}{fits}; give a file of that place"
            )
        data = data.sel({name: low}) if low == high else data.sortby(name)
    left = [name for name in _PLACES if name in data.dims]
    return data.interp(
        {
            name: value
            for name, value in zip(_PLACES, (latitude_deg, longitude_deg), strict=True)
            if name in left
        }
    )


def _mistake(data: Any, latitude_deg: float, longitude_deg: float) -> str:
    """Return a hint that brings a place into the area of a grid; empty without one."""
    for mistake, corrected in MISTAKES.items():
        place = corrected(latitude_deg, longitude_deg)
        within, east = _round_the_earth(data, place[1])
        if all(
            float(within[name].min()) <= value <= float(within[name].max())
            for name, value in zip(_PLACES, (place[0], east), strict=True)
        ):
            return mistake
    return ""


def _round_the_earth(data: Any, longitude_deg: float) -> tuple[Any, float]:
    """Return the data, and a longitude in the grid's convention, such as from 0 to 360; a grid that
    goes round the earth is closed.
    """
    east = np.sort(data["longitude"].values.astype(np.float64))
    if east[0] <= longitude_deg <= east[-1]:
        return data, longitude_deg
    wrapped = float(east[0] + (longitude_deg - east[0]) % 360.0)
    if wrapped <= east[-1]:
        return data, wrapped
    if len(east) < 2 or not math.isclose(
        2.0 * east[-1] - east[-2], east[0] + 360.0, abs_tol=_CLOSED
    ):
        return data, longitude_deg
    columns = [*range(len(east)), 0]
    return data.sortby("longitude").isel(longitude=columns).assign_coords(
        longitude=[*east, east[0] + 360.0]
    ), wrapped
