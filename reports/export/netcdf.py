"""CF netCDF of trajectories, all flights one after the other; needs the extra ``export`` (xarray,
h5netcdf).
"""

from pathlib import Path
from typing import Any

import numpy as np

from reports.export.exporter import EXPORTERS, need_packages
from reports.export.geographic import GeographicFlight, recorded_flights
from reports.run.run_data import RunData

_OBSERVED: dict[str, tuple[str, dict[str, str]]] = {
    "time": ("time", {"standard_name": "time", "long_name": "time", "calendar": "standard", "axis": "T",
                      "units": "seconds since 1970-01-01T00:00:00Z"}),
    "lat": ("latitude", {"standard_name": "latitude", "long_name": "latitude of the UAV", "units": "degrees_north", "axis": "Y"}),
    "lon": ("longitude", {"standard_name": "longitude", "long_name": "longitude of the UAV", "units": "degrees_east", "axis": "X"}),
    "alt": ("altitude", {"standard_name": "altitude", "long_name": "altitude of the UAV", "units": "m", "positive": "up",
                         "axis": "Z"}),
    "platform_speed": ("speed", {"standard_name": "platform_speed_wrt_ground", "units": "m s-1",
                                 "long_name": "speed of the UAV over the ground"}),
    "platform_airspeed": ("airspeed", {"standard_name": "platform_speed_wrt_air", "units": "m s-1",
                                       "long_name": "airspeed of the UAV"}),
    "platform_course": ("course", {"standard_name": "platform_course", "units": "degree", "long_name": "course of the UAV"}),
    "platform_heading": ("heading", {"standard_name": "platform_orientation", "units": "degree", "long_name": "heading"}),
    "platform_pitch": ("pitch", {"standard_name": "platform_pitch", "units": "degree", "long_name": "pitch of the UAV"}),
    "platform_roll": ("roll", {"standard_name": "platform_roll", "units": "degree", "long_name": "roll of the UAV"}),
    "vessel_lat": ("vessel latitude", {"long_name": "latitude of the vessel", "units": "degrees_north"}),
    "vessel_lon": ("vessel longitude", {"long_name": "longitude of the vessel", "units": "degrees_east"}),
}  # fmt: skip
"""Variables of each sample: what of the flight they are, and their attributes."""

_COORDINATES = ("time", "lat", "lon", "alt")


@EXPORTERS.register("netcdf")
class NetCdf:
    """A contiguous ragged array of trajectories (CF conventions 1.8, H.4.3)."""

    suffix = ".nc"

    def __init__(self) -> None:
        # xarray writes by h5netcdf.
        need_packages("netcdf", "xarray", "h5netcdf")

    def write(self, run: RunData, path: Path) -> None:
        """Write all flights that have a time history."""
        import xarray

        flights = list(recorded_flights(run))
        names = np.array([flight.flight_id.encode() for flight in flights])
        variables: dict[str, Any] = {
            "trajectory": (
                "trajectory",
                names,
                {"cf_role": "trajectory_id", "long_name": "flight"},
            ),
            "row_size": (
                "trajectory",
                np.array([len(flight.time) for flight in flights], dtype=np.int32),
                {"sample_dimension": "obs", "long_name": "number of samples of the flight"},
            ),
        }
        for name, (what, attributes) in _OBSERVED.items():
            values = np.concatenate([_values(flight, what) for flight in flights])
            if np.isfinite(values).any():
                variables[name] = ("obs", values, attributes)
        data = xarray.Dataset(variables, attrs=_about(run)).set_coords([*_COORDINATES])
        encoding: dict[str, dict[str, Any]] = {
            name: {"_FillValue": None} for name in (*_COORDINATES, "row_size")
        }
        encoding |= {
            name: {"_FillValue": -9999.0}
            for name in variables
            if name in _OBSERVED and name not in _COORDINATES
        }
        data.to_netcdf(path, engine="h5netcdf", encoding=encoding)


def _about(run: RunData) -> dict[str, str]:
    begun, command = (
        run.manifest.get("begun_utc", "time not recorded"),
        run.manifest.get("command") or "a program made the run",
    )
    return {
        "Conventions": "CF-1.8",
        "featureType": "trajectory",
        "title": str(run.manifest.get("title", "Plume flight study")),
        "source": "simulation by plume-flight-study",
        "institution": "plume-flight-study",
        "history": f"{begun}: {command}",
        "references": "none",
        "comment": "The UAV and the vessel that it flies about.",
    }


def _values(flight: GeographicFlight, what: str) -> np.ndarray[Any, np.dtype[np.float64]]:
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
    }[what]
