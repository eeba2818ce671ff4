"""The cells that a plume estimate is spread over, and how strong a pulse each of them lets expect."""

import math

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr

from gnc.estimation.plume.pass_reader import BEND_MIN
from gnc.estimation.plume.prior import BUOYANT_SPREAD, PlumePrior

Array = npt.NDArray[np.float64]

STRENGTH_STEP = 0.5
"""Step of the logarithm of strengths [-]: half of it is 25 %, about what the shape of a plume
leaves open.
"""

_FADE = 13
"""Steps of strength from the centre of a plume out to where it counts as nothing [-]: e^-6.3 of the
centre.
"""

_HEIGHTS, _BEARINGS, _PLACE_STEP = 35, 25, 0.5
"""Cells over height and bearing, and step of places of the centre across at one moment, over the
expected spread [-, -, -].
"""

_REACH = 3.0
"""Standard deviations of the prior that the cells reach to [-]."""

_LOWEST = 5.0
"""Least height of an axis [m]."""

_SPREADS, _SPREAD_STEP = 5, 0.8
"""Cells of spread, an odd number, and their step in deviations of its logarithm [-]: together they
have 0.94 of the deviation.
"""

_STRENGTH_ERROR, _STRENGTH_OBLIQUE = 0.25, 0.2
"""Error of the strength of a pass, over itself: of one square to the plume, and how much a way
along it over across adds [-].

Of 972 passes with known strength the scatter beyond that of the meander was 0.27 square to the
plume, and 0.45 at 1 to 2.
"""

_WIDTH_ERROR, _WIDTH_OBLIQUE = 0.15, 0.25
"""Error of the logarithm of the width of a pass: of one square to the plume, and how much a way
along it over across adds [-].

The centre moves while the vehicle crosses. Of the same passes the scatter was 0.14 square to the
plume, 0.2 at 0.6 to 1, 0.32 at 1 to 2 and 0.69 at 2 to 4.
"""

_MIDDLE, _COARSE = _SPREADS // 2, 2
"""The expected spread among all, and cells of height that count as one where passes to come are
weighed [-].
"""

_RANGE_MIN = 1e-3
"""Least deviation of the funnel's height over that of the rise [-]: of a range without a width the
difference below is 0 by 0.
"""

_TINY = 1e-300
"""Least probability that is divided by [-]."""

_SPREAD_MIN = 0.4
"""Least spread over that at the expected height [-]."""


class PlumeGrid:
    """Cells of spread, height and strength, in this order: shape (w, h, c); and cells of bearing,
    shape (b,), independent of them.

    A strength is the concentration in the centre of one realisation. The meander in height is
    independent from pass to pass: it forgets itself within 1 to 4 s.

    Parameters
    ----------
    prior : what is expected

    Attributes
    ----------
    height, strength, bearing : of the cells, shapes (h,), (c,), (b,) [m, ppm, rad]
    sigma_y, sigma_z : of the cells, shape (w, h) [m]
    widths : spreads of pulses, at the expected height, shape (v,) [m]: as many as cells of spread
    faint : strengths from the faintest that a cell may be read with up to the strongest, shape (p,)
        [ppm]
    places : of the centre across at one moment, shape (j,) [m]
    prior, bearing_prior : probability of each cell, shapes (w, h, c) and (b,)
    """

    def __init__(self, prior: PlumePrior) -> None:
        self._expected = prior
        low = max(_LOWEST, prior.height - _REACH * prior.height_deviation)
        self.height: Array = np.linspace(
            low, prior.height + _REACH * prior.height_deviation, _HEIGHTS
        )
        # The last one has no other.
        self._pairs = np.arange(0, _HEIGHTS, _COARSE)
        self._paired = np.diff(self._pairs, append=_HEIGHTS)
        self.bearing: Array = np.linspace(-_REACH, _REACH, _BEARINGS) * prior.bearing_deviation
        rises = prior.rise_of(self.height)
        squares = BUOYANT_SPREAD**2 * (rises**2 - prior.rise_of(prior.height) ** 2)
        step = _SPREAD_STEP * prior.sigma_deviation
        self._scales = step * (np.arange(_SPREADS) - _MIDDLE)
        scales = np.exp(self._scales)[:, np.newaxis]
        self.sigma_y: Array = scales * np.sqrt(
            np.maximum(prior.sigma_y**2 + squares, (_SPREAD_MIN * prior.sigma_y) ** 2)
        )
        self.sigma_z: Array = scales * np.sqrt(
            np.maximum(prior.sigma_z**2 + squares, (_SPREAD_MIN * prior.sigma_z) ** 2)
        )
        self.widths: Array = prior.sigma_y * np.exp(self._scales)
        median = np.log(prior.peak * prior.sigma_y * prior.sigma_z / (self.sigma_y * self.sigma_z))
        reach = _REACH * prior.peak_deviation
        logs = np.arange(median.min() - reach, median.max() + reach + STRENGTH_STEP, STRENGTH_STEP)
        self.strength: Array = np.exp(logs)
        self.faint: Array = np.exp(logs[0] + STRENGTH_STEP * np.arange(1 - _FADE, len(logs)))
        self._index = _FADE - 1 + np.arange(len(logs)) - np.arange(_FADE)[:, np.newaxis]
        self._stronger = np.arange(len(self.faint)) + np.arange(_FADE)[:, np.newaxis]
        # Which of the faint strengths a step less than a strength is.
        self._fainter: Array = np.eye(len(self.faint))[self._index.ravel()]
        self._edges: Array = np.sqrt(2.0 * STRENGTH_STEP * (np.arange(_FADE) + 0.5))
        weight = np.exp(-0.5 * ((logs - median[..., np.newaxis]) / prior.peak_deviation) ** 2)
        of_spreads = np.exp(-0.5 * (_SPREAD_STEP * (np.arange(_SPREADS) - _MIDDLE)) ** 2)
        cells = (
            of_spreads[:, np.newaxis, np.newaxis]
            * self._of_heights()[:, np.newaxis]
            * weight
            / weight.sum(axis=2, keepdims=True)
        )
        self.prior: Array = cells / cells.sum()
        of_bearings = np.exp(-0.5 * (self.bearing / prior.bearing_deviation) ** 2)
        self.bearing_prior: Array = of_bearings / of_bearings.sum()
        across = _REACH * math.hypot(prior.bearing_deviation * prior.distance, prior.meander_y)
        self.places: Array = np.linspace(
            -across, across, 1 + 2 * math.ceil(across / (_PLACE_STEP * prior.sigma_y))
        )

    def _of_heights(self) -> Array:
        """Return how likely each height is, shape (h,): a funnel as likely anywhere in its range,
        and a rise that is normal.
        """
        prior = self._expected
        risen = math.sqrt(
            max(
                prior.height_deviation**2 - prior.source_deviation**2,
                (0.5 * (self.height[1] - self.height[0])) ** 2,
            )
        )
        off, half = (
            self.height - prior.height,
            math.sqrt(3.0) * max(prior.source_deviation, _RANGE_MIN * risen),
        )
        result: Array = (ndtr((off + half) / risen) - ndtr((off - half) / risen)) / half
        return result

    def of_widths(self, drawn_out: float) -> Array:
        """Return how likely a pulse of a plume of each spread looks to be of each width, shape (w,
        v).

        Parameters
        ----------
        drawn_out : way of the pass along the plume over that across [-]
        """
        error = math.hypot(_WIDTH_ERROR, _WIDTH_OBLIQUE * drawn_out)
        result: Array = np.exp(-0.5 * ((self._scales - self._scales[:, np.newaxis]) / error) ** 2)
        result /= result.sum(axis=1, keepdims=True)
        return result

    def fading(self, off: Array, looks: float) -> Array:
        """Return how likely a pass at an altitude reads a plume with so many steps less than its
        strength, shape (w, h, f).

        The centre is z_m above the axis with z_m ~ N(0, meander_z^2), and the pulse has exp(-(h +
        z_m - z)^2/2 sigma_z^2) of the strength; of several looks at the plume the best counts. The
        rest to 1 is the chance of nothing.

        Parameters
        ----------
        off : h - z, height of each axis above the pass, shape (h,) [m]
        looks : independent centres that a pass meets, at least 1 [-]
        """
        reach = self._edges * self.sigma_z[..., np.newaxis]
        return _between(self._within(reach, off[:, np.newaxis], looks))

    def chances(self, off: Array, looks: float, least: float, sigma_z: Array) -> Array:
        """Return how likely a pass reads a strength of at least ``least`` [ppm], shape (..., h',
        c).

        Parameters
        ----------
        off : height of each axis of ``coarse`` above the pass, shape (..., h') [m]
        looks : as of ``fading``
        sigma_z : spread in height of each axis, shape (h',) [m]
        """
        reach = np.sqrt(2.0 * np.log(np.maximum(self.strength / least, 1.0)))
        return self._within(reach * sigma_z[:, np.newaxis], off[..., np.newaxis], looks)

    def hits(self, off: Array, looks: float, sigma_z: Array, fraction: float) -> Array:
        """Return how likely a pass reads a ``fraction`` of a plume's own strength at least, shape
        (..., h'); arguments as above.
        """
        return self._within(math.sqrt(-2.0 * math.log(fraction)) * sigma_z, off, looks)

    def beside(self, distance: float, widened: float, duration: float) -> Array:
        """Return how likely the centre is at each place in a pass, given each bearing, shape (b,
        j).

        Meander that two passes have in common does not average out: its variance counts (1 + r)/(1
        - r) times, with r its correlation from pass to pass.

        Parameters
        ----------
        distance : behind the funnel [m]
        widened : spread there over that of the cells [-]
        duration : from pass to pass [s]
        """
        prior, places, bearing = self._expected, self.places, self.bearing
        apart = 2.0 * duration / prior.meander_time
        common = (1.0 + apart) * math.exp(-apart)
        step, cell = float(places[1] - places[0]), distance * float(bearing[1] - bearing[0])
        deviation = math.sqrt(
            (widened * prior.meander_y) ** 2 * (1.0 + common) / (1.0 - common)
            + (step**2 + cell**2) / 12.0
        )
        off = (places - distance * bearing[:, np.newaxis]) / deviation
        result: Array = np.exp(-0.5 * off**2) * (step / (deviation * math.sqrt(2.0 * math.pi)))
        result /= np.maximum(1.0, result.sum(axis=1, keepdims=True))
        return result

    def coarse(self, cells: Array) -> Array:
        """Return the probability of each two heights together and each strength, shape (h', c), of
        cells (w, h, c).
        """
        result: Array = np.add.reduceat(cells.sum(axis=0), self._pairs, axis=0)
        return result

    def coarse_heights(self, heights: Array) -> Array:
        """Return the heights of ``coarse``, the mean of each two of the cells, shape (h',); or
        another quantity of them.
        """
        result: Array = np.add.reduceat(heights, self._pairs) / self._paired
        return result

    def _within(self, reach: Array, off: Array, looks: float) -> Array:
        """Return how likely the centre of the best look is nearer in height than ``reach`` [m],
        with the axis ``off`` [m].
        """
        meander = self._expected.meander_z
        far, middle = reach / meander, off / meander
        beyond: Array = ndtr(middle - far)
        beyond += ndtr(-far - middle)
        beyond **= looks
        return np.subtract(1.0, beyond, out=beyond)

    def expected_deviation(
        self, weights: Array, heights: Array, off: Array, looks: float, sigma_z: Array
    ) -> Array:
        """Return the standard deviation of the height that is expected after a pass whose strength
        is read [m], shape (n,).

        Parameters
        ----------
        weights : probability of each height and strength of ``coarse``, shape (h', c)
        heights : of the axes, shape (h',) [m]
        off : heights above each of the passes, shape (n, h') [m]
        looks, sigma_z : as of ``chances``
        """
        reach = self._edges * sigma_z[:, np.newaxis]
        fading = _between(self._within(reach, off[..., np.newaxis], looks))
        of_heights = weights.sum(axis=1)
        # By height and reading, summed over the strengths that lead to it; nothing is read for the
        # last.
        joint = np.empty((len(heights), len(off), len(self.faint) + 1))
        padded = np.zeros((len(heights), weights.shape[1] + 2 * (_FADE - 1)))
        padded[:, _FADE - 1 : 1 - _FADE] = weights
        np.matmul(
            fading.transpose(1, 0, 2), padded.take(self._stronger, axis=1), out=joint[..., :-1]
        )
        joint[..., -1] = (of_heights * (1.0 - fading.sum(axis=-1))).T
        total = np.maximum(joint.sum(axis=0), _TINY)
        mean = (heights @ joint.reshape(len(heights), -1)).reshape(total.shape)
        square = float(of_heights @ heights**2)
        result: Array = np.sqrt(np.maximum(square - (mean**2 / total).sum(axis=1), 0.0))
        return result

    def over_strengths(self, faint: Array) -> Array:
        """Return values over ``faint``, shape (w, p), as they are for each step less than each
        strength, shape (w, f, c).
        """
        return faint.take(self._index, axis=1)

    def over_faint(self, cells: Array, fading: Array) -> Array:
        """Return how likely a pass reads each strength of ``faint`` with each spread, shape (w, p).

        Parameters
        ----------
        cells : probability of each, shape (w, h, c)
        fading : of that pass, shape (w, h, f)
        """
        read = fading.transpose(0, 2, 1) @ cells
        result: Array = read.reshape(len(read), -1) @ self._fainter
        return result


def _between(within: Array) -> Array:
    """Return the differences of cumulated probabilities along the last axis, the first from 0;
    takes the array over.
    """
    within[..., 1:] -= within[..., :-1].copy()
    return within


def wandered(cells: Array, axis: int, steps: float) -> Array:
    """Return probabilities after a random walk along an axis, of a variance of so many steps
    squared.
    """
    result = cells.copy()
    moved = result.swapaxes(0, axis)
    # A round in which more than a quarter moved either way would turn a peak into a trough.
    rounds = max(1, math.ceil(steps / 0.5))
    share = 0.5 * steps / rounds
    for _ in range(rounds):
        flow = share * (moved[1:] - moved[:-1])
        moved[:-1] += flow
        moved[1:] -= flow
    return result


def normalised(cells: Array, prior: Array) -> Array:
    """Return probabilities of a sum of 1; those of the prior where nothing is left."""
    total = float(cells.sum())
    return cells / total if total > 0.0 else prior.copy()


def over_nothing(slope: Array, bend: Array, strength: Array, drawn_out: float) -> Array:
    """Return the log likelihood of each strength at each place less that of no pulse, shape (v, j,
    p).

    A pulse of strength P fits readings that have one of P (1 + e), e ~ N(0, error^2): e has been
    integrated out.

    Parameters
    ----------
    slope, bend : of ``gnc.estimation.plume.pass_reader.Evidence``, shape (v, j) [1/ppm, 1/ppm^2]
    strength : shape (p,) [ppm]
    drawn_out : way of the pass along the plume over that across [-]
    """
    error = math.hypot(_STRENGTH_ERROR, _STRENGTH_OBLIQUE * drawn_out)
    slope, bend = slope[..., np.newaxis], np.maximum(bend, BEND_MIN)[..., np.newaxis]
    best = slope**2 / bend
    widened = 1.0 + bend * (error * strength) ** 2
    result: Array = 0.5 * (
        best - (best - 2.0 * slope * strength + bend * strength**2) / widened - np.log(widened)
    )
    return result
