"""The wind of one place from netCDF, such as ERA5 of the Copernicus Climate Data Store, read by
xarray.
"""

import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from common.text import install_words
from scenarios.errors import InputError

Array = npt.NDArray[np.float64]

_PAIRS = ((10.0, "u10", "v10"), (100.0, "u100", "v100"))
"""Height [m] and names of ERA5's wind near the surface, eastward and northward."""

_TIMES = ("valid_time", "time")

_PLACES = ("latitude", "longitude")

_OTHER_NAMES = {"lat": "latitude", "lon": "longitude"}
"""What other files than ERA5's call places."""

_METRES_PER_SECOND = {
    "m s**-1",
    "m s-1",
    "m s^-1",
    "m/s",
    "ms-1",
    "m.s-1",
    "metre per second",
    "meter per second",
}
"""Units of a wind that need no conversion, as netCDF files write them."""

_CLOSED = 1e-3
"""What a grid that goes round the earth may lack to 360 deg after its last step [deg]: its
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
            f"wind.table: {path}: netCDF needs xarray and h5netcdf; install the extra: {install_words('weather')}"
        ) from None
    try:
        with xarray.open_dataset(path) as data:
            return _wind_at(path, data, latitude_deg, longitude_deg)
    except (OSError, ValueError, KeyError) as error:
        if isinstance(error, InputError):
            raise
        # What xarray recommends after its first sentence is for programmers.
        reason = str(error).splitlines()[0].partition(". ")[0][:160]
        raise InputError(
            f"wind.table: {path}: cannot be read as netCDF ({reason}); check the file"
        ) from None


def _wind_at(
    path: Path, data: Any, latitude_deg: float, longitude_deg: float
) -> tuple[tuple[float, ...], tuple[float, ...], Array]:
    time = next((name for name in _TIMES if name in data.dims), None)
    pairs = [(height, u, v) for height, u, v in _PAIRS if u in data and v in data]
    if time is None or not (pairs or {"u", "v", "height"} <= {*data.variables}):
        raise InputError(
            f"wind.table: {path}: it has {', '.join(sorted(map(str, data.variables)))[:120]}; needed are a time and u10 with v10,"
            " or u and v over height"
        )
    data = data.rename(
        {
            other: name
            for other, name in _OTHER_NAMES.items()
            if other in data.dims and name not in data.variables
        }
    )
    _check_wind(path, data, time, [name for _, *names in pairs for name in names] or ["u", "v"])
    data = data.sortby(time)
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
    if not np.isfinite(velocity).all():
        raise InputError(
            f"wind.table: {path}: it has no wind at {latitude_deg:.3f}, {longitude_deg:.3f} deg; give another place"
        )
    return tuple(float(t) for t in data_times), heights, np.asarray(velocity, dtype=np.float64)


def _check_wind(path: Path, data: Any, time: str, names: list[str]) -> None:
    """Refuse a wind in another unit than m/s, without a time, or with dimensions that are neither
    time nor place.
    """
    for name in names:
        unit = str(data[name].attrs.get("units", "m/s")).strip()
        if unit not in _METRES_PER_SECOND:
            raise InputError(
                f"wind.table: {path}: {name} is in {unit!r}; it has to be in m/s: convert it"
            )
        if others := [str(of) for of in data[name].dims if of not in (time, "height", *_PLACES)]:
            raise InputError(
                f"wind.table: {path}: {name} has the dimension '{others[0]}' beside time and place; select one of its"
                f" {data.sizes[others[0]]} values, and write that to a file"
            )
    if not np.issubdtype(data[time].dtype, np.datetime64):
        raise InputError(
            f"wind.table: {path}: its times have no unit and origin, as 'hours since 2026-06-01'; give {time} such units"
        )
    if not data.sizes[time]:
        raise InputError(
            f"wind.table: {path}: it has no times; give a file with the time of the flight"
        )


def _at_place(path: Path, data: Any, latitude_deg: float, longitude_deg: float) -> Any:
    """Return the data of one place, by bilinear interpolation."""
    data, longitude_deg = _round_the_earth(data, longitude_deg)
    for name, value in zip(_PLACES, (latitude_deg, longitude_deg), strict=True):
        low, high = float(data[name].min()), float(data[name].max())
        if not low <= value <= high:
            raise InputError(
                f"wind.table: {path}: {name}s go from {low:g} to {high:g} deg, and the flight begins at {value:.3f}; give a file"
                " of that place"
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


def _round_the_earth(data: Any, longitude_deg: float) -> tuple[Any, float]:
    """Return the data, and a longitude as its grid counts it, such as from 0 to 360; a grid that
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
