"""What one pass over a plume's axis says: for each place of the axis, how well a pulse of each strength fits the readings."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gnc.estimation.plume_prior import GasSensor

Array = npt.NDArray[np.float64]

_TURNED = 5.0
"""Distance that the vehicle goes back across by which a pass is over [m]: more than its place is uncertain."""

_LONGEST = 25.0
"""Time after which a pass is over without a turn [s]."""

_FINE = 0.25
"""Step of the concentration along the path that the sensor's lag is computed from [s]: 5 m at 20 m/s, about a spread."""

_BESIDE = 0.25
"""Least way across over that along, where the vehicle turns within the plume [-]: the turn is short."""

_READINGS_MIN = 4
"""Least readings of a pass [-]: with fewer, background and pulse cannot be told apart."""

_SHAPE_ERROR = 0.15
"""Error of a reading that a plume not of the expected shape makes, over the largest of the pass [-]: an assumption."""

_TAIL_ERROR = 0.3
"""Error of what is left of the pass before in the sensor, over itself [-]: as the strength of a pass is known."""

_FIRST_BACKGROUND = 1e3
"""Standard deviation of the background before anything is read [ppm]: clean air has some 400."""

_BEND_MIN = 1e-12
"""Least curvature of a likelihood [1/ppm^2]: a place that the vehicle has not been to says nothing."""

_STILL = 0.1
"""Scatter of a pass over the sensor's noise below which its readings are not believed [-]."""


class Place(NamedTuple):
    """Where the vehicle is, in the frame of the predicted axis [m], at a time [s]."""

    time: float
    along: float
    across: float
    altitude: float


@dataclass(frozen=True, slots=True)
class Path:
    """The way from one side of the axis to the other, and what was read on it.

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
        """Time from turn to turn [s]."""
        return float(self.time[-1] - self.time[0])

    def at(self, across: float) -> tuple[float, float]:
        """Return along and altitude [m] where the way is nearest to a place ``across`` [m]."""
        nearest = self._nearest(across)
        return float(self.along[nearest]), float(self.altitude[nearest])

    def drawn_out(self, across: float, apparent_wind: float) -> float:
        """Return how far along the plume, over how far across it, the vehicle goes by the place nearest to ``across`` [-].

        Parameters
        ----------
        across : [m]
        apparent_wind : with which the plume itself moves along [m/s]
        """
        i = min(max(self._nearest(across), 1), len(self.time) - 2)
        along = self.along[i + 1] - self.along[i - 1] - apparent_wind * (self.time[i + 1] - self.time[i - 1])
        return float(abs(along) / max(abs(self.across[i + 1] - self.across[i - 1]), _BESIDE * abs(along)))

    def covers(self, places: Array) -> Array:
        """Return 1 for each place across that the way goes over, and 0 for others, shape as given [-]."""
        return np.where((places >= self.across.min()) & (places <= self.across.max()), 1.0, 0.0)

    def _nearest(self, across: float) -> int:
        return int(np.abs(self.across - across).argmin())


class PassCollector:
    """Gathers places and readings until the vehicle has turned back and the sensor has answered.

    Parameters
    ----------
    delay, tail : of the sensor, and how long after a turn what it reads belongs to the pass before [s]
    """

    __slots__ = ("_delay", "_extreme", "_places", "_readings", "_side", "_tail", "_turn")

    def __init__(self, *, delay: float, tail: float) -> None:
        self._delay, self._tail = delay, tail
        self._places: list[Place] = []
        self._readings: list[tuple[float, float]] = []
        self._extreme: Place | None = None
        self._side = 0.0
        self._turn: float | None = None

    def add(self, place: Place, reading: float) -> Path | None:
        """Take note of a place and of a reading [ppm], or of none (not a number); return the pass that is over, if one is."""
        if self._places and place.time <= self._places[-1].time:
            self._places.pop()
        self._places.append(place)
        if not math.isnan(reading):
            self._readings.append((place.time - self._delay, reading))
        self._look_for_turn(place)
        if self._turn is None or place.time - self._delay < self._turn + self._tail:
            return None
        return self._closed(self._turn)

    def _look_for_turn(self, place: Place) -> None:
        if self._extreme is None:
            self._extreme = place
        gone = place.across - self._extreme.across
        if self._side == 0.0:
            self._side = math.copysign(1.0, gone) if abs(gone) > _TURNED else 0.0
        if self._side * gone > 0.0:
            self._extreme = place
        elif self._side != 0.0 and abs(gone) > _TURNED and self._turn is None:
            self._turn = self._extreme.time
            self._side, self._extreme = -self._side, place
        if self._turn is None and place.time - self._places[0].time > _LONGEST:
            self._turn = place.time

    def _closed(self, turn: float) -> Path | None:
        places, readings = self._places, self._readings
        begun = places[0].time
        self._turn = None
        self._places = [place for place in places if place.time >= turn]
        end = turn + self._tail
        self._readings = [reading for reading in readings if reading[0] > end]
        inside = [reading for reading in readings if begun <= reading[0] <= end]
        if len(inside) < _READINGS_MIN or turn - begun < 2.0 * _FINE:
            return None
        known = np.array(places)
        time = np.arange(begun, end + _FINE, _FINE)
        along, across, altitude = (np.interp(time, known[:, 0], known[:, i]) for i in (1, 2, 3))
        read_at, values = np.array(inside).T
        return Path(time, along, across, altitude, read_at, values)


@dataclass(frozen=True, slots=True)
class Evidence:
    """What a pass says of a pulse of strength P at place j with spread w: log likelihood P ``slope`` - P^2 ``bend``/2.

    It is the one of noise, background and shape error together, less that of no pulse at all.

    Attributes
    ----------
    slope, bend : shape (w, j) [1/ppm, 1/ppm^2]
    response : largest reading that a pulse of strength 1 of the middle spread makes, where the axis is crossed best [-]
    strength, at, spread : of the pulse that fits best: its strength [ppm], and its indices j and w
    peak : largest reading above the background that this pulse makes [ppm]
    significance : strength of this pulse over its uncertainty by noise alone [-]
    """

    slope: Array
    bend: Array
    response: float
    strength: float
    at: int
    spread: int
    peak: float
    significance: float


class PassReader:
    """Compares readings with pulses: Gaussian in the place across, through the lag of the sensor, over a background that drifts.

    With T the response to a pulse of strength 1, N the columns of the background (level, slope, and what is left of the pass before
    in the sensor) with prior deviations D, and Sigma = sigma^2 I + N D^2 N' the covariance of readings y without a pulse,

        slope = T' Sigma^-1 y,    bend = T' Sigma^-1 T.

    Sigma^-1 costs a 3 by 3 system (Woodbury).

    Parameters
    ----------
    sensor : its data sheet
    """

    __slots__ = ("_ended", "_level", "_level_deviation", "_sensor", "_tail")

    def __init__(self, sensor: GasSensor) -> None:
        self._sensor = sensor
        self._level, self._level_deviation = math.nan, _FIRST_BACKGROUND
        self._tail, self._ended = 0.0, -math.inf

    def read(self, path: Path, places: Array, spreads: Array) -> Evidence | None:
        """Return what a pass says, or nothing where its readings are not believed.

        Parameters
        ----------
        path : of the pass
        places : of the pulse across, shape (j,) [m]
        spreads : of the pulse, shape (w,) [m]
        """
        sensor, y = self._sensor, path.readings
        if float(y.std()) < _STILL * sensor.noise:
            return None
        templates = self._templates(path, places, spreads)
        since = path.read_at - path.time[0]
        level = _median(y) if math.isnan(self._level) else self._level
        if path.time[0] - self._ended > path.duration:
            self._tail = 0.0
        fading = np.exp(-since / sensor.time_constant)
        y = y - level - self._tail * fading
        drift = sensor.background_drift
        background = np.stack(
            [
                np.full(len(y), self._level_deviation),
                drift * (since - 0.5 * since[-1]),
                (_TAIL_ERROR * abs(self._tail) + sensor.noise) * fading,
            ]
        )
        noise = sensor.noise**2
        total = noise + (_SHAPE_ERROR * max(0.0, float(y.max()) - _median(y))) ** 2
        inner = _inner(background, total)
        slope, bend = _projected(templates, y, background, total, inner)
        gain = np.where(slope > 0.0, slope, 0.0) ** 2 / np.maximum(bend, _BEND_MIN)
        best = int(gain.argmax())
        spread, at = divmod(best, len(places))
        alone_slope, alone_bend = _projected(templates[best : best + 1], y, background, noise, _inner(background, noise))
        strength = max(0.0, float(slope[best] / max(float(bend[best]), _BEND_MIN)))
        pulse = strength * templates[best]
        self._settle(y - pulse, background, inner, total, level)
        self._ended = float(path.time[-1])
        turn = self._ended - sensor.time_constant
        self._tail = float(np.interp(turn, path.read_at, pulse))
        return Evidence(
            slope=slope.reshape(len(spreads), -1),
            bend=bend.reshape(len(spreads), -1),
            response=float(templates[len(spreads) // 2 * len(places) :][: len(places)].max()),
            strength=strength,
            at=at,
            spread=spread,
            peak=float(pulse.max()),
            significance=float(alone_slope[0] / math.sqrt(max(float(alone_bend[0]), _BEND_MIN))),
        )

    def _settle(self, rest: Array, background: Array, covariance: Array, variance: float, level: float) -> None:
        """Take the level of the background from what the pulse leaves, for the pass that follows."""
        known = covariance @ (background @ rest)
        # Level and slope at the end of the pass.
        end = background[:2, -1]
        self._level = level + float(end @ known[:2])
        self._level_deviation = math.sqrt(variance * float(end @ covariance[:2, :2] @ end)) + self._sensor.background_drift

    def _templates(self, path: Path, places: Array, spreads: Array) -> Array:
        """Responses to pulses of strength 1 at every place with every spread, shape (w j, m)."""
        off = path.across - places[:, np.newaxis]
        off *= off
        pulses = np.exp(np.multiply.outer(-0.5 / spreads**2, off)).reshape(len(spreads) * len(places), -1)
        constant = self._sensor.time_constant
        # Air that came in from half a step before a point of the path to half a step after it.
        after = np.maximum(path.read_at[:, np.newaxis] - path.time + 0.5 * _FINE, 0.0)
        before = np.maximum(after - _FINE, 0.0)
        lag = np.exp(before / -constant) - np.exp(after / -constant)
        result: Array = pulses @ lag.T
        return result


def _inner(background: Array, variance: float) -> Array:
    """Return (variance I + N N')^-1 of a background (3, m), shape (3, 3)."""
    return np.asarray(np.linalg.inv(variance * np.eye(len(background)) + background @ background.T), dtype=np.float64)


def _projected(templates: Array, y: Array, background: Array, variance: float, inner: Array) -> tuple[Array, Array]:
    """Return slope and bend; arguments as in ``PassReader``: templates (k, m), background (3, m), and its ``_inner``."""
    within = templates @ background.T
    slope = (templates @ y - within @ (inner @ (background @ y))) / variance
    bend = (np.einsum("km,km->k", templates, templates) - ((within @ inner) * within).sum(axis=1)) / variance
    return slope, bend


def _median(values: Array) -> float:
    """Return the median, of an even number the upper one: of few values ``np.median`` takes ten times as long."""
    return float(np.partition(values, len(values) // 2)[len(values) // 2])
