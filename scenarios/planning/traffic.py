"""Other ships in a flight's plan: the knowledge of them on board, and checks that the start keeps
off them and that they leave room for an orbit.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gnc.errors import InfeasibleError
from gnc.estimation.navigation import AirMotion
from gnc.estimation.traffic import OtherVessel
from gnc.estimation.vessel import ReachableSet, VesselLimits, VesselReport
from gnc.guard.guard import GuardParameters, HeadingRateFilter
from gnc.guidance import TrafficParameters
from gnc.mission.yielding import YieldParameters
from scenarios.planning.flight_plan import Start
from scenarios.planning.margin.keepout_margin import vessel_limits
from scenarios.scenario.scenario import Scenario
from scenarios.world.ais.track import received_of_file, received_reports
from scenarios.world.traffic import OtherShip
from scenarios.world.vessel import largest_acceleration, largest_speed
from scenarios.world.world import World

Received = list[tuple[float, VesselReport]]
"""Reports, with the time at which each is received [s]."""

_LOOK = 1.0
"""Time between checks whether an orbit is free [s]."""

_FILE_INTERVAL = (2.0, 10.0)
"""Usual time between reports of ships under way in a file [s] (ITU-R M.1371-5, table 1)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Footprint:
    """The area of an orbit.

    Attributes
    ----------
    radius : of a circle about the centre of oscillation in which it lies [m]
    distance : of that centre from the vessel, along the plume's axis; 0 for a circle about it [m]
    room : distance kept in addition to another ship's radius, so that the guard does not act [m]
    period : of the orbit [s]
    """

    radius: float
    distance: float
    room: float
    period: float


def limits_of(scenario: Scenario, ship: OtherShip, horizon: float) -> VesselLimits:
    """Return the limits of another ship and its reports, for turns away of a duration [s]."""
    if ship.reports is not None and scenario.reports.exact:
        reports = scenario.reports.model_copy(update={"interval_s": _FILE_INTERVAL})
        scenario = scenario.model_copy(update={"reports": reports})
    return vessel_limits(scenario, horizon)


def traffic_parameters(
    scenario: Scenario,
    ships: Sequence[OtherShip],
    *,
    horizon: float,
    speed_max: float,
    footprint: Footprint,
    measured_radius: float,
    meets_ships: bool = False,
) -> TrafficParameters | None:
    """Return the guidance's knowledge of other ships before the flight; None where no ships are
    known and none can become known.

    Parameters
    ----------
    scenario, ships : the flight, and the ships
    horizon : duration of a turn away [s]
    speed_max : largest airspeed of the vehicle [m/s]
    footprint : of the orbit
    measured_radius : distance kept from the measured vessel while giving way [m]
    meets_ships : whether other ships may become known in flight
    """
    if not ships and not meets_ships:
        return None
    return TrafficParameters(
        vessels=tuple(
            OtherVessel(
                name=ship.name, radius=ship.radius, limits=limits_of(scenario, ship, horizon)
            )
            for ship in ships
        ),
        speed_max=speed_max,
        yielding=YieldParameters(
            footprint=footprint.radius, room=footprint.room, measured_radius=measured_radius
        ),
    )


def received_of(
    scenario: Scenario,
    ships: Sequence[OtherShip],
    *,
    outages: Sequence[tuple[float, float]],
    generator: np.random.Generator,
) -> tuple[Received | None, ...]:
    """Return the reports of other ships as they are received; None for a ship that is known
    exactly.
    """
    received: list[Received | None] = []
    for ship in ships:
        if ship.reports is not None:
            received.append(
                received_of_file(
                    scenario.reports, ship.reports, outages=outages, generator=generator
                )
            )
        elif scenario.reports.exact:
            received.append(None)
        else:
            received.append(
                received_reports(
                    scenario.reports,
                    ship.track,
                    duration=scenario.flight.duration_max_s,
                    outages=outages,
                    generator=generator,
                )
            )
    return tuple(received)


def check_traffic_declared(scenario: Scenario, ships: Sequence[OtherShip]) -> None:
    """Raise an InfeasibleError for a ship that exceeds the limits declared to the keep-out guard.

    For the ships of a file, this is a premise that each flight measures: their places are not
    chosen.
    """
    if not scenario.guidance.keepout_guard:
        return
    f, duration = scenario.following, scenario.flight.duration_max_s
    for ship in ships:
        if ship.reports is not None:
            continue
        acceleration = largest_acceleration(ship.track, duration)
        if acceleration > f.vessel_acceleration_mps2:
            raise InfeasibleError(
                f"{ship.name} ({ship.key}) accelerates by {acceleration:.3g} m/s2; the declared"
                f" limit is following.vessel_acceleration_mps2 = {f.vessel_acceleration_mps2:g}, on"
                " which the keep-out guard relies: declare more, or let it turn more slowly"
            )
        speed = largest_speed(ship.track, duration)
        if f.vessel_speed_max_mps is not None and speed > f.vessel_speed_max_mps:
            raise InfeasibleError(
                f"{ship.name} ({ship.key}) moves at up to {speed:.4g} m/s over the ground; ships"
                " are declared to stay within following.vessel_speed_max_mps ="
                f" {f.vessel_speed_max_mps:g}, on which the keep-out guard relies: declare more"
            )


def check_start_beside(
    start: Start,
    guard: GuardParameters | None,
    parameters: TrafficParameters | None,
    ships: Sequence[OtherShip],
    received: Sequence[Received | None],
    own: AirMotion,
    airspeed: float,
) -> None:
    """Refuse a start from which no command keeps the aircraft off another ship.

    Parameters
    ----------
    start, guard : of the flight; any start is accepted without a guard
    parameters : of the ships
    ships, received : the ships and their reports
    own, airspeed : the vehicle's motion at the start, and its airspeed [m/s]

    Raises
    ------
    InfeasibleError : the best turn away comes too close
    """
    if guard is None or parameters is None:
        return
    for vessel, ship, reports in zip(parameters.vessels, ships, received, strict=True):
        known = ReachableSet(vessel.limits)
        first = (
            [VesselReport(0.0, *ship.track.motion(0.0))]
            if reports is None
            else [report for at, report in reports if at <= 0.0]
        )
        if not first:
            continue
        for report in first:
            known.report(report)
        radius = vessel.radius + guard.errors.failed_part.size
        filtering = HeadingRateFilter(guard)
        clearance = filtering.clearance(0.0, own, known.tubes(0.0), airspeed, radius=radius)
        if clearance < 0.0:
            north, east, *_ = ship.track.motion(0.0)
            distance = math.hypot(start.north - north, start.east - east)
            raise InfeasibleError(
                f"the start lies {distance:.1f} m from {ship.name} ({ship.key}) on course"
                f" {math.degrees(start.course):.0f} deg, where the best turn away comes within"
                f" {max(0.0, radius + clearance):.1f} m of where it may be;"
                f" {vessel.radius:g} m are kept from it (keepout.other_radius_m): start elsewhere"
                " (start.place_m, start.course_deg)"
            )


def check_room(scenario: Scenario, world: World, footprint: Footprint) -> None:
    """Refuse an orbit that other ships never leave free for as long as one of its periods.

    Raises
    ------
    InfeasibleError : there is no room for it beside another ship
    """
    if not world.traffic:
        return
    times = np.arange(0.0, scenario.flight.duration_max_s, _LOOK)
    blocked = np.zeros(len(times), dtype=np.bool_)
    by = {}
    centres = np.array([_centre(world, footprint, time) for time in times.tolist()])
    for ship in world.traffic:
        known = (times >= ship.begins) & (times <= ship.ends)
        places = np.array([ship.track.motion(time)[:2] for time in times.tolist()])
        apart = np.hypot(*(places - centres).T)
        inside = known & (apart < ship.radius + footprint.room + footprint.radius)
        if inside.any():
            by[ship.name] = (int(np.count_nonzero(inside)), float(apart[known].min()), ship)
        blocked |= inside
    free = _longest(~blocked) * _LOOK
    if by and free < min(footprint.period, scenario.flight.duration_max_s):
        name, (count, apart, ship) = max(by.items(), key=lambda item: item[1][0])
        raise InfeasibleError(
            f"there is no room for the orbit: {name} ({ship.key}) is within {apart:.0f} m of its"
            f" centre for {count * _LOOK:.0f} s;"
            f" {ship.radius + footprint.room + footprint.radius:.0f} m are needed, r ="
            f" {ship.radius:g} m of the ship (keepout.other_radius_m), a margin of"
            f" {footprint.room:.0f} m and {footprint.radius:.0f} m of the orbit, for one of its"
            f" periods, {footprint.period:.0f} s; it is free for {free:.0f} s at most: fly at"
            " another time or with smaller radii"
        )


def _centre(world: World, footprint: Footprint, time: float) -> tuple[float, float]:
    """Return the centre of oscillation, north and east [m]."""
    north, east, *_ = world.vessel.motion(time)
    if footprint.distance == 0.0:
        return north, east
    axis = world.plume.axis(time)
    return (
        north + footprint.distance * math.cos(axis),
        east + footprint.distance * math.sin(axis),
    )


def _longest(free: "np.ndarray[tuple[int], np.dtype[np.bool_]]") -> int:
    """Return the length of the longest run of true values."""
    longest = run = 0
    for is_free in free.tolist():
        run = run + 1 if is_free else 0
        longest = max(longest, run)
    return longest
