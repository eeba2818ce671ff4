"""Where flights begin, and which starts are refused."""

import math
from collections.abc import Sequence

import numpy as np

from gnc.errors import InfeasibleError
from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import Tube, VesselReport
from gnc.guard.guard import GuardParameters, HeadingRateFilter
from scenarios.planning.flight_plan import Start
from scenarios.scenario.sections.flight import StartConfig
from scenarios.world.vessel import VesselTruth


def sampled_start(
    start: StartConfig, generator: np.random.Generator, *, course: float, axis: float
) -> Start:
    """Return a start: given, or sampled about the plume's axis.

    What is given is sampled all the same, so that nothing else of the flight depends on what is.

    Parameters
    ----------
    start : the ``[start]`` section
    generator : of the random numbers
    course : of the vessel, or of the reference of a circle [rad]
    axis : course along which the plume trails [rad]
    """
    distance = float(generator.uniform(*start.distance_m))
    spread = math.radians(start.spread_deg)
    aspect = float(generator.uniform(-spread, spread))
    flown = float(generator.uniform(-math.pi, math.pi))
    if start.course_deg is not None:
        flown = math.radians(start.course_deg)
    if start.place_m is not None:
        north, east = placed(*start.place_m, course)
        return Start(north=north, east=east, course=flown)
    if start.range_m is not None:
        distance = start.range_m
    bearing = axis + (aspect if start.aspect_deg is None else math.radians(start.aspect_deg))
    return Start(
        north=distance * math.cos(bearing), east=distance * math.sin(bearing), course=flown
    )


def placed(ahead: float, right: float, course: float) -> tuple[float, float]:
    """Return north and east of a place ahead and right of a vessel at the origin on a course
    [m, rad].
    """
    sin_c, cos_c = math.sin(course), math.cos(course)
    return ahead * cos_c - right * sin_c, ahead * sin_c + right * cos_c


def first_reports(
    vessel: VesselTruth, received: list[tuple[float, VesselReport]] | None
) -> list[VesselReport]:
    """Return the reports that the flight begins with; of a vessel that is known exactly, her
    motion.
    """
    if received is None:
        return [VesselReport(0.0, *vessel.motion(0.0))]
    return [report for at, report in received if at <= 0.0]


def check_start(
    start: Start,
    guard: GuardParameters | None,
    vessel: Sequence[Tube],
    *,
    wind: tuple[float, float],
    known: AirMotion | None = None,
    airspeed: float,
    keepout_radius: float,
) -> None:
    """Refuse a start from which no command keeps the aircraft out of the keep-out area.

    Parameters
    ----------
    start, guard : the start, and the guard that would have to keep out; any start is accepted
        without
    vessel : discs in each of which it is for certain, at time 0
    wind : north and east [m/s]
    known : motion by the first measurement, whose wind is as wrong as it may be at the start; None
        where it is known exactly
    airspeed : of the UAV [m/s]
    keepout_radius : r_min [m]

    Raises
    ------
    InfeasibleError : the best turn away comes too close, or the vehicle lags so much that it does
        not lead away
    """
    if guard is None:
        return
    fastest = max(
        math.hypot(tube.velocity_north - wind[0], tube.velocity_east - wind[1]) for tube in vessel
    )
    away = airspeed * math.cos(min(math.pi, guard.heading_rate_max * guard.lag))
    if away <= fastest:
        raise InfeasibleError(
            f"a UAV that turns at {guard.heading_rate_max:.3g} rad/s and lags by {guard.lag:.3g} s overshoots, and then leaves at"
            f" only {away:.1f} of its {airspeed:.1f} m/s, beside a vessel with {fastest:.1f} m/s through the air: slow the vessel,"
            " turn more slowly (guidance.bank_deg), or give a kinematic vehicle a shorter lag (kinematic.heading_rate_lag_s)"
        )
    own = AirMotion(
        ground_north=start.north,
        ground_east=start.east,
        course=start.course,
        wind_north=wind[0],
        wind_east=wind[1],
        wind_error=known.wind_error if known else 0.0,
        wind_by_gusts=known.wind_by_gusts if known else None,
    )
    clearance = HeadingRateFilter(guard).clearance(0.0, own, vessel, airspeed)
    if clearance < 0.0:
        raise InfeasibleError(
            f"the start lies {math.hypot(start.north, start.east):.1f} m from the vessel on course"
            f" {math.degrees(start.course):.0f} deg, where the best turn away comes within"
            f" {max(0.0, guard.radius + clearance):.1f} m of where it may be; keepout.radius_m is {keepout_radius:g} m, and"
            f" the guard has to keep {guard.radius:.1f} m{_most_of_errors(guard, own)}: start farther away (start.distance_m) or on another course"
            " (start.course_deg)"
        )


def _most_of_errors(guard: GuardParameters, own: AirMotion) -> str:
    """Return which term of the error budget takes most of the room, in words; none without one."""
    turn = math.pi / guard.heading_rate_max + guard.delay + guard.lag
    parts = guard.errors.parts(turn, own.wind_by_gusts)
    name, (distance, key) = max(parts.items(), key=lambda part: part[1].distance)
    if distance == 0.0 or not key:
        return ""
    return f" and, for errors, most for {name}: {distance:.1f} m in half a turn ({key})"
