"""Passes through the plume: peaks of CO2 above its background."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from measurement.estimate.record import Record
from measurement.gases import GASES
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array
from measurement.sniffer.spec import SnifferSpec

SNR_LEAST = 5.0
"""Signal to noise from which on a peak is a pass (Kattner et al., ACP 15:10087)."""

_STEPS_LEAST = 3.5
"""Steps of the CO2 readings that passes must be high, in the median: of lower ones too much is lost
in rounding.
"""

_SAMPLES_LEAST = 4
"""Sample periods that passes must last, in the median.

Simulated logs of 0.25 % in which they last longer read 0.25 to 0.28 % in the mean. Those in which
they do not read 0.12 to 0.33 %, and the interval does not say so.
"""

_WHOLE = 0.01
"""Of a sample period, by which a pass may be shorter than whole ones: times are rounded."""

_DITHERED = 4.0
"""Standard deviations of the noise within a step of other gases up to which rounding is noise: it
leaves a mean within a tenth of a step."""

_WINDOW = 60.0
"""Length of the pieces of which the background is the low quantile [s]."""

_QUANTILE, _QUANTILE_SIGMA = 0.05, 1.645
"""Share of the samples, less than those outside the plume, above which the background lies, and by
how many standard deviations of the noise: the normal distribution's quantile."""


@dataclass(frozen=True, kw_only=True)
class Pass:
    """A pass through the plume.

    Attributes
    ----------
    time_s, centre_s : of the CO2 reading's peak, and of the centre of its area [s]
    start_s, end_s : where the CO2 reading leaves its background and is back, or the trough to the
        neighbour [s]
    height_ppm, snr : of the reading's peak over its background, and over its noise [-]
    dose_ppm_s : area of the excess of CO2 in the air, with what the channel remembers at the end
        less that at the start [ppm s]
    """

    time_s: float
    centre_s: float
    start_s: float
    end_s: float
    height_ppm: float
    snr: float
    dose_ppm_s: float


def readings_noise(record: Record, instrument: SnifferSpec) -> dict[str, float]:
    """Return the standard deviation of each gas's readings: what is stated, with rounding to larger
    steps, or what they show.

    Rounding is noise, of a step over the root of 12, where noise or passes carry the readings
    through several steps.
    """
    noise = {}
    for gas in (gas for gas in GASES if gas in record.values[0]):
        stated, step = instrument.known(gas).noise, record.resolution[gas]
        if math.isnan(stated):
            stated = record.scatter[gas]
        elif 0.0 < stated < step and (gas == "co2" or step <= _DITHERED * stated):
            stated = math.hypot(stated, step / math.sqrt(12.0))
        noise[gas] = stated
    return noise


def read_coarsely(passes: Sequence[Pass], record: Record) -> list[str]:
    """Return why passes are read in too large steps of CO2, or too seldom, if they are."""
    height, step = (
        float(np.median([found.height_ppm for found in passes])),
        record.resolution["co2"],
    )
    if height < _STEPS_LEAST * step:
        return [
            f"CO2 reads in steps of {step:g} ppm, and a pass is {height:.0f} ppm high (median); it must be {_STEPS_LEAST:g} steps:"
            " log more decimals"
        ]
    length = float(np.median([found.end_s - found.start_s for found in passes]))
    if length < (_SAMPLES_LEAST - _WHOLE) * record.step:
        return [
            f"a pass lasts {length:.3g} s (median) in the readings of CO2, and there is one every {record.step:.3g} s; it must last"
            f" {_SAMPLES_LEAST} times as long: log readings more often"
        ]
    return []


def co2_background(time: Array, values: Array, noise: float) -> Array:
    """Return the background of CO2: its low quantile in pieces, with straight lines between them."""
    pieces = max(1, round((time[-1] - time[0]) / _WINDOW))
    edges = np.linspace(time[0], time[-1], pieces + 1)
    edges[-1] = math.inf
    middles, levels = [], []
    for low, high in itertools.pairwise(edges):
        inside = (time >= low) & (time < high)
        if inside.any():
            middles.append(float(time[inside].mean()))
            levels.append(float(np.quantile(values[inside], _QUANTILE)) + _QUANTILE_SIGMA * noise)
    return np.interp(time, middles, levels)


def co2_excesses(record: Record, noise: float) -> list[Array]:
    """Return the CO2 of each segment over its background."""

    def found() -> list[Array]:
        each = zip(record.times, record.values, strict=True)
        return [values["co2"] - co2_background(time, values["co2"], noise) for time, values in each]

    return record.once(("CO2 excess", noise), found)


def find_passes(record: Record, channel: Channel) -> tuple[Pass, ...]:
    """Return the passes of a record, given its CO2 channel."""
    from scipy.signal import find_peaks

    noise = channel.noise
    passes: list[Pass] = []
    for time, values, excess in zip(
        record.times, record.values, co2_excesses(record, noise), strict=True
    ):
        least = max(SNR_LEAST * noise, 1e-6 * float(np.abs(values["co2"]).max()))
        peaks, _ = find_peaks(
            np.concatenate([[-math.inf], excess, [-math.inf]]), height=least, prominence=least
        )
        passes += _bounded(time, excess, peaks - 1, channel)
    return tuple(passes)


def _bounded(
    time: Array, excess: Array, peaks: npt.NDArray[np.int64], channel: Channel
) -> list[Pass]:
    """Return the passes at these peaks, each between the troughs to its neighbours, where it is
    above the noise.
    """
    noise, memory = channel.noise, sum(channel.constants)
    inner = [int(a + np.argmin(excess[a : b + 1])) for a, b in itertools.pairwise(peaks)]
    passes = []
    for peak, low, high in zip(peaks, [0, *inner], [*inner, len(excess) - 1], strict=False):
        below = np.flatnonzero(excess <= noise)
        start = max(low, int(below[below < peak].max(initial=low)))
        end = min(high, int(below[below > peak].min(initial=high)))
        height, inside = float(excess[peak]), slice(start, end + 1)
        # The low quantile lies above the background where a plume is never far: then the troughs
        # tell it better.
        level = min(0.0, 0.5 * float(excess[start] + excess[end]))
        weights = np.maximum(excess[inside], 0.0)
        area = float(
            np.trapezoid(excess[inside] - level, time[inside])
            + memory * (excess[end] - excess[start])
        )
        passes.append(
            Pass(
                time_s=float(time[peak]),
                centre_s=float(weights @ time[inside] / weights.sum()),
                start_s=float(time[start]),
                end_s=float(time[end]),
                height_ppm=height,
                snr=height / noise if noise > 0.0 else math.inf,
                dose_ppm_s=area / channel.gain,
            )
        )
    return passes
