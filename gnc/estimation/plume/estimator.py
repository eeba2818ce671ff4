"""Where a plume is, how wide and how strong, from readings that show it and from readings that do
not.
"""

import math
from enum import Enum
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gnc.estimation.plume.grid import STRENGTH_STEP, PlumeGrid, normalised, over_nothing, wandered
from gnc.estimation.plume.pass_reader import Evidence, PassReader
from gnc.estimation.plume.passes import PassCollector, Path
from gnc.estimation.plume.prior import BEARING_DRIFT, HEIGHT_DRIFT, SPEED_MIN, GasSensor, PlumePrior
from gnc.estimation.plume.sensor_watch import SensorState, SensorWatch
from gnc.numeric import clip

__all__ = ["GasSensor", "PlumeEstimator", "PlumePrior", "PlumeState", "SensorState"]

Array = npt.NDArray[np.float64]

SIGNAL_TO_NOISE = 5.0
"""Peak of the readings over their noise from which a pass detects the plume [-] (Kattner 2015, of
CO2).
"""

_FORGET = 6000.0
"""Time in which a posterior falls back to the prior, if nothing is read [s]: a ship may change her
load.
"""

_DIFFUSED = 10.0
"""Least time after which the axis is let wander anew [s]: in less it wanders by less than a cell.
"""

_LOST = 0.01
"""Chance of a row of misses below which a plume that was found is lost again [-]."""

_MEMORY = 10.0
"""Passes that the mean of the innovations is over [-]."""

_CHANCE = 0.02
"""Least chance of a hit or a miss that innovations are judged with [-]: models are not better than
that.
"""

_BELIEVED = 0.75
"""Share of what a pass says that is believed [-]: passes have errors in common. Where the heights
of 80 flights were likeliest.
"""

HIT = 0.6
"""Concentration in a pass over that in the plume's centre from which it hits [-]."""

_UNLIKELY = 1e-5
"""Probability of a height below which it does not count where passes to come are weighed [-]."""

_LOOK = 2.0
"""Way along the plume to an independent centre, over the correlation length of the meander [-]: its
integral scale.
"""

_NEAREST = 0.3
"""Least distance behind the funnel at which a pass is believed, over the prior's [-]: nearer it is
another plume.
"""

_NOMINAL_RESPONSE = 0.5
"""Largest reading over strength before a pass has shown it [-]."""

_RESPONSE_MIN = 1e-6
"""Least reading over strength that counts [-]: far from every place that the axis may have a pass
has none, and detects nothing.
"""


class PlumeState(Enum):
    """What is known of the plume."""

    SEARCHING = "searching"
    FOUND = "found"
    LOST = "lost again"


class _Scene(NamedTuple):
    """How likely the readings of a pass are, over the same factor.

    Attributes
    ----------
    likelihood : of a pulse from a plume of each spread, at each place, of each strength, shape (w,
        j, p)
    nothing : of no pulse
    """

    likelihood: Array
    nothing: float


class PlumeEstimator:
    """Bayes' rule on a grid of spread, height and strength, and on one of bearings, once for each
    pass over the axis.

    The frame is that of the *predicted* axis, which trails behind the funnel with the apparent wind
    as estimated on board: not that of the axis that this filter estimates. The mathematics is in
    docs/finding_the_plume.md.

    Parameters
    ----------
    prior : what is expected

    Attributes
    ----------
    prior, grid : what was expected, and the cells
    cells, bearings : probability of each, shapes (w, h, c) and (b,)
    height, height_deviation : of the axis above the sea, at the distance and in the apparent wind
        of the last pass [m]
    bearing, bearing_deviation : of the axis to the right of the predicted one [rad]; a bearing is
        to be added to its course
    offset, offset_deviation : of the axis to the right of the predicted one, at the distance of the
        last pass [m]
    sigma_y, sigma_z, meander_z : spreads of the plume at one moment, and its meander in height, at
        the last pass [m]
    state : whether the plume is searched for, found, or lost again
    signal_to_noise : peak of the readings over their noise, of the best pass so far [-]
    found_at : time since the start at which the plume was found first [s]; not a number before; by
        it benchmarks/plume judges searches
    innovation : mean normalised innovation squared of the passes, 1 where the filter is consistent
        [-]
    passes : number of passes so far [-]
    """

    def __init__(self, prior: PlumePrior) -> None:
        self.prior, self.grid = prior, PlumeGrid(prior)
        self.state = PlumeState.SEARCHING
        self.signal_to_noise, self.found_at, self.innovation = 0.0, math.nan, 1.0
        self.passes = 0
        sensor = prior.sensor
        self._watch = SensorWatch(sensor)
        self._collector = PassCollector(delay=sensor.delay, tail=sensor.time_constant)
        self._reader = PassReader(sensor)
        self._time = self._diffused_at = 0.0
        self._spoilt = False
        self._distance, self._wind = prior.distance, prior.apparent_wind
        self._least = SIGNAL_TO_NOISE * sensor.noise / _NOMINAL_RESPONSE
        self._misses = self._looks = self._widened = 1.0
        self._heights: Array = prior.height_at(self.grid.height, self._distance, self._wind)
        self.cells: Array = self.grid.prior.copy()
        self.bearings: Array = self.grid.bearing_prior.copy()
        self._note()

    @property
    def sensor(self) -> SensorState:
        """What the readings say about the sensor; unless it works the estimate only diffuses."""
        return self._watch.state

    def predict(self, time_step: float) -> None:
        """Let ``time_step`` [s] go by. What that does to the estimate is computed once for each
        pass.
        """
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
        """Take note of the vehicle's place and of a reading; return whether a pass is over and the
        estimate is a new one.

        To be called after ``predict``, for each reading, and in between as often as the place is to
        be known: each 0.5 s at least.

        Parameters
        ----------
        along, across : of the vehicle, behind the funnel and to the right of the predicted axis,
            seen along it [m]
        altitude : above the sea [m]
        reading : of CO2 [ppm], newly sampled; not a number where there is none. A constant
            background may be in it
        apparent_wind : past the ship now [m/s], taken for 1 m/s at least; that of the prior unless
            given
        """
        if not math.isnan(reading):
            self._watch.read(reading)
            self._spoilt = self._spoilt or self._watch.state is not SensorState.WORKING
        path = self._collector.add(self._time, along, across, altitude, reading)
        if path is None:
            return False
        self._wind = max(
            self.prior.apparent_wind if apparent_wind is None else apparent_wind, SPEED_MIN
        )
        if self._time >= self._diffused_at + _DIFFUSED:
            self._diffuse(self._time - self._diffused_at)
            self._diffused_at = self._time
        self.passes += 1
        along, altitude = path.at(self.offset)
        believed = along > _NEAREST * self.prior.distance and not self._spoilt
        if believed:
            # Where the plume is met it has another spread, and another strength, than where the
            # cells have theirs.
            self._distance, self._widened = along, self.prior.widened(along, self._wind)
        self._heights = self.prior.height_at(self.grid.height, self._distance, self._wind)
        evidence = (
            self._reader.read(path, self.grid.places, self._widened * self.grid.widths)
            if believed
            else None
        )
        if evidence is not None:
            self._correct(path, evidence, altitude)
        self._spoilt = False
        self._note()
        return True

    def detection(self, altitude: float) -> float:
        """Return the probability that a pass at an altitude [m] has a signal to noise above 5."""
        return self._detected(self.grid.over_faint(self.cells, self._fading(altitude)))

    def _fading(self, altitude: float) -> Array:
        """Return ``PlumeGrid.fading`` of a pass at an altitude [m]."""
        return self.grid.fading((self._heights - altitude) / self._widened, self._looks)

    def _detected(self, read: Array) -> float:
        """Return the probability that a pass detects the plume, of the one that it reads each
        strength with each spread (w, p).
        """
        above = np.log(self.grid.faint / self._least) / STRENGTH_STEP + 0.5
        return float(read.sum(axis=0) @ np.minimum(np.maximum(above, 0.0), 1.0))

    def prospects(self, altitudes: Array) -> tuple[Array, Array]:
        """Return the probability of each of some cells, shape (h, c), and that a pass then detects
        the plume, shape (n, h, c).

        Parameters
        ----------
        altitudes : of the passes, shape (n,) or, for each cell its own, (n, h) [m]
        """
        heights = self.grid.coarse_heights(self._heights)
        off = heights - (altitudes[:, np.newaxis] if altitudes.ndim == 1 else altitudes)
        return self._weights, self.grid.chances(
            off / self._widened, self._looks, self._least, self._spread
        )

    def expected_deviation(self, altitudes: Array) -> Array:
        """Return what the standard deviation of the height is expected to be after a pass at each
        altitude [m], shape (n,).
        """
        likely = self._weights.sum(axis=1) > _UNLIKELY
        heights = self.grid.coarse_heights(self._heights)[likely]
        off = (heights - altitudes[:, np.newaxis]) / self._widened
        return self.grid.expected_deviation(
            self._weights[likely], heights, off, self._looks, self._spread[likely]
        )

    def hits(self, altitudes: Array) -> Array:
        """Return the probability that a pass at each altitude [m] hits the plume in height, shape
        (n,).
        """
        off = self.grid.coarse_heights(self._heights) - altitudes[:, np.newaxis]
        result: Array = self.grid.hits(
            off / self._widened, self._looks, self._spread, HIT
        ) @ self._weights.sum(axis=1)
        return result

    def _diffuse(self, time: float) -> None:
        """Let the axis wander for ``time`` [s], and let some of what is known be forgotten."""
        grid = self.grid
        forgotten = -math.expm1(-time / _FORGET)
        self.cells = wandered(
            self.cells, 1, HEIGHT_DRIFT**2 * time / (grid.height[1] - grid.height[0]) ** 2
        )
        self.cells += forgotten * (grid.prior - self.cells)
        self.bearings = wandered(
            self.bearings, 0, BEARING_DRIFT**2 * time / (grid.bearing[1] - grid.bearing[0]) ** 2
        )
        self.bearings += forgotten * (grid.bearing_prior - self.bearings)

    def _correct(self, path: Path, evidence: Evidence, altitude: float) -> None:
        """Take in what a pass says: of spread, height and strength with the bearing as it is
        believed, and the other way round.
        """
        grid = self.grid
        likelihood, nothing = self._scene(path, evidence)
        beside = grid.beside(self._distance, self._widened, path.duration)
        places = self.bearings @ beside
        fading = self._fading(altitude)
        read = grid.over_faint(self.cells, fading)
        self._judge(evidence, self._detected(read) * path.covered(grid.places, places))
        seen = places @ likelihood + nothing * (1.0 - places.sum())
        of_cells = fading @ grid.over_strengths(seen) + nothing * (
            1.0 - fading.sum(axis=-1, keepdims=True)
        )
        there = (likelihood @ read[..., np.newaxis]).sum(axis=0)[:, 0]
        of_bearings = beside @ (there - nothing * read.sum()) + nothing
        self.cells = normalised(self.cells * of_cells**_BELIEVED, grid.prior)
        self.bearings = normalised(self.bearings * of_bearings**_BELIEVED, grid.bearing_prior)

    def _scene(self, path: Path, evidence: Evidence) -> "_Scene":
        """Take note of how a pass met the axis; return how likely its readings are."""
        prior, grid = self.prior, self.grid
        stronger = prior.apparent_wind / (self._wind * self._widened**2)
        self._least = (
            SIGNAL_TO_NOISE
            * prior.sensor.noise
            / (max(evidence.response, _RESPONSE_MIN) * stronger)
        )
        significant = evidence.significance > SIGNAL_TO_NOISE
        drawn_out = path.drawn_out(
            float(grid.places[evidence.at]) if significant else self.offset, self._wind
        )
        self._looks = 1.0 + 2.0 * self._widened * prior.sigma_y * drawn_out / (
            _LOOK * prior.meander_length
        )
        exponent = over_nothing(evidence.slope, evidence.bend, stronger * grid.faint, drawn_out)
        largest = max(0.0, float(exponent.max()))
        exponent -= largest
        likelihood = grid.of_widths(drawn_out) @ np.exp(exponent, out=exponent).reshape(
            len(exponent), -1
        )
        return _Scene(likelihood.reshape(exponent.shape), math.exp(-largest))

    def _judge(self, evidence: Evidence, chance: float) -> None:
        """Compare what a pass showed with the chance of a hit that was expected of it: innovations,
        found, lost again.
        """
        chance = clip(chance, _CHANCE, 1.0 - _CHANCE)
        signal_to_noise = evidence.peak / self.prior.sensor.noise
        hit = signal_to_noise > SIGNAL_TO_NOISE and evidence.significance > SIGNAL_TO_NOISE
        squared = (hit - chance) ** 2 / (chance * (1.0 - chance))
        self.innovation += (squared - self.innovation) / min(self.passes, _MEMORY)
        if hit:
            self.signal_to_noise = max(self.signal_to_noise, signal_to_noise)
            self.found_at = self._time if math.isnan(self.found_at) else self.found_at
            self.state, self._misses = PlumeState.FOUND, 1.0
            return
        self._misses *= 1.0 - chance
        if self.state is PlumeState.FOUND and self._misses < _LOST:
            self.state = PlumeState.LOST
            self.cells = 0.5 * (self.cells + self.grid.prior)
            self.bearings = 0.5 * (self.bearings + self.grid.bearing_prior)

    def _note(self) -> None:
        """Compute the figures of the posterior."""
        prior, grid = self.prior, self.grid
        self._weights = grid.coarse(self.cells)
        of_spreads = self.cells.sum(axis=2)
        self._of_heights = of_heights = of_spreads.sum(axis=0)
        self._spread: Array = grid.coarse_heights(of_spreads.sum(axis=1) @ grid.sigma_z)
        self.height = float(of_heights @ self._heights)
        step = float(self._heights[1] - self._heights[0])
        self.height_deviation = math.sqrt(
            float(of_heights @ (self._heights - self.height) ** 2) + step**2 / 12.0
        )
        self.bearing = float(self.bearings @ grid.bearing)
        self.bearing_deviation = math.sqrt(
            float(self.bearings @ (grid.bearing - self.bearing) ** 2)
        )
        self.offset, self.offset_deviation = (
            self._distance * self.bearing,
            self._distance * self.bearing_deviation,
        )
        self.sigma_y = self._widened * float(np.vdot(of_spreads, grid.sigma_y))
        self.sigma_z = self._widened * float(np.vdot(of_spreads, grid.sigma_z))
        self.meander_z = self._widened * prior.meander_z

    @property
    def height_interval(self) -> tuple[float, float]:
        """2.5 % and 97.5 % quantiles of the height [m]: what tests and benchmarks/plume hold
        against the truth.
        """
        step = self._heights[1] - self._heights[0]
        below = np.concatenate([[0.0], np.cumsum(self._of_heights)])
        edges = np.concatenate([[self._heights[0] - 0.5 * step], self._heights + 0.5 * step])
        low, high = np.interp((0.025, 0.975), below, edges)
        return float(low), float(high)

    @property
    def measurable(self) -> float:
        """Probability that a pass at the best altitude within the limits detects the plume more
        often than not [-].
        """
        best = np.clip(
            self.grid.coarse_heights(self._heights), self.prior.lowest, self.prior.highest
        )
        weights, chances = self.prospects(best[np.newaxis])
        return float(np.sum(weights * (chances[0] > 0.5)))
