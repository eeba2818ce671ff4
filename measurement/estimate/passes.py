"""Passes through the plume: peaks of CO2 above its background."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from measurement.estimate.record import Record
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array

SNR_LEAST = 5.0
"""Least signal to noise of a pass (Kattner et al., ACP 15:10087)."""

_STEPS_LEAST = 3.5
"""Least median height of passes [steps of the CO2 readings]."""

_SAMPLES_LEAST = 4
"""Least median length of passes [sample periods].

Simulated logs of 0.25 % give a mean of 0.25 to 0.28 % where passes last longer, and of 0.12 to 0.33
% where they do not.
"""

_TIME_ROUNDING = 0.01
"""Amount by which a pass may be shorter than whole sample periods [-], because times are
rounded.
"""

_WINDOW = 60.0
"""Length of the pieces whose low quantile is the background [s]."""

_QUANTILE, _QUANTILE_SIGMA = 0.05, 1.645
"""Low quantile of the readings, and height of the background above it [standard deviations]."""


@dataclass(frozen=True, kw_only=True)
class Pass:
    """A pass through the plume.

    Attributes
    ----------
    time_s, centre_s : of the peak of the CO2 reading, and of the centre of its area [s]
    start_s, end_s : times at which the CO2 reading leaves its background and returns to it, or of
        the trough to the neighbouring pass [s]
    height_ppm, snr : of the peak over the background [ppm], and over the noise [-]
    dose_ppm_s : area of the excess of CO2 in the air, corrected for the channel's memory at start
        and end [ppm s]
    """

    time_s: float
    centre_s: float
    start_s: float
    end_s: float
    height_ppm: float
    snr: float
    dose_ppm_s: float


def co2_excesses(record: Record, noise: float) -> list[Array]:
    """Return the CO2 of each segment over its background [ppm]."""

    def compute() -> list[Array]:
        return [
            values["co2"] - _background(time, values["co2"], noise)
            for time, values in zip(record.times, record.values, strict=True)
        ]

    return record.cached(("CO2 excess", noise), compute)


def _background(time: Array, values: Array, noise: float) -> Array:
    """Return the background of CO2: its low quantile in each piece, joined by straight lines."""
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


def find_passes(record: Record, channel: Channel) -> tuple[Pass, ...]:
    """Return the passes of a record, given its CO2 channel."""
    from scipy.signal import find_peaks

    noise = channel.noise
    excesses = co2_excesses(record, noise)
    passes: list[Pass] = []
    for time, values, excess in zip(record.times, record.values, excesses, strict=True):
        least = max(SNR_LEAST * noise, 1e-6 * float(np.abs(values["co2"]).max()))
        # Padded, so that a peak at either end counts.
        padded = np.concatenate([[-math.inf], excess, [-math.inf]])
        peaks, _ = find_peaks(padded, height=least, prominence=least)
        passes += _passes_at(peaks - 1, time, excess, channel)
    return tuple(passes)


def _passes_at(
    peaks: npt.NDArray[np.int64], time: Array, excess: Array, channel: Channel
) -> list[Pass]:
    """Return the passes at peaks: each lasts while the excess is above noise, at most from trough
    to trough.
    """
    noise, memory = channel.noise, sum(channel.constants)
    troughs = [int(a + np.argmin(excess[a : b + 1])) for a, b in itertools.pairwise(peaks)]
    below = np.flatnonzero(excess <= noise)
    passes = []
    for peak, low, high in zip(peaks, [0, *troughs], [*troughs, len(excess) - 1], strict=False):
        start = max(low, int(below[below < peak].max(initial=low)))
        end = min(high, int(below[below > peak].min(initial=high)))
        height, inside = float(excess[peak]), slice(start, end + 1)
        # Where a plume is always near, the low quantile is above the background, and the troughs
        # are a better level.
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


def coarseness_problem(passes: Sequence[Pass], record: Record) -> tuple[str, ...]:
    """Return the problem of CO2 that is read in too large steps, or too rarely, for these
    passes.
    """
    height = float(np.median([found.height_ppm for found in passes]))
    step = record.resolution["co2"]
    if height < _STEPS_LEAST * step:
        return (
            f"CO2 reads in steps of {step:g} ppm, and a pass is {height:.0f} ppm high (median);"
            f" it must be {_STEPS_LEAST:g} steps: log more decimals",
        )
    length = float(np.median([found.end_s - found.start_s for found in passes]))
    if length < (_SAMPLES_LEAST - _TIME_ROUNDING) * record.step:
        return (
            f"a pass lasts {length:.3g} s (median) in the readings of CO2, and there is one every"
            f" {record.step:.3g} s; it must last {_SAMPLES_LEAST} times as long:"
            " log readings more often",
        )
    return ()
