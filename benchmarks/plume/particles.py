"""The plume estimate by particles, to compare the grid with: a regularised bootstrap filter over
the same model.
"""

import math

import numpy as np

from gnc.estimation.plume.estimator import PlumeEstimator
from gnc.estimation.plume.passes import Evidence, Path
from gnc.estimation.plume.prior import BEARING_DRIFT, HEIGHT_DRIFT, PlumePrior

COUNT = 1000
"""Particles [-]."""

_SHRINK = 0.15
"""Bandwidth of the kernels that resampled particles are drawn from, over the spread of all [-]."""


class ParticleEstimator(PlumeEstimator):
    """Particles of height, bearing, logarithm of strength and of spread. Figures and prospects are
    those of the cells they are in.

    Parameters
    ----------
    prior : what is expected
    """

    def __init__(self, prior: PlumePrior) -> None:
        super().__init__(prior)
        self._generator = np.random.default_rng(0)
        cells, bearings = self.grid.prior, self.grid.bearing_prior
        w, h, c = np.unravel_index(
            self._generator.choice(cells.size, COUNT, p=cells.ravel()), cells.shape
        )
        b = self._generator.choice(len(bearings), COUNT, p=bearings)
        values = [
            w.astype(float),
            self.grid.height[h],
            np.log(self.grid.strength[c]),
            self.grid.bearing[b],
        ]
        self._particles = np.array(values)
        self._steps = np.array([1.0] + [axis[1] - axis[0] for axis in self._axes()])
        self._particles += self._steps[:, np.newaxis] * self._generator.uniform(
            -0.5, 0.5, self._particles.shape
        )

    def _axes(self) -> tuple[np.ndarray, ...]:
        return self.grid.height, np.log(self.grid.strength), self.grid.bearing

    def _diffuse(self, time: float) -> None:
        drifts = np.array([0.0, HEIGHT_DRIFT, 0.0, BEARING_DRIFT]) * math.sqrt(time)
        self._particles += drifts[:, np.newaxis] * self._generator.standard_normal(
            self._particles.shape
        )

    def _correct(self, path: Path, evidence: Evidence, altitude: float) -> None:
        prior, grid, generator = self.prior, self.grid, self._generator
        scene = self._scene(path, evidence)
        w = np.clip(np.rint(self._particles[0]).astype(int), 0, len(grid.sigma_y) - 1)
        heights = prior.height_at(self._particles[1], self._distance, self._wind)
        looks = generator.standard_normal((max(1, round(self._looks)), COUNT))
        off = np.abs(heights + prior.meander_z * looks - altitude).min(axis=0)
        nearest = np.clip(
            np.rint((self._particles[1] - grid.height[0]) / self._steps[1]).astype(int),
            0,
            len(grid.height) - 1,
        )
        strength = np.exp(self._particles[2] - 0.5 * (off / grid.sigma_z[w, nearest]) ** 2)
        across = self._distance * self._particles[3] + prior.meander_y * generator.standard_normal(
            COUNT
        )
        step = grid.places[1] - grid.places[0]
        j = np.rint((across - grid.places[0]) / step).astype(int)
        inside = (j >= 0) & (j < len(grid.places))
        p = np.clip(
            (np.log(np.maximum(strength, 1e-9) / grid.faint[0])) / self._steps[2],
            0.0,
            len(grid.faint) - 1.0,
        )
        of = scene.likelihood[w, np.clip(j, 0, len(grid.places) - 1), np.rint(p).astype(int)]
        weight = np.where(inside, of, scene.nothing)
        self._judge(evidence, self.detection(altitude))
        self._resample(weight / weight.sum())

    def _resample(self, weight: np.ndarray) -> None:
        generator, spread = self._generator, self._particles.std(axis=1)
        places = (generator.uniform() + np.arange(COUNT)) / COUNT
        chosen = self._particles[
            :, np.minimum(np.searchsorted(np.cumsum(weight), places), COUNT - 1)
        ]
        mean = chosen.mean(axis=1, keepdims=True)
        # Shrunk to the mean, so that the kernels do not widen the whole (Liu and West 2001).
        shrunk = mean + math.sqrt(1.0 - _SHRINK**2) * (chosen - mean)
        width = _SHRINK * np.maximum(np.minimum(chosen.std(axis=1), spread), 0.2 * self._steps)
        self._particles = shrunk + width[:, np.newaxis] * generator.standard_normal(chosen.shape)
        self._count()

    def _count(self) -> None:
        indices = [np.clip(np.rint(self._particles[0]).astype(int), 0, len(self.cells) - 1)]
        for values, axis in zip(self._particles[1:], self._axes(), strict=True):
            indices.append(
                np.clip(
                    np.rint((values - axis[0]) / (axis[1] - axis[0])).astype(int), 0, len(axis) - 1
                )
            )
        *of_cells, of_bearings = indices
        counts = np.bincount(
            np.ravel_multi_index(tuple(of_cells), self.cells.shape), minlength=self.cells.size
        )
        self.cells = counts.reshape(self.cells.shape) / COUNT
        self.bearings = np.bincount(of_bearings, minlength=len(self.bearings)) / COUNT
