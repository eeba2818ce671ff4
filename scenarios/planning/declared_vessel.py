"""Checks that a vessel, and the reports of a file, keep within their declared limits: the keep-out
guard relies on them.
"""

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from common.text import utc_text
from gnc.errors import InfeasibleError
from gnc.estimation.vessel import KEPT, VesselLimits, VesselReport, radius_after, radius_by_speed
from scenarios.scenario.scenario import Scenario
from scenarios.world.ais.track import AisVessel
from scenarios.world.vessel import (
    TRACK_STEP,
    SteadyVessel,
    VesselTruth,
    largest_acceleration,
    largest_inconsistency,
    largest_speed,
    sampled,
    track_times,
)

_INCONSISTENCY_MAX = 0.01
"""Largest difference between the way of a user's track and the integral of its velocity [m].

The integral is a sum: for curves and splines with exact velocity it differs by up to 0.6 mm in an
hour.
"""

_LOOKS = 10
"""Number of points of a track between two checks [-], 0.5 s: between them its distance from a disc
deviates from a straight line by millimetres.
"""

_SLOWEST = 1.0
"""Least speed at which the error of a course counts [m/s]: slower ships keep their last sound
course.
"""

Array = npt.NDArray[np.float64]


def check_vessel(scenario: Scenario, vessel: VesselTruth, limits: VesselLimits) -> None:
    """Raise an InfeasibleError for a vessel, or reports of a file, beyond the limits that are
    declared to the keep-out guard.
    """
    check_declared(scenario, vessel)
    if isinstance(vessel, AisVessel) and scenario.guidance.keepout_guard:
        # The error of the vehicle's own place is not part of the reports'.
        of_reports = replace(limits, position_sigma=scenario.reports.position_sigma_m)
        _check_reports(vessel, of_reports, scenario.flight.duration_max_s)


def with_antenna_errors(scenario: Scenario, vessel: VesselTruth) -> Scenario:
    """Return the scenario with the errors of reports at the funnel: errors of heading and rate of
    turn add to them, over the distance of the antenna.
    """
    hull, reports = scenario.vessel.hull, scenario.reports
    distance = 0.0 if hull is None else hull.antenna_distance
    if distance == 0.0 or reports.exact:
        return scenario
    heading = math.radians(reports.heading_sigma_deg)
    if isinstance(vessel, AisVessel):
        velocity, _ = vessel.samples
        speed = max(_SLOWEST, float(np.hypot(*velocity.T).min()))
        heading = math.hypot(heading, reports.velocity_sigma_mps / speed)
    turning = math.radians(reports.turn_rate_sigma_deg_s)
    fastest = fastest_turn(distance, scenario.following.vessel_acceleration_mps2)
    added = math.hypot(distance * turning, distance * fastest * heading)
    return scenario.model_copy(
        update={
            "reports": reports.model_copy(
                update={
                    "position_sigma_m": math.hypot(reports.position_sigma_m, distance * heading),
                    "velocity_sigma_mps": math.hypot(reports.velocity_sigma_mps, added),
                }
            )
        }
    )


def check_declared(scenario: Scenario, vessel: VesselTruth) -> None:
    """Raise an InfeasibleError for a vessel that exceeds the limits declared to the keep-out guard.

    This also holds for a vessel that is known exactly: its motion during a turn away is not known
    when the turn begins.
    """
    if not scenario.guidance.keepout_guard:
        return
    f, duration = scenario.following, scenario.flight.duration_max_s
    if type(vessel) is SteadyVessel:
        # Its motion is the same at all times.
        duration = 0.0
    acceleration, speed = largest_acceleration(vessel, duration), largest_speed(vessel, duration)
    relied = "on which the keep-out guard relies: declare more, or fly another time or track"
    if acceleration > f.vessel_acceleration_mps2:
        raise InfeasibleError(
            f"the vessel accelerates by {_at_least(acceleration)} m/s2, changes of speed and course"
            " together; the declared limit is following.vessel_acceleration_mps2 ="
            f" {f.vessel_acceleration_mps2:g}, {relied}"
        )
    _check_turn(scenario, vessel, duration)
    if f.vessel_speed_max_mps is not None and speed > f.vessel_speed_max_mps:
        raise InfeasibleError(
            f"the vessel moves at up to {_at_least(speed)} m/s over the ground; it is declared to"
            f" stay within following.vessel_speed_max_mps = {f.vessel_speed_max_mps:g}, {relied}"
        )
    # NaN does not count as agreement.
    if not (off := largest_inconsistency(vessel, duration)) <= _INCONSISTENCY_MAX:
        raise InfeasibleError(
            f"vessel.track '{scenario.vessel.track}': its places and the integral of the velocity"
            f" that motion() returns differ by up to {off:.2g} m; {_INCONSISTENCY_MAX:g} m are"
            " allowed for rounding: let the velocity be the derivative of the place"
        )


def fastest_turn(distance: float, acceleration: float) -> float:
    """Return the largest assumed rate of turn of a ship [rad/s]: at that rate its antenna has the
    vessel's declared acceleration about its funnel.

    Parameters
    ----------
    distance : of the antenna from the funnel [m]
    acceleration : declared of the vessel [m/s^2]
    """
    return math.sqrt(acceleration / distance)


def _check_turn(scenario: Scenario, vessel: VesselTruth, duration: float) -> None:
    """Raise an InfeasibleError for a vessel that turns faster than assumed, where its antenna is
    not at the funnel.
    """
    hull = scenario.vessel.hull
    distance = 0.0 if hull is None or scenario.vessel_known else hull.antenna_distance
    if distance == 0.0:
        return
    _, course = sampled(vessel, duration)
    rate = float(np.abs(np.diff(course)).max(initial=0.0)) / TRACK_STEP
    acceleration = scenario.following.vessel_acceleration_mps2
    if rate > fastest_turn(distance, acceleration):
        raise InfeasibleError(
            f"the vessel turns at up to {math.degrees(rate):.2g} deg/s, which moves its antenna,"
            f" {distance:g} m from the funnel (vessel.antenna_from_bow_m), with"
            f" {_at_least(rate**2 * distance)} m/s2; the declared limit is"
            f" following.vessel_acceleration_mps2 = {acceleration:g}: declare more"
        )


def _at_least(value: float) -> str:
    """Return a positive number rounded up to four digits, as a sufficient value to declare."""
    digit = 10.0 ** (math.floor(math.log10(value)) - 3)
    return f"{math.ceil(value / digit) * digit:.4g}"


def _check_reports(vessel: AisVessel, limits: VesselLimits, duration: float) -> None:
    """Raise an InfeasibleError for reports of a file whose discs would not contain the vessel.

    The smooth track has to stay within the discs of each report to the end of the flight: all
    reports after it may be lost.

    Parameters
    ----------
    vessel : vessel with its reports and its smooth track
    limits : declared limits of both, including the errors
    duration : of the longest flight [s]
    """
    times = track_times(duration)[::_LOOKS]
    places = vessel.places[: _LOOKS * len(times) : _LOOKS]
    before = sum(report.time <= 0.0 for report in vessel.reports)
    for report in vessel.reports[max(0, before - KEPT) :]:
        if report.time >= 0.0 and _within_for_good(report, vessel, limits):
            continue
        begins = int(np.searchsorted(times, report.time))
        age = np.concatenate([[max(0.0, -report.time)], times[begins:] - report.time])
        way = np.vstack([vessel.motion(max(0.0, report.time))[:2], places[begins:]]) - (
            report.north,
            report.east,
        )
        velocity = np.array([report.velocity_north, report.velocity_east])
        allowed = radius_after(limits, age)
        drifted = "reports.velocity_sigma_mps and following.vessel_acceleration_mps2"
        _check_within(vessel, report, age, way - age[:, None] * velocity, allowed, drifted)
        if limits.speed_max < math.inf:
            by_speed = radius_by_speed(limits, age)
            # The guard keeps off this disc only where it is the smaller one. No other check covers
            # the speed before the start.
            by_speed[by_speed >= allowed] = math.inf
            _check_within(
                vessel,
                report,
                age,
                way,
                by_speed,
                f"following.vessel_speed_max_mps = {limits.speed_max:g}",
            )


def _check_within(
    vessel: AisVessel,
    report: VesselReport,
    age: Array,
    off_centre: Array,
    allowed: Array,
    declared: str,
) -> None:
    """Raise an InfeasibleError where the track leaves a report's disc.

    Parameters
    ----------
    vessel, report : the track and the report
    age : of the report, shape (n,) [s]
    off_centre, allowed : offset of the track from the disc's centre, shape (n, 2), and the disc's
        radius [m]
    declared : keys that the radius follows from
    """
    off = np.hypot(*off_centre.T)
    worst = int(np.argmax(off - allowed))
    if off[worst] > allowed[worst]:
        raise InfeasibleError(
            f"the report of {utc_text(vessel.place.utc + report.time)} and the smooth track through"
            f" all reports lie {off[worst]:.1f} m apart after {age[worst]:.1f} s;"
            f" {allowed[worst]:.1f} m are allowed for by reports.position_sigma_m and {declared}:"
            " declare more, delete the report, or fly another time of its file (place.utc)"
        )


def _within_for_good(report: VesselReport, vessel: AisVessel, limits: VesselLimits) -> bool:
    """Return whether errors of a report are so small that a vessel that keeps to its acceleration
    never leaves its disc.

    With errors e_p and e_v of place and velocity, (e_p/sigma_p)^2 + (e_v/sigma_v)^2 <= k^2, Cauchy
    and Schwarz have e_p + e_v s <= k hypot(sigma_p, sigma_v s).
    """
    north, east, velocity_north, velocity_east = vessel.motion(report.time)
    place = limits.deviations * limits.position_sigma
    velocity = limits.deviations * limits.velocity_sigma
    if not (place > 0.0 and velocity > 0.0):
        return False
    wrong_place = math.hypot(report.north - north, report.east - east)
    wrong_velocity = math.hypot(
        report.velocity_north - velocity_north, report.velocity_east - velocity_east
    )
    return math.hypot(wrong_place / place, wrong_velocity / velocity) <= 1.0
