"""Estimates where a plume is, how wide and how strong, from readings that show it and readings that
do not.

``PlumeGrid`` holds the cells of an estimate, and the readings that are expected of a pass in each.
``PlumeEstimator`` applies Bayes' rule to them, once for each pass over the axis. The mathematics is
in docs/finding_the_plume.md.
"""

import math
from enum import Enum
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr

from gnc.estimation.plume.passes import (
    BEND_MIN,
    Evidence,
    PassCollector,
    PassReader,
    Path,
    SensorState,
    SensorWatch,
)
from gnc.estimation.plume.prior import (
    BEARING_DRIFT,
    BUOYANT_SPREAD,
    HEIGHT_DRIFT,
    SPEED_MIN,
    PlumePrior,
)
from gnc.numeric import clip

Array = npt.NDArray[np.float64]

SIGNAL_TO_NOISE = 5.0
"""Least peak of the readings of a detection, over their noise [-] (Kattner 2015, of CO2)."""

HIT = 0.6
"""Least concentration in a pass that counts as a hit, over that in the plume's centre [-]."""

STRENGTH_STEP = 0.5
"""Step of the logarithm of strengths [-]: a plume's shape determines it to about half of it."""

_FADE = 13
"""Steps of strength from a plume's centre to where its concentration counts as 0 [-]: at e^-6.3 of
that in the centre.
"""

_HEIGHTS, _BEARINGS = 35, 25
"""Cells over height and bearing [-]."""

_PLACE_STEP = 0.5
"""Step between the places of the centre across the axis at one moment, over the expected spread
[-].
"""

_REACH = 3.0
"""Standard deviations of the prior that the cells cover [-]."""

_LOWEST = 5.0
"""Least height of an axis [m]."""

_SPREADS, _SPREAD_STEP = 5, 0.8
"""Cells of spread, an odd number, and their step in deviations of its logarithm [-]."""

_MIDDLE = _SPREADS // 2
"""Index of the expected spread [-]."""

_COARSE = 2
"""Cells of height that are merged into one where future passes are weighed [-]."""

_STRENGTH_ERROR, _STRENGTH_OBLIQUE = 0.25, 0.2
"""Relative error of the strength of a pass that is square to the plume, and its growth per
obliqueness (way along the plume over way across) [-].

In 972 passes with known strength the scatter beyond that of the meander was 0.27 square to the
plume, and 0.45 at an obliqueness of 1 to 2.
"""

_WIDTH_ERROR, _WIDTH_OBLIQUE = 0.15, 0.25
"""Error of the logarithm of the width of a pass that is square to the plume, and its growth per
obliqueness [-].

The centre moves while the vehicle crosses. In the same passes the scatter was 0.14 square to the
plume, 0.2 at an obliqueness of 0.6 to 1, 0.32 at 1 to 2 and 0.69 at 2 to 4.
"""

_RANGE_MIN = 1e-3
"""Least deviation of the stack's height over that of the rise [-]; the likelihood divides by it."""

_TINY = 1e-300
"""Least probability in a denominator [-]."""

_SPREAD_MIN = 0.4
"""Least spread over that at the expected height [-]."""

_FORGET = 6000.0
"""Time constant with which a posterior falls back to the prior [s]: a ship may change its load."""

_DIFFUSED = 10.0
"""Least time between random walks of the axis [s]: in a shorter time it wanders by less than a
cell.
"""

_LOST = 0.01
"""Probability of a row of misses below which a plume that was found is lost again [-]."""

_MEMORY = 10.0
"""Passes over which innovations are averaged [-]."""

_CHANCE = 0.02
"""Least probability of a hit or a miss in an innovation [-]."""

_BELIEVED = 0.75
"""Exponent of a pass's likelihood [-]; the most likely value over 80 flights. It is below 1 since
passes share errors.
"""

_UNLIKELY = 1e-5
"""Least probability of a height that counts where future passes are weighed [-]."""

_LOOK = 2.0
"""Way along the plume to an independent centre, over the meander's correlation length [-]."""

_NEAREST = 0.3
"""Least distance from the stack of a pass that is believed, over that of the prior [-]: a plume
that is nearer is another one.
"""

_NOMINAL_RESPONSE = 0.5
"""Largest reading over strength, before a pass has shown it [-]."""

_RESPONSE_MIN = 1e-6
"""Least reading over strength [-]: a pass far from the axis detects nothing."""


class PlumeGrid:
    """Cells of spread, height and strength, shape (w, h, c), and of bearing, shape (b,).

    The bearing is independent of the others. A strength is the concentration in the centre of one
    realisation. The meander in height is independent from pass to pass: its time scale is 1 to 4 s.

    Parameters
    ----------
    prior : what is expected

    Attributes
    ----------
    height, strength, bearing : of the cells, shapes (h,), (c,), (b,) [m, ppm, rad]
    sigma_y, sigma_z : of the cells, shape (w, h) [m]
    widths : spreads of pulses at the expected height, one for each cell of spread, shape (v,) [m]
    faint : strengths from the faintest that a pass may read in any cell up to the strongest, shape
        (p,) [ppm]
    places : of the centre across the axis at one moment, shape (j,) [m]
    prior, bearing_prior : probability of each cell, shapes (w, h, c) and (b,)
    """

    def __init__(self, prior: PlumePrior) -> None:
        self._expected = prior
        self._set_heights_and_spreads()
        median = np.log(prior.peak * prior.sigma_y * prior.sigma_z / (self.sigma_y * self.sigma_z))
        logs = self._set_strengths(median)
        self._set_bearings_and_places()
        self.prior: Array = self._cell_prior(median, logs)

    def _set_heights_and_spreads(self) -> None:
        prior = self._expected
        low = max(_LOWEST, prior.height - _REACH * prior.height_deviation)
        high = prior.height + _REACH * prior.height_deviation
        self.height: Array = np.linspace(low, high, _HEIGHTS)
        # Pairs of heights; the last height has no other.
        self._pairs = np.arange(0, _HEIGHTS, _COARSE)
        self._paired = np.diff(self._pairs, append=_HEIGHTS)
        rises = prior.rise_of(self.height)
        squares = BUOYANT_SPREAD**2 * (rises**2 - prior.rise_of(prior.height) ** 2)
        self._scales = _SPREAD_STEP * prior.sigma_deviation * (np.arange(_SPREADS) - _MIDDLE)

        def spreads(expected: float) -> Array:
            least = (_SPREAD_MIN * expected) ** 2
            at_heights: Array = np.sqrt(np.maximum(expected**2 + squares, least))
            result: Array = np.exp(self._scales)[:, np.newaxis] * at_heights
            return result

        self.sigma_y: Array = spreads(prior.sigma_y)
        self.sigma_z: Array = spreads(prior.sigma_z)
        self.widths: Array = prior.sigma_y * np.exp(self._scales)

    def _set_strengths(self, median: Array) -> Array:
        """Set the strengths around their median, shape (w, h); return their logarithms."""
        reach = _REACH * self._expected.peak_deviation
        logs = np.arange(median.min() - reach, median.max() + reach + STRENGTH_STEP, STRENGTH_STEP)
        self.strength: Array = np.exp(logs)
        self.faint: Array = np.exp(logs[0] + STRENGTH_STEP * np.arange(1 - _FADE, len(logs)))
        # Index of the faint strength that is f steps less than each strength, shape (f, c).
        self._index = _FADE - 1 + np.arange(len(logs)) - np.arange(_FADE)[:, np.newaxis]
        self._fainter: Array = np.eye(len(self.faint))[self._index.ravel()]
        # Index of the strength that is f steps more than each faint strength, shape (f, p).
        self._stronger = np.arange(len(self.faint)) + np.arange(_FADE)[:, np.newaxis]
        # Distance from the centre, over the spread, at which each step of fading ends.
        self._edges: Array = np.sqrt(2.0 * STRENGTH_STEP * (np.arange(_FADE) + 0.5))
        return logs

    def _set_bearings_and_places(self) -> None:
        prior = self._expected
        self.bearing: Array = np.linspace(-_REACH, _REACH, _BEARINGS) * prior.bearing_deviation
        of_bearings = np.exp(-0.5 * (self.bearing / prior.bearing_deviation) ** 2)
        self.bearing_prior: Array = of_bearings / of_bearings.sum()
        across = _REACH * math.hypot(prior.bearing_deviation * prior.distance, prior.meander_y)
        steps = 2 * math.ceil(across / (_PLACE_STEP * prior.sigma_y))
        self.places: Array = np.linspace(-across, across, 1 + steps)

    def _cell_prior(self, median: Array, logs: Array) -> Array:
        """Return the probability of each cell, shape (w, h, c)."""
        deviation = self._expected.peak_deviation
        of_strengths = np.exp(-0.5 * ((logs - median[..., np.newaxis]) / deviation) ** 2)
        of_spreads = np.exp(-0.5 * (_SPREAD_STEP * (np.arange(_SPREADS) - _MIDDLE)) ** 2)
        cells: Array = (
            of_spreads[:, np.newaxis, np.newaxis]
            * self._height_likelihood()[:, np.newaxis]
            * of_strengths
            / of_strengths.sum(axis=2, keepdims=True)
        )
        cells /= cells.sum()
        return cells

    def _height_likelihood(self) -> Array:
        """Return the likelihood of each height, shape (h,).

        The stack is as likely anywhere in its range of heights, and the rise is normal.
        """
        prior = self._expected
        variance = prior.height_deviation**2 - prior.source_deviation**2
        least = 0.5 * (self.height[1] - self.height[0])
        risen = math.sqrt(max(variance, least**2))
        half = math.sqrt(3.0) * max(prior.source_deviation, _RANGE_MIN * risen)
        off = self.height - prior.height
        result: Array = (ndtr((off + half) / risen) - ndtr((off - half) / risen)) / half
        return result

    def width_likelihood(self, obliqueness: float) -> Array:
        """Return the probability of each width of a pulse for each spread of the plume.

        Parameters
        ----------
        obliqueness : of the pass, way along the plume over that across [-]

        Returns
        -------
        array, shape (w, v)
        """
        error = math.hypot(_WIDTH_ERROR, _WIDTH_OBLIQUE * obliqueness)
        result: Array = np.exp(-0.5 * ((self._scales - self._scales[:, np.newaxis]) / error) ** 2)
        result /= result.sum(axis=1, keepdims=True)
        return result

    def fading(self, off: Array, looks: float) -> Array:
        """Return the probability that a pass reads each number of steps less than the strength.

        The centre is z_m above the axis with z_m ~ N(0, meander_z^2), and the pulse has exp(-(h +
        z_m - z)^2/2 sigma_z^2) of the strength; the best of several looks at the plume counts. The
        probabilities of a cell add up to 1 less that of reading nothing.

        Parameters
        ----------
        off : h - z, height of each axis above the pass, shape (h,) [m]
        looks : independent centres that a pass meets, at least 1 [-]

        Returns
        -------
        array, shape (w, h, f)
        """
        reach = self._edges * self.sigma_z[..., np.newaxis]
        return _differences(self.within(reach, off[:, np.newaxis], looks))

    def chances(self, off: Array, looks: float, least: float, sigma_z: Array) -> Array:
        """Return the probability that a pass reads at least some strength, shape (..., h', c).

        Parameters
        ----------
        off : height of each axis of ``coarse`` above the pass, shape (..., h') [m]
        looks : same as ``fading``
        least : least strength of the reading [ppm]
        sigma_z : spread in height of each axis, shape (h',) [m]
        """
        reach = np.sqrt(2.0 * np.log(np.maximum(self.strength / least, 1.0)))
        return self.within(reach * sigma_z[:, np.newaxis], off[..., np.newaxis], looks)

    def place_likelihood(self, distance: float, widened: float, duration: float) -> Array:
        """Return the probability of each place of the centre, given each bearing, shape (b, j).

        Meander that two passes have in common does not average out: its variance counts (1 + r)/(1
        - r) times, with r its correlation from pass to pass.

        Parameters
        ----------
        distance : behind the stack [m]
        widened : spread there over that of the cells [-]
        duration : from pass to pass [s]
        """
        prior, places, bearing = self._expected, self.places, self.bearing
        apart = 2.0 * duration / prior.meander_time
        common = (1.0 + apart) * math.exp(-apart)
        step = float(places[1] - places[0])
        cell = distance * float(bearing[1] - bearing[0])
        deviation = math.sqrt(
            (widened * prior.meander_y) ** 2 * (1.0 + common) / (1.0 - common)
            + (step**2 + cell**2) / 12.0
        )
        off = (places - distance * bearing[:, np.newaxis]) / deviation
        result: Array = np.exp(-0.5 * off**2) * (step / (deviation * math.sqrt(2.0 * math.pi)))
        result /= np.maximum(1.0, result.sum(axis=1, keepdims=True))
        return result

    def coarse(self, cells: Array) -> Array:
        """Return the probability of each pair of heights and strength, shape (h', c).

        Parameters
        ----------
        cells : probability of each, shape (w, h, c)
        """
        result: Array = np.add.reduceat(cells.sum(axis=0), self._pairs, axis=0)
        return result

    def coarse_heights(self, heights: Array) -> Array:
        """Return the mean over each pair of heights, shape (h',), of the heights or of another
        quantity.
        """
        result: Array = np.add.reduceat(heights, self._pairs) / self._paired
        return result

    def expected_deviation(
        self, weights: Array, heights: Array, off: Array, looks: float, sigma_z: Array
    ) -> Array:
        """Return the expected standard deviation of the height after a pass [m], shape (n,).

        Parameters
        ----------
        weights : probability of each height and strength of ``coarse``, shape (h', c)
        heights : of the axes, shape (h',) [m]
        off : heights above each of the passes, shape (n, h') [m]
        looks, sigma_z : same as ``chances``
        """
        reach = self._edges * sigma_z[:, np.newaxis]
        fading = _differences(self.within(reach, off[..., np.newaxis], looks))
        of_heights = weights.sum(axis=1)
        # Probability of each height and reading, summed over the strengths that lead to it; the
        # last reading is nothing.
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

    def faded(self, values: Array) -> Array:
        """Return the values of those ``faint`` strengths that are each number of steps below each
        strength.

        Parameters
        ----------
        values : shape (w, p)

        Returns
        -------
        array, shape (w, f, c)
        """
        return values.take(self._index, axis=1)

    def reading_probability(self, cells: Array, fading: Array) -> Array:
        """Return the probability that a pass reads each ``faint`` strength with each spread.

        Parameters
        ----------
        cells : probability of each, shape (w, h, c)
        fading : of that pass, shape (w, h, f)

        Returns
        -------
        array, shape (w, p)
        """
        read = fading.transpose(0, 2, 1) @ cells
        result: Array = read.reshape(len(read), -1) @ self._fainter
        return result

    def within(self, reach: Array, off: Array, looks: float) -> Array:
        """Return the probability that the centre of the best look is nearer than ``reach`` [m].

        Parameters
        ----------
        reach, off : of the centre, and height of the axis above the pass, of one shape [m]
        looks : same as ``fading``
        """
        meander = self._expected.meander_z
        far = reach / meander
        middle = off / meander
        beyond: Array = ndtr(middle - far)
        beyond += ndtr(-far - middle)
        beyond **= looks
        return np.subtract(1.0, beyond, out=beyond)


def _differences(cumulated: Array) -> Array:
    """Return the differences along the last axis, the first from 0; overwrites the array."""
    cumulated[..., 1:] -= cumulated[..., :-1].copy()
    return cumulated


def random_walk(cells: Array, axis: int, variance: float) -> Array:
    """Return probabilities after a random walk along an axis.

    Parameters
    ----------
    cells : probability of each, any shape
    axis : of the array
    variance : of the walk, in steps between cells squared
    """
    result = cells.copy()
    moved = result.swapaxes(0, axis)
    # A round in which more than a quarter moved either way would turn a peak into a trough.
    rounds = max(1, math.ceil(variance / 0.5))
    share = 0.5 * variance / rounds
    for _ in range(rounds):
        flow = share * (moved[1:] - moved[:-1])
        moved[:-1] += flow
        moved[1:] -= flow
    return result


def _normalised(cells: Array, prior: Array) -> Array:
    """Return probabilities that add up to 1; those of the prior where all of them are 0."""
    total = float(cells.sum())
    return cells / total if total > 0.0 else prior.copy()


def _log_likelihood_ratio(slope: Array, bend: Array, strength: Array, obliqueness: float) -> Array:
    """Return the log likelihood of each strength at each place, less the log likelihood of no
    pulse.

    A pulse of strength P fits readings with a pulse of strength P (1 + e), e ~ N(0, error^2); the
    likelihood is integrated over e.

    Parameters
    ----------
    slope, bend : of ``Evidence``, shape (v, j) [1/ppm, 1/ppm^2]
    strength : shape (p,) [ppm]
    obliqueness : of the pass, way along the plume over that across [-]

    Returns
    -------
    array, shape (v, j, p)
    """
    error = math.hypot(_STRENGTH_ERROR, _STRENGTH_OBLIQUE * obliqueness)
    slope = slope[..., np.newaxis]
    bend = np.maximum(bend, BEND_MIN)[..., np.newaxis]
    best = slope**2 / bend
    widened = 1.0 + bend * (error * strength) ** 2
    result: Array = 0.5 * (
        best - (best - 2.0 * slope * strength + bend * strength**2) / widened - np.log(widened)
    )
    return result


class PlumeState(Enum):
    """What is known of the plume."""

    SEARCHING = "searching"
    FOUND = "found"
    LOST = "lost again"


class _Scene(NamedTuple):
    """Likelihood of the readings of a pass, up to one common factor.

    Attributes
    ----------
    likelihood : of a plume of each spread, at each place, if it is read with each strength, shape
        (w, j, p)
    nothing : likelihood without a pulse
    """

    likelihood: Array
    nothing: float


class PlumeEstimator:
    """Bayes' rule on cells of spread, height and strength, and on cells of bearing.

    The frame is that of the *predicted* axis, which trails behind the stack with the apparent wind
    as estimated on board; it is not that of the axis that this filter estimates.

    Parameters
    ----------
    prior : what is expected

    Attributes
    ----------
    prior, grid : the expected plume, and the cells
    cells, bearings : probability of each, shapes (w, h, c) and (b,)
    height, height_deviation : of the axis above the sea, at the distance and in the apparent wind
        of the last pass [m]
    bearing, bearing_deviation : of the axis to the right of the predicted one, to be added to its
        course [rad]
    offset, offset_deviation : of the axis to the right of the predicted one, at the distance of the
        last pass [m]
    sigma_y, sigma_z, meander_z : spreads of the plume at one moment, and its meander in height, at
        the last pass [m]
    state : whether the plume is searched for, found, or lost again
    found_at : time since the start at which the plume was found first [s]; NaN before;
        benchmarks/plume judges searches by it
    innovation : mean normalised innovation squared of the passes, 1 where the filter is consistent
        [-]
    passes : number of passes so far [-]
    detectable : least strength that a pass such as the last one detects [ppm]
    """

    def __init__(self, prior: PlumePrior) -> None:
        self.prior = prior
        self.grid = PlumeGrid(prior)
        self.state = PlumeState.SEARCHING
        self.found_at = math.nan
        self.innovation = 1.0
        self.passes = 0
        sensor = prior.sensor
        self._watch = SensorWatch(sensor)
        self._collector = PassCollector(delay=sensor.delay, tail=sensor.time_constant)
        self._reader = PassReader(sensor)
        self._time = 0.0
        self._diffused_at = 0.0
        self._spoilt = False
        # Of the last pass: where it met the axis, spread there over that of the cells, and
        # independent centres that it met.
        self._distance = prior.distance
        self._wind = prior.apparent_wind
        self._widened = 1.0
        self._looks = 1.0
        self.detectable = SIGNAL_TO_NOISE * sensor.noise / _NOMINAL_RESPONSE
        # Probability of the misses since the last hit.
        self._misses = 1.0
        self._heights: Array = prior.height_at(self.grid.height, self._distance, self._wind)
        self.cells: Array = self.grid.prior.copy()
        self.bearings: Array = self.grid.bearing_prior.copy()
        self._note()

    @property
    def sensor(self) -> SensorState:
        """State of the sensor; while it does not work, the estimate only diffuses."""
        return self._watch.state

    def predict(self, time_step: float) -> None:
        """Let ``time_step`` [s] go by; the estimate follows at the next pass."""
        self._time += time_step
        self._watch.wait(time_step)
        if self._watch.state is not SensorState.WORKING:
            self._spoilt = True

    def update(
        self,
        along: float,
        across: float,
        altitude: float,
        reading: float,
        *,
        apparent_wind: float | None = None,
    ) -> bool:
        """Take in a place and a reading; return whether a pass is over and the estimate is new.

        To be called after ``predict``, for each reading, and in between at least each 0.5 s.

        Parameters
        ----------
        along, across : of the vehicle, behind the stack and to the right of the predicted axis,
            seen along it [m]
        altitude : above the sea [m]
        reading : new reading of CO2; NaN without one [ppm]. It may contain a constant background
        apparent_wind : past the ship now, at least 1 m/s is assumed; by default the prior's [m/s]
        """
        if not math.isnan(reading):
            self._watch.read(reading)
            self._spoilt = self._spoilt or self._watch.state is not SensorState.WORKING
        path = self._collector.add(self._time, along, across, altitude, reading)
        if path is None:
            return False
        wind = self.prior.apparent_wind if apparent_wind is None else apparent_wind
        self._wind = max(wind, SPEED_MIN)
        if self._time >= self._diffused_at + _DIFFUSED:
            self._diffuse(self._time - self._diffused_at)
            self._diffused_at = self._time
        self.passes += 1
        self._take_in(path)
        self._spoilt = False
        self._note()
        return True

    def _take_in(self, path: Path) -> None:
        """Correct the estimate by a pass, unless the pass is not believed."""
        distance, altitude = path.at(self.offset)
        believed = distance > _NEAREST * self.prior.distance and not self._spoilt
        if believed:
            # At that distance the plume has another spread and strength than at the cells'
            # distance.
            self._distance = distance
            self._widened = self.prior.widened(distance, self._wind)
        self._heights = self.prior.height_at(self.grid.height, self._distance, self._wind)
        if not believed:
            return
        widths = self._widened * self.grid.widths
        evidence = self._reader.read(path, self.grid.places, widths)
        if evidence is not None:
            self._correct(path, evidence, altitude)

    def detection(self, altitude: float) -> float:
        """Return the probability that a pass at an altitude [m] has a signal to noise above 5."""
        fading = self._fading(altitude)
        return self._detected(self.grid.reading_probability(self.cells, fading))

    def _fading(self, altitude: float) -> Array:
        """Return ``PlumeGrid.fading`` of a pass at an altitude [m]."""
        return self.grid.fading((self._heights - altitude) / self._widened, self._looks)

    def _detected(self, read: Array) -> float:
        """Return the probability that a pass detects the plume.

        Parameters
        ----------
        read : probability that it reads each strength with each spread, shape (w, p)
        """
        above = np.log(self.grid.faint / self.detectable) / STRENGTH_STEP + 0.5
        return float(read.sum(axis=0) @ np.minimum(np.maximum(above, 0.0), 1.0))

    def prospects(self, altitudes: Array) -> tuple[Array, Array]:
        """Return the probability of each coarse cell, and the probability that a pass detects the
        plume if that cell is true.

        Parameters
        ----------
        altitudes : of the passes [m], shape (n,), or (n, h) with another altitude for each height

        Returns
        -------
        arrays, shapes (h, c) and (n, h, c)
        """
        heights = self.grid.coarse_heights(self._heights)
        off = heights - (altitudes[:, np.newaxis] if altitudes.ndim == 1 else altitudes)
        return self._weights, self.grid.chances(
            off / self._widened, self._looks, self.detectable, self._spread
        )

    def expected_deviation(self, altitudes: Array) -> Array:
        """Return the expected deviation of the height after a pass at each altitude [m]."""
        likely = self._weights.sum(axis=1) > _UNLIKELY
        heights = self.grid.coarse_heights(self._heights)[likely]
        off = (heights - altitudes[:, np.newaxis]) / self._widened
        return self.grid.expected_deviation(
            self._weights[likely], heights, off, self._looks, self._spread[likely]
        )

    def hits(self, altitudes: Array) -> Array:
        """Return the probability that a pass at each altitude [m] hits the plume in height."""
        off = self.grid.coarse_heights(self._heights) - altitudes[:, np.newaxis]
        reach = math.sqrt(-2.0 * math.log(HIT)) * self._spread
        hits = self.grid.within(reach, off / self._widened, self._looks)
        result: Array = hits @ self._weights.sum(axis=1)
        return result

    def _diffuse(self, time: float) -> None:
        """Let the axis wander for ``time`` [s], and the estimate fall back towards the prior."""
        grid = self.grid
        forgotten = -math.expm1(-time / _FORGET)
        height_step = grid.height[1] - grid.height[0]
        self.cells = random_walk(self.cells, 1, HEIGHT_DRIFT**2 * time / height_step**2)
        self.cells += forgotten * (grid.prior - self.cells)
        bearing_step = grid.bearing[1] - grid.bearing[0]
        self.bearings = random_walk(self.bearings, 0, BEARING_DRIFT**2 * time / bearing_step**2)
        self.bearings += forgotten * (grid.bearing_prior - self.bearings)

    def _correct(self, path: Path, evidence: Evidence, altitude: float) -> None:
        """Correct the cells given the estimate of the bearing, and the bearing given that of the
        cells.
        """
        grid = self.grid
        likelihood, nothing = self._scene(path, evidence)
        of_places = grid.place_likelihood(self._distance, self._widened, path.duration)
        places = self.bearings @ of_places
        fading = self._fading(altitude)
        read = grid.reading_probability(self.cells, fading)
        self._judge(evidence, self._detected(read) * path.covered(grid.places, places))
        seen = places @ likelihood + nothing * (1.0 - places.sum())
        missed = 1.0 - fading.sum(axis=-1, keepdims=True)
        of_cells = fading @ grid.faded(seen) + nothing * missed
        there = (likelihood @ read[..., np.newaxis]).sum(axis=0)[:, 0]
        of_bearings = of_places @ (there - nothing * read.sum()) + nothing
        self.cells = _normalised(self.cells * of_cells**_BELIEVED, grid.prior)
        self.bearings = _normalised(self.bearings * of_bearings**_BELIEVED, grid.bearing_prior)

    def _scene(self, path: Path, evidence: Evidence) -> _Scene:
        """Note how a pass met the axis; return the likelihood of its readings."""
        prior, grid = self.prior, self.grid
        stronger = prior.apparent_wind / (self._wind * self._widened**2)
        response = max(evidence.response, _RESPONSE_MIN)
        self.detectable = SIGNAL_TO_NOISE * prior.sensor.noise / (response * stronger)
        significant = evidence.significance > SIGNAL_TO_NOISE
        across = float(grid.places[evidence.at]) if significant else self.offset
        obliqueness = path.obliqueness(across, self._wind)
        way = 2.0 * self._widened * prior.sigma_y * obliqueness
        self._looks = 1.0 + way / (_LOOK * prior.meander_length)
        exponent = _log_likelihood_ratio(
            evidence.slope, evidence.bend, stronger * grid.faint, obliqueness
        )
        largest = max(0.0, float(exponent.max()))
        exponent -= largest
        of_widths = np.exp(exponent, out=exponent).reshape(len(exponent), -1)
        likelihood = grid.width_likelihood(obliqueness) @ of_widths
        return _Scene(likelihood.reshape(exponent.shape), math.exp(-largest))

    def _judge(self, evidence: Evidence, chance: float) -> None:
        """Compare a pass with its expected probability of a hit: innovation and state."""
        chance = clip(chance, _CHANCE, 1.0 - _CHANCE)
        signal_to_noise = evidence.peak / self.prior.sensor.noise
        hit = signal_to_noise > SIGNAL_TO_NOISE and evidence.significance > SIGNAL_TO_NOISE
        squared = (hit - chance) ** 2 / (chance * (1.0 - chance))
        self.innovation += (squared - self.innovation) / min(self.passes, _MEMORY)
        if hit:
            if math.isnan(self.found_at):
                self.found_at = self._time
            self.state = PlumeState.FOUND
            self._misses = 1.0
            return
        self._misses *= 1.0 - chance
        if self.state is PlumeState.FOUND and self._misses < _LOST:
            self.state = PlumeState.LOST
            self.cells = 0.5 * (self.cells + self.grid.prior)
            self.bearings = 0.5 * (self.bearings + self.grid.bearing_prior)

    def _note(self) -> None:
        """Compute the figures of the posterior."""
        grid = self.grid
        self._weights = grid.coarse(self.cells)
        of_spreads = self.cells.sum(axis=2)
        self._of_heights = of_spreads.sum(axis=0)
        self._spread: Array = grid.coarse_heights(of_spreads.sum(axis=1) @ grid.sigma_z)
        self.height = float(self._of_heights @ self._heights)
        step = float(self._heights[1] - self._heights[0])
        variance = float(self._of_heights @ (self._heights - self.height) ** 2)
        self.height_deviation = math.sqrt(variance + step**2 / 12.0)
        self.bearing = float(self.bearings @ grid.bearing)
        variance = float(self.bearings @ (grid.bearing - self.bearing) ** 2)
        self.bearing_deviation = math.sqrt(variance)
        self.offset = self._distance * self.bearing
        self.offset_deviation = self._distance * self.bearing_deviation
        self.sigma_y = self._widened * float(np.vdot(of_spreads, grid.sigma_y))
        self.sigma_z = self._widened * float(np.vdot(of_spreads, grid.sigma_z))
        self.meander_z = self._widened * self.prior.meander_z

    @property
    def height_interval(self) -> tuple[float, float]:
        """2.5 % and 97.5 % quantiles of the height [m]."""
        step = self._heights[1] - self._heights[0]
        below = np.concatenate([[0.0], np.cumsum(self._of_heights)])
        edges = np.concatenate([[self._heights[0] - 0.5 * step], self._heights + 0.5 * step])
        low, high = np.interp((0.025, 0.975), below, edges)
        return float(low), float(high)

    @property
    def measurable(self) -> float:
        """Probability that most passes at some altitude within the limits detect the plume [-]."""
        best = np.clip(
            self.grid.coarse_heights(self._heights), self.prior.lowest, self.prior.highest
        )
        weights, chances = self.prospects(best[np.newaxis])
        return float(np.sum(weights * (chances[0] > 0.5)))
