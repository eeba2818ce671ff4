"""One flight beside a ship of a patrol: where it begins, its phases, and what is taken from its
row.
"""

import math
from collections.abc import Iterator

import numpy as np
import pandas as pd

from gnc.mission.mission import Mode
from scenarios.engine.task import Row
from scenarios.studies.patrol.legs import Air, Leg, Mover
from scenarios.studies.patrol.tables import APPROACH, LEAVING, MEASURING, SEARCHING, verdict_of

_TAKEN = (
    "fsc_percent", "orbit_at_s", "time_to_find_s", "settling_time_s", "enough", "outcome", "message", "keepout_violations",
    "min_distance_m", "altitude_outside_s", "kept_out",
)  # fmt: skip
"""Columns of a flight's row that a ship's has, too."""


def start_beside(ship: Mover, course: float, last: Leg, air: Air) -> dict[str, object]:
    """Return where a flight beside a ship on a course [rad] begins, as keys of its scenario: at the
    end of the way to her.
    """
    place = (last.end - ship.at(last.ends)) * complex(math.cos(course), -math.sin(course))
    return {
        "start.place_m": (place.real, place.imag),
        "start.course_deg": math.degrees(last.course(air)),
    }


def taken(row: Row) -> Row:
    """Return what a ship's row takes from that of the flight beside her."""
    return {name: row[name] for name in _TAKEN if name in row} | {"verdict": verdict_of(row)}


def phases(row: Row, history: pd.DataFrame) -> Iterator[tuple[str, int, int]]:
    """Yield the phases of a flight, each with the numbers of its first and its last sample."""
    time = history["time_s"].to_numpy(np.float64)
    leaving = np.flatnonzero(history["mode"].to_numpy() == Mode.DEPARTING.number)
    end = len(time) - 1
    orbit = _sample(time, row.get("orbit_at_s", math.inf))
    found = _sample(time, row.get("orbit_at_s", math.inf) + row.get("time_to_find_s", math.inf))
    left = int(leaving[0]) if len(leaving) else end
    edges = np.minimum.accumulate([end, left, found, orbit, 0])[::-1].tolist()
    for i, phase in enumerate((APPROACH, SEARCHING, MEASURING, LEAVING)):
        if edges[i + 1] > edges[i]:
            yield phase, edges[i], edges[i + 1]


def _sample(time: np.ndarray[tuple[int], np.dtype[np.float64]], at: float) -> int:
    """Return the number of the sample at a time, the last one's if it is later [s]."""
    return min(int(np.searchsorted(time, at)), len(time) - 1)
