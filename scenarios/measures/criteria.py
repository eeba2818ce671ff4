"""What a flight fails of its criteria."""

import math

from scenarios.engine.task import Row
from scenarios.flight.outcome import Outcome
from scenarios.scenario.sections.flight import CriteriaConfig
from scenarios.world.faults import NOT_OF_AIRCRAFT

_ROUNDING = 1.0 + 1e-12
"""By what a command may exceed its limit: rounding alone [-]."""

Check = tuple[bool, str]
"""Whether a criterion is met, and what to say where it is not."""


def failed_criteria(row: Row, criteria: CriteriaConfig) -> list[str]:
    """Return what a flight's row fails, each as a short sentence; empty when all is met.

    Beside the criteria every flight has to keep out and to complete: an aircraft that is lost meets
    nothing, also where its fault is flown on purpose.
    """
    checks = [_keeps_out(row)] if "keepout_violations" in row else []
    if row["outcome"] != Outcome.COMPLETED.value:
        checks.append((False, row["message"] or "did not complete"))
        if row["outcome"] == Outcome.AIRCRAFT_LOST.value:
            checks.append((_part_failed(row), "nothing of the aircraft had failed"))
    else:
        checks += [*_tracking_checks(row, criteria), *_command_checks(row, criteria)]
        if "keepout_violations" in row:
            checks += [*_crossing_checks(row, criteria), *_mission_checks(row, criteria)]
    return [message for met, message in checks if not met]


def kept_out(row: Row) -> bool:
    """Return whether a flight is known to have kept out of the keep-out area to its end."""
    return bool(row.get("keepout_violations", 1) == 0) and row["outcome"] != Outcome.DIVERGED.value


def _keeps_out(row: Row) -> Check:
    count = row["keepout_violations"]
    return (
        count == 0,
        f"{count} keep-out violation{'s' * (count != 1)}, the deepest by {row['keepout_depth_m']:.2f} m",
    )


def _tracking_checks(row: Row, criteria: CriteriaConfig) -> list[Check]:
    checks = []
    if criteria.settles:
        checks.append((math.isfinite(row["settling_time_s"]), "did not settle"))
        since = row["duration_s"] - row["settling_time_s"]
        for name, key, limit, unit in (
            ("rms tracking error", "tracking_error_rms_m", criteria.tracking_error_rms_m, "m"),
            (
                "rms airspeed error",
                "airspeed_error_rms_mps",
                criteria.airspeed_error_rms_mps,
                "m/s",
            ),
            ("largest altitude error", "altitude_error_max_m", criteria.altitude_error_max_m, "m"),
        ):
            # One that settled with its last sample has none of these figures, and shows nothing.
            if limit and math.isfinite(row["settling_time_s"]):
                met, message = _at_most(name, row.get(key, math.nan), limit, unit)
                # A flight is settled while errors still die out: in a short one they count for
                # more.
                checks.append((met, f"{message}, in the {since:.0f} s since it settled"))
    if criteria.tracking_error_end_m:
        checks.append(
            _at_most(
                "tracking error at the end",
                row["tracking_error_end_m"],
                criteria.tracking_error_end_m,
                "m",
            )
        )
    return checks


def _command_checks(row: Row, criteria: CriteriaConfig) -> list[Check]:
    largest, demand = row["heading_rate_limit_rad_s"], row["heading_rate_demand_max_rad_s"]
    checks = []
    if criteria.law_beyond_heading_rate_max:
        checks.append(
            (
                demand > largest,
                f"the law asked for {demand:.4f} rad/s, within omega_max = {largest:.4f}",
            )
        )
    else:
        command = row["heading_rate_command_max_rad_s"]
        checks.append(
            (
                command <= largest * _ROUNDING,
                f"commanded {command:.4f} rad/s, above omega_max = {largest:.4f}",
            )
        )
    if criteria.law_within_heading_rate_max:
        checks.append(
            (
                demand <= largest * _ROUNDING,
                f"the law asked for {demand:.4f} rad/s, above omega_max = {largest:.4f}",
            )
        )
    return checks


def _crossing_checks(row: Row, criteria: CriteriaConfig) -> list[Check]:
    checks = []
    if "crossing_clearance_min_m" in row:
        clearance, radius = row["crossing_clearance_min_m"], row["keepout_radius_m"]
        checks.append(
            (clearance >= 0.0, f"crossed at {radius + clearance:.2f} m, inside {radius:g} m")
        )
    if criteria.crossing_interval_error:
        interval, predicted = (
            row.get("crossing_interval_mean_s", math.nan),
            row["crossing_interval_predicted_s"],
        )
        error = interval / predicted - 1.0
        message = (
            f"mean crossing interval {interval:.3f} s, {100.0 * abs(error):.1f} % {'longer' if error > 0.0 else 'shorter'} than the"
            f" predicted {predicted:.3f} s, more than the {100.0 * criteria.crossing_interval_error:g} % that are allowed"
        )
        if math.isnan(error):
            message = "too few crossings for a mean interval, which is one over whole periods of the orbit"
        checks.append((abs(error) <= criteria.crossing_interval_error, message))
    for name, key, unit, limits in (
        ("interval", "crossing_interval_mean_s", "s", criteria.crossing_interval_s),
        ("distance", "crossing_distance_mean_m", "m", criteria.crossing_distance_m),
    ):
        if limits is not None:
            value = row.get(key, math.nan)
            message = f"mean crossing {name} {value:.3f} {unit} outside {limits[0]:g} to {limits[1]:g} {unit}"
            checks.append((limits[0] <= value <= limits[1], message))
    return checks


def _mission_checks(row: Row, criteria: CriteriaConfig) -> list[Check]:
    checks = []
    # A track from a file may have no manoeuvre in the time of the flight.
    if criteria.resumes_within_periods and not math.isnan(row.get("manoeuvre_end_s", 0.0)):
        periods = row.get("resume_periods", math.nan)
        message = f"crossings resumed {periods:.2f} periods after the last manoeuvre"
        checks.append((periods <= criteria.resumes_within_periods, message))
    if criteria.time_to_find_s:
        checks.append(
            _at_most(
                "time to find the plume",
                row.get("time_to_find_s", math.nan),
                criteria.time_to_find_s,
                "s",
            )
        )
    if criteria.within_altitudes:
        outside = row.get("altitude_outside_s", math.nan)
        checks.append(
            (outside == 0.0, f"{outside:.1f} s outside of flight.altitude_min_m and altitude_max_m")
        )
    if criteria.modes_at_end:
        checks.append((row["mode_at_end"] in criteria.modes_at_end, f"ended {row['mode_at_end']}"))
    return checks


def _part_failed(row: Row) -> bool:
    """Return whether a part of the aircraft had failed; otherwise it was given up on a false alarm."""
    return row["fault"] not in NOT_OF_AIRCRAFT and bool(row["duration_s"] >= row["fault_time_s"])


def _at_most(name: str, value: float, limit: float, unit: str) -> Check:
    return value <= limit, f"{name} {value:.2f} {unit}, above the limit of {limit:g} {unit}"
