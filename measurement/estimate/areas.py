"""The published method: areas of SO2 and CO2 over a window around each pass."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from measurement.estimate.passes import Pass
from measurement.estimate.record import Record
from measurement.estimate.signals import shares_of
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array, parallel
from measurement.sniffer.spec import SnifferSpec

Span = tuple[float, float]
"""Beginning and end [s]."""

_LEAD = 1.0
"""Time from the beginning of a window to that of its pass [s]."""

_TAIL = 5.0
"""Time from the end of a pass to that of its window [slowest time constants]."""

_BASE = 15.0
"""Length of the background beside a window, outside of other windows [s]; at least one sample."""

_SHARE_LEAST = 0.05
"""Least share of an area that allows a conclusion."""

_SAME = 1e-6
"""Difference of times that count as equal [s]: seconds since 1970 are accurate to 2e-7."""


@dataclass(frozen=True, kw_only=True)
class Areas:
    """Areas of all passes together.

    Attributes
    ----------
    ratio : SO2 over CO2 [ppb/ppm]
    noise : standard deviation of the ratio by the noise [ppb/ppm]
    share : share of an area of SO2 that is left where passes overlap in its channel [-]
    separate : ratio of the areas of separate passes, computed from the share that is left of each
        gas [ppb/ppm]
    interval_s : between passes, median; NaN for one pass [s]
    gas : in the place of SO2, in words
    """

    ratio: float
    noise: float
    share: float
    separate: float
    interval_s: float
    gas: str

    def truncation_reason(self, t90_s: float) -> str:
        """Return why areas hold too little of the SO2, given its t90 [s].

        Either passes overlap, or a single pass is cut off at the end of the record.
        """
        share = f"{100.0 * self.share:.0f} %"
        if math.isnan(self.interval_s):
            return (
                f"the record ends before an {self.gas} channel with a t90 of {t90_s:g} s has read"
                f" the pass: about {share} of its area of {self.gas} is there; use the regression"
            )
        return (
            f"passes every {self.interval_s:.1f} s overlap in an {self.gas} channel with a t90 of"
            f" {t90_s:g} s: about {share} of an area of {self.gas} remains; use the regression"
        )


def area_ratio(record: Record, instrument: SnifferSpec, passes: Sequence[Pass]) -> Areas:
    """Return the ratio of the areas of SO2 and CO2, corrected for other gases.

    Areas are of the excess over the straight line between the means before and after a window.
    """
    gases = record.gases
    shares = shares_of(instrument, gases)
    weights = _area_weights(record, instrument, passes)
    areas = {gas: float(weights[gas] @ record.of(gas)) for gas in gases}
    co2 = sum(shares[gas][1] * areas[gas] for gas in gases)
    times = np.array([found.centre_s for found in passes])
    interval = float(np.median(np.diff(times))) if len(times) > 1 else math.nan
    if co2 <= 0.0:
        co2 = math.nan
    ratio = sum(shares[gas][0] * areas[gas] for gas in gases) / co2
    variance = sum(
        (shares[gas][0] - ratio * shares[gas][1]) ** 2
        * _variance(weights[gas], instrument.known(gas), record.step)
        for gas in gases
    )
    remaining = {}
    for gas in gases:
        puffs = _puffs(record, instrument, passes, gas)
        remaining[gas] = max(float(weights[gas] @ puffs) / co2, _SHARE_LEAST)
    separate = sum(shares[gas][0] * areas[gas] / remaining[gas] for gas in gases) / co2
    return Areas(
        ratio=ratio,
        noise=math.sqrt(variance) / co2,
        share=remaining["so2"],
        separate=separate,
        interval_s=interval,
        gas=instrument.name_of("so2"),
    )


def _variance(weights: Array, channel: Channel, step: float) -> float:
    """Return the variance of a weighted sum of readings by noise and drift of the zero."""
    # A step of the drift changes all readings after it.
    later = np.cumsum(weights[::-1])
    noise = channel.noise**2 * float(weights @ weights)
    return noise + channel.random_walk**2 * step * float(later @ later)


def _area_weights(
    record: Record, instrument: SnifferSpec, passes: Sequence[Pass]
) -> dict[str, Array]:
    """Return the weights of each gas's samples in the areas of all passes together.

    A window ends when the slowest channel has forgotten its pass, or when the next window begins.
    """
    tail = _TAIL * max(instrument.known(gas).constants[0] for gas in record.gases)
    windows: list[Span] = []
    for i, found in enumerate(passes):
        # After the end of the window before, this one begins ahead of its pass; otherwise it begins
        # at the trough.
        before = windows[-1][1] if windows else -math.inf
        onset = passes[i + 1].start_s if i + 1 < len(passes) else math.inf
        windows.append((max(found.start_s - _LEAD, before), min(found.end_s + tail, onset)))
    weights = {}
    for gas in record.gases:
        late = instrument.known(gas).delay_s - instrument.known("co2").delay_s
        weights[gas] = record.cached(
            ("areas", tuple(windows), late), partial(_sum_weights, record, windows, late)
        )
    return weights


def _sum_weights(record: Record, windows: Sequence[Span], late: float) -> Array:
    """Return the weights of samples in the sum of areas over windows that are ``late`` [s] later,
    shape (n,).
    """
    weights = np.zeros(len(record.time))
    for i, (start, end) in enumerate(windows):
        after_last = windows[i - 1][1] if i else -math.inf
        before_next = windows[i + 1][0] if i + 1 < len(windows) else math.inf
        free = after_last + late, before_next + late
        _add_window(weights, record, (start + late, end + late), free)
    return weights


def _add_window(weights: Array, record: Record, window: Span, free: Span) -> None:
    """Add the weights of an area over a window, less its background, to those of the samples.

    The background is the straight line between the means of the samples before and after it, within
    ``_BASE`` of the window and within ``free`` [s].
    """
    before = 0
    for time in record.times:
        first = int(np.searchsorted(time, window[0] - _SAME))
        last = int(np.searchsorted(time, window[1] + _SAME)) - 1
        if last > first + 1 and first < len(time):
            part = weights[before : before + len(time)]
            # Trapezoids: the ends count half. The area below the background's line follows from the
            # mean of its ends.
            part[first : last + 1] += record.step
            part[[first, last]] -= 0.5 * record.step
            earliest = int(np.searchsorted(time, max(free[0], window[0] - _BASE) - _SAME))
            latest = int(np.searchsorted(time, min(free[1], window[1] + _BASE) + _SAME)) - 1
            sides = slice(min(earliest, first), first + 1), slice(last, max(latest, last) + 1)
            for base in sides:
                part[base] -= 0.5 * record.step * (last - first) / len(part[base])
            return
        before += len(time)


def _puffs(record: Record, instrument: SnifferSpec, passes: Sequence[Pass], gas: str) -> Array:
    """Return the readings of a gas's channel for puffs of CO2 with the dose of each pass [ppm].

    Each sample is the mean over a step, so that the time of a puff between two samples does not
    matter.
    """
    channel, co2 = instrument.known(gas), instrument.known("co2")
    centres = np.array([found.centre_s for found in passes])
    arrivals = centres - sum(co2.constants) + channel.delay_s - co2.delay_s
    since = record.time[:, np.newaxis] - arrivals
    begin = np.maximum(since - 0.5 * record.step, 0.0)
    end = np.maximum(since + 0.5 * record.step, 0.0)
    doses = np.array([found.dose_ppm_s for found in passes])
    read = np.zeros(len(since))
    for weight, constant in parallel(channel.constants):
        decayed = (np.exp(-begin / constant) - np.exp(-end / constant)) @ doses
        read += weight / record.step * decayed
    return read
