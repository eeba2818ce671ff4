"""Axis and spreads of a plume, looked up by the apparent wind at emission and by age."""

import math

import numpy as np

from measurement.emission.emission import Emission
from measurement.plume.air import MarineAir
from measurement.plume.arrays import Array, Indices
from measurement.plume.settings import PlumeSettings
from measurement.plume.spread import STEP, spreads

_RATIO = math.log(1.08)
"""Step between winds of the table, as a logarithm: linear between them is good to 1e-3."""

_STEADY = 1e-6
"""Relative range of winds below which they are one."""

_TYPICAL_AGE = 30.0
"""Age that a plume typically has where it is crossed [s]."""

_COLUMNS = 5


class SpreadTable:
    """Height of the axis, relative spreads across and up, and those of the meander, by apparent
    wind and age.

    Parameters
    ----------
    emission, air, source_height, settings : as of ``measurement.plume.spread.spreads``
    winds : least and largest apparent wind [m/s]
    age_max : largest age [s]
    """

    def __init__(
        self,
        emission: Emission,
        air: MarineAir,
        source_height: float,
        winds: tuple[float, float],
        age_max: float,
        settings: PlumeSettings,
    ) -> None:
        low, high = winds
        steady = high - low <= _STEADY * high
        count = 1 if steady else 1 + math.ceil(math.log(high / low) / _RATIO)
        grid = np.array([0.5 * (low + high)]) if steady else np.geomspace(low, high, count)
        self._first, self._step = math.log(grid[0]), math.log(high / low) / max(1, count - 1)
        of = spreads(emission, air, source_height, grid, age_max, settings)
        table = np.stack(
            [of.height, of.relative_y, of.relative_z, of.meander_y, of.meander_z], axis=-1
        )
        if settings.mean:
            table[..., 1:3] = np.hypot(table[..., 1:3], table[..., 3:])
        if settings.mean or not settings.meander:
            table[..., 3:] = 0.0
        self._ages = table.shape[1] - 1
        self._winds = count
        # Values at an age of the table, and what they grow by until the next.
        self._rows = np.concatenate([table[:, :-1], np.diff(table, axis=1)], axis=-1).reshape(
            -1, 2 * _COLUMNS
        )
        self.typical_spread = float(
            of.relative_y[count // 2, min(self._ages, round(_TYPICAL_AGE / STEP))]
        )

    def at(self, wind: Array, age: Array) -> Array:
        """Return height, sigma_ry, sigma_rz, sigma_my and sigma_mz [m], shape (5, n), linear in age
        and in the wind's logarithm.

        Parameters
        ----------
        wind : apparent wind [m/s], shape (n,), within the table's
        age : [s], shape (n,), from 0 to the table's end
        """
        steps = age / STEP
        index = np.minimum(steps.astype(np.intp), self._ages - 1)
        rest = steps - index
        if self._winds == 1:
            return self._row(index, rest)
        place = np.clip((np.log(wind) - self._first) / self._step, 0.0, self._winds - 1.0)
        line = np.minimum(place.astype(np.intp), self._winds - 2)
        share = place - line
        index += line * self._ages
        below = self._row(index, rest)
        result: Array = below + share * (self._row(index + self._ages, rest) - below)
        return result

    def _row(self, index: Indices, rest: Array) -> Array:
        row = self._rows.take(index, axis=0).T
        result: Array = row[:_COLUMNS] + rest * row[_COLUMNS:]
        return result
