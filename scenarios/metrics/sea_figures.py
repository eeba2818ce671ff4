"""From the record of a flight over the real sea to its row in the summary."""

import math

import numpy as np
import numpy.typing as npt

from common.numeric import rms
from gnc.sea_parameters import Mode
from scenarios.engine.task import Row
from scenarios.metrics.crossings import Crossing, find_crossings
from scenarios.metrics.keepout import keepout_figures
from scenarios.planning.sea_planner import SeaPlan
from scenarios.schema.sea_config import SeaCriteria
from scenarios.simulation.outcome import Outcome
from scenarios.simulation.sea_loop import DITCHED, SEA_COLUMNS, SeaRecord
from scenarios.world.weather import SATELLITES, VESSEL_DATA

Array = npt.NDArray[np.float64]

_GIVEN_UP = (Mode.GLIDING.value, Mode.TERMINATING.value, DITCHED)
"""Modes of a flight that is over for its task."""

SEA_SUMMARY_COLUMNS = (
    "flight_id", "trial", "outcome", "message", "criteria_met", "aircraft", "fidelity", "seed", "nu", "nu_min", "nu_max",
    "wind_speed_mps", "wind_from_deg", "vessel_speed_mps", "turbulence", "fault", "fault_time_s", "modes", "mode_at_end",
    "start_distance_m", "start_aspect_deg", "eta", "omega_0_rad_s", "keepout_radius_m", "keepout_margin_m",
    "keepout_violations", "keepout_time_s", "keepout_depth_m", "min_distance_m", "end_distance_m", "settling_time_s",
    "crossing_count", "crossing_interval_mean_s", "crossing_interval_std_s", "crossing_interval_predicted_s",
    "crossing_distance_mean_m", "crossing_distance_min_m", "tracking_error_rms_m", "tracking_error_max_m",
    "spread_m", "spread_predicted_m", "manoeuvre_end_s", "resume_time_s", "resume_periods",
    "guard_interventions", "guard_time_s", "guard_after_settling_s", "guard_lost_s",
    "wind_error_rms_mps", "vessel_error_rms_m", "vessel_error_max_m", "centre_error_rms_m", "airspeed_min_mps", "airspeed_max_mps",
    "altitude_error_max_m", "bank_max_deg", "heading_rate_command_max_rad_s", "heading_rate_limit_rad_s", "duration_s",
    "wall_time_s",
)  # fmt: skip
"""Columns of ``summary.csv`` of a trial over the real sea, in order. A figure that a flight does not have is empty."""


def sea_column(history: Array, name: str) -> Array:
    """Return one column of a flight's time history."""
    return history[:, SEA_COLUMNS.index(name)]


def sea_plan_row(plan: SeaPlan) -> Row:
    """Return the part of a row that is known once the flight is planned."""
    least, most = plan.track.apparent_wind_range
    speed = plan.guidance.centre.speed
    bearing = math.atan2(plan.start_east, plan.start_north)
    return {
        "nu": plan.nu,
        "nu_min": least / speed,
        "nu_max": most / speed,
        "start_distance_m": math.hypot(plan.start_north, plan.start_east),
        "start_aspect_deg": math.degrees(math.remainder(bearing - plan.track.axis(0.0), 2.0 * math.pi)),
        "fault_time_s": plan.fault.begins if plan.fault.kind != "none" else math.nan,
        "eta": plan.oscillation.eta,
        "omega_0_rad_s": plan.oscillation.omega_0,
        "keepout_radius_m": plan.keepout_radius,
        "keepout_margin_m": plan.margin.total,
        "spread_predicted_m": plan.margin.tracking_sigma,
        "crossing_interval_predicted_s": plan.oscillation.crossing_interval,
        "manoeuvre_end_s": plan.track.manoeuvres_end,
        "heading_rate_limit_rad_s": plan.guidance.guidance.heading_rate_max,
    }


def sea_figures(plan: SeaPlan, record: SeaRecord) -> tuple[Row, list[Crossing]]:
    """Measure a flight.

    Keep-out, guard and limits count from the first second; tracking and crossings from settling.

    Returns
    -------
    row : the measured part of the flight's row
    crossings : of the settled flight
    """
    history = record.history
    time = sea_column(history, "time_s")
    position, velocity = _in_vessel_frame(history, plan.altitude)
    keepout = keepout_figures(time, position, plan.keepout_radius)
    guarding = sea_column(history, "guard")
    sample = plan.log_interval * plan.guidance.guidance.time_step
    row: Row = {
        "outcome": record.outcome.value,
        "message": record.message,
        "modes": ", ".join(_modes(history)),
        "mode_at_end": record.mode,
        "keepout_violations": keepout.violations,
        "keepout_time_s": keepout.time_inside,
        "keepout_depth_m": keepout.depth,
        "min_distance_m": keepout.distance_min,
        "end_distance_m": float(np.linalg.norm(position[-1])),
        "settling_time_s": record.settled_at,
        "guard_interventions": len(record.interventions),
        "guard_time_s": sum(stretch.duration_s for stretch in record.interventions),
        "guard_lost_s": sample * float(np.count_nonzero(guarding > 1.0)),
        "vessel_error_max_m": float(np.max(_vessel_error(history))),
        "airspeed_min_mps": float(np.min(sea_column(history, "airspeed_mps"))),
        "airspeed_max_mps": float(np.max(sea_column(history, "airspeed_mps"))),
        "altitude_error_max_m": float(np.max(np.abs(sea_column(history, "altitude_m") - plan.altitude))),
        "bank_max_deg": math.degrees(float(np.max(np.abs(sea_column(history, "roll_rad"))))),
        "heading_rate_command_max_rad_s": float(np.max(np.abs(sea_column(history, "heading_rate_command_rad_s")))),
        "duration_s": float(time[-1]),
    }
    settled = time >= record.settled_at
    if np.count_nonzero(settled) < 2:
        return row, []
    row["guard_after_settling_s"] = sample * float(np.count_nonzero(guarding[settled] > 0.0))
    row |= _settled_figures(plan, history[settled], position[settled])
    crossings = _crossings(history[settled], position[settled], velocity[settled])
    return row | _crossing_figures(plan, crossings, history), crossings


def _in_vessel_frame(history: Array, source_height: float) -> tuple[Array, Array]:
    """Return position and velocity from the plume's origin, each shape (n, 3): north, east, up [m, m/s]."""
    up = sea_column(history, "altitude_m") - source_height
    position = [sea_column(history, f"{axis}_m") - sea_column(history, f"vessel_{axis}_m") for axis in ("north", "east")]
    velocity = [
        sea_column(history, f"velocity_{axis}_mps") - sea_column(history, f"vessel_velocity_{axis}_mps")
        for axis in ("north", "east")
    ]
    return np.column_stack([*position, up]), np.column_stack([*velocity, sea_column(history, "climb_rate_mps")])


def _modes(history: Array) -> list[str]:
    """Return the modes that a flight went through, each once, in the order of their first time."""
    names = [mode.value for mode in Mode]
    return [names[int(number)] for number in dict.fromkeys(sea_column(history, "mode").tolist())]


def _vessel_error(history: Array) -> Array:
    """Return how far the vessel is from where it is taken to be [m]."""
    return np.hypot(
        *(sea_column(history, f"vessel_seen_{axis}_m") - sea_column(history, f"vessel_{axis}_m") for axis in ("north", "east"))
    )


def _settled_figures(plan: SeaPlan, history: Array, position: Array) -> Row:
    """Measure what a flight does once it has settled."""
    to_north = sea_column(history, "reference_north_m") - sea_column(history, "north_m")
    to_east = sea_column(history, "reference_east_m") - sea_column(history, "east_m")
    distance = np.hypot(position[:, 0], position[:, 1])
    towards = (to_north * position[:, 0] + to_east * position[:, 1]) / distance
    wind = np.hypot(
        sea_column(history, "wind_north_mps") - plan.weather.wind_north,
        sea_column(history, "wind_east_mps") - plan.weather.wind_east,
    )
    return {
        "tracking_error_rms_m": rms(np.hypot(to_north, to_east)),
        "tracking_error_max_m": float(np.max(np.hypot(to_north, to_east))),
        "spread_m": float(np.std(towards)),
        "wind_error_rms_mps": rms(wind),
        "vessel_error_rms_m": rms(_vessel_error(history)),
        "centre_error_rms_m": rms(sea_column(history, "centre_error_m")),
    }


def _crossings(history: Array, position: Array, velocity: Array) -> list[Crossing]:
    """Find crossings of an axis that turns, in the frame that turns with it."""
    time, axis = sea_column(history, "time_s"), sea_column(history, "plume_axis_rad")
    axis = np.unwrap(axis)
    rate = np.gradient(axis, time)
    cos_a, sin_a = np.cos(axis), np.sin(axis)
    along = cos_a * position[:, 0] + sin_a * position[:, 1]
    across = cos_a * position[:, 1] - sin_a * position[:, 0]
    along_rate = cos_a * velocity[:, 0] + sin_a * velocity[:, 1] + rate * across
    across_rate = cos_a * velocity[:, 1] - sin_a * velocity[:, 0] - rate * along
    return find_crossings(
        time,
        np.column_stack([along, across, position[:, 2]]),
        np.column_stack([along_rate, across_rate, velocity[:, 2]]),
        (1.0, 0.0),
    )


def _predicted_interval(plan: SeaPlan, history: Array, first: float, last: float) -> float:
    """Return the mean of pi/omega_0 over a vessel's changes of course and speed, from its first crossing to its last [s].

    Where omega_0 changes with time, crossings come at the rate omega_0/pi: their number between two times is its integral.
    """
    time = np.linspace(first, last, max(2, math.ceil(last - first)))
    through_air = [
        np.interp(time, sea_column(history, "time_s"), sea_column(history, f"vessel_velocity_{axis}_mps")) - wind
        for axis, wind in zip(("north", "east"), plan.weather.wind, strict=True)
    ]
    ratio = np.hypot(*through_air) / plan.guidance.centre.speed
    steps = np.linspace(0.0, plan.guidance.speed_ratio_max, len(plan.periods))
    crossing_rate = 2.0 / np.interp(ratio, steps, plan.periods)
    return float((last - first) / np.trapezoid(crossing_rate, time))


def _crossing_figures(plan: SeaPlan, crossings: list[Crossing], history: Array) -> Row:
    row: Row = {"crossing_count": len(crossings)}
    if crossings:
        distances = [crossing.distance for crossing in crossings]
        row |= {"crossing_distance_mean_m": float(np.mean(distances)), "crossing_distance_min_m": min(distances)}
    if len(crossings) > 1:
        intervals = np.diff([crossing.time for crossing in crossings])
        row |= {"crossing_interval_mean_s": float(np.mean(intervals)), "crossing_interval_std_s": float(np.std(intervals))}
        least, most = plan.track.apparent_wind_range
        if most > least:
            row["crossing_interval_predicted_s"] = _predicted_interval(plan, history, crossings[0].time, crossings[-1].time)
    after = [crossing.time for crossing in crossings if crossing.time >= plan.track.manoeuvres_end]
    if after:
        row["resume_time_s"] = after[0] - plan.track.manoeuvres_end
        row["resume_periods"] = row["resume_time_s"] / plan.period(float(sea_column(history, "speed_ratio")[-1]))
    return row


def sea_unmet(row: Row, criteria: SeaCriteria) -> list[str]:
    """Return what a flight's row fails, each as a short sentence; empty when all is met.

    Beside the criteria every flight has to keep out, to complete, and not to be given up where nothing of the aircraft
    has failed: a false alarm would end it safely, and measure nothing.
    """
    nothing = math.nan
    broken = row["fault"] not in ("none", VESSEL_DATA, SATELLITES) and row.get("duration_s", math.inf) >= row.get(
        "fault_time_s", 0.0
    )
    limit = row["heading_rate_limit_rad_s"] * (1.0 + 1e-12)
    checks = [
        (
            row["keepout_violations"] == 0,
            f"entered the keep-out area {row['keepout_violations']} times, by {row['keepout_depth_m']:.1f} m",
        ),
        (
            row["heading_rate_command_max_rad_s"] <= limit,
            f"commanded {row['heading_rate_command_max_rad_s']:.4f} rad/s, above omega_max",
        ),
        (row["outcome"] == Outcome.COMPLETED.value, "did not complete"),
        (broken or row["mode_at_end"] not in _GIVEN_UP, f"ended {row['mode_at_end']}, though nothing of the aircraft failed"),
    ]
    if criteria.settles:
        checks.append((math.isfinite(row["settling_time_s"]), "did not settle"))
    if criteria.crossing_interval_error is not None:
        interval, predicted = row.get("crossing_interval_mean_s", nothing), row["crossing_interval_predicted_s"]
        error = interval / predicted - 1.0
        found = f"mean crossing interval {interval:.3f} s, {100.0 * error:+.1f} % of {predicted:.3f} s"
        message = "too few crossings for an interval" if math.isnan(error) else found
        checks.append((abs(error) <= criteria.crossing_interval_error, message))
    if criteria.tracking_error_rms_m is not None:
        error = row.get("tracking_error_rms_m", nothing)
        checks.append((error <= criteria.tracking_error_rms_m, f"rms tracking error {error:.2f} m"))
    if criteria.resumes_within_periods is not None:
        periods = row.get("resume_periods", nothing)
        checks.append(
            (periods <= criteria.resumes_within_periods, f"crossings resumed {periods:.2f} periods after the last manoeuvre")
        )
    if criteria.modes_at_end:
        checks.append((row["mode_at_end"] in criteria.modes_at_end, f"ended {row['mode_at_end']}"))
    return [message for met, message in checks if not met]
