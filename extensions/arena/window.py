"""Figures of the end of a flight, whether it has settled or not. They compare laws that may never
settle.
"""

import math

import numpy as np

from common.columns import Column, described
from scenarios.engine.task import Row
from scenarios.flight.outcome import Outcome
from scenarios.flight.record import FlightRecord
from scenarios.measures.figures import crossings_of, in_vessel_frame, rms
from scenarios.planning.flight_plan import FlightPlan

WINDOW_COLUMNS = described(
    {
        "window_s": "time before the end of the flight over which it is evaluated",
        "error_rms_m": Column(
            "root mean square distance to the reference", title="Error rms", worse="higher"
        ),
        "error_mean_m": "mean distance to the reference",
        "error_max_m": "largest distance to the reference",
        "effort_rms_rad_s": Column(
            "root mean square commanded heading rate", title="Effort rms", digits=3, worse="higher"
        ),
        "excess_rms_rad_s": Column(
            "root mean square of the commanded heading rate less that of the reference",
            title="Excess effort",
            digits=3,
            worse="higher",
        ),
        "saturated_share": Column(
            "share of the time in which the demand was limited to omega_max",
            title="Cut commands",
            unit="%",
            scale=100.0,
            digits=1,
            worse="higher",
        ),
        "guard_share": "share of the time in which the keep-out guard changed commands",
        "crossings_per_minute": Column(
            "crossings of the plume's axis in a minute", title="Crossings", worse="lower"
        ),
        "crossing_distance_mean_m": Column(
            "mean distance of the crossings from the funnel",
            title="Crossing distance",
            digits=0,
            worse="higher",
        ),
        "window_distance_min_m": "closest approach, at the recorded samples",
        "speed_ratio_mean": "mean speed ratio through the air",
    }
)
"""Columns of ``window_figures``, in order."""

MEASURED_COLUMNS = described(
    {
        "plume_s_per_minute": Column(
            "seconds in the plume in a minute", title="In the plume", worse="lower"
        ),
        "sulphur_information_per_minute": Column(
            "1/sigma^2 of the sulphur content by noise, in a minute",
            unit="1/((% m/m)² min)",
            worse="lower",
        ),
    }
)
"""Columns of ``measured_figures``, in order."""

_SECONDS_PER_MINUTE = 60.0


def window_figures(plan: FlightPlan, record: FlightRecord, *, window: float) -> Row:
    """Measure the last ``window`` [s] of a flight beside a vessel.

    Errors are distances to the reference; the effort is the commanded heading rate, and its excess
    is the difference from the reference's heading rate.
    """
    column = record.column
    time = column("time_s")
    last = time > time[-1] - window
    error, command, reference, wind_north, wind_east, vessel_north, vessel_east = (
        values[last]
        for values in (
            np.hypot(
                column("reference_north_m") - column("north_m"),
                column("reference_east_m") - column("east_m"),
            ),
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
        "window_distance_min_m": float(np.min(np.linalg.norm(position[last], axis=1))),
        "speed_ratio_mean": float(
            np.mean(np.hypot(vessel_north - wind_north, vessel_east - wind_east))
        )
        / plan.guidance.speed,
    }
    if crossings:
        row["crossing_distance_mean_m"] = float(
            np.mean([crossing.distance for crossing in crossings])
        )
    return row


def measured_figures(row: Row, *, window: float) -> Row:
    """Return the information of a minute in the air for the measurement, from the sniffer's result
    of ``window`` [s], or of all of a shorter flight.

    The plume's is the time in which the concentration is above exp(-2) of that on its axis. Of the
    fuel's sulphur content it is the information, 1/sigma^2 by noise, the part of the standard
    uncertainty that more time takes away; the gains and zeros of the instrument are the same for
    everyone. Information adds up over time and over flights, and is 0 where a result is not
    admitted (quality C) or lost with the aircraft, and not a number where the sniffer has no noise;
    its mean over flights, to the power of
    -1/2, is the standard uncertainty by noise of a minute.
    """
    if "seconds_in_plume_s" not in row:
        return {}
    minutes, noise = (
        min(window, row["duration_s"]) / _SECONDS_PER_MINUTE,
        float(row.get("fsc_noise_percent", math.nan)),
    )
    admitted = (
        row["sulphur_quality"] != "C"
        and noise >= 0.0
        and row["outcome"] != Outcome.AIRCRAFT_LOST.value
    )
    information = 0.0
    if admitted:
        information = 1.0 / (noise**2 * minutes) if noise else math.nan
    return {
        "plume_s_per_minute": row["seconds_in_plume_s"] / minutes,
        "sulphur_information_per_minute": information,
    }
