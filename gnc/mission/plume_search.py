"""How high to fly next, so that the plume is found soon and then known well."""

import math
from typing import Protocol

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr

from gnc.estimation.plume.estimator import HIT, PlumeEstimator, PlumeState
from gnc.numeric import clip

Array = npt.NDArray[np.float64]

_STEP = 6.0
"""Between the heights that are weighed [m]: less than the spread of a plume."""

_HORIZON = 8
"""Number of passes that the search plans ahead [-]."""

_KNOWN = 0.3
"""Deviation of the height over the spread of a pass [-], below which nothing is gained by flying
anywhere else.
"""

_REACH, _PROBES = 1.6, np.linspace(0.0, 1.0, 9)
"""How far off the estimated height is flown to, over its deviation, and heights that are weighed
[-, -].
"""

_RUNG = 15.0
"""Between the heights of a ladder [m]."""

_AHEAD = 3.0
"""Passes over which the information of this one counts [-]: after those the later ones have given
as much.
"""


class Search(Protocol):
    """Decides after a pass (``PlumeEstimator.update`` returned True) how high to fly next."""

    def next_altitude(self, estimator: PlumeEstimator, altitude: float, pass_time: float) -> float:
        """Return how high to cross next, above the sea [m], within the limits.

        Parameters
        ----------
        estimator : after its last pass
        altitude : of the vehicle now [m]
        pass_time : between passes [s]
        """


class HeightSearch:
    """Maximises the probability of detection per time; once the plume is found, narrows its height
    down, and then stays.

    While it searches, each height is weighed by the passes that lie on the way to it and at it: the
    sum over them of the probability that the plume has been detected by then is the largest for the
    height with the least expected time to find. Misses that have a plume in common are not
    independent; given a cell of the estimate they are.

    Parameters
    ----------
    lowest, highest : altitudes that may be flown [m]: limits of the flight, of the terrain and of
        the keep-out area together
    climb_rate : that the vehicle climbs and sinks at [m/s]
    """

    __slots__ = ("_climb_rate", "_heights", "_highest", "_lowest")

    def __init__(self, *, lowest: float, highest: float, climb_rate: float) -> None:
        self._lowest, self._highest, self._climb_rate = lowest, highest, climb_rate
        self._heights: Array = np.linspace(
            lowest, highest, max(2, 1 + math.ceil((highest - lowest) / _STEP))
        )

    def next_altitude(self, estimator: PlumeEstimator, altitude: float, pass_time: float) -> float:
        """Return how high to cross next [m]; arguments as of ``Search``."""
        if estimator.state is not PlumeState.FOUND:
            return self._soonest(estimator, altitude, self._climb_rate * pass_time)
        return self._hitting(estimator)

    def _hitting(self, estimator: PlumeEstimator) -> float:
        """Return the height with the most expected hits: now, and later by what the pass shows of
        the height.
        """
        height, deviation = estimator.height, estimator.height_deviation
        spread, meander = estimator.sigma_z, estimator.meander_z
        if deviation < _KNOWN * math.hypot(spread, meander):
            return clip(height, self._lowest, self._highest)
        low, high = (
            clip(height + side * _REACH * deviation, self._lowest, self._highest)
            for side in (-1.0, 1.0)
        )
        altitudes = low + (high - low) * _PROBES
        off = np.hypot(estimator.expected_deviation(altitudes), meander)
        later = 2.0 * ndtr(math.sqrt(-2.0 * math.log(HIT)) * spread / off) - 1.0
        return float(altitudes[int((estimator.hits(altitudes) + _AHEAD * later).argmax())])

    def _soonest(self, estimator: PlumeEstimator, altitude: float, climb: float) -> float:
        """Return the height with the least expected time to find, where ``climb`` [m] is what a
        pass leaves time for.
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
    """Goes up and down a ladder of heights, one after each pass, until the plume is found; then
    flies at the estimated height.

    Parameters
    ----------
    lowest, highest : altitudes that may be flown [m]
    """

    __slots__ = ("_highest", "_lowest", "_up")

    def __init__(self, *, lowest: float, highest: float) -> None:
        self._lowest, self._highest = lowest, highest
        self._up = True

    def next_altitude(self, estimator: PlumeEstimator, altitude: float, pass_time: float) -> float:  # noqa: ARG002 - of the Protocol
        """Return how high to cross next [m]; arguments as of ``Search``."""
        height = estimator.height
        if estimator.state is not PlumeState.FOUND:
            if not self._lowest < altitude + (_RUNG if self._up else -_RUNG) < self._highest:
                self._up = not self._up
            height = altitude + (_RUNG if self._up else -_RUNG)
        return clip(height, self._lowest, self._highest)
