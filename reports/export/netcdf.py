"""CF netCDF of trajectories, all flights one after the other, with what was measured on them; needs
the extra ``export`` (xarray, h5netcdf).
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from common.columns import Column, Table, column_of, without_unit
from common.run_layout import FLIGHTS, SUMMARY
from reports.export.exporter import EXPORTERS, need_packages
from reports.export.geographic import GeographicFlight, recorded_flights
from reports.run.columns import Array
from reports.run.run_data import RunData

Variable = tuple[str, Any, dict[str, Any]]
"""A variable of the file: its dimension, its values, and its attributes."""

_SAMPLE, _FLIGHT = "obs", "trajectory"
"""Dimensions: samples of all flights one after the other, and flights."""

_FILL = -9999.0
"""What stands for a number that is missing."""

_MOTION: dict[str, tuple[str, dict[str, str]]] = {
    "time": ("time", {"standard_name": "time", "long_name": "time", "calendar": "standard",
    "axis": "T",
                      "units": "seconds since 1970-01-01T00:00:00Z"}),
    "lat": ("latitude", {"standard_name": "latitude", "long_name": "latitude of the UAV",
    "units": "degrees_north", "axis": "Y"}),
    "lon": ("longitude", {"standard_name": "longitude", "long_name": "longitude of the UAV",
    "units": "degrees_east", "axis": "X"}),
    "alt": ("altitude", {"standard_name": "altitude", "long_name": "altitude of the UAV",
    "units": "m", "positive": "up",
                         "axis": "Z"}),
    "platform_speed": ("speed", {"standard_name": "platform_speed_wrt_ground", "units": "m s-1",
                                 "long_name": "speed of the UAV over the ground"}),
    "platform_airspeed": ("airspeed", {"standard_name": "platform_speed_wrt_air", "units": "m s-1",
                                       "long_name": "airspeed of the UAV"}),
    "platform_course": ("course", {"standard_name": "platform_course", "units": "degree",
    "long_name": "course of the UAV"}),
    "platform_heading": ("heading", {"standard_name": "platform_orientation", "units": "degree",
    "long_name": "heading"}),
    "platform_pitch": ("pitch", {"standard_name": "platform_pitch", "units": "degree",
    "long_name": "pitch of the UAV"}),
    "platform_roll": ("roll", {"standard_name": "platform_roll", "units": "degree",
    "long_name": "roll of the UAV"}),
    "vessel_lat": ("vessel latitude", {"long_name": "latitude of the vessel",
    "units": "degrees_north"}),
    "vessel_lon": ("vessel longitude", {"long_name": "longitude of the vessel",
    "units": "degrees_east"}),
    "northward_wind": ("wind north", {"standard_name": "northward_wind", "units": "m s-1",
                                      "long_name": "northward wind as estimated on board"}),
    "eastward_wind": ("wind east", {"standard_name": "eastward_wind", "units": "m s-1",
                                    "long_name": "eastward wind as estimated on board"}),
}  # fmt: skip
"""Variables of each sample that follow from the flight on earth: what of it they are, and their
attributes.
"""

_COORDINATES = ("time", "lat", "lon", "alt")

_ESTIMATED = (
    "axis_height_estimated_m",
    "axis_height_deviation_m",
    "axis_offset_estimated_m",
    "axis_offset_deviation_m",
)
"""What a search for the plume estimates of its axis at each sample, and the standard deviations."""

_STANDARD_NAMES = {
    "so2_reading_ppb": "mole_fraction_of_sulfur_dioxide_in_air",
    "co2_reading_ppm": "mole_fraction_of_carbon_dioxide_in_air",
    "no_reading_ppb": "mole_fraction_of_nitrogen_monoxide_in_air",
    "no2_reading_ppb": "mole_fraction_of_nitrogen_dioxide_in_air",
}
"""Names of the CF conventions for columns of a time history."""

_UNCERTAINTIES = ("uncertainty", "deviation", "noise", "common", "low", "high")
"""Words by which a figure's uncertainty is called as the figure, with this word behind."""

_UDUNITS = {
    "ppb": "1e-9",
    "ppm": "1e-6",
    "% m/m": "percent",
    "% of the fuel": "percent",
    "deg": "degree",
    "degC": "degree_Celsius",
}
"""Units that the CF conventions call otherwise."""


@EXPORTERS.register("netcdf")
class NetCdf:
    """A contiguous ragged array of trajectories (CF conventions 1.8, H.4.3).

    A sample has the motion, the wind, and what the instruments read; a trajectory has what was
    found in its flight: the sulphur in the fuel with its uncertainty, and the figures of other
    instruments. What instruments fill is known from the run's ``columns.json``, a user's among
    them.
    """

    suffix = ".nc"

    def __init__(self) -> None:
        # xarray writes by h5netcdf.
        need_packages("netcdf", "xarray", "h5netcdf")

    def write(self, run: RunData, path: Path) -> None:
        """Write all flights that have a time history."""
        import xarray

        flights = list(recorded_flights(run))
        variables = {
            **_flight_variables(flights),
            **_sample_variables(flights),
            **_reading_variables(run, flights),
            **_figure_variables(run, flights),
        }
        for name, (_, _, attributes) in variables.items():
            if uncertain := _uncertainties(name, variables):
                attributes["ancillary_variables"] = " ".join(uncertain)
        data = xarray.Dataset(variables, attrs=_about(run)).set_coords([*_COORDINATES])
        encoding = {name: {"_FillValue": _fill_value(name, data[name])} for name in variables}
        del encoding["trajectory"]
        data.to_netcdf(path, engine="h5netcdf", encoding=encoding)


def _flight_variables(flights: Sequence[GeographicFlight]) -> dict[str, Variable]:
    names = np.array([flight.flight_id.encode() for flight in flights])
    sizes = np.array([len(flight.time) for flight in flights], dtype=np.int32)
    return {
        "trajectory": (_FLIGHT, names, {"cf_role": "trajectory_id", "long_name": "flight"}),
        "row_size": (
            _FLIGHT,
            sizes,
            {"sample_dimension": _SAMPLE, "long_name": "number of samples of the flight"},
        ),
        "geoid_height": (
            _FLIGHT,
            np.array([flight.geoid_height for flight in flights]),
            {
                "standard_name": "geoid_height_above_reference_ellipsoid",
                "long_name": "mean sea level above the WGS 84 ellipsoid, as given (place.geoid_m)",
                "units": "m",
            },
        ),
    }


def _sample_variables(flights: Sequence[GeographicFlight]) -> dict[str, Variable]:
    found: dict[str, Variable] = {}
    for name, (what, attributes) in _MOTION.items():
        values = np.concatenate([_motion(flight, what) for flight in flights])
        if np.isfinite(values).any():
            found[name] = (_SAMPLE, values, dict(attributes))
    # The sentences of all flights in their order; most runs have one.
    references = dict.fromkeys(flight.height_reference for flight in flights)
    found["alt"][2]["comment"] = " ".join(references)
    return found


def _reading_variables(run: RunData, flights: Sequence[GeographicFlight]) -> dict[str, Variable]:
    """Return what instruments recorded at each sample, and what a search estimated."""
    found: dict[str, Variable] = {}
    for name, column in _measured(run.columns.get(FLIGHTS, {}), flights):
        values = np.concatenate([_recorded(flight.history, name) for flight in flights])
        if np.isfinite(values).any():
            attributes = _attributes(column)
            if name in _STANDARD_NAMES:
                attributes["standard_name"] = _STANDARD_NAMES[name]
            found[name] = (_SAMPLE, column.scale * values, attributes)
    return found


def _measured(declared: Table, flights: Sequence[GeographicFlight]) -> Iterator[tuple[str, Column]]:
    """Yield the columns of time histories that an instrument fills, or a search estimates."""
    recorded = dict.fromkeys(str(name) for flight in flights for name in flight.history)
    for name in recorded:
        column = column_of({FLIGHTS: declared}, FLIGHTS, name)
        if (column.part and column.kind == "number") or name in (*_ESTIMATED, *_STANDARD_NAMES):
            yield name, column


def _recorded(history: pd.DataFrame, name: str) -> Array:
    if name not in history:
        return np.full(len(history), np.nan)
    return np.asarray(pd.to_numeric(history[name], errors="coerce"), dtype=float)


def _figure_variables(run: RunData, flights: Sequence[GeographicFlight]) -> dict[str, Variable]:
    """Return what instruments found in each flight."""
    found: dict[str, Variable] = {}
    for name, column in run.columns.get(SUMMARY, {}).items():
        values = pd.Series([flight.row.get(name) for flight in flights], dtype=object)
        if not column.part or values.isna().all():
            continue
        attributes = _attributes(column)
        if column.kind == "text":
            del attributes["units"]
            texts = np.array([str(value).encode() for value in values.fillna("")])
            found[name] = (_FLIGHT, texts, attributes)
            continue
        if column.kind == "truth":
            values = values.map({True: 1.0, False: 0.0, "True": 1.0, "False": 0.0})
        numbers = np.asarray(pd.to_numeric(values, errors="coerce"), dtype=float)
        found[name] = (_FLIGHT, column.scale * numbers, attributes)
    return found


def _attributes(column: Column) -> dict[str, Any]:
    return {"long_name": column.meaning or column.title, "units": _cf_unit(column.unit)}


def _cf_unit(unit: str) -> str:
    """Return a unit as the CF conventions write it: ``m s-1`` for ``m/s``."""
    above, _, below = unit.partition("/") if unit not in _UDUNITS else (unit, "", "")
    words = [_UDUNITS.get(word, word) for word in ([above] if above in _UDUNITS else above.split())]
    for word in below.strip("()").split():
        base, power = re.fullmatch(r"(.*?)(\d*)", word).groups()  # type: ignore[union-attr]
        words.append(f"{_UDUNITS.get(base, base)}-{power or 1}")
    return " ".join(word for word in words if word != "1") or "1"


def _uncertainties(name: str, variables: Mapping[str, Variable]) -> list[str]:
    """Return the variables that say how uncertain another one is."""
    stem = without_unit(name)
    end = name.removeprefix(stem)
    called = [f"{stem.removesuffix('_estimated')}_{word}{end}" for word in _UNCERTAINTIES]
    return [other for other in called if other in variables and other != name]


def _fill_value(name: str, values: Any) -> float | None:
    """Return what stands for a missing value; coordinates, counts and text have none."""
    return None if name in _COORDINATES or values.dtype.kind != "f" else _FILL


def _about(run: RunData) -> dict[str, str]:
    begun = run.manifest.get("begun_utc", "time not recorded")
    command = run.manifest.get("command") or "a program made the run"
    return {
        "Conventions": "CF-1.8",
        "featureType": "trajectory",
        "title": str(run.manifest.get("title", "Plume flight study")),
        "source": "simulation by plume-flight-study",
        "institution": "plume-flight-study",
        "history": f"{begun}: {command}",
        "references": "none",
        "comment": "The UAV, the vessel that it flies about, and what was measured.",
    }


def _motion(flight: GeographicFlight, what: str) -> Array:
    nothing = np.full(len(flight.time), np.nan)
    uav, vessel = flight.uav, flight.vessel
    return {
        "time": flight.start + flight.time,
        "latitude": uav.latitude,
        "longitude": uav.longitude,
        "altitude": uav.altitude,
        "speed": uav.speed,
        "airspeed": flight.airspeed,
        "course": uav.course,
        "heading": flight.heading,
        "pitch": flight.pitch,
        "roll": flight.roll,
        "vessel latitude": vessel.latitude if vessel else nothing,
        "vessel longitude": vessel.longitude if vessel else nothing,
        "wind north": flight.wind_north,
        "wind east": flight.wind_east,
    }[what]
