"""Figures of the end of a flight, whether it has settled or not: by them laws are compared that may never settle."""

import numpy as np

from common.numeric import rms
from scenarios.engine.task import Row
from scenarios.metrics.figures import crossings_of, in_vessel_frame
from scenarios.planning.flight_plan import FlightPlan
from scenarios.simulation.record import FlightRecord

WINDOW_COLUMNS = (
    "window_s", "error_rms_m", "error_mean_m", "error_max_m", "effort_rms_rad_s", "excess_rms_rad_s", "saturated_share",
    "guard_share", "crossings_per_minute", "plume_s_per_minute", "crossing_distance_mean_m", "window_distance_min_m",
    "speed_ratio_mean",
)  # fmt: skip
"""Of ``window_figures``, in order."""

_SECONDS_PER_MINUTE = 60.0


def window_figures(plan: FlightPlan, record: FlightRecord, *, window: float, plume_half_width: float) -> Row:
    """Measure the last ``window`` [s] of a flight beside a vessel.

    Errors are distances to the reference; the effort is the heading rate that was commanded, and its excess is what it differs from
    the reference's own. A flight is in the plume within ``plume_half_width`` [m] of the axis, on the plume's side.
    """
    column = record.column
    time = column("time_s")
    last = time > time[-1] - window
    error, command, reference, wind_north, wind_east, vessel_north, vessel_east = (
        values[last]
        for values in (
            np.hypot(column("reference_north_m") - column("north_m"), column("reference_east_m") - column("east_m")),
            column("heading_rate_command_rad_s"),
            column("reference_heading_rate_rad_s"),
            column("wind_north_mps"),
            column("wind_east_mps"),
            column("vessel_velocity_north_mps"),
            column("vessel_velocity_east_mps"),
        )
    )
    position, velocity = in_vessel_frame(record, plan.source_height)
    crossings = crossings_of(plan, record, last, position, velocity)
    axis = column("plume_axis_rad")[last]
    north, east = position[last, 0], position[last, 1]
    along, across = north * np.cos(axis) + east * np.sin(axis), east * np.cos(axis) - north * np.sin(axis)
    minutes = float(time[-1] - time[last][0]) / _SECONDS_PER_MINUTE
    row: Row = {
        "window_s": minutes * _SECONDS_PER_MINUTE,
        "error_rms_m": rms(error),
        "error_mean_m": float(np.mean(error)),
        "error_max_m": float(np.max(error)),
        "effort_rms_rad_s": rms(command),
        "excess_rms_rad_s": rms(command - reference),
        "saturated_share": float(np.mean(column("command_saturated")[last])),
        "guard_share": float(np.mean(column("guard")[last] > 0.0)),
        "crossings_per_minute": len(crossings) / minutes,
        "plume_s_per_minute": _SECONDS_PER_MINUTE * float(np.mean((np.abs(across) < plume_half_width) & (along > 0.0))),
        "window_distance_min_m": float(np.min(np.linalg.norm(position[last], axis=1))),
        "speed_ratio_mean": float(np.mean(np.hypot(vessel_north - wind_north, vessel_east - wind_east))) / plan.guidance.speed,
    }
    if crossings:
        row["crossing_distance_mean_m"] = float(np.mean([crossing.distance for crossing in crossings]))
    return row
