"""What one pass over a plume's axis says: for each place of the axis, how well a pulse of each
strength fits the readings.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gnc.estimation.plume.passes import FINE, Path
from gnc.estimation.plume.prior import BACKGROUND_DRIFT, GasSensor

Array = npt.NDArray[np.float64]

_SHAPE_ERROR = 0.15
"""Error of a reading that a plume not of the expected shape makes, over the largest of the pass
[-]: an assumption.
"""

_TAIL_ERROR = 0.3
"""Error of what is left of the pass before in the sensor, over itself [-]: as the strength of a
pass is known.
"""

_UNSEEN_DRIFT = 1.0
"""Time of drift by which the level at the end of a pass is less sure than its fit says [s]: drift
is no straight line.
"""

_FIRST_BACKGROUND = 1e3
"""Standard deviation of the background before anything is read [ppm]: clean air has some 400."""

BEND_MIN = 1e-12
"""Least curvature of a likelihood [1/ppm^2]: a place that the vehicle has not been to says nothing.
"""

_STILL = 0.1
"""Largest less least reading of a pass over the sensor's noise, below which they are not believed
[-].
"""


@dataclass(frozen=True, slots=True)
class Evidence:
    """What a pass says of a pulse of strength P at place j with spread w: log likelihood P
    ``slope`` - P^2 ``bend``/2.

    It is the one of noise, background and shape error together, less that of no pulse at all.

    Attributes
    ----------
    slope, bend : shape (w, j) [1/ppm, 1/ppm^2]
    response : largest reading that a pulse of strength 1 of the middle spread makes, where the axis
        is crossed best [-]
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


class _Match(NamedTuple):
    """Products of templates T, readings y and background N, of k templates or of one.

    Attributes
    ----------
    read, square, covered : T' y, T' T and N' T, shapes (k,), (k,) and (k, 3)
    background : N' y, shape (3,)
    """

    read: Array
    square: Array
    covered: Array
    background: Array

    def of(self, one: int) -> "_Match":
        """Return those of one template."""
        return _Match(self.read[one], self.square[one], self.covered[one], self.background)

    def projected(self, variance: float, inner: Array) -> tuple[Array, Array]:
        """Return slope and bend as of ``PassReader``; arguments as of ``_inner``, and that."""
        held = self.covered @ inner
        slope: Array = (self.read - held @ self.background) / variance
        bend: Array = (self.square - (held * self.covered).sum(axis=-1)) / variance
        return slope, bend


class PassReader:
    """Compares readings with pulses: Gaussian in the place across, through the lag of the sensor,
    over a background that drifts.

    With T the response to a pulse of strength 1, N the columns of the background (level, slope, and
    what is left of the pass before in the sensor) with prior deviations D, and Sigma = sigma^2 I +
    N D^2 N' the covariance of readings y without a pulse,

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
        low, middle, high = _spread_of(y)
        if high - low < _STILL * sensor.noise:
            return None
        templates = self._templates(path, places, spreads)
        since = path.read_at - path.time[0]
        level, unread = self._level, max(0.0, float(path.time[0]) - self._ended)
        if math.isnan(level):
            level, unread = middle, 0.0
        elif unread > path.duration:
            self._tail = 0.0
        fading = np.exp(-since / sensor.time_constant)
        y = y - level - self._tail * fading
        background = np.empty((3, len(y)))
        # Passes without readings, or that are not believed, leave the level time to drift.
        background[0] = math.hypot(self._level_deviation, BACKGROUND_DRIFT * unread)
        background[1] = BACKGROUND_DRIFT * (since - 0.5 * since[-1])
        background[2] = (_TAIL_ERROR * abs(self._tail) + sensor.noise) * fading
        noise = sensor.noise**2
        _, middle, high = _spread_of(y)
        total = noise + (_SHAPE_ERROR * max(0.0, high - middle)) ** 2
        inner = _inner(background, total)
        match = _Match(
            templates @ y,
            (templates * templates).sum(axis=1),
            templates @ background.T,
            background @ y,
        )
        slope, bend = match.projected(total, inner)
        bend_up = np.maximum(bend, BEND_MIN)
        gain = np.maximum(slope, 0.0) ** 2 / bend_up
        best = int(gain.argmax())
        spread, at = divmod(best, len(places))
        fitting = templates[best]
        alone_slope, alone_bend = match.of(best).projected(noise, _inner(background, noise))
        strength = max(0.0, float(slope[best] / bend_up[best]))
        pulse = strength * fitting
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
            significance=float(alone_slope / math.sqrt(max(float(alone_bend), BEND_MIN))),
        )

    def _settle(
        self, rest: Array, background: Array, covariance: Array, variance: float, level: float
    ) -> None:
        """Take the level of the background from what the pulse leaves, for the pass that follows."""
        known = covariance @ (background @ rest)
        # Level and slope at the end of the pass.
        end = background[:2, -1]
        self._level = level + float(end @ known[:2])
        fitted = math.sqrt(variance * float(end @ covariance[:2, :2] @ end))
        self._level_deviation = fitted + _UNSEEN_DRIFT * BACKGROUND_DRIFT

    def _templates(self, path: Path, places: Array, spreads: Array) -> Array:
        """Responses to pulses of strength 1 at every place with every spread, shape (w j, m)."""
        off = path.across - places[:, np.newaxis]
        off *= off
        pulses = np.exp(np.multiply.outer(-0.5 / spreads**2, off)).reshape(
            len(spreads) * len(places), -1
        )
        constant = self._sensor.time_constant
        # Air that came in from half a step before a point of the path to half a step after it.
        after = np.maximum(path.read_at[:, np.newaxis] - path.time + 0.5 * FINE, 0.0)
        before = np.maximum(after - FINE, 0.0)
        lag = np.exp(before / -constant) - np.exp(after / -constant)
        result: Array = pulses @ lag.T
        return result


def _inner(background: Array, variance: float) -> Array:
    """Return (variance I + N N')^-1 of a background (3, m), shape (3, 3): by cofactors, as LAPACK
    takes ten times as long.
    """
    (a, b, c), (_, d, e), (_, _, f) = (background @ background.T).tolist()
    a, d, f = a + variance, d + variance, f + variance
    of_a, of_b, of_c = d * f - e * e, c * e - b * f, b * e - c * d
    of_d, of_e, of_f = a * f - c * c, b * c - a * e, a * d - b * b
    cofactors = np.array(((of_a, of_b, of_c), (of_b, of_d, of_e), (of_c, of_e, of_f)))
    cofactors /= a * of_a + b * of_b + c * of_c
    return cofactors


def _spread_of(values: Array) -> tuple[float, float, float]:
    """Return the least, the median (of an even number the upper one) and the largest: of few values
    numpy takes longer.
    """
    ordered = sorted(values.tolist())
    return ordered[0], ordered[len(ordered) // 2], ordered[-1]
