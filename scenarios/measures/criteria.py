"""Judges each flight: compares its figures with the limits of its criteria."""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from common.faults import faults_in
from common.verdict import KeepOut
from scenarios.engine.task import Row
from scenarios.flight.outcome import Outcome
from scenarios.scenario.sections.flight import CriteriaConfig
from scenarios.world.faults import NOT_OF_AIRCRAFT

_ROUNDING = 1.0 + 1e-12
"""By what a command may exceed its limit: rounding alone [-]."""

_SEVERITY = [
    outcome.value
    for outcome in (
        Outcome.COMPLETED,
        Outcome.INFEASIBLE,
        Outcome.TRIM_FAILED,
        Outcome.INCOMPLETE,
        Outcome.NOT_SETTLED,
        Outcome.FAILED,
        Outcome.AIRCRAFT_LOST,
        Outcome.DIVERGED,
        Outcome.UNEXPLAINED_VIOLATION,
    )
]
"""Outcomes from the best to the worst."""


class Judged(NamedTuple):
    """One criterion in one flight.

    Attributes
    ----------
    key, column : as in ``common.verdict.Criterion``
    value : of the figure, NaN if the flight has none; or a word
    limit : of the flight; None where its scenario sets none
    worse : how bad the value is, larger is worse, comparable between limits; NaN without a value
    of_limit : how bad the value is relative to its limit; larger is worse
    message : message about a flight that fails the criterion; empty if it is met
    judges : whether the criterion applies to the flight
    """

    key: str
    column: str
    value: Any
    limit: Any
    worse: float
    of_limit: float
    message: str
    judges: bool = True


def failed_criteria(row: Row, criteria: CriteriaConfig) -> list[str]:
    """Return the criteria that a flight's row fails, each as a short sentence; empty if all are
    met.

    In addition to the criteria, every flight has to keep out and to complete its mission. A flight
    that loses its aircraft meets nothing, even if its scenario declares the fault.
    """
    return [of.message for of in judged_criteria(row, criteria) if of.judges and of.message]


def judged_criteria(row: Row, criteria: CriteriaConfig) -> Iterator[Judged]:
    """Yield every criterion with the figure of a flight, also criteria that do not apply to it: a
    flight that did not complete is judged only by keeping out and completing.
    """
    measured = "keepout_violations" in row
    if measured:
        yield _keeps_out(row)
    yield _completes(row)
    if "duration_s" not in row:
        return
    completed = row["outcome"] == Outcome.COMPLETED.value
    others = [*_tracking(row, criteria), *_commands(row, criteria)]
    if measured:
        others += [*_crossings(row, criteria), *_mission(row, criteria)]
    for of in others:
        yield of if completed else of._replace(judges=False)


def _keeps_out(row: Row) -> Judged:
    count, clearance = row["keepout_violations"], _clearance(row)
    message = ""
    others = row.get("others_violations", 0)
    if count > others:
        own = count - others
        message = (
            f"{own} keep-out violation{'s' * (own != 1)}, the deepest by"
            f" {row.get('keepout_depth_m', math.nan):.2f} m"
        )
    if others:
        beside = (
            f"{others} keep-out violation{'s' * (others != 1)} of other ships, the deepest by"
            f" {-row['others_clearance_min_m']:.2f} m, of {row['others_nearest']}"
        )
        message = "; ".join(filter(None, (message, beside)))
    known = KeepOut.of(row) is not KeepOut.UNKNOWN
    return Judged("keep_out", "clearance_m", clearance, 0.0, -clearance, -clearance, message, known)


def _clearance(row: Row) -> float:
    """Return a flight's closest approach to the keep-out area, or to that of another ship [m]."""
    nearest, radius = (row.get(name, math.nan) for name in ("min_distance_m", "keepout_radius_m"))
    return min(float(nearest - radius), float(row.get("others_clearance_min_m", math.inf)))


def _completes(row: Row) -> Judged:
    outcome, message = row["outcome"], ""
    if outcome != Outcome.COMPLETED.value:
        message = row["message"] or "did not complete"
        if outcome == Outcome.AIRCRAFT_LOST.value and not _part_failed(row):
            message = f"{message}; nothing of the aircraft had failed"
    worse = float(_SEVERITY.index(outcome))
    return Judged("mission", "outcome", outcome, Outcome.COMPLETED.value, worse, worse, message)


def _part_failed(row: Row) -> bool:
    """Return whether a part of the aircraft had failed; if not, the aircraft was given up after a
    false alarm.
    """
    return any(
        kind not in NOT_OF_AIRCRAFT and row["duration_s"] >= begins
        for kind, begins in faults_in(row)
    )


def _tracking(row: Row, criteria: CriteriaConfig) -> Iterator[Judged]:
    settling = row.get("settling_time_s", math.nan)
    settled = math.isfinite(settling)
    yield Judged(
        "settles",
        "settling_time_s",
        settling,
        True if criteria.settles else None,
        settling,
        settling,
        "" if settled else "did not settle",
        judges=criteria.settles,
    )
    # At settling, errors still decay: in a short flight they weigh more.
    since = f", in the {row['duration_s'] - settling:.0f} s since it settled"
    for key, name, limit, unit in (
        ("tracking_error_rms_m", "rms tracking error", criteria.tracking_error_rms_m, "m"),
        ("airspeed_error_rms_mps", "rms airspeed error", criteria.airspeed_error_rms_mps, "m/s"),
        ("altitude_error_max_m", "largest altitude error", criteria.altitude_error_max_m, "m"),
    ):
        # A flight that settled at its last sample has none of these figures, and proves nothing.
        judges = criteria.settles and settled
        yield _at_most(
            key, key, row, limit if criteria.settles else False, name, unit, since, judges
        )
    key = "tracking_error_end_m"
    yield _at_most(key, key, row, criteria.tracking_error_end_m, "tracking error at the end", "m")


def _commands(row: Row, criteria: CriteriaConfig) -> Iterator[Judged]:
    largest, demand, command = (
        row.get(f"heading_rate_{name}_rad_s", math.nan)
        for name in ("limit", "demand_max", "command_max")
    )
    demanded, commanded = (rate / largest if largest else math.nan for rate in (demand, command))
    beyond, within = criteria.law_beyond_heading_rate_max, criteria.law_within_heading_rate_max
    if beyond:
        message = f"the law demanded {demand:.4f} rad/s, within omega_max = {largest:.4f}"
        yield Judged(
            "law_beyond_heading_rate_max",
            "",
            demanded,
            1.0,
            -demanded,
            -demanded,
            message * (not demand > largest),
        )
    else:
        message = f"commanded {command:.4f} rad/s, above omega_max = {largest:.4f}"
        message *= not command <= largest * _ROUNDING
        yield Judged("heading_rate", "", commanded, 1.0, commanded, commanded, message)
    if within:
        message = f"the law demanded {demand:.4f} rad/s, above omega_max = {largest:.4f}"
        message *= not demand <= largest * _ROUNDING
        key = "law_within_heading_rate_max"
        yield Judged(key, "", demanded, 1.0, demanded, demanded, message)


def _crossings(row: Row, criteria: CriteriaConfig) -> Iterator[Judged]:
    if "crossing_clearance_min_m" in row:
        clearance, radius = row["crossing_clearance_min_m"], row["keepout_radius_m"]
        message = f"crossed at {radius + clearance:.2f} m, inside {radius:g} m"
        message *= not clearance >= 0.0
        yield Judged(
            "crossing_clearance",
            "crossing_clearance_m",
            clearance,
            0.0,
            -clearance,
            -clearance,
            message,
        )
    yield _interval_error(row, criteria.crossing_interval_error)
    for key, name, unit, limits in (
        ("crossing_interval_mean_s", "interval", "s", criteria.crossing_interval_s),
        ("crossing_distance_mean_m", "distance", "m", criteria.crossing_distance_m),
    ):
        if limits is not None:
            value, (low, high) = row.get(key, math.nan), limits
            outside = max(low - value, value - high)
            message = f"mean crossing {name} {value:.3f} {unit} outside {low:g} to {high:g} {unit}"
            message *= not low <= value <= high
            yield Judged(
                key.replace("_mean", ""), key, value, [low, high], outside, outside, message
            )


def _interval_error(row: Row, limit: float) -> Judged:
    interval = row.get("crossing_interval_mean_s", math.nan)
    predicted = row["crossing_interval_predicted_s"]
    error = interval / predicted - 1.0
    message = ""
    if limit and math.isnan(error):
        message = (
            "too few crossings for a mean interval, which is one over whole periods of the orbit"
        )
    elif limit and abs(error) > limit:
        message = (
            f"mean crossing interval {interval:.3f} s, {100.0 * abs(error):.1f} %"
            f" {'longer' if error > 0.0 else 'shorter'} than the predicted {predicted:.3f} s,"
            f" more than the {100.0 * limit:g} % that are allowed"
        )
    key, size = "crossing_interval_error", abs(error)
    of_limit = size / limit if limit else size
    return Judged(key, key, size, limit or None, size, of_limit, message, judges=bool(limit))


def _mission(row: Row, criteria: CriteriaConfig) -> Iterator[Judged]:
    # A track from a file may have no manoeuvre in the time of the flight.
    key, limit = "resumes_within_periods", criteria.resumes_within_periods
    if not math.isnan(row.get("manoeuvre_end_s", 0.0)):
        periods = row.get("resume_periods", math.nan)
        message = f"crossings resumed {periods:.2f} periods after the last manoeuvre"
        judged = _at_most(key, "resume_periods", row, limit, "", "")
        yield judged._replace(message=message if judged.message else "")
    key, limit = "time_to_find_s", criteria.time_to_find_s
    yield _at_most(key, key, row, limit, "time to find the plume", "s")
    if criteria.within_altitudes:
        outside = row.get("altitude_outside_s", math.nan)
        message = f"{outside:.1f} s outside of flight.altitude_min_m and altitude_max_m"
        message *= outside != 0.0
        yield Judged(
            "within_altitudes", "altitude_outside_s", outside, 0.0, outside, outside, message
        )
    if criteria.modes_at_end:
        mode, allowed = row["mode_at_end"], list(criteria.modes_at_end)
        other = float(mode not in allowed)
        message = f"ended {mode}" if other else ""
        yield Judged("modes_at_end", "mode_at_end", mode, allowed, other, other, message)


def _at_most(
    key: str,
    column: str,
    row: Row,
    limit: float,
    name: str,
    unit: str,
    since: str = "",
    judges: bool = True,
) -> Judged:
    """Return the criterion for an upper limit of a figure; a limit of 0 or false gives none."""
    value = row.get(column, math.nan)
    message = ""
    if limit and not value <= limit:
        message = f"{name} {value:.2f} {unit}, above the limit of {limit:g} {unit}{since}"
    of_limit = value / limit if limit else value
    return Judged(
        key, column, value, limit or None, value, of_limit, message, judges and bool(limit)
    )
