"""From a flight's record to its row in the summary."""

import math

import numpy as np
import numpy.typing as npt

from common.numeric import rms
from scenarios.engine.task import Row
from scenarios.metrics.crossings import Crossing, find_crossings
from scenarios.metrics.keepout import keepout_figures
from scenarios.planning.planner import FlightPlan, Mission
from scenarios.schema.config import Criteria
from scenarios.simulation.closed_loop import COLUMNS, FlightRecord
from scenarios.world.steady_vessel import Vessel

Array = npt.NDArray[np.float64]

SUMMARY_COLUMNS = (
    "flight_id", "outcome", "message", "criteria_met", "aircraft", "fidelity", "seed", "nu", "plume_heading_deg",
    "plume_elevation_deg", "eta", "omega_0_rad_s", "oscillation_limit", "r_co_m", "keepout_radius_m", "keepout_violations",
    "keepout_time_s", "keepout_depth_m", "min_distance_m", "crossing_count", "crossing_interval_mean_s", "crossing_interval_std_s",
    "crossing_interval_predicted_s", "crossing_distance_mean_m", "crossing_distance_min_m", "crossing_angle_mean_deg",
    "settling_time_s", "tracking_error_rms_m", "tracking_error_max_m", "tracking_error_end_m", "airspeed_error_rms_mps",
    "airspeed_error_max_mps", "airspeed_trim_rms_mps", "altitude_error_rms_m", "altitude_error_max_m",
    "heading_rate_error_rms_rad_s", "heading_rate_wanted_max_rad_s", "heading_rate_command_max_rad_s",
    "heading_rate_limit_rad_s", "heading_rate_bound_rad_s", "heading_rate_flown_max_rad_s", "epsilon_per_m", "look_ahead_m",
    "steering_max_rad_s", "speed_max_mps", "bank_max_deg", "saturation_fraction", "guard_interventions", "guard_time_s",
    "duration_s", "wall_time_s",
)  # fmt: skip
"""Columns of ``summary.csv``, in order. A figure that a flight does not have is empty."""


def column(history: Array, name: str) -> Array:
    """Return one column of a flight's time history."""
    return history[:, COLUMNS.index(name)]


def relative_motion(vessel: Vessel, history: Array) -> tuple[Array, Array]:
    """Return position and velocity from the plume's origin, each shape (n, 3): north, east, up [m, m/s]."""
    time = column(history, "time_s")
    v_north, v_east = vessel.velocity_ned
    position = np.column_stack([
        column(history, "north_m") - v_north * time,
        column(history, "east_m") - v_east * time,
        column(history, "altitude_m") - vessel.source_height,
    ])  # fmt: skip
    velocity = np.column_stack([
        column(history, "velocity_north_mps") - v_north,
        column(history, "velocity_east_mps") - v_east,
        column(history, "climb_rate_mps"),
    ])  # fmt: skip
    return position, velocity


def settling_index(distance: Array, band: float) -> int | None:
    """Return the first sample from which ``distance`` stays below ``band``, or None."""
    outside = np.nonzero(distance >= band)[0]
    first = int(outside[-1]) + 1 if len(outside) else 0
    return first if first < len(distance) else None


def plan_row(plan: FlightPlan) -> Row:
    """Return the part of a row that is known once the flight is planned."""
    row: Row = {
        "heading_rate_limit_rad_s": plan.heading_rate_max,
        "heading_rate_bound_rad_s": plan.steering.bound if math.isfinite(plan.steering.bound) else math.nan,
        "epsilon_per_m": plan.steering.look_ahead.epsilon,
        "look_ahead_m": plan.steering.look_ahead.radius,
        "steering_max_rad_s": plan.steering.steering_max,
    }
    mission = plan.mission
    if mission is None:
        return row
    return row | {
        "nu": mission.nu,
        "plume_heading_deg": math.degrees(mission.vessel.plume_heading),
        "plume_elevation_deg": math.degrees(mission.vessel.plume_elevation),
        "eta": mission.oscillation.eta,
        "omega_0_rad_s": mission.oscillation.omega_0,
        "oscillation_limit": mission.oscillation.limit,
        "r_co_m": mission.centre_distance,
        "keepout_radius_m": mission.keepout_radius,
        "crossing_interval_predicted_s": mission.oscillation.crossing_interval,
    }


def flight_figures(plan: FlightPlan, record: FlightRecord) -> tuple[Row, list[Crossing]]:
    """Measure a flight.

    Keep-out and heading-rate commands count from the first second; tracking, airspeed, altitude and crossings from settling.

    Returns
    -------
    row : the measured part of the flight's row
    crossings : of the settled flight
    """
    history = record.history
    time = column(history, "time_s")
    to_reference = np.hypot(
        column(history, "reference_north_m") - column(history, "north_m"),
        column(history, "reference_east_m") - column(history, "east_m"),
    )
    row: Row = {
        "outcome": record.outcome.value,
        "message": record.message,
        "tracking_error_end_m": float(to_reference[-1]),
        "heading_rate_wanted_max_rad_s": record.heading_rate_wanted_max,
        "heading_rate_command_max_rad_s": record.heading_rate_command_max,
        "heading_rate_flown_max_rad_s": float(np.max(np.abs(column(history, "heading_rate_rad_s")))),
        "speed_max_mps": float(np.max(np.hypot(column(history, "velocity_north_mps"), column(history, "velocity_east_mps")))),
        "bank_max_deg": math.degrees(float(np.max(np.abs(column(history, "roll_rad"))))),
        "saturation_fraction": record.saturation_fraction,
        "duration_s": float(time[-1]),
    }
    first = settling_index(to_reference, plan.settling_band)
    settled = slice(first, None) if first is not None and first <= len(time) - 2 else None
    if settled is not None:
        row |= _settled_figures(plan, history[settled], to_reference[settled])
    if plan.mission is None:
        return row, []
    if plan.mission.guard:
        row |= {"guard_interventions": record.guard_interventions, "guard_time_s": record.guard_time}
    figures, crossings = _mission_figures(plan.mission, history, settled)
    return row | figures, crossings


def _settled_figures(plan: FlightPlan, history: Array, to_reference: Array) -> Row:
    """Measure what a flight does once it has settled."""
    airspeed_error = column(history, "airspeed_mps") - column(history, "airspeed_command_mps")
    altitude_error = column(history, "altitude_m") - plan.altitude
    heading_rate_error = column(history, "heading_rate_rad_s") - column(history, "reference_heading_rate_rad_s")
    return {
        "settling_time_s": float(column(history, "time_s")[0]),
        "tracking_error_rms_m": rms(to_reference),
        "tracking_error_max_m": float(np.max(to_reference)),
        "airspeed_error_rms_mps": rms(airspeed_error),
        "airspeed_error_max_mps": float(np.max(np.abs(airspeed_error))),
        "airspeed_trim_rms_mps": rms(column(history, "airspeed_command_mps") - plan.reference.speed),
        "altitude_error_rms_m": rms(altitude_error),
        "altitude_error_max_m": float(np.max(np.abs(altitude_error))),
        "heading_rate_error_rms_rad_s": rms(heading_rate_error),
    }


def _mission_figures(mission: Mission, history: Array, settled: slice | None) -> tuple[Row, list[Crossing]]:
    """Measure the keep-out area over the whole flight, and the crossings once it has settled."""
    time = column(history, "time_s")
    position, velocity = relative_motion(mission.vessel, history)
    keepout = keepout_figures(time, position, mission.keepout_radius)
    row: Row = {
        "keepout_violations": keepout.violations,
        "keepout_time_s": keepout.time_inside,
        "keepout_depth_m": keepout.depth,
        "min_distance_m": keepout.distance_min,
    }
    if settled is None:
        return row, []
    crossings = find_crossings(
        time[settled], position[settled], velocity[settled], mission.vessel.plume_direction_ned, mission.vessel.plume_elevation
    )
    row["crossing_count"] = len(crossings)
    if crossings:
        distances = [crossing.distance for crossing in crossings]
        row |= {
            "crossing_distance_mean_m": float(np.mean(distances)),
            "crossing_distance_min_m": min(distances),
            "crossing_angle_mean_deg": math.degrees(float(np.mean([crossing.angle for crossing in crossings]))),
        }
    if len(crossings) > 1:
        intervals = np.diff([crossing.time for crossing in crossings])
        row |= {
            "crossing_interval_mean_s": float(np.mean(intervals)),
            "crossing_interval_std_s": float(np.std(intervals)),
        }
    return row, crossings


def unmet_criteria(row: Row, criteria: Criteria) -> list[str]:
    """Return what a completed flight's row fails, each as a short sentence; empty when all is met."""
    omega_max, wanted = row["heading_rate_limit_rad_s"], row["heading_rate_wanted_max_rad_s"]
    limit = omega_max * (1.0 + 1e-12)
    checks = []
    if "keepout_violations" in row:
        checks += _mission_checks(row, criteria)
    if criteria.settles:
        checks += [
            _at_most("rms tracking error", row.get("tracking_error_rms_m"), criteria.tracking_error_rms_m, "m"),
            _at_most("rms airspeed error", row.get("airspeed_error_rms_mps"), criteria.airspeed_error_rms_mps, "m/s"),
            _at_most("largest altitude error", row.get("altitude_error_max_m"), criteria.altitude_error_max_m, "m"),
        ]
    if criteria.tracking_error_end_m is not None:
        checks.append(_at_most("tracking error at the end", row.get("tracking_error_end_m"), criteria.tracking_error_end_m, "m"))
    if criteria.law_beyond_heading_rate_max:
        checks.append((wanted > omega_max, f"the law asked for {wanted:.4f} rad/s, within omega_max = {omega_max:.4f}"))
    else:
        command = row["heading_rate_command_max_rad_s"]
        checks.append((command <= limit, f"commanded {command:.4f} rad/s, above omega_max = {omega_max:.4f}"))
    if criteria.law_within_heading_rate_max:
        checks.append((wanted <= limit, f"the law asked for {wanted:.4f} rad/s, above omega_max = {omega_max:.4f}"))
    return [message for met, message in checks if not met]


def _mission_checks(row: Row, criteria: Criteria) -> list[tuple[bool, str]]:
    interval, predicted = row.get("crossing_interval_mean_s", math.nan), row["crossing_interval_predicted_s"]
    checks = [
        (row["keepout_violations"] == 0, f"entered the keep-out area {row['keepout_violations']} times"),
        (
            row.get("crossing_distance_min_m", -math.inf) >= row["keepout_radius_m"],
            f"crossed at {row.get('crossing_distance_min_m', math.nan):.2f} m, inside {row['keepout_radius_m']:g} m",
        ),
        (
            abs(interval / predicted - 1.0) <= criteria.crossing_interval_error,
            f"mean crossing interval {interval:.3f} s against {predicted:.3f} s",
        ),
    ]
    for name, key, unit, limits in (
        ("interval", "crossing_interval_mean_s", "s", criteria.crossing_interval_s),
        ("distance", "crossing_distance_mean_m", "m", criteria.crossing_distance_m),
    ):
        if limits is not None:
            value = row.get(key, math.nan)
            message = f"mean crossing {name} {value:.3f} {unit} outside {limits[0]:g} to {limits[1]:g} {unit}"
            checks.append((limits[0] <= value <= limits[1], message))
    return checks


def _at_most(name: str, value: float | None, limit: float, unit: str) -> tuple[bool, str]:
    if value is None:
        return False, f"{name} is unknown: the flight never settled"
    return value <= limit, f"{name} {value:.2f} {unit} above {limit:g} {unit}"
