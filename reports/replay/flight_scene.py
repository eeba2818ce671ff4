"""The scene of one flight, from its time history."""

from typing import Any

import numpy as np
import pandas as pd

from reports.document.scene import Scene
from reports.run.columns import Array, column
from reports.run.flight_config import Config, keepout_shape, source_height
from reports.run.plume_shape import PlumeShape, plume_shape
from reports.run.ship import hull_of
from reports.run.time_history import guard_stretches, shown_distances, true_wind, vessel_heading
from reports.run.trials import Trial

INTERVAL = 0.2
"""Between samples of a scene, or as a time history has them if that is longer [s]."""

_PLUME_LENGTH = 3.0
"""Length of the plume that is drawn, over r_min [-]."""

_CHANGED, _SHAPES_MAX = 0.1, 25
"""Change of the ship's speed or of the wind from which the plume is drawn anew [-], and how often
at most in a flight.
"""

_SLOW = 1.0
"""Speed below which changes count as those of this speed [m/s]."""


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
    # Never more than the history has, whatever its times are.
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
    up = 0.0 if keepout_shape(config) == "cylinder" else altitude - source_height(config)
    distance = np.hypot(np.hypot(places["north"], places["east"]), up)
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
        },
        guard=[
            (float(recorded[first]), float(recorded[min(after, len(recorded) - 1)]), held)
            for first, after, held in guard_stretches(history)
        ],
        crossings=column(
            trial.run.crossings_of(str(row["flight_id"])).dropna(subset="time_s"), "time_s"
        ),
        distances=shown_distances(distance, time >= float(row["settling_time_s"]), radius),
        keepout_radius=radius,
        keepout_shape=keepout_shape(config),
        source_height=source_height(config),
        hull=hull_of(config),
        plumes=_plumes(config, row, history),
    )


def _plumes(
    config: Config, row: "pd.Series[Any]", history: pd.DataFrame
) -> list[tuple[float, PlumeShape]]:
    """Return the plume's shapes in the course of a flight, each with the time from which it has it
    [s].
    """
    time = column(history, "time_s")
    north, east = (column(history, f"vessel_velocity_{axis}_mps") for axis in ("north", "east"))
    wind_north, wind_east = true_wind(history, row)
    air = np.column_stack([
        np.hypot(north, east), np.hypot(wind_north, wind_east), np.hypot(wind_north - north, wind_east - east)
    ])  # fmt: skip
    length = _PLUME_LENGTH * float(row["keepout_radius_m"])
    shapes: list[tuple[float, PlumeShape]] = []
    for sample in _changes(air):
        speed, wind, apparent = air[sample].tolist()
        shape = plume_shape(config, speed=speed, wind=wind, apparent_wind=apparent, length=length)
        if shape.smoke or not shapes or shapes[-1][1].smoke:
            shapes.append((float(time[sample]), shape))
    return shapes


def _changes(air: Array) -> list[int]:
    """Return the first sample, and each at which a speed differs by ``_CHANGED`` or, if they were
    too many, by more.
    """
    speeds = np.log(np.maximum(air, _SLOW))
    changed = _CHANGED
    while True:
        chosen = [0]
        for sample in np.flatnonzero(np.isfinite(speeds).all(axis=1)).tolist():
            if np.abs(speeds[sample] - speeds[chosen[-1]]).max() > changed:
                chosen.append(sample)
        if len(chosen) <= _SHAPES_MAX:
            return chosen
        changed *= 1.5
