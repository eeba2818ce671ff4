"""The expected height and bearing of a plume's axis: predicted, given, or searched for."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr

from gnc.estimation.navigation import OwnMotion
from gnc.estimation.plume.estimator import HIT, PlumeEstimator, PlumeState
from gnc.estimation.plume.passes import SensorState
from gnc.estimation.plume.prior import Expectation, downwash, expected_plume, rise
from gnc.estimation.vessel import TargetMotion
from gnc.mission.mission import Mode
from gnc.numeric import clip, limited, wrap
from gnc.reference.moving_centre import MovingCentre

Array = npt.NDArray[np.float64]

_HEIGHT_STEP = 6.0
"""Step between the heights that are weighed [m]: less than the spread of a plume."""

_HORIZON = 8
"""Number of passes that the search plans ahead [-]."""

_KNOWN = 0.3
"""Deviation of the height, over the spread of a pass, below which the search stays at that height
[-].
"""

_PROBE_REACH = 1.6
"""Largest distance of a flown height from the estimated one, over its deviation [-]."""

_PROBES = np.linspace(0.0, 1.0, 9)
"""Number of heights that are weighed, from the lowest to the highest probe [-]."""

_PASSES_INFORMED = 3.0
"""Number of passes over which the information of one pass counts [-]: later passes have given as
much.
"""

_RUNG = 15.0
"""Step between the heights of a ladder [m]."""

_MODES = {
    PlumeState.SEARCHING: Mode.SEARCHING,
    PlumeState.FOUND: Mode.FOUND,
    PlumeState.LOST: Mode.LOST_AGAIN,
}

_BEARING_TIME = 15.0
"""Time constant with which the centre of oscillation follows the estimated bearing [s]."""

_NOTED = 0.75
"""Time between readings beyond which the estimator gets a position in between [s]."""

_SILENT = 2.0
"""Time without readings after which the estimator is informed of the gap [s]."""

_DECIDED = 10.0
"""Least time for which a chosen height is held once the plume is found [s]."""

_PASS_TIME = 8.0
"""Time between passes that is assumed before the first two [s]."""

_PASS_MEMORY = 0.3
"""Weight of the last pass in the mean time between them [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisHeight:
    """The expected height of the axis over the distance from the stack.

    Attributes
    ----------
    source : height of the stack's mouth above the sea [m]
    climb : slope of the axis [-]
    momentum_flux, buoyancy_flux : of the assumed exhaust; 0 for an axis without plume rise
        [m^4/s^2, m^4/s^3]
    stack_diameter, exhaust_speed : at the stack's mouth, whose wake draws the plume down; 0
        without exhaust [m, m/s]
    lowest, highest : altitudes that are flown [m]
    """

    source: float
    climb: float = 0.0
    momentum_flux: float = 0.0
    buoyancy_flux: float = 0.0
    stack_diameter: float = 0.0
    exhaust_speed: float = 0.0
    lowest: float = 0.0
    highest: float = float("inf")

    def at(self, distance: float, speed: float) -> float:
        """Return the height above the sea, at a distance from the stack in an apparent wind [m].

        Parameters
        ----------
        distance : behind the stack [m]
        speed : of the apparent wind [m/s]
        """
        mouth = max(0.0, self.source - downwash(self.stack_diameter, self.exhaust_speed, speed))
        climbed = rise(self.momentum_flux, self.buoyancy_flux, distance, speed)
        return clip(mouth + self.climb * distance + climbed, self.lowest, self.highest)


@dataclass(frozen=True, slots=True, kw_only=True)
class Climb:
    """The slow way in which the commanded altitude follows the demanded one, so that the autopilot
    follows.

    Attributes
    ----------
    time : constant of the lag [s]
    gradient : steepest climb or descent over the vehicle's way [-]
    reach : largest distance of the command from the present altitude [m]: an autopilot that has
        fallen behind by more may stop its integrator, and come back slowly
    """

    time: float
    gradient: float
    reach: float = math.inf

    def step(
        self,
        altitude: float,
        demanded: float,
        speed: float,
        time_step: float,
        *,
        flown: float = math.nan,
    ) -> float:
        """Return the altitude to command a time step later [m].

        Parameters
        ----------
        altitude, demanded : commanded now, and demanded in the end [m]
        speed : of the vehicle [m/s]
        time_step : [s]
        flown : altitude now; NaN where it is unknown [m]
        """
        rate = limited((demanded - altitude) / self.time, self.gradient * speed)
        following = altitude + time_step * rate
        return following if math.isnan(flown) else flown + limited(following - flown, self.reach)


class AxisInputs(NamedTuple):
    """The inputs from which the expected axis of a plume is computed.

    Attributes
    ----------
    own, vessel : motion of the vehicle and of the vessel
    centre : of oscillation
    speed : V_r [m/s]
    plan_time : between plans [s]
    """

    own: OwnMotion
    vessel: TargetMotion
    centre: MovingCentre
    speed: float
    plan_time: float

    @property
    def apparent_wind(self) -> float:
        """Speed of the air past the vessel, by the centre of oscillation [m/s]."""
        return self.centre.speed_ratio * self.speed


class ExpectedAxis:
    """Where the axis is expected during one flight.

    Parameters
    ----------
    parameters : how the axis is known
    mode : initial mode while the reference is tracked

    Attributes
    ----------
    climb : how the altitude follows
    flown : altitude now; NaN where it is unknown [m]
    demanded : altitude to fly [m]
    bearing : of the centre of oscillation, to the right of where the plume trails behind the
        vessel's motion through the air [rad]
    mode : mode while the reference is tracked
    """

    def __init__(self, parameters: "AxisParameters", mode: Mode) -> None:
        self._height = parameters.height
        self.climb = parameters.climb
        self.flown = math.nan
        self.demanded = parameters.altitude
        self.bearing = 0.0
        self.mode = mode

    def plan(self, time: float, inputs: AxisInputs, *, tracking: bool) -> None:
        """Update the expectation; ``tracking`` says whether the reference is tracked."""
        raise NotImplementedError


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisParameters:
    """How a plume's axis is known.

    Attributes
    ----------
    height : predicted height of the axis, and lowest and highest altitude that are flown
    altitude : at the start [m]
    climb : how the altitude follows
    """

    height: AxisHeight
    altitude: float
    climb: Climb

    def begin(self) -> ExpectedAxis:
        """Return the axis at the beginning of a flight."""
        raise NotImplementedError


def trail(own: OwnMotion, vessel: TargetMotion) -> float:
    """Return the course along which a plume trails behind the vessel, as estimated [rad]."""
    north, east = apparent_wind(own, vessel)
    return math.atan2(east, north)


def apparent_wind(own: OwnMotion, vessel: TargetMotion) -> tuple[float, float]:
    """Return the velocity of the air past the vessel, north and east, as estimated [m/s]."""
    return own.wind_north - vessel.velocity_north, own.wind_east - vessel.velocity_east


# A plume that is predicted, or given.


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictedPlume(AxisParameters):
    """A plume whose axis is predicted from wind, vessel and the rise of exhaust, or given."""

    def begin(self) -> "PredictedAxis":
        """Return the axis at the beginning of a flight."""
        return PredictedAxis(self)


class PredictedAxis(ExpectedAxis):
    """The predicted axis, or the true one once it is given."""

    def __init__(self, parameters: PredictedPlume) -> None:
        super().__init__(parameters, Mode.TRACKING)
        self._true_axis: tuple[float, float] | None = None

    def set_true_axis(self, height: float, course: float) -> None:
        """Set the axis at the centre of oscillation: height above the sea [m], course [rad]."""
        self._true_axis = height, course

    def plan(self, time: float, inputs: AxisInputs, *, tracking: bool) -> None:  # noqa: ARG002 - of the base
        """Demand the given height, or the one predicted at the centre, within the limits."""
        if self._true_axis is None:
            self.demanded = self._height.at(inputs.centre.distance, inputs.apparent_wind)
            return
        height, course = self._true_axis
        self.demanded = clip(height, self._height.lowest, self._height.highest)
        self.bearing = wrap(course - trail(inputs.own, inputs.vessel))


# A plume that is searched for: which height to cross next.


class Search(Protocol):
    """Decides how high to fly next, after a pass (``PlumeEstimator.update`` returned True)."""

    def next_altitude(self, estimator: PlumeEstimator, altitude: float, pass_time: float) -> float:
        """Return the altitude of the next crossing above the sea, within the limits [m].

        Parameters
        ----------
        estimator : after its last pass
        altitude : of the vehicle now [m]
        pass_time : between passes [s]
        """


class HeightSearch:
    """Maximises the probability of detection per time, then reduces the uncertainty of the height,
    and stays there.

    During the search, each height is weighed by the passes on the way to it and at it. The sum over
    these passes of the probability that the plume has been detected by then is largest for the
    height with the least expected time to find. Misses of the same plume are not independent, but
    they are for a given cell of the estimate.

    Parameters
    ----------
    lowest, highest : altitudes that may be flown [m]: the limits of the flight, the terrain and the
        keep-out area together
    climb_rate : at which the vehicle climbs and sinks [m/s]
    """

    def __init__(self, *, lowest: float, highest: float, climb_rate: float) -> None:
        self._lowest = lowest
        self._highest = highest
        self._climb_rate = climb_rate
        count = max(2, 1 + math.ceil((highest - lowest) / _HEIGHT_STEP))
        self._heights: Array = np.linspace(lowest, highest, count)

    def next_altitude(self, estimator: PlumeEstimator, altitude: float, pass_time: float) -> float:
        """Return the altitude of the next crossing [m]; see ``Search``."""
        if estimator.state is not PlumeState.FOUND:
            return self._soonest(estimator, altitude, self._climb_rate * pass_time)
        return self._most_hits(estimator)

    def _most_hits(self, estimator: PlumeEstimator) -> float:
        """Return the height with the most expected hits, now and after the pass [m]."""
        height = estimator.height
        deviation = estimator.height_deviation
        spread = estimator.sigma_z
        meander = estimator.meander_z
        if deviation < _KNOWN * math.hypot(spread, meander):
            return clip(height, self._lowest, self._highest)
        low, high = (
            clip(height + side * _PROBE_REACH * deviation, self._lowest, self._highest)
            for side in (-1.0, 1.0)
        )
        altitudes = low + (high - low) * _PROBES
        off = np.hypot(estimator.expected_deviation(altitudes), meander)
        later = 2.0 * ndtr(math.sqrt(-2.0 * math.log(HIT)) * spread / off) - 1.0
        hits = estimator.hits(altitudes) + _PASSES_INFORMED * later
        return float(altitudes[int(hits.argmax())])

    def _soonest(self, estimator: PlumeEstimator, altitude: float, climb: float) -> float:
        """Return the height with the least expected time to find [m].

        ``climb`` is the change of altitude that a pass leaves time for [m].
        """
        weights, chances = estimator.prospects(self._heights)
        missed = 1.0 - chances
        steps = climb * np.arange(1, _HORIZON + 1)
        way = altitude + np.clip(self._heights[:, np.newaxis] - altitude, -steps, steps)
        step = self._heights[1] - self._heights[0]
        index = np.clip(
            np.rint((way - self._lowest) / step).astype(np.intp), 0, len(self._heights) - 1
        )
        still = np.ones_like(missed)
        lost = np.zeros(len(self._heights))
        for k in range(_HORIZON):
            still *= missed[index[:, k]]
            lost += np.tensordot(still, weights)
        return float(self._heights[int(lost.argmin())])


class LadderSearch:
    """Goes up and down a ladder of heights, one a pass, until the plume is found, and stays at its
    height.

    Parameters
    ----------
    lowest, highest : altitudes that may be flown [m]
    """

    def __init__(self, *, lowest: float, highest: float) -> None:
        self._lowest = lowest
        self._highest = highest
        self._rung = _RUNG

    def next_altitude(self, estimator: PlumeEstimator, altitude: float, pass_time: float) -> float:  # noqa: ARG002 - of the Protocol
        """Return the altitude of the next crossing [m]; see ``Search``."""
        height = estimator.height
        if estimator.state is not PlumeState.FOUND:
            if not self._lowest < altitude + self._rung < self._highest:
                self._rung = -self._rung
            height = altitude + self._rung
        return clip(height, self._lowest, self._highest)


# A plume that is searched for: its axis, as it is estimated from readings.


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchedPlume(AxisParameters):
    """A plume that is searched for; on the way to it the predicted height is flown.

    Attributes
    ----------
    height, altitude, climb : same as ``AxisParameters``
    expected : of ship and sensor
    climb_rate : at which the vehicle climbs and sinks [m/s]
    ladder : whether a ladder of heights is flown until the plume is found, instead of the most
        informative height
    """

    expected: Expectation
    climb_rate: float
    ladder: bool = False

    def begin(self) -> "SearchedAxis":
        """Return the axis at the beginning of a flight."""
        return SearchedAxis(self)


@dataclass(slots=True)
class PlumeEstimate:
    """The estimate of a plume after the last pass; NaN before it is searched for.

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


class _Fix(NamedTuple):
    """Where the vehicle was at a time [s], north and east of the vessel and above the sea [m]."""

    time: float
    north: float
    east: float
    altitude: float


class SearchedAxis(ExpectedAxis):
    """The axis as it is estimated from readings once the reference is tracked.

    Attributes
    ----------
    estimate : after the last pass
    sensor : state of the sensor, as its readings show it
    """

    def __init__(self, parameters: SearchedPlume) -> None:
        super().__init__(parameters, Mode.SEARCHING)
        self._expected = expected = parameters.expected
        self.estimate = PlumeEstimate()
        self.sensor = SensorState.WORKING
        self._search: Search
        if parameters.ladder:
            self._search = LadderSearch(lowest=expected.lowest, highest=expected.highest)
        else:
            self._search = HeightSearch(
                lowest=expected.lowest,
                highest=expected.highest,
                climb_rate=parameters.climb_rate,
            )
        self._estimator: PlumeEstimator | None = None
        self._inputs: AxisInputs | None = None
        self._fixes: list[_Fix] = []
        self._last_note = 0.0
        self._last_pass = 0.0
        self._decide_at = 0.0
        self._pass_time = _PASS_TIME
        self._bearing_demand = 0.0

    def measurable(self) -> float:
        """Return the probability that the plume can be crossed within the altitudes flown [-].

        It is costly to compute; NaN before the search.
        """
        return self._estimator.measurable if self._estimator is not None else math.nan

    def take_readings(self, time: float, readings: Sequence[tuple[float, float]]) -> None:
        """Note the place now, and the readings since the last call.

        Parameters
        ----------
        time : now [s]
        readings : pairs of time [s] and reading [ppm], in the order of time
        """
        estimator = self._estimator
        inputs = self._inputs
        if estimator is None or inputs is None:
            return
        own = inputs.own
        vessel = inputs.vessel
        north = own.ground_north - vessel.north
        east = own.ground_east - vessel.east
        self._fixes.append(_Fix(time, north, east, self.flown))
        for read_at, reading in readings:
            if read_at - self._last_note > _NOTED:
                self._note(estimator, inputs, 0.5 * (self._last_note + read_at), math.nan)
            self._note(estimator, inputs, read_at, reading)
        if readings:
            del self._fixes[:-2]
        elif time - self._last_note > _SILENT:
            self._note(estimator, inputs, time, math.nan)

    def plan(self, time: float, inputs: AxisInputs, *, tracking: bool) -> None:
        """Follow the prediction on the way; search once the reference is first tracked."""
        self._inputs = inputs
        if self._estimator is None:
            if not tracking:
                self.demanded = self._height.at(inputs.centre.distance, inputs.apparent_wind)
                return
            self._estimator = self._begin_search(time, inputs)
        self.bearing += (self._bearing_demand - self.bearing) * min(
            1.0, inputs.plan_time / _BEARING_TIME
        )
        self.sensor = self._estimator.sensor
        if self.sensor is SensorState.WORKING:
            self.mode = _MODES[self._estimator.state]
        else:
            self.mode = Mode.SENSOR_FAILED

    def _begin_search(self, time: float, inputs: AxisInputs) -> PlumeEstimator:
        # The wind at the vehicle's height is used: its change with height is not known on board.
        prior = expected_plume(
            self._expected,
            distance=inputs.centre.distance,
            apparent_wind=inputs.apparent_wind,
            wind_speed=math.hypot(inputs.own.wind_north, inputs.own.wind_east),
        )
        estimator = PlumeEstimator(prior)
        self._last_note = time
        self._last_pass = time
        self._keep_estimate(estimator)
        self._decide(estimator, self.demanded)
        return estimator

    def _note(
        self, estimator: PlumeEstimator, inputs: AxisInputs, at: float, reading: float
    ) -> None:
        """Give the estimator the place at a time [s], and the reading there [ppm]."""
        fix = _fix_at(self._fixes, at)
        wind_north, wind_east = apparent_wind(inputs.own, inputs.vessel)
        speed = math.hypot(wind_north, wind_east) or 1.0
        # From the vessel along the predicted axis, and to its right.
        along = (fix.north * wind_north + fix.east * wind_east) / speed
        across = (fix.east * wind_north - fix.north * wind_east) / speed
        if at > self._last_note:
            estimator.predict(at - self._last_note)
            self._last_note = at
        passed = estimator.update(
            along, across, fix.altitude, reading, apparent_wind=inputs.apparent_wind
        )
        if not passed:
            return
        self._pass_time += _PASS_MEMORY * (at - self._last_pass - self._pass_time)
        self._last_pass = at
        # Bearing from the stack: the pass may have been nearer than the orbit's centre, or farther.
        self._bearing_demand = estimator.bearing
        self._keep_estimate(estimator)
        if estimator.state is not PlumeState.FOUND or at >= self._decide_at:
            self._decide(estimator, fix.altitude)

    def _decide(self, estimator: PlumeEstimator, altitude: float) -> None:
        """Choose the altitude of the next crossing."""
        self.demanded = self._search.next_altitude(estimator, altitude, self._pass_time)
        self._decide_at = self._last_pass + _DECIDED

    def _keep_estimate(self, found: PlumeEstimator) -> None:
        self.estimate = PlumeEstimate(
            height=found.height,
            height_deviation=found.height_deviation,
            offset=found.offset,
            offset_deviation=found.offset_deviation,
            spread=found.sigma_z,
            spread_across=found.sigma_y,
            innovation=found.innovation,
        )


def _fix_at(fixes: Sequence[_Fix], time: float) -> _Fix:
    """Return the place at a time [s], interpolated between known places; at least one is known."""
    later = len(fixes) - 1
    while later > 0 and fixes[later - 1].time >= time:
        later -= 1
    then = fixes[later]
    before = fixes[max(0, later - 1)]
    if then.time > before.time:
        fraction = clip((time - before.time) / (then.time - before.time), 0.0, 1.0)
    else:
        fraction = 1.0
    return _Fix(
        time,
        before.north + fraction * (then.north - before.north),
        before.east + fraction * (then.east - before.east),
        before.altitude + fraction * (then.altitude - before.altitude),
    )
