"""Fluctuations within a plume, one factor for all gases, of unit mean."""

import math

import numpy as np

from measurement.plume.arrays import Array

_MODES = 64
"""Waves of which the field is made: enough that the sum is Gaussian."""

_CHUNK = 512
"""Points whose waves are summed at a time: their phases stay in the processor's cache."""

_TURN = 2.0 * math.pi


class Structure:
    """exp(s g - s^2/2) with s^2 = ln(1 + i^2) and g a Gaussian field of unit variance: log-normal,
    of mean 1 and intensity i.

    g is a sum of 64 waves with covariance exp(-r^2/2 L^2). It is frozen at emission: its place
    along the plume is the path of air that has passed the funnel, and across it is that from the
    centre. It does not touch the ratio of gases.

    Parameters
    ----------
    intensity : i, standard deviation over mean [-]
    length_along : L along the plume [m]
    length_across : L across, in relative spreads [-]
    generator : source of its randomness
    """

    def __init__(
        self,
        intensity: float,
        length_along: float,
        length_across: float,
        generator: np.random.Generator,
    ) -> None:
        self._deviation = math.sqrt(math.log1p(intensity**2))
        scale = np.array([length_along, length_across, length_across])
        # In turns per metre and per spread, a column for each direction.
        self._waves = (generator.standard_normal((_MODES, 3)) / (_TURN * scale)).T[:, :, np.newaxis]
        self._phases = generator.uniform(0.0, 1.0, (_MODES, 1))

    def factor(self, path: Array, across: Array, up: Array) -> Array:
        """Return the factor on the concentration [-], shape (n,).

        Parameters
        ----------
        path : air that has passed the funnel until emission [m], shape (n,)
        across, up : from the centre, in relative spreads [-], shape (n,)
        """
        field = np.empty(len(path))
        along, beside, above = self._waves
        for start in range(0, len(path), _CHUNK):
            part = slice(start, start + _CHUNK)
            turns = self._phases + along * path[part] + beside * across[part] + above * up[part]
            turns -= np.rint(turns)
            # Cosines of single precision are good to 1e-6 and take a tenth of the time.
            field[part] = np.cos((_TURN * turns).astype(np.float32)).sum(axis=0, dtype=np.float64)
        field *= math.sqrt(2.0 / _MODES)
        result: Array = np.exp(self._deviation * field - 0.5 * self._deviation**2)
        return result
