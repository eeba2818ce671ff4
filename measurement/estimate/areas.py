"""The published method: areas of SO2 and CO2 over a window about each pass."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from measurement.estimate.fit.signals import shares_of, used_gases
from measurement.estimate.passes import Pass
from measurement.estimate.record import Record
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array, parallel
from measurement.sniffer.spec import SnifferSpec

_LEAD = 1.0
"""The window begins so long before the pass [s]."""

_TAIL = 5.0
"""It ends so many of the slowest time constants after the pass."""

_BASE = 15.0
"""Length of the background on either side of the window, where no other pass is; one sample where
there is no room [s].
"""

_SHARE_LEAST = 0.05
"""Share that remains of an area under which nothing follows from the rest."""

_SAME = 1e-6
"""Times that differ by less are the same [s]: seconds since 1970 are known to 2e-7."""


@dataclass(frozen=True, kw_only=True)
class Areas:
    """Areas of all passes together.

    Attributes
    ----------
    ratio : SO2 over CO2 [ppb/ppm]
    noise : its standard deviation by the noise [ppb/ppm]
    share : of an area of SO2 that remains, as passes overlap in its channel [-]
    separate : the ratio that areas of separate passes would read, by the share that remains of each
        gas [ppb/ppm]
    interval_s : between passes, median [s]; not a number for one pass
    """

    ratio: float
    noise: float
    share: float
    separate: float
    interval_s: float

    def unread(self, t90_s: float) -> str:
        """Return why areas hold too little of the SO2: passes overlap; a single one is cut off
        where the record or a part ends.

        Parameters
        ----------
        t90_s : of SO2 [s]
        """
        share = f"{100.0 * self.share:.0f} %"
        if math.isnan(self.interval_s):
            return (
                f"the record ends before an SO2 channel with a t90 of {t90_s:g} s has read the pass: about {share} of its area"
                " of SO2 is there; use the regression"
            )
        return (
            f"passes every {self.interval_s:.1f} s overlap in an SO2 channel with a t90 of {t90_s:g} s: about {share} of an area"
            " of SO2 remains; use the regression"
        )


def area_ratio(record: Record, instrument: SnifferSpec, passes: Sequence[Pass]) -> Areas:
    """Return the ratio of the areas of SO2, corrected for the gases that its cell responds to, and
    of CO2.

    Areas are of the excess over the straight line between the means before and after a window.
    """
    gases = used_gases(record)
    counted, weights = shares_of(instrument, gases), _windows(record, instrument, passes)
    areas = {gas: float(weights[gas] @ record.of(gas)) for gas in gases}
    co2 = sum(counted[gas][1] * areas[gas] for gas in gases)
    times = np.array([found.centre_s for found in passes])
    interval = float(np.median(np.diff(times))) if len(times) > 1 else math.nan
    if co2 <= 0.0:
        return Areas(
            ratio=math.nan, noise=math.nan, share=math.nan, separate=math.nan, interval_s=interval
        )
    ratio = sum(counted[gas][0] * areas[gas] for gas in gases) / co2
    variance = sum(
        (counted[gas][0] - ratio * counted[gas][1]) ** 2
        * _variance(weights[gas], instrument.known(gas), record.step)
        for gas in gases
    )
    remains = {
        gas: max(float(weights[gas] @ _puffs(record, instrument, passes, gas)) / co2, _SHARE_LEAST)
        for gas in gases
    }
    separate = sum(counted[gas][0] * areas[gas] / remains[gas] for gas in gases) / co2
    return Areas(
        ratio=ratio,
        noise=math.sqrt(variance) / co2,
        share=remains["so2"],
        separate=separate,
        interval_s=interval,
    )


def _variance(weights: Array, channel: Channel, step: float) -> float:
    """Return the variance of a weighted sum of readings, by noise and by the drift of their zero."""
    # A step of the drift is in all readings that follow it.
    later = np.cumsum(weights[::-1])
    return channel.noise**2 * float(weights @ weights) + channel.random_walk**2 * step * float(
        later @ later
    )


def _windows(record: Record, instrument: SnifferSpec, passes: Sequence[Pass]) -> dict[str, Array]:
    """Return the weights of each gas's samples in the areas of all passes together.

    A window begins before its pass, and ends when the slowest channel has forgotten it or the next
    one begins. Each gas has its own delay.
    """
    gases = used_gases(record)
    tail = _TAIL * max(instrument.known(gas).constants[0] for gas in gases)
    onsets = [*(found.start_s for found in passes[1:]), math.inf]
    ends = [min(found.end_s + tail, onset) for found, onset in zip(passes, onsets, strict=True)]
    # Where the one before is over, the window leads its pass; where not, it begins at the trough.
    starts = [
        max(found.start_s - _LEAD, before)
        for found, before in zip(passes, [-math.inf, *ends[:-1]], strict=True)
    ]
    windows, weights = tuple(zip(starts, ends, strict=True)), {}
    for gas in gases:
        late = instrument.known(gas).delay_s - instrument.known("co2").delay_s
        weights[gas] = record.once(
            ("areas", windows, late), partial(_all_windows, record, windows, late)
        )
    return weights


def _all_windows(record: Record, windows: Sequence[tuple[float, float]], late: float) -> Array:
    """Return the weights of samples in the areas over windows that are ``late`` [s]."""
    weights = np.zeros(len(record.time))
    for i, (start, end) in enumerate(windows):
        free = (
            (windows[i - 1][1] if i else -math.inf),
            (windows[i + 1][0] if i + 1 < len(windows) else math.inf),
        )
        _add_window(weights, record, (start + late, end + late), (free[0] + late, free[1] + late))
    return weights


def _puffs(record: Record, instrument: SnifferSpec, passes: Sequence[Pass], gas: str) -> Array:
    """Return what a gas's channel reads of puffs with the dose of each pass, if it read CO2: sums
    of exponentials [ppm].

    Each sample is the mean from half a step before it to half a step after it. At single moments,
    an area would depend on where between two samples a puff arrives.
    """
    channel, co2 = instrument.known(gas), instrument.known("co2")
    arrivals = (
        np.array([found.centre_s for found in passes])
        - sum(co2.constants)
        + channel.delay_s
        - co2.delay_s
    )
    since = record.time[:, np.newaxis] - arrivals
    begin, end = (np.maximum(since + half, 0.0) for half in (-0.5 * record.step, 0.5 * record.step))
    doses = np.array([found.dose_ppm_s for found in passes])
    read = np.zeros(len(since))
    for weight, constant in parallel(channel.constants):
        read += (
            weight / record.step * ((np.exp(-begin / constant) - np.exp(-end / constant)) @ doses)
        )
    return read


def _add_window(
    weights: Array, record: Record, window: tuple[float, float], free: tuple[float, float]
) -> None:
    """Add to the samples' weights those of an area over a window and its background [s].

    The background is the straight line between the means of the samples before and after the
    window: of those within ``_BASE``, as far as they belong to no other pass.
    """
    before = 0
    for time in record.times:
        first = int(np.searchsorted(time, window[0] - _SAME))
        last = int(np.searchsorted(time, window[1] + _SAME)) - 1
        if last > first + 1 and first < len(time):
            part = weights[before : before + len(time)]
            # Trapezoids: the ends count half. The background's line has the area of its ends' mean.
            part[first : last + 1] += record.step
            part[[first, last]] -= 0.5 * record.step
            earliest = int(np.searchsorted(time, max(free[0], window[0] - _BASE) - _SAME))
            latest = int(np.searchsorted(time, min(free[1], window[1] + _BASE) + _SAME)) - 1
            sides = slice(min(earliest, first), first + 1), slice(last, max(latest, last) + 1)
            for base in sides:
                part[base] -= 0.5 * record.step * (last - first) / len(part[base])
            return
        before += len(time)
