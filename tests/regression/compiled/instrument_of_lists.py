"""An instrument whose columns and readings are lists, of numbers of NumPy."""

import numpy as np


class InstrumentOfLists:
    """Measures the altitude."""

    COLUMNS = ["read_m", "read_twice_m"]  # noqa: RUF012  The sources take a list, too.

    def __init__(self, _scenario, _world, generator):
        self._generator = generator

    def read(self, _time, _motion, sample):
        """Return the altitude with noise, and twice of it."""
        altitude = np.float32(sample[0] + self._generator.normal())
        return [altitude, 2 * altitude]
