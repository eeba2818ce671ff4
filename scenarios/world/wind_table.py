"""The mean wind from a file: a table over time, height or both, or netCDF."""

import csv
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from aircraft.wind import WindField, over_the_sea
from common.physics import wind_velocity
from common.text import other_units, utc_text
from measurement.tables import decimal_commas, other_separator
from scenarios.errors import InputError
from scenarios.scenario.sections.world import WindConfig
from scenarios.world.ais.rows import number_of, seconds_of
from scenarios.world.place import Place
from scenarios.world.wind_netcdf import read_netcdf

Array = npt.NDArray[np.float64]

COLUMNS = ("time_utc", "height_m", "speed_mps", "from_deg")
"""Of a table; one of the first two may be missing."""

_TO = "to_deg"
"""Column of where the wind blows to."""

_SPEED_MAX = 100.0
"""Fastest wind that a table may have: a hurricane's is 90 m/s [m/s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TabledWind:
    """The wind of a file on a grid.

    Attributes
    ----------
    times : since 1970 in UTC, shape (n,); empty where it does not change with time [s]
    heights : above the sea, shape (m,); empty where it does not change with height [m]
    velocity : where it blows to, north and east, shape (max(n, 1), max(m, 1), 2) [m/s]
    lines : of a table: the first and the last with a wind
    """

    times: tuple[float, ...]
    heights: tuple[float, ...]
    velocity: Array
    lines: tuple[int, int] | None = None


def tabled_wind(config: WindConfig, place: Place, duration: float) -> WindField:
    """Return the wind of a scenario that has it from a file, timed from the flight's start.

    Parameters
    ----------
    config : the ``[wind]`` section, with a table
    place : where and when the flight begins
    duration : of the longest flight [s]

    Raises
    ------
    InputError : the file cannot be read, or does not cover the flight
    """
    found, name = _read(str(config.table), place), config.table
    if found.times:
        first, last = found.times[0], found.times[-1]
        if not first <= place.utc <= place.utc + duration <= last:
            at = [f" (line {line})" for line in found.lines] if found.lines else ["", ""]
            raise InputError(
                f"wind.table: {name} goes from {utc_text(first)}{at[0]} to {utc_text(last)}{at[1]}; the longest flight goes from"
                f" {utc_text(place.utc)} to {utc_text(place.utc + duration)}: give a longer table, or set place.utc or"
                " flight.duration_max_s"
            )
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


def first_time(table: str, place: Place) -> float:
    """Return the first time of a file of wind, since 1970 [s]; not a number where it has none.

    Raises
    ------
    InputError : the file cannot be read
    """
    times = _read(table, place).times
    return times[0] if times else math.nan


def _read(table: str, place: Place) -> TabledWind:
    path = Path(table)
    try:
        stamp = path.stat().st_mtime_ns, path.stat().st_size
    except OSError as error:
        raise InputError(
            f"wind.table: {path}: cannot be read: {error.strerror}; check the path"
        ) from None
    if path.suffix.lower() != ".nc":
        return _read_table(path, stamp)
    if not math.isfinite(place.latitude):
        raise InputError(
            f"wind.table: {path} has winds of many places; say which: place.latitude_deg, place.longitude_deg"
        )
    return _read_netcdf(path, stamp, math.degrees(place.latitude), math.degrees(place.longitude))


@lru_cache(maxsize=8)
def _read_netcdf(
    path: Path, _stamp: tuple[int, int], latitude_deg: float, longitude_deg: float
) -> TabledWind:
    times, heights, velocity = read_netcdf(path, latitude_deg, longitude_deg)
    return TabledWind(times=times, heights=heights, velocity=velocity)


@lru_cache(maxsize=8)
def _read_table(path: Path, _stamp: tuple[int, int]) -> TabledWind:
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            return _on_grid(path, list(_rows(path, csv.reader(file))))
    except OSError as error:
        raise InputError(
            f"wind.table: {path}: cannot be read: {error.strerror}; check the path"
        ) from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(
            f"wind.table: {path}: not a table as text ({error}); save it in UTF-8"
        ) from None


def _rows(
    path: Path, cells: Iterator[list[str]]
) -> Iterator[tuple[int, float, float, float, float]]:
    """Yield line, time [s], height [m], and where the wind blows to, north and east [m/s]; not a
    number for what has no column.
    """
    lines = enumerate(cells, start=1)
    first, heads = next(
        (
            (line, [head.strip().lower() for head in row])
            for line, row in lines
            if any(map(str.strip, row))
        ),
        (0, []),
    )
    if not heads:
        columns = ",".join(COLUMNS[:1] + COLUMNS[2:])
        raise InputError(
            f"wind.table: {path}: the file is empty; give a table with the columns {columns}"
        )
    if words := other_separator(",".join(heads)):
        raise InputError(f"wind.table: {path} {words}")
    if not set(COLUMNS[2:]) <= set(heads) or not set(COLUMNS[:2]) & set(heads):
        remedy = other_units(heads, COLUMNS[2:]) or "rename the columns to these"
        if _TO in heads and COLUMNS[3] not in heads:
            remedy = f"{COLUMNS[3]} is where the wind comes from: add 180 deg to '{_TO}', less 360 where it is more, and rename it"
        raise InputError(f"wind.table: {path}, line {first}: the header is {','.join(heads)[:80]!r}; it must be {','.join(COLUMNS)}"
                         f", of which time_utc or height_m may be missing: {remedy}")  # fmt: skip
    if twice := [column for column in COLUMNS if heads.count(column) > 1]:
        raise InputError(
            f"wind.table: {path}, line {first}: the header has '{twice[0]}' twice; leave one of the columns out"
        )
    for line, row in lines:
        if not any(cell.strip() for cell in row):
            continue
        if words := _incomplete(heads, row):
            raise InputError(f"wind.table: {path}, line {line} {words}")
        named = dict(zip(heads, row, strict=False))
        try:
            time = seconds_of(named.get("time_utc", "")) if "time_utc" in heads else math.nan
        except ValueError:
            raise InputError(
                f"wind.table: {path}, line {line}: {named.get('time_utc', '')[:40]!r} is no time, as in 2026-06-01T12:00:00Z;"
                " correct it"
            ) from None
        height, speed, direction = (number_of(named.get(column)) for column in COLUMNS[1:])
        good = (
            0.0 <= speed <= _SPEED_MAX
            and abs(direction) <= 360.0
            and ("height_m" not in heads or 0.0 < height <= 20e3)
        )
        if not good:
            raise InputError(
                f"wind.table: {path}, line {line}: {','.join(row)[:80]!r}; speeds go from 0 to {_SPEED_MAX:g} m/s, directions"
                " from 0 to 360 deg, heights are above 0: correct the line, or delete it"
            )
        yield line, time, height, *wind_velocity(speed, direction)


def _incomplete(heads: list[str], row: list[str]) -> str:
    """Return what a row lacks, and the remedy; nothing of one with a number in each column of
    numbers.
    """
    shown = repr(",".join(row)[:80])
    numbers = [heads.index(column) for column in COLUMNS[1:] if column in heads]
    if words := decimal_commas(row, heads, numbers):
        return words
    if len(row) < len(heads):
        return f"has {len(row)} of {len(heads)} columns: {shown}; correct the line, or delete it"
    for place in numbers:
        if math.isnan(number_of(row[place])):
            return f"has {row[place][:40]!r} for {heads[place]}, which is not a number: correct the line, or delete it"
    return ""


def _on_grid(path: Path, rows: list[tuple[int, float, float, float, float]]) -> TabledWind:
    if not rows:
        raise InputError(f"wind.table: {path}: no row below the header; give one at least")
    timed, layered = math.isfinite(rows[0][1]), math.isfinite(rows[0][2])
    at: dict[float, dict[float, tuple[float, float]]] = {}
    before = -math.inf
    for line, time, height, north, east in rows:
        key = time if timed else 0.0
        if key < before:
            raise InputError(
                f"wind.table: {path}, line {line}: {utc_text(time)} is before the line above; sort the table by time"
            )
        layers = at.setdefault(key, {})
        if (layer := height if layered else 0.0) in layers:
            raise InputError(
                f"wind.table: {path}, line {line}: the time and height of a line above once more; delete one of them"
            )
        layers[layer], before = (north, east), key
    heights = tuple(sorted(next(iter(at.values()))))
    for time, layers in at.items():
        if tuple(sorted(layers)) != heights:
            raise InputError(
                f"wind.table: {path}: at {utc_text(time)} heights are {sorted(layers)} m, at first {list(heights)}; give the same"
                " at all times"
            )
    velocity = np.array([[layers[height] for height in heights] for layers in at.values()])
    return TabledWind(
        times=tuple(at) if timed else (),
        heights=heights if layered else (),
        velocity=velocity,
        lines=(rows[0][0], rows[-1][0]),
    )
