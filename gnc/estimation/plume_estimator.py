"""Where a plume is, how wide and how strong, from readings that show it and from readings that do not."""

import math
from enum import Enum

import numpy as np
import numpy.typing as npt

from gnc.estimation.plume_grid import PlumeGrid
from gnc.estimation.plume_passes import Evidence, PassCollector, PassReader, Path, Place
from gnc.estimation.plume_prior import GasSensor, PlumePrior
from gnc.estimation.sensor_watch import SensorState, SensorWatch

__all__ = ["GasSensor", "PlumeEstimator", "PlumePrior", "PlumeState", "SensorState"]

Array = npt.NDArray[np.float64]

SIGNAL_TO_NOISE = 5.0
"""Peak of the readings over their noise from which a pass detects the plume [-] (Kattner 2015, of CO2)."""

_FORGET = 1800.0
"""Time in which a posterior falls back to the prior, if nothing is read [s]: a ship may change her load."""

_LOST = 0.01
"""Chance of a row of misses below which a plume that was found is lost again [-]."""

_MEMORY = 10.0
"""Passes that the mean of the innovations is over [-]."""

_CHANCE = 0.02
"""Least chance of a hit or a miss that innovations are judged with [-]: models are not better than that."""

_STRENGTH_ERROR = 0.25
"""Error of the strength of a pass, over itself, by width, speed and gusts [-]: an assumption. It also covers the grid's step."""

_LOOK = 1.0
"""Way along the plume to an independent centre, over the correlation length of the meander [-]."""

_NEAREST = 0.3
"""Least distance behind the funnel at which a pass is believed, over the prior's [-]: nearer it is another plume."""

_BEND_MIN = 1e-12
"""Least curvature of a likelihood [1/ppm^2]: a place that the vehicle has not been to says nothing."""

_NOMINAL_RESPONSE = 0.5
"""Largest reading over strength before a pass has shown it [-]."""


class PlumeState(Enum):
    """What is known of the plume."""

    SEARCHING = "searching"
    FOUND = "found"
    LOST = "lost again"


class PlumeEstimator:
    """Bayes' rule on a grid of spread, height, strength and bearing, once for each pass over the axis.

    The frame is that of the *predicted* axis, which trails behind the funnel with the apparent wind as estimated on board: not that
    of the axis that this filter estimates. The mathematics is in docs/finding_the_plume.md.

    Parameters
    ----------
    prior : what is expected

    Attributes
    ----------
    prior, grid, cells : what was expected, the cells, and the probability of each, shape (w, h, c, b)
    height, height_deviation : of the axis above the sea, at the distance and in the apparent wind of the last pass [m]
    bearing, bearing_deviation : of the axis to the right of the predicted one [rad]; a bearing is to be added to its course
    offset, offset_deviation : of the axis to the right of the predicted one, at the distance of the last pass [m]
    sigma_y, sigma_z : spreads of the plume at one moment, at the estimated height [m]
    state : whether the plume is searched for, found, or lost again
    signal_to_noise : peak of the readings over their noise, of the best pass so far [-]
    found_at : time since the start at which the plume was found first [s]; not a number before
    innovation : mean normalised innovation squared of the passes, 1 where the filter is consistent [-]
    passes : number of passes so far [-]
    """

    def __init__(self, prior: PlumePrior) -> None:
        self.prior, self.grid = prior, PlumeGrid(prior)
        self.state = PlumeState.SEARCHING
        self.signal_to_noise, self.found_at, self.innovation = 0.0, math.nan, 1.0
        self.passes = 0
        sensor = prior.sensor
        self._watch = SensorWatch(interval=sensor.interval, saturated=sensor.saturated)
        self._collector = PassCollector(delay=sensor.delay, tail=sensor.time_constant)
        self._reader = PassReader(sensor)
        self._time = self._pass_at = 0.0
        self._spoilt = False
        self._distance, self._wind = prior.distance, prior.apparent_wind
        self._least = SIGNAL_TO_NOISE * sensor.noise / _NOMINAL_RESPONSE
        self._misses = self._looks = 1.0
        self.cells: Array = self.grid.prior.copy()
        self._note()

    @property
    def sensor(self) -> SensorState:
        """What the readings say about the sensor; unless it works the estimate only diffuses."""
        return self._watch.state

    def predict(self, time_step: float) -> None:
        """Let ``time_step`` [s] go by. What that does to the estimate is computed once for each pass."""
        self._time += time_step
        self._watch.wait(time_step)
        if self._watch.state is not SensorState.WORKING:
            self._spoilt = True

    def update(self, along: float, across: float, altitude: float, reading: float, *, apparent_wind: float | None = None) -> bool:
        """Take note of the vehicle's place and of a reading; return whether a pass is over and the estimate is a new one.

        To be called after ``predict``, for each reading, and in between as often as the place is to be known: each 0.5 s at least.

        Parameters
        ----------
        along, across : of the vehicle, behind the funnel and to the right of the predicted axis, seen along it [m]
        altitude : above the sea [m]
        reading : of CO2 [ppm], newly sampled; not a number where there is none. A constant background may be in it
        apparent_wind : past the ship now [m/s]; that of the prior unless given
        """
        if not math.isnan(reading):
            self._watch.read(reading)
            self._spoilt = self._spoilt or self._watch.state is not SensorState.WORKING
        path = self._collector.add(Place(self._time, along, across, altitude), reading)
        if path is None:
            return False
        self._wind = apparent_wind or self.prior.apparent_wind
        self._diffuse(self._time - self._pass_at)
        self._pass_at = self._time
        self.passes += 1
        behind = path.at(self.offset)[0] > _NEAREST * self.prior.distance
        believed = behind and not self._spoilt
        evidence = self._reader.read(path, self.grid.places, self.grid.spreads) if believed else None
        self._spoilt = False
        if evidence is not None:
            self._correct(path, evidence)
        self._note()
        return True

    def detection(self, altitude: float) -> float:
        """Return the probability that a pass at an altitude [m] has a signal to noise above 5."""
        weights, chances = self.prospects(np.array([altitude]))
        return float(np.sum(weights * chances[0]))

    def prospects(self, altitudes: Array) -> tuple[Array, Array]:
        """Return the probability of each of some cells, shape (h, c), and that a pass then detects the plume, shape (n, h, c).

        Parameters
        ----------
        altitudes : of the passes, shape (n,) or, for each cell its own, (n, h) [m]
        """
        heights = self.grid.coarse_heights(self._heights)
        off = heights - (altitudes[:, np.newaxis] if altitudes.ndim == 1 else altitudes)
        return self._weights, self.grid.chances(off, self._looks, self._least)

    def expected_deviation(self, altitudes: Array) -> Array:
        """Return what the standard deviation of the height is expected to be after a pass at each altitude [m], shape (n,)."""
        heights = self.grid.coarse_heights(self._heights)
        off = heights - altitudes[:, np.newaxis]
        return self.grid.expected_deviation(self._weights, heights, off, self._looks)

    def _diffuse(self, time: float) -> None:
        """Let the axis wander for ``time`` [s], and let some of what is known be forgotten."""
        prior, grid = self.prior, self.grid
        for axis, drift, values in ((1, prior.height_drift, grid.height), (3, prior.bearing_drift, grid.bearing)):
            share = min(0.25, 0.5 * drift**2 * time / (values[1] - values[0]) ** 2)
            moved = self.cells.swapaxes(0, axis)
            flow = share * (moved[1:] - moved[:-1])
            moved[:-1] += flow
            moved[1:] -= flow
        forgotten = -math.expm1(-time / _FORGET)
        self.cells += forgotten * (grid.prior - self.cells)

    def _correct(self, path: Path, evidence: Evidence) -> None:
        """Take in what a pass says."""
        prior, grid = self.prior, self.grid
        self._least = SIGNAL_TO_NOISE * prior.sensor.noise / evidence.response
        self._distance, altitude = path.at(self.offset)
        heights = prior.height_at(grid.height, self._distance, self._wind)
        # Likelihood of each strength at each place, over that of no pulse at all; its largest is 1.
        exponent = self._over_nothing(evidence)
        largest = max(0.0, float(exponent.max()))
        nothing = math.exp(-largest)
        likelihood = np.exp(exponent - largest)
        beside = self._beside(path)
        self._looks = self._seen(path, evidence)
        fading = grid.fading(heights, altitude, self._looks)
        elsewhere = nothing * (1.0 - beside.sum(axis=1))
        seen = (beside @ likelihood).transpose(0, 2, 1) + elsewhere
        expected = grid.over_strengths(seen)
        w, f, c, b = expected.shape
        of_cells = fading @ expected.reshape(w, f, c * b)
        of_cells += (nothing * (1.0 - fading.sum(axis=-1)))[..., np.newaxis]
        self._judge(evidence, altitude)
        self.cells *= of_cells.reshape(w, -1, c, b)
        total = float(self.cells.sum())
        self.cells = self.cells / total if total > 0.0 else grid.prior.copy()

    def _over_nothing(self, evidence: Evidence) -> Array:
        """Return the log likelihood of each strength at each place less that of no pulse, shape (w, j, p).

        A pulse of strength P fits readings that have one of P (1 + e), e ~ N(0, 0.25^2): e has been integrated out.
        """
        strength, slope = self.grid.faint, evidence.slope[..., np.newaxis]
        bend = np.maximum(evidence.bend, _BEND_MIN)[..., np.newaxis]
        best = slope**2 / bend
        widened = 1.0 + bend * (_STRENGTH_ERROR * strength) ** 2
        result: Array = 0.5 * (best - (best - 2.0 * slope * strength + bend * strength**2) / widened - np.log(widened))
        return result

    def _seen(self, path: Path, evidence: Evidence) -> float:
        """Return how many independent centres of the plume a pass meets [-]."""
        prior, grid = self.prior, self.grid
        across = float(grid.places[evidence.at]) if evidence.significance > SIGNAL_TO_NOISE else self.offset
        way = 2.0 * float(grid.spreads[evidence.spread]) * path.drawn_out(across, self._wind)
        return 1.0 + way / (_LOOK * prior.meander_length)

    def _beside(self, path: Path) -> Array:
        """Return how likely the centre is at each place, given each bearing, shape (b, j).

        Meander that two passes have in common does not average out: its variance counts (1 + r)/(1 - r) times, with r its
        correlation from pass to pass.
        """
        prior, grid = self.prior, self.grid
        apart = 2.0 * path.duration / prior.meander_time
        common = (1.0 + apart) * math.exp(-apart)
        step = grid.places[1] - grid.places[0]
        cell = self._distance * (grid.bearing[1] - grid.bearing[0])
        deviation = math.sqrt(prior.meander_y**2 * (1.0 + common) / (1.0 - common) + (step**2 + cell**2) / 12.0)
        off = (grid.places - self._distance * grid.bearing[:, np.newaxis]) / deviation
        result: Array = np.exp(-0.5 * off**2) * (step / (deviation * math.sqrt(2.0 * math.pi)))
        result /= np.maximum(1.0, result.sum(axis=1, keepdims=True))
        return result

    def _judge(self, evidence: Evidence, altitude: float) -> None:
        """Compare what a pass showed with what was expected of it: innovations, found, lost again."""
        chance = min(max(self.detection(altitude), _CHANCE), 1.0 - _CHANCE)
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

    def _note(self) -> None:
        """Compute the figures of the posterior."""
        prior, grid = self.prior, self.grid
        of_bearings = np.ones(self.cells[..., 0].size) @ self.cells.reshape(-1, len(grid.bearing))
        of_strengths = self.cells.sum(axis=3)
        self._weights = grid.coarse(of_strengths)
        of_spreads = of_strengths.sum(axis=2)
        of_heights = of_spreads.sum(axis=0)
        self._heights: Array = prior.height_at(grid.height, self._distance, self._wind)
        self.height = float(of_heights @ self._heights)
        step = float(self._heights[1] - self._heights[0])
        self.height_deviation = math.sqrt(float(of_heights @ (self._heights - self.height) ** 2) + step**2 / 12.0)
        self._of_heights = of_heights
        self.bearing = float(of_bearings @ grid.bearing)
        self.bearing_deviation = math.sqrt(float(of_bearings @ (grid.bearing - self.bearing) ** 2))
        self.offset, self.offset_deviation = self._distance * self.bearing, self._distance * self.bearing_deviation
        self.sigma_y = float(np.sum(of_spreads * grid.sigma_y))
        self.sigma_z = float(np.sum(of_spreads * grid.sigma_z))

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
        """Probability that a pass at the best altitude within the limits detects the plume more often than not [-]."""
        best = np.clip(self.grid.coarse_heights(self._heights), self.prior.lowest, self.prior.highest)
        weights, chances = self.prospects(best[np.newaxis])
        return float(np.sum(weights * (chances[0] > 0.5)))
