"""A plume's axis that is searched for, and followed by what is read of it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from gnc.estimation.plume.estimator import PlumeEstimator, PlumeState
from gnc.estimation.plume.passes import SensorState
from gnc.estimation.plume.prior import Expectation, expected_plume
from gnc.mission.axis_height import AxisHeight
from gnc.mission.mode import Mode
from gnc.mission.plume_axis import Climb, Situation, apparent_wind
from gnc.mission.plume_search import HeightSearch, LadderSearch, Search
from gnc.numeric import clip

_MODES = {
    PlumeState.SEARCHING: Mode.SEARCHING,
    PlumeState.FOUND: Mode.FOUND,
    PlumeState.LOST: Mode.LOST_AGAIN,
}

_BEARING_TIME = 15.0
"""Time in which the centre of oscillation follows the bearing that is estimated [s]: it is swung
round the vessel gently.
"""

_NOTED, _SILENT = 0.75, 2.0
"""Time between readings beyond which the estimator gets a position in between, and beyond which it
is informed of silence [s].
"""

_DECIDED = 10.0
"""Time for which a height that was chosen holds at least once the plume is found [s]: what is known
of it changes more slowly.
"""

Place = tuple[float, float, float, float]
"""Time [s], place north and east of the vessel, altitude [m]."""

_PASS_TIME, _PASS_MEMORY = 8.0, 0.3
"""Time between passes before the first two [s], and weight of the last one in its mean [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchedPlume:
    """A plume that is searched for.

    Attributes
    ----------
    height : of the axis as it is predicted, flown at on the way
    altitude : at the start [m]
    climb : how the altitude follows
    expected : of ship and sensor
    climb_rate : that the vehicle climbs and sinks at [m/s]
    ladder : whether a ladder of heights is flown until it is found, instead of the most informative
        height
    """

    height: AxisHeight
    altitude: float
    climb: Climb
    expected: Expectation
    climb_rate: float
    ladder: bool = False

    def search(self) -> Search:
        """Return what decides where to cross next, fresh."""
        lowest, highest = self.expected.lowest, self.expected.highest
        if self.ladder:
            return LadderSearch(lowest=lowest, highest=highest)
        return HeightSearch(lowest=lowest, highest=highest, climb_rate=self.climb_rate)

    def begin(self) -> "SearchedAxis":
        """Return the axis of one flight."""
        return SearchedAxis(self)


@dataclass(slots=True)
class PlumeEstimate:
    """What was believed of a plume after the last pass; not a number before it is searched for.

    Attributes
    ----------
    height, height_deviation : of the axis above the sea [m]
    offset, offset_deviation : of the axis to the right of the predicted one [m]
    spread, spread_across : of one realisation in height and across [m]
    innovation : mean normalised innovation squared [-]
    """

    height: float = math.nan
    height_deviation: float = math.nan
    offset: float = math.nan
    offset_deviation: float = math.nan
    spread: float = math.nan
    spread_across: float = math.nan
    innovation: float = math.nan


class SearchedAxis:
    """The axis as it is estimated from readings, once the reference is tracked; attributes as of
    ``PlumeAxis``, and more.

    Attributes
    ----------
    estimate : what was believed after the last pass
    sensor : what the readings say of their sensor
    """

    __slots__ = (
        "_bearing", "_decide_at", "_estimator", "_last_note", "_last_pass", "_parameters", "_pass_time", "_places", "_search",
        "_situation", "bearing", "climb", "demanded", "estimate", "flown", "mode", "sensor",
    )  # fmt: skip

    def __init__(self, parameters: SearchedPlume) -> None:
        self._parameters, self.climb, self.demanded = (
            parameters,
            parameters.climb,
            parameters.altitude,
        )
        self._estimator: PlumeEstimator | None = None
        self._search = parameters.search()
        self._situation: Situation | None = None
        self._places: list[Place] = []
        self._last_note = self._last_pass = self._decide_at = 0.0
        self._pass_time, self._bearing, self.bearing, self.flown, self.mode = (
            _PASS_TIME,
            0.0,
            0.0,
            math.nan,
            Mode.SEARCHING,
        )
        self.estimate, self.sensor = PlumeEstimate(), SensorState.WORKING

    def measurable(self) -> float:
        """Return the probability that the plume can be crossed within the altitudes that are flown
        [-]; costly.
        """
        return self._estimator.measurable if self._estimator is not None else math.nan

    def take_readings(self, time: float, readings: Sequence[tuple[float, float]]) -> None:
        """Take note of the place now, and of what was read since the last readings came, each with
        its own time [s].
        """
        situation = self._situation
        if self._estimator is None or situation is None:
            return
        own, target = situation.own, situation.target
        self._places.append(
            (time, own.ground_north - target.north, own.ground_east - target.east, self.flown)
        )
        for read_at, reading in readings:
            if read_at - self._last_note > _NOTED:
                self._note(0.5 * (self._last_note + read_at), math.nan)
            self._note(read_at, reading)
        if readings:
            del self._places[:-2]
        elif time - self._last_note > _SILENT:
            self._note(time, math.nan)

    def plan(self, time: float, situation: Situation, *, tracking: bool) -> None:
        """Begin to search where the reference is first tracked; follow the prediction on the way
        there.
        """
        p, self._situation = self._parameters, situation
        wind = situation.centre.speed_ratio * situation.speed
        if self._estimator is None:
            if not tracking:
                self.demanded = p.height.at(situation.centre.distance, wind)
                return
            # At the vehicle's height: nobody on board knows how it changes with height.
            blowing = math.hypot(situation.own.wind_north, situation.own.wind_east)
            distance = situation.centre.distance
            prior = expected_plume(
                p.expected, distance=distance, apparent_wind=wind, wind_speed=blowing
            )
            self._estimator = PlumeEstimator(prior)
            self._last_note = self._last_pass = time
            self._take_note(self._estimator)
            self._decide(self._estimator, self.demanded)
        self.bearing += (self._bearing - self.bearing) * min(
            1.0, situation.plan_time / _BEARING_TIME
        )
        self.sensor = self._estimator.sensor
        self.mode = (
            _MODES[self._estimator.state]
            if self.sensor is SensorState.WORKING
            else Mode.SENSOR_FAILED
        )

    def _note(self, at: float, reading: float) -> None:
        """Give the estimator the position at a time [s], and the reading there [ppm]."""
        situation, estimator = self._situation, self._estimator
        if situation is None or estimator is None:
            return
        north, east, altitude = _place_at(self._places, at)
        along, across = _seen_along(situation, north, east)
        if at > self._last_note:
            estimator.predict(at - self._last_note)
            self._last_note = at
        wind = situation.centre.speed_ratio * situation.speed
        if estimator.update(along, across, altitude, reading, apparent_wind=wind):
            self._pass_time += _PASS_MEMORY * (at - self._last_pass - self._pass_time)
            self._last_pass = at
            # As seen from the funnel: the pass may have been nearer than the orbit's centre, or
            # farther away.
            self._bearing = estimator.bearing
            self._take_note(estimator)
            if estimator.state is not PlumeState.FOUND or at >= self._decide_at:
                self._decide(estimator, altitude)

    def _decide(self, estimator: PlumeEstimator, altitude: float) -> None:
        """Choose how high to cross next."""
        self.demanded = self._search.next_altitude(estimator, altitude, self._pass_time)
        self._decide_at = self._last_pass + _DECIDED

    def _take_note(self, found: PlumeEstimator) -> None:
        self.estimate = PlumeEstimate(
            found.height, found.height_deviation, found.offset, found.offset_deviation, found.sigma_z,
            found.sigma_y, found.innovation,
        )  # fmt: skip


def _seen_along(situation: Situation, north: float, east: float) -> tuple[float, float]:
    """Return where a place north and east of the vessel is along the predicted axis and to the
    right of it [m].
    """
    wind_north, wind_east = apparent_wind(situation.own, situation.target)
    speed = math.hypot(wind_north, wind_east) or 1.0
    return (north * wind_north + east * wind_east) / speed, (
        east * wind_north - north * wind_east
    ) / speed


def _place_at(places: Sequence[Place], time: float) -> tuple[float, float, float]:
    """Return the place at a time [s] between those that are known, of which there is one at least."""
    later = len(places) - 1
    while later > 0 and places[later - 1][0] >= time:
        later -= 1
    then, before = places[later], places[max(0, later - 1)]
    share = (
        clip((time - before[0]) / (then[0] - before[0]), 0.0, 1.0) if then[0] > before[0] else 1.0
    )
    _, north, east, altitude = before
    return (
        north + share * (then[1] - north),
        east + share * (then[2] - east),
        altitude + share * (then[3] - altitude),
    )
