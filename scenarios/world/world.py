"""The world of one flight: the true vessel, plume and air, and the faults."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from aircraft.weather import Weather
from aircraft.wind import WindField
from common.errors import PluginError
from common.hull import ShipHull
from common.plugins import call_plugin, is_users, number, numbers
from scenarios.errors import InputError
from scenarios.scenario.extension_points import PLUME_MODELS, VESSEL_TRACKS
from scenarios.scenario.scenario import Scenario
from scenarios.world.ais.track import AT_THE_FUNNEL, AisVessel, ais_vessel, with_size_of_file
from scenarios.world.faults import Faults
from scenarios.world.plume import UNIFORM, Background, Exhaust, Plume
from scenarios.world.traffic import OtherShip
from scenarios.world.vessel import (
    Place,
    SteadyVessel,
    VesselTruth,
    given_place,
    sampled,
    track_times,
)
from scenarios.world.wind import first_time, wind_of

TRACK_MARGIN = 5.0
"""Time for which the track goes on after the longest flight [s]."""

_LOOK_STEP = 1.0
"""Time between the points at which a user's track or plume is checked before its flight [s]."""

_ORIGIN_MAX = 0.01
"""Largest distance of the beginning of a user's track from the origin, for rounding [m]."""

_COURSE_MAX = math.radians(1.0)
"""Largest difference of its course from the direction of its velocity [rad]: that of a course to
first order in a swing of 20 degrees.
"""

_AT_REST = 0.1
"""Speed below which a vessel's course is that of its bow [m/s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class World:
    """The truth outside the UAV.

    Attributes
    ----------
    vessel, plume : the ship's motion and the plume's axis
    elevation, source_height : of the plume's axis, and of its origin above the sea [rad, m]
    weather : the air
    faults : of the flight, with their times
    exhaust : the vessel's smoke, or None
    background : CO2 of the air beside it
    place : where on earth, and when
    hull : of the vessel, where it is known; the vessel's place is that of its funnel
    traffic : ships other than the vessel
    """

    vessel: VesselTruth
    plume: Plume
    elevation: float
    source_height: float
    weather: Weather
    faults: Faults
    place: Place
    hull: ShipHull | None = None
    exhaust: Exhaust | None = None
    background: Background = UNIFORM
    traffic: Sequence[OtherShip] = ()

    def headings(self, times: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return the ship's heading at some times, shape (n,) [rad]."""
        return np.array([self.vessel.course(time) for time in times.tolist()])


_MOTION = numbers(4, "north, east [m] and their rates [m/s]")
_COURSE = number("the course, clockwise from north [rad]")
_AXIS = number("the course along which the plume trails [rad]")
"""Return values of a user's track and plume."""


def vessel_of(scenario: Scenario) -> VesselTruth:
    """Return the vessel's motion over the longest flight.

    Raises
    ------
    PluginError : the track does not exist or cannot be made, or its motion or course is unusable
    InputError : the track's file cannot be read, or does not cover the longest flight
    """
    config, duration = sized(scenario).vessel, scenario.flight.duration_max_s
    if config.from_file:
        altitude = scenario.source_height
        return ais_vessel(
            config,
            altitude=altitude,
            utc=scenario.place.utc,
            duration=duration,
            margin=TRACK_MARGIN,
            written=scenario.table.of("vessel.track", config.track),
        )
    if config.track == "manoeuvres" and not config.manoeuvres:
        return SteadyVessel(scenario.vessel_speed, math.radians(config.course_deg))
    part = f"vessel.track '{config.track}'"
    track: VesselTruth = call_plugin(
        part,
        VESSEL_TRACKS.get(config.track),
        config,
        scenario.vessel_speed,
        duration + TRACK_MARGIN,
    )
    if is_users(track):
        _check_track(part, track, duration)
    return track


def sized(scenario: Scenario) -> Scenario:
    """Return the scenario with the size of the ship and the place of the antenna from the file of
    its track, where they are not given.

    Raises
    ------
    InputError : the file cannot be read, or the size is needed and not known
    """
    vessel = scenario.vessel
    if vessel.from_file:
        written = scenario.table.of("vessel.track", vessel.track)
        vessel = with_size_of_file(vessel, written)
    if vessel.hull is None and (scenario.keepout.from_hull or vessel.stack_from_bow_m is not None):
        needs = "keepout.from 'hull'" if scenario.keepout.from_hull else "vessel.stack_from_bow_m"
        raise InputError(
            f"{needs} needs the size of the ship, and nothing says it; give vessel.length_m and"
            " vessel.beam_m"
        )
    return scenario.model_copy(update={"vessel": vessel})


def antenna_offset(scenario: Scenario) -> tuple[float, float]:
    """Return the place of the antenna, ahead of the funnel and to starboard of it [m]."""
    hull = scenario.vessel.hull
    return AT_THE_FUNNEL if hull is None else hull.antenna_offset


def _check_track(part: str, track: VesselTruth, duration: float) -> None:
    """Raise a PluginError for an unusable track of a user; ``check_declared`` compares place and
    velocity.
    """
    if not isinstance(getattr(track, "manoeuvres_end", None), int | float | np.number):
        raise PluginError(
            f"{part} has no manoeuvres_end, the time at which its last manoeuvre ends [s]; give it"
            " one, math.nan without any"
        )
    for time in np.arange(0.0, duration, _LOOK_STEP).tolist():
        north, east, v_north, v_east = call_plugin(part, track.motion, time, result=_MOTION)
        course = call_plugin(part, track.course, time, result=_COURSE)
        if time == 0.0 and math.hypot(north, east) > _ORIGIN_MAX:
            raise PluginError(
                f"{part} begins at {north:g} m north and {east:g} m east; let it begin at the"
                " origin: motion(0)"
            )
        flown = math.atan2(v_east, v_north)
        if (
            math.hypot(v_north, v_east) > _AT_REST
            and abs(math.remainder(course - flown, math.tau)) > _COURSE_MAX
        ):
            raise PluginError(
                f"{part}: course({time:g}) is {course:.4g} rad, and the velocity of"
                f" motion({time:g}) points to {flown:.4g} rad; let"
                f" them agree to {_COURSE_MAX:.2g} rad, clockwise from north"
            )


def place_of(scenario: Scenario, vessel: VesselTruth) -> Place:
    """Return place and time of a flight's start, as far as they are known; without a time in the
    scenario, the first time of its wind.
    """
    if isinstance(vessel, AisVessel):
        return vessel.place
    place, table = given_place(scenario.place, scenario.source_height), scenario.wind.table
    if table is None or math.isfinite(place.utc):
        return place
    return replace(place, utc=first_time(table, place, scenario.table.of("wind.table", table)))


def mean_wind(scenario: Scenario, vessel: VesselTruth) -> WindField:
    """Return the mean wind of a scenario's flights."""
    return wind_of(scenario, place_of(scenario, vessel))


def plume_of(scenario: Scenario, vessel: VesselTruth) -> Plume:
    """Return the plume behind a vessel.

    Raises
    ------
    PluginError : there is no such plume model, or it cannot be made, or its axis is unusable
    """
    part, model = f"plume.model '{scenario.plume.model}'", PLUME_MODELS.get(scenario.plume.model)
    duration = scenario.flight.duration_max_s + TRACK_MARGIN
    section = scenario.plume.model_copy(update={"source_height_m": scenario.source_height})
    given = section, vessel, mean_wind(scenario, vessel), duration
    plume: Plume = call_plugin(part, model, *given, by_wind=scenario.plume_by_wind)
    if is_users(plume):
        for time in np.arange(0.0, duration, _LOOK_STEP).tolist():
            call_plugin(part, plume.axis, time, result=_AXIS)
    return plume


@dataclass(frozen=True, slots=True, kw_only=True)
class ApparentWind:
    """Speed of a vessel through the air.

    Attributes
    ----------
    at_start, least, greatest : at time 0, and over the whole track [m/s]
    """

    at_start: float
    least: float
    greatest: float


def apparent_wind(scenario: Scenario, vessel: VesselTruth) -> ApparentWind:
    """Return the speed of a vessel through the air at the height of its funnel, over the longest
    flight.
    """
    duration = scenario.flight.duration_max_s + TRACK_MARGIN
    (past,) = winds_past(vessel, mean_wind(scenario, vessel), [scenario.source_height], duration)
    return past


def winds_past(
    vessel: VesselTruth, wind: WindField, heights: Sequence[float], duration: float
) -> list[ApparentWind]:
    """Return the speed of a vessel through the air at each of some heights [m], over a duration
    [s].
    """
    if isinstance(vessel, SteadyVessel) and wind.constant:
        _, _, v_north, v_east = vessel.motion(0.0)
        wind_north, wind_east = wind.now(0.0, heights[0])
        steady = math.hypot(v_north - wind_north, v_east - wind_east)
        return [ApparentWind(at_start=steady, least=steady, greatest=steady)] * len(heights)
    velocity, _ = sampled(vessel, duration)
    times = track_times(duration)[: len(velocity)]
    return [
        _over_the_track(velocity - np.column_stack(wind.at(times, height))) for height in heights
    ]


def _over_the_track(through_air: npt.NDArray[np.float64]) -> ApparentWind:
    speeds = np.hypot(through_air[:, 0], through_air[:, 1])
    return ApparentWind(
        at_start=float(speeds[0]), least=float(speeds.min()), greatest=float(speeds.max())
    )
