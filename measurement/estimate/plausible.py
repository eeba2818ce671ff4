"""What no living sensor reads, and no exhaust has."""

import math

import numpy as np

from measurement.estimate.fit.signals import used_gases
from measurement.estimate.quality import STRANGE_SIGMA, quiet
from measurement.estimate.record import Record, shown_scatter, shown_step
from measurement.estimate.sticking import sticking
from measurement.gases import GASES, UNITS
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec

OZONE_MOST = 50.0
"""NO2 that ozone makes of the NO of a plume, at most [ppb] (assumption): all ozone of the air over
the sea, which has 20 to 50.
"""

_LOW, _HIGH, _SIGMAS = 0.05, 0.95, 3.29
"""Shares of the readings below the level outside the plume, and below that in it; of noise alone
they lie so many sigma apart.
"""


_CUT_LEAST, _CUT_OVER, _CUT_STEPS = 8, 3.0, 5
"""Readings at the last one, and how often as many as at any of the next steps before it, that show
where readings are cut off.
"""

_FASTER, _FASTEST = 0.5, 0.1
"""Share of the stated t90 within which a sensor may fall, for uneven times and wrong figures; and
where t90 is not well known.
"""

_FALL_SIGMAS = 10.0
"""Standard deviations of the noise by which a reading is lower than the one before it allows, until
noise is no explanation.
"""


def unlikely(record: Record, readings: Readings, instrument: SnifferSpec) -> list[str]:
    """Return what is wrong with readings of CO2, SO2, and the gases of the record that the SO2
    channel responds to.
    """
    so2 = instrument.known("so2")
    telling = [
        "so2",
        *(
            gas
            for gas in used_gases(record)
            if so2.cross.get(gas, 0.0) or so2.cross_sd.get(gas, 0.0)
        ),
    ]
    problems = [
        problem
        for gas in used_gases(record)
        for problem in _cut_off(readings, instrument.known(gas))
    ]
    problems += [
        *sticking(readings, instrument.known("co2")),
        *_spikes(record, readings, instrument.known("co2")),
    ]
    for channel in map(instrument.known, telling):
        problems += sticking(readings, channel) or quiet(record.scatter[channel.gas], channel)
    return problems or _exchanged(record, instrument)


def _cut_off(readings: Readings, channel: Channel) -> list[str]:
    """Return the problem of readings that end in a heap, at the largest or the least, if they do.

    What lies beyond is lost, which makes a mean of SO2 or of CO2 too low, or too high. Saturation
    is told apart.
    """
    column = readings.values[:, GASES.index(channel.gas)]
    known, step = column[np.isfinite(column)], shown_step(column)
    most, least = float(known.max()), float(known.min())
    noise = channel.noise
    if math.isnan(noise):
        noise = shown_scatter([known[known > least]], step)
    name, unit = channel.gas.upper(), UNITS[channel.gas]
    if not step:
        return []
    if most < channel.range_high - 0.5 * channel.resolution and (
        times := _heap((most - known) / step)
    ):
        return [
            f"{name} reads {most:g} {unit}, and never more, {times} times, and hardly ever just less: it is cut off"
        ]
    # Clean air without noise that is seen reads the same, and least.
    if noise >= step and (times := _heap((known - least) / step)):
        return [
            f"{name} reads {least:g} {unit}, and never less, {times} times, and hardly ever just more: it is cut off; log what its"
            " noise takes below"
        ]
    return []


def _heap(steps: Array) -> int:
    """Return how many readings lie at 0 steps from the end, where these are a heap: noise and
    plumes end in fewer and fewer.
    """
    heap, *near = (int(np.sum(np.round(steps) == number)) for number in range(_CUT_STEPS + 1))
    return heap if heap >= _CUT_LEAST and heap > _CUT_OVER * max(near) else 0


def _spikes(record: Record, readings: Readings, channel: Channel) -> list[str]:
    """Return the problem of CO2 that falls faster than its sensor can, as it does after a spike, if
    it does.

    A reading falls towards that of the air, and no lower: a time constant later an e-th of its
    excess is left. One spike is enough to draw the slope to 0, and where SO2 is noisy nothing else
    shows it.
    """
    column = readings.values[:, GASES.index("co2")]
    known = np.flatnonzero(np.isfinite(column))
    time, values, lowest = readings.time[known], column[known], float(np.min(column[known]))
    noise = np.fmax(channel.noise, record.scatter["co2"])
    fastest = channel.constants[0] * max(
        _FASTEST, min(_FASTER, 1.0 - STRANGE_SIGMA * channel.t90_sd)
    )
    least = (
        lowest + (values[:-1] - lowest) * np.exp(-np.diff(time) / fastest) - _FALL_SIGMAS * noise
    )
    falls = np.flatnonzero(values[1:] < least)
    if not falls.size:
        return []
    i, more = int(falls[0]), f", and {falls.size - 1} more such falls" if falls.size > 1 else ""
    when = f"in {time[i + 1] - time[i]:.2g} s at {time[i] - readings.time[0]:.0f} s{more}"
    return [
        f"CO2 falls from {values[i]:.1f} to {values[i + 1]:.1f} ppm {when}, faster than a t90 of {channel.t90_s:g} s allows: leave"
        " spikes empty, or correct t90_s"
    ]


def _exchanged(record: Record, instrument: SnifferSpec) -> list[str]:
    """Return the problem of NO2 that exceeds NO by more than ozone makes of it, if it does.

    Of the NOx of exhaust 3 to 20 % are NO2.
    """
    if not {"no", "no2"} <= set(used_gases(record)):
        return []
    gains = {gas: instrument.known(gas).gain for gas in ("no", "no2")}
    no, no2 = (
        float(np.ptp(np.quantile(record.of(gas), (_LOW, _HIGH)))) / gain
        for gas, gain in gains.items()
    )
    # The squares of what noise and plume do add up.
    if no2**2 - (_SIGMAS * record.scatter["no2"] / gains["no2"]) ** 2 <= (no + OZONE_MOST) ** 2:
        return []
    return [
        f"NO2 varies by {no2:.0f} ppb in the plume and NO by {no:.0f} ppb: exhaust has more NO than NO2, and ozone makes at most"
        f" {OZONE_MOST:g} ppb of it; check which columns are SO2, NO and NO2, and their units"
    ]
