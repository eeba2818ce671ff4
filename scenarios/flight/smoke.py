"""The smoke in a flight's replay: the parcels of the realisation in which it was flown."""

import json
from typing import Any

import numpy as np

from measurement.plume.fluctuating_plume import FluctuatingPlume
from scenarios.world.plume import Exhaust

LENGTH = 3.0
"""Length of the plume that is recorded, over r_min [-]."""

_SPACING = 6.0
"""Approximate distance between recorded parcels [m], of the order of their spreads near the
keep-out area.
"""


def smoke_record(exhaust: Exhaust | None, duration: float, radius: float) -> bytes | None:
    """Return the parcels that were in the air during a flight as JSON, or None without such smoke.

    Parameters
    ----------
    exhaust : of the flight's vessel, or None
    duration : of the flight [s]
    radius : r_min [m]

    Notes
    -----
    Keys are the fields of ``PlumeLine``, with the times of emission as ``first`` and ``step`` [s].
    ``drift_north`` and ``drift_east`` are the drift of the air over the ground at the time of each
    emission [m].
    """
    if exhaust is None or not isinstance(exhaust.dispersion, FluctuatingPlume):
        return None
    line = exhaust.dispersion.line(duration, length=LENGTH * radius, spacing=_SPACING)
    drift_north, drift_east = exhaust.displacement(line.emitted)
    metres = {
        "north": line.north, "east": line.east, "wind": line.wind, "drift_north": drift_north,
        "drift_east": drift_east,
    }  # fmt: skip
    record: dict[str, Any] = {
        "first": float(line.emitted[0]),
        "step": line.step,
        "age_max": line.age_max,
        **{name: np.round(values, 2).tolist() for name, values in metres.items()},
        "across": np.round(line.across, 3).tolist(),
        "up": np.round(line.up, 3).tolist(),
        "winds": line.winds.tolist(),
        "table": np.round(line.table, 2).tolist(),
    }
    return json.dumps(record, separators=(",", ":")).encode()
