"""A flight beside a vessel at a place on earth, and how far from it an export is."""

import math

import numpy as np
import pandas as pd

from reports.build import export_run

PLACES = {"kattegat": (57.2, 11.3), "date line": (-16.0, 179.997)}
"""Where the flight is [deg]; the second one goes over the date line."""

START = 1780308000.0
"""2026-06-01T10:00:00Z (date -u -d ... +%s)."""

TOLERANCE = 0.1
"""How far places may be off what they are [m]."""


def track():
    """Return a flight in circles about a vessel that sails north-east, as a run records it."""
    time = 0.1 * np.arange(601)
    angle = 0.1 * time
    vessel = {"vessel_north_m": 5.0 * time, "vessel_east_m": 6.0 * time}
    return pd.DataFrame({
        "time_s": time, "north_m": 300.0 * np.sin(angle) + vessel["vessel_north_m"],
        "east_m": 300.0 * (1.0 - np.cos(angle)) + 250.0 + vessel["vessel_east_m"],
        "velocity_north_mps": 30.0 * np.cos(angle) + 5.0, "velocity_east_mps": 30.0 * np.sin(angle) + 6.0,
        **vessel, "vessel_velocity_north_mps": 5.0, "vessel_velocity_east_mps": 6.0, "plume_axis_rad": math.radians(230.0),
        "altitude_m": 60.0 + np.sin(time), "altitude_command_m": 60.0, "airspeed_mps": 30.0, "climb_rate_mps": np.cos(time),
        "heading_rad": angle % math.tau, "pitch_rad": 0.05, "roll_rad": 0.5, "throttle": 0.4,
    })  # fmt: skip


def off(found, true):
    """Return the largest distance of places [deg] from where they are [m]."""
    found, true = np.asarray(found, dtype=float), np.asarray(true, dtype=float)
    metres = math.radians(1.0) * 6.4e6
    east = (found[:, 1] - true[:, 1] + 180.0) % 360.0 - 180.0
    return metres * np.hypot(found[:, 0] - true[:, 0], east * np.cos(np.radians(true[:, 0]))).max()


def exported(run_path, name):
    (path,) = export_run(run_path, name)
    assert path.parent == run_path / "export"
    return path


READ = {"so2_reading_ppb": 12.3, "co2_reading_ppm": 431.25, "no_reading_ppb": 80.0}
"""Columns of a sniffer that has no NO2, and by how much each rises over the flight; before 1 s
there is no reading.
"""


def read():
    """Return what was read at each sample, as a time history has it."""
    time = track()["time_s"].to_numpy()
    return {
        name: np.where(time < 1.0, math.nan, rise * np.floor(time) / 60.0)
        for name, rise in READ.items()
    }


def assert_read(found, name):
    """Readings are exported to six digits, or to a thousandth."""
    np.testing.assert_allclose(
        np.array(found, dtype=float), read()[name], rtol=1e-5, atol=1e-3, err_msg=name
    )
