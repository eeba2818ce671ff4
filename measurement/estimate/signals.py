"""SO2 and CO2 of a record, corrected for other gases and brought to one response and one delay.

1. Response: each channel is filtered to the slowest poles of all, which amplifies no noise.
2. Delay: each is shifted to the delay of SO2.
3. Background: a slow level of each channel, and the transient at each segment's start, span a
   basis. Signals are made orthogonal to it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd

from measurement.estimate.record import Record
from measurement.gases import UNITS
from measurement.sniffer.lag import Array, lag
from measurement.sniffer.spec import SnifferSpec

Poles = tuple[float, ...]
"""Time constants [s], the largest first."""

Ends = tuple[int, int]
"""Samples at the beginning and at the end of each segment [-]."""

Weights = tuple[float, float, float, float]
"""Weights of the four samples of ``_AROUND`` [-]."""

_AROUND = (-1, 0, 1, 2)
"""Samples from which a shifted signal is interpolated, relative to the sample before the place."""

_ON_SAMPLE = 1e-9
"""Largest difference, in steps, between a delay and a whole number of steps that counts as that
number.
"""

_STRAIGHT_MAX = 300.0
"""Longest record whose background is one straight line [s]."""

_KNOT_INTERVAL = 120.0
"""Time between the knots of the background of a longer record, linear between them [s]."""

_INDEPENDENT = 1e-6
"""Least singular value of a column of the basis, relative to the largest."""

_MEMORY = 12.0
"""Time after which a filter has forgotten its input [time constants]."""

_FREE_LEAST = 3
"""Least number of known samples in excess of the background's parameters [-]."""

_OUTSIDE = 0.1
"""Share of the samples, those with the least CO2, that shows the level outside the plume."""


# Response and delay of one channel


def slowest(poles: Sequence[Poles]) -> Poles:
    """Return the poles of the common response: the largest time constant of each order."""
    count = max(len(p) for p in poles)
    return tuple(max(p[i] for p in poles if len(p) > i) for i in range(count))


def equalised(signal: Array, step: float, own: Poles, common: Poles) -> Array:
    """Return the signal that a channel with the common poles would have read.

    Each pole's filter is (1 + tau s)/(1 + T s), that is tau/T c + (1 - tau/T) lag_T(c), exact for a
    signal that is linear between samples. It is at rest at the first sample; the transient that
    this neglects is in the basis of the background.

    Parameters
    ----------
    signal : shape (n,) or (n, k), a step [s] apart
    own, common : poles; a missing one is 0
    """
    for i, target in enumerate(common):
        tau = own[i] if i < len(own) else 0.0
        if tau != target:
            signal = tau / target * signal + (1.0 - tau / target) * lag(signal, step, target)
    return signal


def equalised_from_rest(signal: Array, step: float, own: Poles, common: Poles) -> Array:
    """Return the equalised signal where it was 0 before its first sample."""
    padded = np.concatenate([np.zeros((1, *signal.shape[1:])), signal])
    return equalised(padded, step, own, common)[1:]


def shifted(signal: Array, step: float, delay: float) -> Array:
    """Return a smooth signal ``delay`` [s] later, by cubic interpolation.

    Beyond its ends it stays at its last value.

    Parameters
    ----------
    signal : shape (n, ...), a step [s] apart
    """
    whole, weights = _between_samples(step, delay)
    samples = np.arange(len(signal)) + whole
    moved = np.zeros(signal.shape)
    for offset, weight in zip(_AROUND, weights, strict=True):
        if weight:
            moved += weight * signal.take(samples + offset, axis=0, mode="clip")
    return moved


def _beyond_ends(step: float, delay: float) -> Ends:
    """Return the number of samples of a signal ``shifted`` by ``delay`` [s] that lie beyond its
    ends.
    """
    whole, weights = _between_samples(step, delay)
    used = [whole + offset for offset, weight in zip(_AROUND, weights, strict=True) if weight]
    return max(0, -min(used)), max(0, *used)


def _between_samples(step: float, delay: float) -> tuple[int, Weights]:
    """Return the sample before a time ``delay`` [s] earlier, and Lagrange's weights around it."""
    place = -delay / step
    whole = math.floor(place)
    share = place - whole
    if share < _ON_SAMPLE or share > 1.0 - _ON_SAMPLE:
        whole, share = round(place), 0.0
    return whole, (
        -share * (share - 1.0) * (share - 2.0) / 6.0,
        (share + 1.0) * (share - 1.0) * (share - 2.0) / 2.0,
        -(share + 1.0) * share * (share - 2.0) / 2.0,
        (share + 1.0) * share * (share - 1.0) / 6.0,
    )


# Background


def background_basis(record: Record, common: Poles, known: Array) -> Array:
    """Return an orthonormal basis of the background, shape (n, k), 0 at samples not ``known``."""
    time = record.time
    pieces = 1 if record.duration <= _STRAIGHT_MAX else math.ceil(record.duration / _KNOT_INTERVAL)
    place = (time - time[0]) / max(record.duration, 1e-9) * pieces
    columns = [np.maximum(0.0, 1.0 - np.abs(place - knot)) for knot in range(pieces + 1)]
    start = 0
    for segment in record.times:
        for values in transients(segment, common):
            transient = np.zeros(len(time))
            transient[start : start + len(segment)] = values
            columns.append(transient)
        start += len(segment)
    # A knot in a gap may have no samples.
    columns = [column for column in (known * column for column in columns) if column.any()]
    if not columns:
        return np.zeros((len(time), 0))
    unit = np.stack([column / np.linalg.norm(column) for column in columns], axis=1)
    basis, sizes, _ = np.linalg.svd(unit, full_matrices=False)
    return np.asarray(basis[:, sizes > _INDEPENDENT * sizes[0]])


def transients(time: Array, common: Poles) -> list[Array]:
    """Return the transient of an unknown initial state in a signal, for each pole, shape (n,) each.

    Parameters
    ----------
    time : of one segment [s]
    """
    return [np.exp(-(time - time[0]) / constant) for constant in common]


def without(basis: Array, signal: Array) -> Array:
    """Return the part of a signal that the background does not explain, in the signal's shape."""
    return np.asarray(signal - basis @ (basis.T @ signal))


# Signals of the regression


@dataclass(frozen=True, kw_only=True)
class Signals:
    """Signals of the regression ``so2 = slope co2 + background + noise``.

    Attributes
    ----------
    record, instrument : sources of the signals
    co2, so2 : at the common response and delay, with their backgrounds, shape (n,) [ppm], [ppb]
    ends : samples for which at least one channel of another delay has no readings
    known : 0 at these and 1 at all others, shape (n,)
    basis : orthonormal, of the backgrounds, shape (n, k)
    common : poles of the common response
    shares : of each gas's reading in ``so2`` and in ``co2``
    """

    record: Record
    instrument: SnifferSpec
    co2: Array
    so2: Array
    ends: Ends
    known: Array
    basis: Array
    common: Poles
    shares: dict[str, tuple[float, float]]

    def noise(self, gas: str) -> float:
        """Return the standard deviation of a gas's readings."""
        return self.instrument.known(gas).noise

    def readings(self, gas: str) -> Array:
        """Return the readings of a gas at the common response and delay, shape (n,)."""
        return _aligned(self.record, gas, self._poles(gas), self.common, self.delay_to_so2(gas))

    def delay_to_so2(self, gas: str) -> float:
        """Return the delay of SO2 less that of a gas [s]."""
        return self.instrument.known("so2").delay_s - self.instrument.known(gas).delay_s

    @cached_property
    def excess(self) -> tuple[Array, Array]:
        """CO2 and SO2 without the background, 0 where they are unknown, shape (n,) each."""
        co2 = without(self.basis, self.known * self.co2)
        so2 = without(self.basis, self.known * self.so2)
        return co2, so2

    @cached_property
    def count(self) -> int:
        """Number of known samples [-], at least 1."""
        return max(1, int(self.known.sum()))

    @property
    def enough(self) -> bool:
        """Whether the background leaves some of the known samples unexplained."""
        return bool(self.count >= self.basis.shape[1] + _FREE_LEAST)

    def backwards(self, gas: str, weights: Array) -> Array:
        """Return the weights of a gas's readings in a weighted sum of its equalised samples.

        The filter starts from rest; for weights orthogonal to the background this makes no
        difference.

        Parameters
        ----------
        weights : of the equalised samples, shape (n,) or (n, k)
        """
        ends = np.cumsum([len(segment) for segment in self.record.times])[:-1]
        step, own = self.record.step, self._poles(gas)
        parts = [
            equalised_from_rest(part[::-1], step, own, self.common)[::-1]
            for part in np.split(weights, ends)
        ]
        return np.ascontiguousarray(np.concatenate(parts))

    def noise_energy(self, gas: str) -> float:
        """Return the expected sum of squares of a gas's equalised noise, without the background's
        part.

        It is for noise of standard deviation 1.
        """
        key = "noise energy", self._poles(gas), self.common, self._shift_weights(gas), self.ends
        return self.record.cached(key, lambda: self._noise_energy(gas))

    def _noise_energy(self, gas: str) -> float:
        energy = 0.0
        for segment in self.record.times:
            squares = self.impulse(gas, len(segment)) ** 2
            # Each reading contributes to all samples after it.
            first, end = self.ends[0], len(segment) - self.ends[1]
            samples = np.maximum(0, end - np.maximum(first, np.arange(len(squares))))
            energy += float(np.sum(squares * samples))
        key = "background energy", self._poles(gas), self.common, self.ends
        return energy - self.record.cached(
            key, lambda: float(np.sum(self.backwards(gas, self.basis) ** 2))
        )

    def impulse(self, gas: str, longest: int | None = None) -> Array:
        """Return the impulse response: the samples after a reading of 1, shape (length,)."""
        longest = len(self.so2) if longest is None else longest
        length = min(longest, int(_MEMORY * sum(self.common) / self.record.step) + 2)
        one = np.zeros(length)
        one[0] = 1.0
        response = equalised_from_rest(one, self.record.step, self._poles(gas), self.common)
        weights = self._shift_weights(gas)
        return response if weights[1] == 1.0 else np.convolve(response, weights)[:longest]

    def _poles(self, gas: str) -> Poles:
        return self.instrument.known(gas).constants

    def _shift_weights(self, gas: str) -> Weights:
        return _between_samples(self.record.step, self.delay_to_so2(gas))[1]


def shares_of(instrument: SnifferSpec, gases: tuple[str, ...]) -> dict[str, tuple[float, float]]:
    """Return the share of each gas's reading in SO2 and in CO2.

    They are the inverse of gains and cross-sensitivities.
    """
    channels = [instrument.known(gas) for gas in gases]
    response = np.zeros((len(gases), len(gases)))
    for i, channel in enumerate(channels):
        for j, other in enumerate(gases):
            share = 1.0 if channel.gas == other else channel.cross.get(other, 0.0)
            response[i, j] = channel.gain * share
    inverse = np.linalg.inv(response)
    so2, co2 = inverse[gases.index("so2")], inverse[gases.index("co2")]
    return {gas: (float(so2[i]), float(co2[i])) for i, gas in enumerate(gases)}


def common_poles(
    instrument: SnifferSpec, gases: tuple[str, ...], shares: dict[str, tuple[float, float]]
) -> Poles:
    """Return the poles of the common response.

    They are the slowest of SO2 and CO2. A slower channel that corrects these gases is included
    where its noise, at their response, would be larger than that of SO2.
    """
    so2, co2 = instrument.known("so2"), instrument.known("co2")
    poles = slowest([so2.constants, co2.constants])
    slow = []
    for gas in gases:
        channel = instrument.known(gas)
        noise = abs(shares[gas][0]) * channel.noise * channel.constants[0] / poles[0]
        if gas not in ("so2", "co2") and noise > so2.noise:
            slow.append(channel.constants)
    return slowest([poles, *slow])


def make_signals(record: Record, instrument: SnifferSpec, ends: Ends = (0, 0)) -> Signals:
    """Return the signals of a record for the response, delays, gains and cross-sensitivities given.

    Samples at the ends of segments count as unknown where a relevant channel has no reading for
    them; the first and the last ``ends`` samples of each segment always do.
    """
    shares = shares_of(instrument, record.gases)
    common = common_poles(instrument, record.gases, shares)
    so2, co2 = np.zeros(len(record.time)), np.zeros(len(record.time))
    reference = instrument.known("so2").delay_s
    unknown = [ends]
    for gas in record.gases:
        channel = instrument.known(gas)
        delay = reference - channel.delay_s
        signal = _aligned(record, gas, channel.constants, common, delay)
        so2 += shares[gas][0] * signal
        co2 += shares[gas][1] * signal
        if any(shares[gas]):
            unknown.append(_beyond_ends(record.step, delay))
    ends = max(begin for begin, _ in unknown), max(end for _, end in unknown)
    known = record.cached(("known", ends), lambda: _known(record, ends))
    basis = record.cached(("basis", common, ends), lambda: background_basis(record, common, known))
    return Signals(
        record=record,
        instrument=instrument,
        co2=co2,
        so2=so2,
        ends=ends,
        known=known,
        basis=basis,
        common=common,
        shares=shares,
    )


def _known(record: Record, ends: Ends) -> Array:
    """Return 1 for each sample of the record, and 0 at the ends of its segments, shape (n,)."""
    parts = [np.zeros(len(time)) for time in record.times]
    for part in parts:
        part[ends[0] : max(0, len(part) - ends[1])] = 1.0
    return np.concatenate(parts)


def _aligned(record: Record, gas: str, own: Poles, common: Poles, delay: float) -> Array:
    """Return the readings of a gas with the common poles, ``delay`` [s] later."""

    def filtered() -> list[Array]:
        return [equalised(segment[gas], record.step, own, common) for segment in record.values]

    def aligned() -> Array:
        parts = record.cached(("filtered", gas, own, common), filtered)
        return np.concatenate([shifted(part, record.step, delay) for part in parts])

    return record.cached(("aligned", gas, own, common, delay), aligned)


def signals_table(signals: Signals, slope: float) -> tuple[pd.DataFrame, float]:
    """Return readings, excesses, fit and residual by sample, and the signal to noise of SO2."""
    record = signals.record
    co2, so2 = signals.excess
    known = signals.known > 0.0
    # Without the background both have a mean of 0. They are shown relative to the level of CO2
    # outside the plume.
    level = float(np.quantile(co2[known], _OUTSIDE)) if known.any() else 0.0
    fit = slope * co2
    residual = so2 - fit
    signal = float(np.std(fit[known])) if known.any() else 0.0
    rest = float(np.std(residual[known])) if known.any() else 0.0
    columns = {"time_s": record.time}
    for gas in record.gases:
        columns[f"{gas}_{UNITS[gas]}"] = record.of(gas)
    excesses = {
        "co2_excess_ppm": co2 - level,
        "so2_excess_ppb": so2 - slope * level,
        "fit_ppb": fit - slope * level,
        "residual_ppb": residual,
    }
    columns |= {name: np.where(known, values, math.nan) for name, values in excesses.items()}
    return pd.DataFrame(columns), signal / rest if rest > 0.0 else math.inf
