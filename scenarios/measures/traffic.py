"""Measures how near a flight came to ships other than the measured one."""

import json
import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from common.premises import TRAFFIC_TERM, ratio_column, time_column
from gnc.mission.mission import Mode
from scenarios.engine.task import Row
from scenarios.flight.record import FlightRecord
from scenarios.flight.traffic_belief import TrafficBelief
from scenarios.instruments.sniffer import INSIDE, PLACE_COLUMNS, fraction_of_axis
from scenarios.measures.keepout import keepout_figures
from scenarios.planning.flight_plan import FlightPlan
from scenarios.world.traffic import OtherShip

Array = npt.NDArray[np.float64]

_TRACK_INTERVAL = 2.0
"""Time between the recorded places of another ship [s]: maps draw its track by them."""

_SHOWN = 6000.0
"""Distance from the measured ship up to which another one is recorded [m]."""


class _Approach(NamedTuple):
    """How near a path came to a ship: its row of the table, and the distance beyond its radius
    [m].
    """

    row: Row
    clearance: float


def traffic_rows(plan: FlightPlan, record: FlightRecord) -> list[Row]:
    """Return a row for each of the other ships whose track is known during the flight."""
    return [approach.row for approach in _approaches(plan, record)]


def traffic_figures(plan: FlightPlan, record: FlightRecord) -> Row:
    """Return the figures of the nearest of the other ships, and the premise of all; nothing without
    other ships.
    """
    if plan.world is None or not plan.world.traffic:
        return {}
    step = plan.log_interval * plan.time_step
    yielded = np.count_nonzero(record.column("mode") == Mode.YIELDING.number)
    row: Row = {"others_violations": 0, "yielded_s": step * float(yielded)}
    approaches = _approaches(plan, record)
    if approaches:
        nearest = min(approaches, key=lambda of: of.clearance)
        row |= {
            "others_nearest": nearest.row["ship"],
            "others_distance_min_m": nearest.row["distance_min_m"],
            "others_clearance_min_m": nearest.clearance,
            "others_violations": sum(of.row["violations"] for of in approaches),
        }
    return row


def traffic_premise(record: FlightRecord) -> Row:
    """Return the largest ratio of the premise that other ships are within their discs, and its
    time.
    """
    (name,) = TrafficBelief.COLUMNS
    if name not in record.columns:
        return {}
    ratios = record.column(name)
    if not np.isfinite(ratios).any():
        return {ratio_column(TRAFFIC_TERM): math.nan, time_column(TRAFFIC_TERM): math.nan}
    i = int(np.nanargmax(ratios))
    return {
        ratio_column(TRAFFIC_TERM): float(ratios[i]),
        time_column(TRAFFIC_TERM): float(record.column("time_s")[i]),
    }


def traffic_record(plan: FlightPlan, duration: float) -> bytes | None:
    """Return names, radii and tracks of the other ships near the measured one as JSON; None without
    any.

    Parameters
    ----------
    plan : the flight
    duration : of the flight [s]
    """
    if plan.world is None or not plan.world.traffic:
        return None
    vessel = plan.world.vessel
    ships: list[dict[str, Any]] = []
    for ship in plan.world.traffic:
        times = np.arange(0.0, duration + _TRACK_INTERVAL, _TRACK_INTERVAL)
        times = times[(times >= ship.begins) & (times <= ship.ends)]
        if not len(times):
            continue
        places = _motion(ship, times)[:, :2]
        measured = np.array([vessel.motion(time)[:2] for time in times.tolist()])
        if float(np.hypot(*(places - measured).T).min()) > _SHOWN:
            continue
        ships.append(
            {
                "name": ship.name,
                "radius": ship.radius,
                "time": times.tolist(),
                "north": np.round(places[:, 0], 2).tolist(),
                "east": np.round(places[:, 1], 2).tolist(),
            }
        )
    return json.dumps({"ships": ships}, separators=(",", ":")).encode()


def _approaches(plan: FlightPlan, record: FlightRecord) -> list[_Approach]:
    """Return how near a path came to each of the other ships."""
    if plan.world is None:
        return []
    column = record.column
    time = column("time_s")
    path = np.column_stack(
        [
            column("north_m"),
            column("east_m"),
            column("velocity_north_mps"),
            column("velocity_east_mps"),
        ]
    )
    approaches = []
    for ship in plan.world.traffic:
        known = (time >= ship.begins) & (time <= ship.ends)
        if np.count_nonzero(known) < 2:
            continue
        relative = path[known] - _motion(ship, time[known])
        position, velocity = (
            np.column_stack([part, np.zeros(len(part))])
            for part in (relative[:, :2], relative[:, 2:])
        )
        found = keepout_figures(time[known], position, velocity, ship.radius, "cylinder")
        nearest = int(np.argmin(np.hypot(*relative[:, :2].T)))
        row: Row = {
            "ship": ship.name,
            "radius_m": ship.radius,
            "distance_min_m": found.distance_min,
            "time_s": float(time[known][nearest]),
            "violations": found.violations,
            "time_inside_s": found.time_inside,
            "plume_s": _time_in_plume(plan, record, ship),
        }
        approaches.append(_Approach(row, found.distance_min - ship.radius))
    return approaches


def _time_in_plume(plan: FlightPlan, record: FlightRecord, ship: OtherShip) -> float:
    """Return the time in the plume of a ship [s]; NaN for a ship without emissions."""
    if ship.exhaust is None:
        return math.nan
    path = (record.column(name) for name in ("time_s", *PLACE_COLUMNS))
    inside = fraction_of_axis(ship.exhaust.sample(*path)) > INSIDE
    return plan.log_interval * plan.time_step * float(np.count_nonzero(inside))


def _motion(ship: OtherShip, times: Array) -> Array:
    """Return place and velocity of a ship at some times, shape (n, 4) [m, m/s]."""
    return np.array([ship.track.motion(time) for time in times.tolist()])
