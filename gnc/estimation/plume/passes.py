"""Passes of the vehicle over a plume's axis, and the evidence of a plume in their readings.

A pass is the way from turn to turn (``PassCollector``). Its readings are compared with pulses of a
plume (``PassReader``), unless the sensor does not work (``SensorWatch``).
"""

import math
from bisect import bisect_left
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gnc.estimation.plume.prior import BACKGROUND_DRIFT, GasSensor

Array = npt.NDArray[np.float64]

_EQUAL, _EQUAL_BY_NOISE = 10, 1e-12
"""Least number of equal readings of a stuck sensor, and the largest probability that noise makes as
many [-, -].
"""

_SILENT_INTERVALS, _SILENT_TIME = 5.0, 2.0
"""Number of reading intervals without a reading, and least time, after which a sensor counts as
silent [-, s].
"""

_TURNED = 5.0
"""Way back across the axis after which a pass is over [m]: more than the error of the position."""

_LONGEST = 25.0
"""Time after which a pass is over without a turn [s]."""

_FINE = 0.25
"""Time step of the path in the model of the sensor's lag [s]: 5 m at 20 m/s, about a spread."""

_ACROSS_MIN = 0.25
"""Least way across over way along, where the vehicle turns within the plume [-]."""

_READINGS_MIN = 4
"""Least number of readings of a pass [-]: fewer do not separate background and pulse."""

_SHAPE_ERROR = 0.15
"""Error of a reading by the plume's shape, over the largest reading [-]: an assumption."""

_TAIL_ERROR = 0.3
"""Relative error of the gas of the last pass that is still in the sensor [-]."""

_UNSEEN_DRIFT = 1.0
"""Time for which the level drifts after a pass: so much less certain than its fit is the level at
the end [s].
"""

_FIRST_BACKGROUND = 1e3
"""Standard deviation of the background before the first reading [ppm]: clean air has some 400."""

BEND_MIN = 1e-12
"""Least curvature of a likelihood [1/ppm^2]; it stands for places that the vehicle did not reach.
"""

_STILL = 0.1
"""Least range of the readings of a pass that is believed, over the sensor's noise [-]."""


class SensorState(Enum):
    """State of a sensor, as its readings show it."""

    WORKING = "working"
    SILENT = "silent"
    STUCK = "stuck"
    SATURATED = "saturated"


class SensorWatch:
    """Watches the readings of a sensor.

    The readings of a dead sensor whose noise is that of a working one look the same as clean air. A
    sensor whose noise is less than the step of its readings repeats them in clean air, too. So it
    takes more equal readings to show that it is stuck: 73 where the noise is half the step, 2,211
    at a fifth. Below a sixteenth of the step no number of readings shows it.

    Parameters
    ----------
    sensor : its data sheet

    Attributes
    ----------
    state : as the readings so far show it; it recovers when they do
    """

    def __init__(self, sensor: GasSensor) -> None:
        self._patience = max(_SILENT_TIME, _SILENT_INTERVALS * sensor.interval)
        self._saturated = sensor.saturated
        self._stuck_from = equal_readings(sensor)
        self._last = math.nan
        self._equal = 0
        self._waited = 0.0
        self.state = SensorState.WORKING

    def wait(self, time_step: float) -> None:
        """Let ``time_step`` [s] go by."""
        self._waited += time_step
        if self._waited > self._patience:
            self.state = SensorState.SILENT

    def read(self, reading: float) -> None:
        """Take in a reading [ppm]."""
        self._equal = self._equal + 1 if reading == self._last else 1
        self._last = reading
        self._waited = 0.0
        if reading >= self._saturated:
            self.state = SensorState.SATURATED
        elif self._equal >= self._stuck_from:
            self.state = SensorState.STUCK
        else:
            self.state = SensorState.WORKING


def equal_readings(sensor: GasSensor) -> float:
    """Return the number of equal readings in a row from which a sensor counts as stuck [-].

    It is infinite where no noise is visible in the readings. A reading is rounded to the step d,
    its noise is normal with the deviation s. Equal readings are most likely in air at a multiple of
    d: each repeats the one before with the probability erf(d/(2 sqrt(2) s)).
    """
    same = math.erf(sensor.resolution / (2.0 * math.sqrt(2.0) * sensor.noise))
    if same == 0.0:
        return _EQUAL
    if same == 1.0:
        return math.inf
    return max(_EQUAL, math.ceil(math.log(_EQUAL_BY_NOISE) / math.log(same)))


@dataclass(frozen=True, slots=True)
class Path:
    """The way from one side of the axis to the other, and the readings on it.

    Attributes
    ----------
    time, along, across, altitude : of the way, at equal steps, shape (n,) [s, m]
    read_at : when the air of each reading was at the inlet, shape (m,) [s]
    readings : shape (m,) [ppm]
    """

    time: Array
    along: Array
    across: Array
    altitude: Array
    read_at: Array
    readings: Array

    @property
    def duration(self) -> float:
        """Time from turn to turn, and for which the sensor still shows the way before [s]."""
        return float(self.time[-1] - self.time[0])

    def at(self, across: float) -> tuple[float, float]:
        """Return along and altitude [m] where the way is nearest to a place ``across`` [m]."""
        nearest = self._nearest(across)
        return float(self.along[nearest]), float(self.altitude[nearest])

    def obliqueness(self, across: float, apparent_wind: float) -> float:
        """Return the way along the plume over that across it, near a place [-].

        Parameters
        ----------
        across : of the place [m]
        apparent_wind : speed of the plume along its axis [m/s]
        """
        i = min(max(self._nearest(across), 1), len(self.time) - 2)
        duration = self.time[i + 1] - self.time[i - 1]
        along = abs(self.along[i + 1] - self.along[i - 1] - apparent_wind * duration)
        return float(along / max(abs(self.across[i + 1] - self.across[i - 1]), _ACROSS_MIN * along))

    def covered(self, places: Array, weights: Array) -> float:
        """Return the sum of the weights of the places across that the way covers; places ascend."""
        first, last = places.searchsorted((self.across.min(), self.across.max()))
        return float(weights[first:last].sum())

    def _nearest(self, across: float) -> int:
        return int(np.abs(self.across - across).argmin())


class _Place(NamedTuple):
    time: float
    along: float
    across: float
    altitude: float


class _Reading(NamedTuple):
    time: float
    value: float


class PassCollector:
    """Gathers places and readings until the vehicle has turned back and the sensor has answered.

    Parameters
    ----------
    delay : of the sensor [s]
    tail : time after a turn for which readings still belong to the pass before [s]
    """

    def __init__(self, *, delay: float, tail: float) -> None:
        self._delay = delay
        self._tail = tail
        self._places: list[_Place] = []
        self._readings: list[_Reading] = []
        self._farthest = math.nan
        self._farthest_at = math.nan
        self._side = 0.0
        self._turn: float | None = None

    def add(
        self, time: float, along: float, across: float, altitude: float, reading: float
    ) -> Path | None:
        """Take in a place and a reading; return the pass that is over, if one is.

        Parameters
        ----------
        time : [s]
        along, across, altitude : of the vehicle, in the frame of the predicted axis [m]
        reading : [ppm]; NaN without one
        """
        if self._places and time <= self._places[-1].time:
            self._places.pop()
        self._places.append(_Place(time, along, across, altitude))
        answered = time - self._delay
        if not math.isnan(reading):
            self._readings.append(_Reading(answered, reading))
        self._look_for_turn(time, across)
        if self._turn is None or answered < self._turn + self._tail:
            return None
        return self._closed(self._turn)

    def _look_for_turn(self, time: float, across: float) -> None:
        gone = across - self._farthest
        if self._side * gone > 0.0 or math.isnan(gone):
            self._farthest = across
            self._farthest_at = time
        elif not -_TURNED <= gone <= _TURNED:
            if self._side == 0.0:
                self._side = math.copysign(1.0, gone)
                self._farthest = across
                self._farthest_at = time
            elif self._turn is None:
                self._turn = self._farthest_at
                self._side = -self._side
                self._farthest = across
                self._farthest_at = time
        if self._turn is None and time - self._places[0].time > _LONGEST:
            self._turn = time

    def _closed(self, turn: float) -> Path | None:
        """Return the pass up to a turn [s], or None if it is too short; keep the rest."""
        places = self._places
        begin = places[0].time
        end = turn + self._tail
        readings = [reading for reading in self._readings if begin <= reading.time <= end]
        self._turn = None
        self._places = places[bisect_left(places, turn, key=lambda place: place.time) :]
        self._readings = [reading for reading in self._readings if reading.time > end]
        if len(readings) < _READINGS_MIN or turn - begin < 2.0 * _FINE:
            return None
        known_at, *known = np.array(places).T
        time = np.arange(begin, end + _FINE, _FINE)
        along, across, altitude = (np.interp(time, known_at, values) for values in known)
        read_at, values = np.array(readings).T
        return Path(time, along, across, altitude, read_at, values)


@dataclass(frozen=True, slots=True)
class Evidence:
    """The evidence in a pass's readings for a pulse of strength P at place j with spread w.

    The log likelihood of the pulse, less that of no pulse, is P ``slope`` - P^2 ``bend``/2, with
    noise, background and shape error together.

    Attributes
    ----------
    slope, bend : shape (w, j) [1/ppm, 1/ppm^2]
    response : largest reading that a pulse of strength 1 of the middle spread makes, where the axis
        is crossed best [-]
    at : index j of the pulse that fits best
    peak : largest reading above the background that this pulse makes [ppm]
    significance : strength of this pulse over its uncertainty by noise alone [-]
    """

    slope: Array
    bend: Array
    response: float
    at: int
    peak: float
    significance: float


class _Products(NamedTuple):
    """Products of templates T, readings y and background N, for k templates or for one.

    Attributes
    ----------
    read, square, covered : T' y, T' T and T' N, shapes (k,), (k,) and (k, 3)
    background : N' y, shape (3,)
    """

    read: Array
    square: Array
    covered: Array
    background: Array

    def of(self, index: int) -> "_Products":
        """Return the products of one template."""
        return _Products(self.read[index], self.square[index], self.covered[index], self.background)

    def projected(self, variance: float, inner: Array) -> tuple[Array, Array]:
        """Return slope and bend of ``Evidence``; parameters same as ``_inner``, and its result."""
        held = self.covered @ inner
        slope: Array = (self.read - held @ self.background) / variance
        bend: Array = (self.square - (held * self.covered).sum(axis=-1)) / variance
        return slope, bend


class PassReader:
    """Compares readings with pulses that are Gaussian across the plume.

    A pulse is read through the lag of the sensor, over a background that drifts. With T the
    response to a pulse of strength 1, N the columns of the background (level, slope, and the rest
    of the last pass in the sensor) times their prior deviations, and Sigma = sigma^2 I + N N' the
    covariance of readings y without a pulse,

        slope = T' Sigma^-1 y,    bend = T' Sigma^-1 T.

    Sigma^-1 costs a 3 by 3 system (Woodbury).

    Parameters
    ----------
    sensor : its data sheet

    Attributes
    ----------
    level, level_deviation : of the background at the end of the last pass; NaN before it [ppm]
    """

    def __init__(self, sensor: GasSensor) -> None:
        self._sensor = sensor
        self.level = math.nan
        self.level_deviation = _FIRST_BACKGROUND
        self._tail = 0.0
        self._ended = -math.inf

    def read(self, path: Path, places: Array, spreads: Array) -> Evidence | None:
        """Return the evidence of a pass, or None where its readings are not believed.

        Parameters
        ----------
        path : of the pass
        places : of the pulse across, shape (j,) [m]
        spreads : of the pulse, shape (w,) [m]
        """
        sensor = self._sensor
        low, middle, high = _spread_of(path.readings)
        if high - low < _STILL * sensor.noise:
            return None
        unread = max(0.0, float(path.time[0]) - self._ended)
        level = self.level
        if math.isnan(level):
            level = middle
            unread = 0.0
        elif unread > path.duration:
            self._tail = 0.0
        background, fading = self._background(path, unread)
        y = path.readings - level - self._tail * fading
        _, middle, high = _spread_of(y)
        noise = sensor.noise**2
        total = noise + (_SHAPE_ERROR * max(0.0, high - middle)) ** 2
        inner = _inner(background, total)
        templates = self.templates(path, places, spreads)
        products = _Products(
            templates @ y,
            (templates * templates).sum(axis=1),
            templates @ background.T,
            background @ y,
        )
        slope, bend = products.projected(total, inner)
        bend_up = np.maximum(bend, BEND_MIN)
        best = int((np.maximum(slope, 0.0) ** 2 / bend_up).argmax())
        alone_slope, alone_bend = products.of(best).projected(noise, _inner(background, noise))
        strength = max(0.0, float(slope[best] / bend_up[best]))
        pulse = strength * templates[best]
        self._settle(y - pulse, background, inner, total, level)
        self._ended = float(path.time[-1])
        self._tail = float(np.interp(self._ended - sensor.time_constant, path.read_at, pulse))
        of_middle = len(spreads) // 2 * len(places)
        return Evidence(
            slope=slope.reshape(len(spreads), -1),
            bend=bend.reshape(len(spreads), -1),
            response=float(templates[of_middle : of_middle + len(places)].max()),
            at=best % len(places),
            peak=float(pulse.max()),
            significance=float(alone_slope / math.sqrt(max(float(alone_bend), BEND_MIN))),
        )

    def _background(self, path: Path, unread: float) -> tuple[Array, Array]:
        """Return the columns N of the background, shape (3, m), and the fading of the last pass.

        Parameters
        ----------
        path : of the pass
        unread : time since the end of the last pass that was read, in which the level drifts [s]
        """
        sensor = self._sensor
        since = path.read_at - path.time[0]
        fading: Array = np.exp(-since / sensor.time_constant)
        background = np.empty((3, len(since)))
        background[0] = math.hypot(self.level_deviation, BACKGROUND_DRIFT * unread)
        background[1] = BACKGROUND_DRIFT * (since - 0.5 * since[-1])
        background[2] = (_TAIL_ERROR * abs(self._tail) + sensor.noise) * fading
        return background, fading

    def _settle(
        self, rest: Array, background: Array, inner: Array, variance: float, level: float
    ) -> None:
        """Take the level at the end of the pass from the readings less the pulse."""
        fitted = inner @ (background @ rest)
        end = background[:2, -1]
        self.level = level + float(end @ fitted[:2])
        deviation = math.sqrt(variance * float(end @ inner[:2, :2] @ end))
        self.level_deviation = deviation + _UNSEEN_DRIFT * BACKGROUND_DRIFT

    def templates(self, path: Path, places: Array, spreads: Array) -> Array:
        """Return the readings of pulses of strength 1; parameters same as ``read``.

        They are the readings at every place with every spread, shape (w j, m).
        """
        off = path.across - places[:, np.newaxis]
        off *= off
        pulses = np.exp(np.multiply.outer(-0.5 / spreads**2, off)).reshape(
            len(spreads) * len(places), -1
        )
        constant = self._sensor.time_constant
        # Each point of the path stands for the air from half a step before it to half a step after
        # it.
        after = np.maximum(path.read_at[:, np.newaxis] - path.time + 0.5 * _FINE, 0.0)
        before = np.maximum(after - _FINE, 0.0)
        lag = np.exp(before / -constant) - np.exp(after / -constant)
        result: Array = pulses @ lag.T
        return result


def _inner(background: Array, variance: float) -> Array:
    """Return (variance I + N N')^-1, shape (3, 3), of a background N, shape (3, m).

    By cofactors, since LAPACK takes ten times as long.
    """
    (a, b, c), (_, d, e), (_, _, f) = (background @ background.T).tolist()
    a += variance
    d += variance
    f += variance
    of_a = d * f - e * e
    of_b = c * e - b * f
    of_c = b * e - c * d
    of_d = a * f - c * c
    of_e = b * c - a * e
    of_f = a * d - b * b
    cofactors = np.array(((of_a, of_b, of_c), (of_b, of_d, of_e), (of_c, of_e, of_f)))
    cofactors /= a * of_a + b * of_b + c * of_c
    return cofactors


def _spread_of(values: Array) -> tuple[float, float, float]:
    """Return the least, the median (the upper one of an even number) and the largest value.

    Of few values numpy takes longer.
    """
    ordered = sorted(values.tolist())
    return ordered[0], ordered[len(ordered) // 2], ordered[-1]
