"""Initial values of the response and delay of SO2 that are not stated, by a search on a grid."""

import math
from dataclasses import replace

import numpy as np

from measurement.errors import MeasurementError
from measurement.estimate.model import with_delay
from measurement.estimate.record import Record
from measurement.estimate.signals import Signals, make_signals, shifted, without
from measurement.sniffer.lag import Array
from measurement.sniffer.spec import SnifferSpec

DELAY_MOST = 30.0
"""Largest delay of SO2 after CO2 in the search [s]."""

T90_LEAST, T90_MOST = 0.5, 120.0
"""Range of t90 of SO2 in the search [s]."""

_DELAY_SEARCH = tuple(float(d) for d in np.arange(-5.0, DELAY_MOST + 1.0, 1.0))
_T90_SEARCH = tuple(float(t) for t in np.geomspace(T90_LEAST, T90_MOST, 14))
"""Grids of delay and t90 [s]."""


def so2_delay(instrument: SnifferSpec) -> float:
    """Return the delay of SO2 after CO2 [s]."""
    return instrument.known("so2").delay_s - instrument.known("co2").delay_s


def searched_timing(record: Record, instrument: SnifferSpec) -> SnifferSpec:
    """Return the instrument with the t90 and delay of SO2 that leave least of it unexplained.

    Only those are sought whose deviation is infinite.
    """
    so2 = instrument.known("so2")
    t90s = _T90_SEARCH if math.isinf(so2.t90_sd) else (so2.t90_s,)
    stated = so2_delay(instrument)
    delays = _DELAY_SEARCH if math.isinf(so2.delay_sd_s) else (stated,)
    if len(t90s) == len(delays) == 1:
        return instrument
    best, least = (so2.t90_s, stated), math.inf
    for t90_s in t90s:
        signals = make_signals(record, instrument.with_channel(replace(so2, t90_s=t90_s)))
        for delay, left in zip(delays, _unexplained(signals, delays, stated), strict=True):
            if left < least:
                best, least = (t90_s, delay), left
    found = instrument.with_channel(replace(so2, t90_s=best[0]))
    return with_delay(found, "so2", instrument.known("co2").delay_s + best[1])


def _unexplained(signals: Signals, delays: tuple[float, ...], stated: float) -> list[float]:
    """Return the energy of SO2 that CO2 does not explain, over its noise, at each delay [s]."""
    _, so2 = signals.excess
    energy, noise = float(so2 @ so2), _so2_noise(signals)
    left = []
    for delay in delays:
        moved = shifted(signals.co2, signals.record.step, delay - stated)
        co2: Array = without(signals.basis, signals.known * moved)
        # SO2 does not fall where CO2 rises: a negative share counts as 0.
        explained = max(0.0, float(co2 @ so2)) / max(float(np.linalg.norm(co2)), 1e-30)
        left.append((energy - explained**2) / noise)
    return left


def _so2_noise(signals: Signals) -> float:
    """Return the mean square of the noise of the SO2 signal, or 1 if it has none or is too short.

    A small t90 smooths SO2 most: without this scale it would have the smallest residuals.
    """
    energy = sum(
        in_so2**2 * signals.noise(gas) ** 2 * signals.noise_energy(gas)
        for gas, (in_so2, _) in signals.shares.items()
        if in_so2
    )
    return energy / signals.count if energy > 0.0 and signals.enough else 1.0


def check_timing_is_stated(instrument: SnifferSpec) -> None:
    """Check that t90 and delay of SO2 are stated.

    Raises
    ------
    MeasurementError : one is not
    """
    so2 = instrument.known("so2")
    if math.isinf(so2.t90_sd) or math.isinf(so2.delay_sd_s):
        raise MeasurementError(
            f"t90 and delay of '{instrument.name}' are not both given; give them, or use the"
            " regression"
        )
