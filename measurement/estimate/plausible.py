"""What no living sensor reads, and no exhaust has."""

import numpy as np

from measurement.estimate.fit.signals import used_gases
from measurement.estimate.quality import quiet
from measurement.estimate.record import Record
from measurement.estimate.sticking import sticking
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec

OZONE_MOST = 50.0
"""NO2 that ozone makes of the NO of a plume, at most [ppb] (assumption): all ozone of the air over the sea, which has 20 to 50."""

_LOW, _HIGH, _SIGMAS = 0.05, 0.95, 3.29
"""Shares of the readings below the level outside the plume, and below that in it; of noise alone they lie so many sigma apart."""


def unlikely(record: Record, readings: Readings, instrument: SnifferSpec) -> list[str]:
    """Return what is wrong with readings of CO2, SO2, and the gases of the record that the SO2 channel responds to."""
    so2 = instrument.known("so2")
    telling = ["so2", *(gas for gas in used_gases(record) if so2.cross.get(gas, 0.0) or so2.cross_sd.get(gas, 0.0))]
    problems = list(sticking(readings, instrument.known("co2")))
    for channel in map(instrument.known, telling):
        problems += sticking(readings, channel) or quiet(record.scatter[channel.gas], channel)
    return problems or _exchanged(record)


def _exchanged(record: Record) -> list[str]:
    """Return the problem of NO2 that exceeds NO by more than ozone makes of it, if it does.

    Of the NOx of exhaust 3 to 20 % are NO2.
    """
    if not {"no", "no2"} <= set(used_gases(record)):
        return []
    no, no2 = (float(np.ptp(np.quantile(record.of(gas), (_LOW, _HIGH)))) for gas in ("no", "no2"))
    # The squares of what noise and plume do add up.
    if no2**2 - (_SIGMAS * record.scatter["no2"]) ** 2 <= (no + OZONE_MOST) ** 2:
        return []
    return [
        f"NO2 varies by {no2:.0f} ppb in the plume and NO by {no:.0f} ppb: exhaust has more NO than NO2, and ozone makes at most"
        f" {OZONE_MOST:g} ppb of it; check which columns are SO2, NO and NO2, and their units"
    ]
