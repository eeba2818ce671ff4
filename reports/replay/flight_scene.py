"""The scene of one flight, from its time history."""

import math
from datetime import datetime
from typing import Any

import numpy as np
import pandas as pd

from common.hull import HULL_SHAPES
from reports.document.scene import Estimate, Event, Gas, OtherTrack, Scene
from reports.run.columns import Array, column
from reports.run.flight_config import (
    fault_marks,
    hull_of,
    is_level,
    keepout_shape,
    outline_of,
    source_height,
)
from reports.run.time_history import (
    guard_stretches,
    keepout_distance,
    shown_distances,
    true_wind,
    vessel_heading,
)
from reports.run.trials import Trial

INTERVAL = 0.2
"""Between samples of a scene, or as a time history has them if that is longer [s]."""

_PLUME_LENGTH = 3.0
"""Length of a plume without smoke that is drawn, over r_min [-]."""

_GASES = (("co2_reading_ppm", "CO2", "ppm"), ("co2_ppm", "CO2", "ppm"))
"""Columns that may colour the track, their gas and unit: CO2 is read fast enough to show a
crossing.
"""

_STRONGEST = 0.99
"""Quantile of a gas that has the strongest colour [-]."""


def flight_scene(trial: Trial, row: "pd.Series[Any]", history: pd.DataFrame | None) -> Scene | None:
    """Return the scene of one flight of a trial, given its row and its time history; None if that
    is short, or without a vessel.
    """
    if history is None or len(history) < 2 or not np.isfinite(row["keepout_radius_m"]):
        return None
    recorded = column(history, "time_s")
    if not all(
        np.isfinite(known).all()
        for known in (recorded, column(history, "vessel_north_m"), column(history, "north_m"))
    ):
        return None
    interval = max(INTERVAL, float(np.median(np.diff(recorded))))
    # Never more than the history has, even if its times are wrong.
    samples = min(len(history), int((recorded[-1] - recorded[0]) / interval + 1e-6) + 1)
    if samples < 2:
        return None
    time = recorded[0] + interval * np.arange(samples)

    def at_times(values: Array, *, angles: bool = False) -> Array:
        # A value that is not known stays what it was.
        known = np.isfinite(values)
        if not known.any():
            return np.zeros(len(time))
        curve = np.unwrap(values[known]) if angles else values[known]
        sampled: Array = np.interp(time, recorded[known], curve)
        return sampled

    def angle(name: str, instead: Array) -> Array:
        values = column(history, name)
        return at_times(values if np.isfinite(values).any() else instead, angles=True)

    vessel = {axis: at_times(column(history, f"vessel_{axis}_m")) for axis in ("north", "east")}
    places = {
        f"{prefix}{axis}": at_times(column(history, f"{prefix}{axis}_m")) - vessel[axis]
        for prefix in ("", "reference_")
        for axis in ("north", "east")
    }
    config, altitude, radius = (
        trial.flight_config(row),
        at_times(column(history, "altitude_m")),
        float(row["keepout_radius_m"]),
    )
    shape = keepout_shape(config)
    up = 0.0 if is_level(shape) else altitude - source_height(config)
    distance = np.hypot(np.hypot(places["north"], places["east"]), up)
    if shape in HULL_SHAPES.values():
        distance = at_times(keepout_distance(history, config))
    wind_north, wind_east = (at_times(values) for values in true_wind(history, row))
    past = np.hypot(
        wind_north - np.gradient(vessel["north"], interval),
        wind_east - np.gradient(vessel["east"], interval),
    )
    guard = [
        (float(recorded[first]), float(recorded[min(after, len(recorded) - 1)]), held)
        for first, after, held in guard_stretches(history)
    ]
    gas, values = _gas(history)
    flight_id = str(row["flight_id"])
    return Scene(
        start=float(time[0]),
        interval=interval,
        columns={
            **places,
            **{f"vessel_{axis}": place for axis, place in vessel.items()},
            "altitude": altitude,
            # A kinematic vehicle has neither heading nor pitch.
            "heading": angle("heading_rad", column(history, "course_rad")),
            "pitch": angle(
                "pitch_rad",
                np.arctan2(column(history, "climb_rate_mps"), column(history, "airspeed_mps")),
            ),
            "roll": at_times(column(history, "roll_rad"), angles=True),
            "vessel_heading": at_times(
                vessel_heading(history, float(config.get("vessel", {}).get("course_deg", 0.0)))
            ),
            "plume_axis": at_times(column(history, "plume_axis_rad"), angles=True),
            "airspeed": at_times(column(history, "airspeed_mps")),
            "wind_north": wind_north,
            "wind_east": wind_east,
            "apparent_drift": interval * np.cumsum(past),
            "gas": at_times(values),
        },
        utc=_utc(row),
        guard=guard,
        events=_events(row, time, distance, guard),
        crossings=column(trial.run.crossings_of(flight_id).dropna(subset="time_s"), "time_s"),
        distances=shown_distances(distance, time >= float(row["settling_time_s"]), radius),
        keepout_radius=radius,
        keepout_shape=shape,
        outline=outline_of(config) if shape in HULL_SHAPES.values() else None,
        source_height=source_height(config),
        plume_length=_PLUME_LENGTH * radius,
        plume_rise=math.tan(math.radians(float(config["plume"].get("elevation_deg", 0.0)))),
        hull=hull_of(config),
        gas=gas,
        estimate=_estimate(trial.run.evaluation(flight_id), row),
        smoke=trial.run.smoke(flight_id),
        others=[
            other
            for ship in trial.run.traffic(flight_id)
            if (other := _other_track(ship, time)) is not None
        ],
    )


def _other_track(ship: dict[str, Any], time: Array) -> OtherTrack | None:
    """Return another ship at the samples' times [s]; None where its track is not known then."""
    times, north, east = (np.asarray(ship[name], np.float64) for name in ("time", "north", "east"))
    known = np.flatnonzero((time >= times[0]) & (time <= times[-1]))
    if len(known) < 2 or len(times) < 2:
        return None
    heading = np.unwrap(np.arctan2(np.gradient(east, times), np.gradient(north, times)))
    return OtherTrack(
        str(ship["name"]),
        float(ship["radius"]),
        np.interp(time, times, north),
        np.interp(time, times, east),
        np.interp(time, times, heading),
        (int(known[0]), int(known[-1])),
    )


def _utc(row: "pd.Series[Any]") -> float | None:
    """Return the time of a flight's start since 1970 [s], or None where it is not known."""
    start = row.get("start_utc")
    return datetime.fromisoformat(start).timestamp() if isinstance(start, str) and start else None


def _events(
    row: "pd.Series[Any]", time: Array, distance: Array, guard: list[tuple[float, float, bool]]
) -> list[Event]:
    """Return what one can go to in a flight, in the order of time but for its start and end."""
    times = {
        "closest approach": float(time[int(np.argmin(distance))]),
        "settled": row.get("settling_time_s"),
        **fault_marks(row),
        "guard acts": guard[0][0] if guard else math.nan,
        "verdict": row.get("verdict_time_s"),
    }
    known = [
        Event(name, float(at))
        for name, at in times.items()
        if isinstance(at, int | float) and math.isfinite(at) and time[0] <= at <= time[-1]
    ]
    ends = [Event("start", float(time[0])), Event("end", float(time[-1]))]
    return [ends[0], *sorted(known, key=lambda event: event.time), ends[1]]


def _gas(history: pd.DataFrame) -> tuple[Gas | None, Array]:
    """Return the gas that colours the track, and its values; none of a flight without exhaust."""
    for name, gas, unit in _GASES:
        values = column(history, name)
        known = values[np.isfinite(values)]
        if len(known) and np.ptp(known) > 0.0:
            base = float(np.quantile(known, 0.05))
            above = values - base
            words = "as read" if "reading" in name else "as simulated"
            return Gas(gas, unit, float(np.quantile(known - base, _STRONGEST)), words), above
    return None, np.full(len(history), math.nan)


def _estimate(evaluation: dict[str, Any] | None, row: "pd.Series[Any]") -> Estimate | None:
    """Return how the estimate of the fuel's sulphur grew, of a flight that has one."""
    began = row.get("settling_time_s")
    if (
        evaluation is None
        or not evaluation.get("over_time")
        or not isinstance(began, int | float)
        or not math.isfinite(began)
    ):
        return None
    limits = [verdict["limit_percent"] for verdict in evaluation["estimate"]["verdicts"]]
    rows = [
        (
            began + of["elapsed_s"],
            of["fsc_percent"],
            of["low_percent"],
            of["high_percent"],
            str(of.get(f"verdict_{limits[0]:g}") or "") if limits else "",
        )
        for of in evaluation["over_time"]
        if of["fsc_percent"] is not None and math.isfinite(of["fsc_percent"])
    ]
    return Estimate(rows, limits) if rows else None
