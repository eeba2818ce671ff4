"""A sniffer that may fail: dead, it repeats its last reading; saturated, it reads the end of its
range.
"""

import numpy as np
import numpy.typing as npt

from measurement.gases import GASES
from measurement.sniffer.sniffer import Readings, Sniffer
from measurement.sniffer.spec import SnifferSpec
from scenarios.world.faults import SNIFFER_DEAD, SNIFFER_SATURATED, TimedFault

Array = npt.NDArray[np.float64]


class FailingSniffer:
    """A sniffer in flight, with the effect of its fault.

    Parameters
    ----------
    spec : the instrument
    fault : fault of the sniffer
    generator, time_step : same as for ``Sniffer``
    """

    def __init__(
        self,
        spec: SnifferSpec,
        fault: TimedFault,
        *,
        generator: np.random.Generator,
        time_step: float,
    ) -> None:
        self._sniffer = Sniffer(spec, generator=generator, time_step=time_step)
        self._fault = fault
        ends = {channel.gas: channel.range_high for channel in spec.channels}
        self._full = np.array([ends.get(gas, np.nan) for gas in GASES])
        self._stuck = np.full(len(GASES), np.nan)

    def advance(self, air: Array, pressure: Array) -> Readings:
        """Return the readings up to the last of these samples; see ``Sniffer.advance``."""
        read = self._sniffer.advance(air, pressure)
        kind, values = self._fault.kind, read.values
        good = read.time < self._fault.begins
        if kind == SNIFFER_SATURATED:
            values[~good] = self._full
        elif kind == SNIFFER_DEAD:
            if good.any():
                self._stuck = values[good][-1].copy()
            values[~good] = self._stuck
        return read
