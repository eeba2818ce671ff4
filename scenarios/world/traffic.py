"""The ships other than the measured one: those of a scenario, and those of an AIS file."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from aircraft.wind import WindField
from gnc.errors import InfeasibleError
from gnc.estimation.vessel import VesselReport
from measurement.errors import MeasurementError
from scenarios.errors import InputError
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.traffic import TRAFFIC_MAX, TrafficConfig, TrafficEmissionConfig
from scenarios.scenario.sections.world import VesselConfig
from scenarios.world.ais.track import AisVessel, FileShip, ships_of_file
from scenarios.world.plume import Exhaust, Plume, exhaust_of
from scenarios.world.vessel import (
    ManoeuvringVessel,
    Place,
    SteadyVessel,
    VesselTruth,
    check_manoeuvres,
)

_SAME_PLACE = 10.0
"""Distance below which two ships are at one place [m]: they would have collided."""

_FAR = 10_000.0
"""Distance from the measured ship beyond which ships of a file are left out [m]: the UAV beside
that ship does not go so far.
"""

_LOOK = 10.0
"""Time between checks of the distance of a file's ships from the measured one [s]."""


class DisplacedVessel:
    """A vessel on a track that begins elsewhere than at the origin.

    Parameters
    ----------
    track : from the origin at time 0
    north, east : of its first place [m]
    """

    def __init__(self, track: VesselTruth, north: float, east: float) -> None:
        self._track, self._north, self._east = track, north, east

    @property
    def manoeuvres_end(self) -> float:
        """Time at which the last manoeuvre ends, NaN without any [s]."""
        return self._track.manoeuvres_end

    def motion(self, time: float) -> tuple[float, float, float, float]:
        """Return north, east [m] and their rates [m/s] at a time [s]."""
        north, east, v_north, v_east = self._track.motion(time)
        return north + self._north, east + self._east, v_north, v_east

    def course(self, time: float) -> float:
        """Return the course [rad] at a time [s]."""
        return self._track.course(time)


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherShip:
    """A ship other than the measured one.

    Attributes
    ----------
    name : in messages, tables and maps
    radius : to keep from it [m]
    track : in the frame of the flight
    begins, ends : times between which its track is known [s]
    reports : of a file, in the flight's time and frame; None for a ship of the scenario
    key : of the scenario that has it
    emission : of its funnel, as in the scenario, or None
    exhaust : its smoke in the flight's air, or None
    """

    name: str
    radius: float
    track: VesselTruth
    begins: float
    ends: float
    key: str
    reports: Sequence[VesselReport] | None = None
    emission: TrafficEmissionConfig | None = None
    exhaust: Exhaust | None = None


def traffic_of(
    scenario: Scenario, vessel: VesselTruth, place: Place, *, margin: float
) -> tuple[OtherShip, ...]:
    """Return the ships other than the measured one, over the longest flight.

    Parameters
    ----------
    scenario : the flight
    vessel, place : the measured ship, and where and when the flight begins
    margin : time for which tracks continue after the longest flight [s]

    Raises
    ------
    InputError : a file cannot be read, a place is not known, two ships have one name or are at one
        place, or there are too many
    InfeasibleError : manoeuvres of a ship overlap
    """
    ships = [
        ship
        for number, config in enumerate(scenario.traffic)
        for ship in _given(scenario, number, config, vessel, place, margin)
    ]
    if isinstance(vessel, AisVessel):
        own = vessel.source.mmsi
        found = ships_of_file(
            vessel.source.path,
            without=own,
            place=place,
            duration=_duration(scenario),
            margin=margin,
            written=scenario.table.of("vessel.track", scenario.vessel.track),
        )
        ships += _of_file(scenario, found, vessel, None, "vessel.track")
    if len(ships) > TRAFFIC_MAX:
        raise InputError(
            f"there are {len(ships)} ships besides the measured one within {_FAR / 1000.0:g} km of"
            f" it; the most is {TRAFFIC_MAX}: leave some out of the file"
        )
    _check_names(ships)
    _check_places(ships, vessel)
    return tuple(ships)


def with_exhausts(
    scenario: Scenario,
    ships: Sequence[OtherShip],
    plume: Plume,
    wind: WindField,
    *,
    duration: float,
    generator: np.random.Generator,
) -> tuple[OtherShip, ...]:
    """Return ships with the smoke of those that emit any; parameters are those of ``exhaust_of``.

    Raises
    ------
    InfeasibleError : the plume model has no smoke, a ship has no such speed, or the apparent wind
        past it is too weak for a plume
    """
    made = []
    for ship in ships:
        exhaust = None
        if ship.emission is not None:
            try:
                exhaust = exhaust_of(
                    scenario,
                    ship.track,
                    plume,
                    wind,
                    duration=duration,
                    generator=generator,
                    of=ship.emission,
                )
            except MeasurementError as error:
                raise InfeasibleError(f"{ship.name} ({ship.key}.emission): {error}") from None
        made.append(replace(ship, exhaust=exhaust))
    return tuple(made)


def _duration(scenario: Scenario) -> float:
    return scenario.flight.duration_max_s


def radius_kept(scenario: Scenario, config: TrafficConfig | None = None) -> float:
    """Return the radius to keep from a ship other than the measured one, by its entry of
    ``traffic``, if it has one [m].
    """
    if config is not None and config.radius_m is not None:
        return config.radius_m
    return scenario.keepout.other_radius_m or scenario.keepout.radius_m


def _given(
    scenario: Scenario,
    number: int,
    config: TrafficConfig,
    vessel: VesselTruth,
    place: Place,
    margin: float,
) -> Iterator[OtherShip]:
    """Yield the ships of an entry of ``traffic``."""
    key, duration = f"traffic.{number}", _duration(scenario)
    if config.from_file:
        if not math.isfinite(place.latitude) or not math.isfinite(place.utc):
            raise InputError(
                f"{key}.track is a file of AIS reports, and where and when the flight begins is not"
                " known: set place.latitude_deg, place.longitude_deg and place.utc"
            )
        own = vessel.source.mmsi if isinstance(vessel, AisVessel) else None
        found = ships_of_file(
            config.track,
            without=own,
            only=config.mmsi,
            place=place,
            duration=duration,
            margin=margin,
            key=key,
        )
        yield from _of_file(scenario, found, vessel, config, key)
        return
    speed, course = config.speed_mps, math.radians(config.course_deg)
    track: VesselTruth = SteadyVessel(speed, course)
    if config.manoeuvres:
        moves = VesselConfig(
            speed_mps=speed, course_deg=config.course_deg, manoeuvres=config.manoeuvres
        )
        try:
            check_manoeuvres(moves, speed)
        except InfeasibleError as error:
            raise InfeasibleError(str(error).replace("vessel.", f"{key}.", 1)) from None
        track = ManoeuvringVessel(moves, speed, duration + margin)
    north, east = _place(config, key, vessel, place)
    yield OtherShip(
        name=config.name or f"traffic_{number + 1}",
        radius=radius_kept(scenario, config),
        track=DisplacedVessel(track, north, east),
        begins=-math.inf,
        ends=math.inf,
        key=key,
        emission=config.emission,
    )


def _place(
    config: TrafficConfig, key: str, vessel: VesselTruth, place: Place
) -> tuple[float, float]:
    """Return the place of a ship at the start, north and east [m]."""
    if config.latitude_deg is None or config.longitude_deg is None:
        ahead, right = config.place_m or (0.0, 0.0)
        course = vessel.course(0.0)
        sin_c, cos_c = math.sin(course), math.cos(course)
        return ahead * cos_c - right * sin_c, ahead * sin_c + right * cos_c
    if not math.isfinite(place.latitude):
        raise InputError(
            f"{key}.latitude_deg is given, and where the flight begins is not known: set"
            " place.latitude_deg and place.longitude_deg, or give place_m"
        )
    north, east = place.frame.to_local(
        np.radians(config.latitude_deg), np.radians(config.longitude_deg)
    )
    return float(north), float(east)


def _of_file(
    scenario: Scenario,
    found: Sequence[FileShip],
    vessel: VesselTruth,
    config: TrafficConfig | None,
    key: str,
) -> Iterator[OtherShip]:
    """Yield the ships of a file that come near the measured one while their tracks are known."""
    times = np.arange(0.0, _duration(scenario) + _LOOK, _LOOK).tolist()
    for ship in found:
        known = [time for time in times if ship.begins <= time <= ship.ends] or [times[-1]]
        near = min(
            math.hypot(*(a - b for a, b in zip(track[:2], measured[:2], strict=True)))
            for track, measured in ((_displaced(ship).motion(t), vessel.motion(t)) for t in known)
        )
        if near <= _FAR:
            name = f"MMSI_{ship.mmsi}"
            if config is not None and config.name is not None:
                name = config.name if config.mmsi is not None else f"{config.name}_{ship.mmsi}"
            yield OtherShip(
                name=name,
                radius=radius_kept(scenario, config),
                track=_displaced(ship),
                begins=ship.begins,
                ends=ship.ends,
                key=key,
                reports=ship.reports,
                emission=config.emission if config is not None else None,
            )


def _displaced(ship: FileShip) -> DisplacedVessel:
    return DisplacedVessel(ship.track, *ship.origin)


def _check_names(ships: Sequence[OtherShip]) -> None:
    names = [ship.name for ship in ships]
    if twice := next((name for name in names if names.count(name) > 1), None):
        keys = [ship.key for ship in ships if ship.name == twice]
        raise InputError(
            f"{' and '.join(keys)} are both called '{twice}'; give each a name of its own"
        )


def _check_places(ships: Sequence[OtherShip], vessel: VesselTruth) -> None:
    """Refuse ships that are at one place at the start."""
    placed = [("the measured ship", "", (0.0, 0.0, 0.0, 0.0))]
    placed[0] = ("the measured ship", "", vessel.motion(0.0))
    for ship in ships:
        if not ship.begins <= 0.0 <= ship.ends:
            continue
        north, east, *_ = ship.track.motion(0.0)
        for name, key, (other_north, other_east, *_) in placed:
            apart = math.hypot(north - other_north, east - other_east)
            if apart < _SAME_PLACE:
                which = f"{key} ({name})" if key else name
                raise InputError(
                    f"{ship.key} ({ship.name}) is {apart:.1f} m from {which} at the start; two"
                    f" ships are {_SAME_PLACE:g} m apart at least: give it another place"
                    " (place_m), or leave it out"
                )
        placed.append((ship.name, ship.key, ship.track.motion(0.0)))
