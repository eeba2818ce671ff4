"""The scene of one flight, from its time history."""

import math
from typing import Any

import numpy as np
import pandas as pd

from reports.document.scene import PlumeShape, Scene
from reports.replay.plume_shape import plume_shape
from reports.run.columns import Array, column
from reports.run.trials import Trial

INTERVAL = 0.5
"""Between samples of a scene, or as a time history has them if that is longer [s]: cubics between them are good to centimetres."""

_PLUME_LENGTH = 3.0
"""Length of the plume that is drawn, over r_min [-]."""

_LENGTH, _BEAM = 4.5, 0.7
"""Length and beam of a hull over the height of its funnel [-]: an assumption, of a feeder of 155 m by 24 m and 35 m."""

_AT_REST = 0.01
"""Speed below which a vessel's heading is not that of its motion [m/s]."""


def flight_scene(trial: Trial, row: "pd.Series[Any]") -> Scene | None:
    """Return the scene of one flight of a trial, given its row; None if it has no time history, or no vessel."""
    history = trial.run.history(str(row["flight_id"]))
    if history is None or len(history) < 2 or not np.isfinite(column(history, "vessel_north_m")).all():
        return None
    recorded = column(history, "time_s")
    interval = max(INTERVAL, float(np.median(np.diff(recorded))))
    time = recorded[0] + interval * np.arange(math.floor((recorded[-1] - recorded[0]) / interval + 1e-6) + 1)

    def at_times(values: Array) -> Array:
        sampled: Array = np.interp(time, recorded, np.nan_to_num(values))
        return sampled

    def angle(name: str, instead: Array | None = None) -> Array:
        known = column(history, name)
        return at_times(np.unwrap(instead if instead is not None and np.isnan(known).any() else np.nan_to_num(known)))

    vessel = {axis: at_times(column(history, f"vessel_{axis}_m")) for axis in ("north", "east")}
    relative = {
        f"{prefix}{axis}": at_times(column(history, f"{prefix}{axis}_m")) - vessel[axis]
        for prefix in ("", "reference_")
        for axis in ("north", "east")
    }
    climb = np.arctan2(np.nan_to_num(column(history, "climb_rate_mps")), np.maximum(1.0, column(history, "airspeed_mps")))
    return Scene(
        start=float(time[0]),
        interval=interval,
        columns={
            **relative,
            **{f"vessel_{axis}": place for axis, place in vessel.items()},
            "altitude": at_times(column(history, "altitude_m")),
            "heading": angle("heading_rad", column(history, "course_rad")),
            "pitch": angle("pitch_rad", climb),
            "roll": angle("roll_rad"),
            "vessel_heading": at_times(_vessel_heading(history, float(trial.setting("vessel.course_deg", 0.0)))),
            "plume_axis": angle("plume_axis_rad"),
        },
        guard=_stretches(recorded, column(history, "guard")),
        crossings=trial.run.crossings_of(str(row["flight_id"]))["time_s"].to_numpy(dtype=np.float64),
        keepout_radius=float(row["keepout_radius_m"]),
        keepout_shape=trial.shape,
        source_height=trial.source_height,
        hull_length=_LENGTH * trial.source_height,
        hull_beam=_BEAM * trial.source_height,
        plume=_plume(trial, row, history),
    )


def _plume(trial: Trial, row: "pd.Series[Any]", history: pd.DataFrame) -> PlumeShape:
    """Return the plume's shape, in the wind and at the vessel's speed that the flight began with."""
    north, east = (float(column(history, f"vessel_velocity_{axis}_mps")[0]) for axis in ("north", "east"))
    wind, towards = float(row["wind_speed_mps"]), math.radians(float(row["wind_from_deg"])) + math.pi
    apparent = math.hypot(wind * math.cos(towards) - north, wind * math.sin(towards) - east)
    length = _PLUME_LENGTH * float(row["keepout_radius_m"])
    return plume_shape(trial.config, speed=math.hypot(north, east), wind=wind, apparent_wind=apparent, length=length)


def _vessel_heading(history: pd.DataFrame, course_deg: float) -> Array:
    """Return where the vessel's bow points at each sample, without jumps [rad]: along its motion, at rest as it was before."""
    north, east = (column(history, f"vessel_velocity_{axis}_mps") for axis in ("north", "east"))
    moving = np.hypot(north, east) > _AT_REST
    if not moving.any():
        return np.full(len(history), math.radians(course_deg))
    last = np.maximum.accumulate(np.where(moving, np.arange(len(history)), np.argmax(moving)))
    heading: Array = np.unwrap(np.arctan2(east, north)[last])
    return heading


def _stretches(time: Array, guard: Array) -> list[tuple[float, float, bool]]:
    """Return when the guard changed commands: from, to [s], and whether it held its radius, from its values 0, 1 and 2."""
    state = np.nan_to_num(guard)
    starts = np.concatenate([[0], np.flatnonzero(np.diff(state)) + 1])
    ends = np.append(starts[1:], len(state) - 1)
    return [
        (float(time[start]), float(time[end]), bool(state[start] < 2.0))
        for start, end in zip(starts, ends, strict=True)
        if state[start] > 0.0
    ]
