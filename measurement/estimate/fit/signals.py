"""SO2 and CO2 of a record, corrected for other gases and brought to one response and one delay."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd

from measurement.estimate.fit.background import background_basis, without
from measurement.estimate.fit.response import (
    Poles,
    adjoint,
    between_samples,
    equalised,
    impulse,
    shifted,
    slowest,
    unread,
)
from measurement.estimate.record import Record
from measurement.gases import GASES, UNITS
from measurement.sniffer.lag import Array
from measurement.sniffer.spec import SnifferSpec

_MEMORY = 12.0
"""Time constants after which a filter has forgotten."""

_FREE_LEAST = 3
"""Known samples beside those that the background takes up, at least [-]."""

_OUTSIDE = 0.1
"""Share of the samples with the least CO2, by which the level outside the plume is shown."""


Ends = tuple[int, int]
"""Samples at the beginning and at the end of each segment [-]."""


@dataclass(frozen=True, kw_only=True)
class Signals:
    """What is regressed: ``so2 = slope co2 + background + noise``.

    Attributes
    ----------
    record, instrument : what they are made of
    co2, so2 : at the common response and delay, with their backgrounds, shape (n,) [ppm], [ppb]
    ends : what at least one channel of another delay has no readings for
    known : 0 of these and 1 of all others, shape (n,): these alone count
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

    def poles(self, gas: str) -> Poles:
        """Return the poles of a gas's channel."""
        return self.instrument.known(gas).constants

    def noise(self, gas: str) -> float:
        """Return the standard deviation of a gas's readings."""
        return self.instrument.known(gas).noise

    def excess(self) -> tuple[Array, Array]:
        """Return CO2 and SO2 without what the background explains, and 0 where they are not known."""
        return self._excess

    @cached_property
    def _excess(self) -> tuple[Array, Array]:
        return without(self.basis, self.known * self.co2), without(
            self.basis, self.known * self.so2
        )

    @cached_property
    def count(self) -> int:
        """Samples that are known [-]; 1 at least."""
        return max(1, int(self.known.sum()))

    @property
    def enough(self) -> bool:
        """Whether more samples are known than the background takes up: of as many all is explained,
        and only rounding is left.
        """
        return bool(self.count >= self.basis.shape[1] + _FREE_LEAST)

    def backwards(self, gas: str, weights: Array) -> Array:
        """Return the weights of a gas's readings in a weighted sum of its equalised samples, shape
        (n,) or (n, k).
        """
        ends = np.cumsum([len(segment) for segment in self.record.times])[:-1]
        parts = np.split(weights, ends)
        return np.concatenate(
            [adjoint(part, self.record.step, self.poles(gas), self.common) for part in parts]
        )

    def noise_energy(self, gas: str) -> float:
        """Return the expected sum of squares, beside the background, of a gas's equalised noise of
        standard deviation 1.
        """
        key = "noise energy", self.poles(gas), self.common, self._weights(gas), self.ends
        return self.record.once(key, lambda: self._noise_energy(gas))

    def _noise_energy(self, gas: str) -> float:
        energy = 0.0
        for segment in self.record.times:
            squares = self._impulse(gas, len(segment)) ** 2
            # Each reading is in all samples after it.
            first, end = self.ends[0], len(segment) - self.ends[1]
            energy += float(
                np.sum(squares * np.maximum(0, end - np.maximum(first, np.arange(len(squares)))))
            )
        key = "background energy", self.poles(gas), self.common, self.ends
        return energy - self.record.once(
            key, lambda: float(np.sum(self.backwards(gas, self.basis) ** 2))
        )

    def noise_correlation(self, gas: str) -> float:
        """Return the sum over all lags of the squared autocovariance of a gas's equalised noise of
        standard deviation 1.
        """
        response = self._impulse(gas, len(self.so2))
        return float(np.sum(np.correlate(response, response, mode="full") ** 2))

    def _impulse(self, gas: str, longest: int) -> Array:
        length = min(longest, int(_MEMORY * sum(self.common) / self.record.step) + 2)
        response = impulse(length, self.record.step, self.poles(gas), self.common)
        weights = self._weights(gas)
        return response if weights[1] == 1.0 else np.convolve(response, weights)[:longest]

    def late(self, gas: str) -> float:
        """Return by how much later a gas's readings have to be to come as late as those of SO2 [s]."""
        return self.instrument.known("so2").delay_s - self.instrument.known(gas).delay_s

    def _weights(self, gas: str) -> tuple[float, float, float, float]:
        return between_samples(self.record.step, self.late(gas))[1]


def used_gases(record: Record) -> tuple[str, ...]:
    """Return the gases of a record, in the order of ``GASES``."""
    return tuple(gas for gas in GASES if gas in record.values[0])


def shares_of(instrument: SnifferSpec, gases: tuple[str, ...]) -> dict[str, tuple[float, float]]:
    """Return what each gas's reading has to count for in SO2 and in CO2: the inverse of gains and
    cross-sensitivities.
    """
    channels = [instrument.known(gas) for gas in gases]
    response = np.array(
        [
            [c.gain * (1.0 if c.gas == other else c.cross.get(other, 0.0)) for other in gases]
            for c in channels
        ]
    )
    inverse = np.linalg.inv(response)
    so2, co2 = inverse[gases.index("so2")], inverse[gases.index("co2")]
    return {gas: (float(so2[i]), float(co2[i])) for i, gas in enumerate(gases)}


def common_poles(
    instrument: SnifferSpec, gases: tuple[str, ...], shares: dict[str, tuple[float, float]]
) -> Poles:
    """Return the poles of the common response.

    They are the slowest of SO2 and CO2; a slower channel that corrects them joins in where bringing
    it to their response would make its noise larger than that of SO2.
    """
    main = [instrument.known(gas) for gas in ("so2", "co2")]
    poles = slowest([channel.constants for channel in main])
    slow = [
        channel.constants
        for channel in (instrument.known(gas) for gas in gases if gas not in ("so2", "co2"))
        if abs(shares[channel.gas][0]) * channel.noise * channel.constants[0] / poles[0]
        > main[0].noise
    ]
    return slowest([poles, *slow])


def make_signals(record: Record, instrument: SnifferSpec, ends: Ends = (0, 0)) -> Signals:
    """Return the signals of a record, given the instrument's response, delays, gains and
    cross-sensitivities.

    Samples at the ends of segments count as not known where a channel that counts has no reading
    for them, and the first and the last ``ends`` of each in any case.
    """
    gases = used_gases(record)
    shares = shares_of(instrument, gases)
    common = common_poles(instrument, gases, shares)
    so2, co2 = np.zeros(len(record.time)), np.zeros(len(record.time))
    reference = instrument.known("so2").delay_s
    for gas in gases:
        channel = instrument.known(gas)
        signal = _brought(record, gas, channel.constants, common, reference - channel.delay_s)
        so2 += shares[gas][0] * signal
        co2 += shares[gas][1] * signal
    unknown = [
        ends,
        *(
            unread(record.step, reference - instrument.known(gas).delay_s)
            for gas in gases
            if any(shares[gas])
        ),
    ]
    ends = max(begin for begin, _ in unknown), max(end for _, end in unknown)
    known = record.once(("known", ends), lambda: _known(record, ends))
    basis = record.once(("basis", common, ends), lambda: background_basis(record, common, known))
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


def _brought(record: Record, gas: str, own: Poles, common: Poles, late: float) -> Array:
    """Return the readings of a gas with the common poles, ``late`` [s] later."""

    def slowed() -> list[Array]:
        return [equalised(segment[gas], record.step, own, common) for segment in record.values]

    def brought() -> Array:
        parts = record.once(("slowed", gas, own, common), slowed)
        return np.concatenate([shifted(part, record.step, late) for part in parts])

    return record.once(("brought", gas, own, common, late), brought)


def samples_of(signals: Signals, slope: float) -> tuple[pd.DataFrame, float]:
    """Return readings, equalised excesses, fit and residual by sample, and the signal to noise of
    SO2.
    """
    record = signals.record
    (co2, so2), known = signals.excess(), signals.known > 0.0
    # Beside the background both have a mean of 0; they are shown from the level that CO2 has
    # outside the plume.
    level = float(np.quantile(co2[known], _OUTSIDE)) if known.any() else 0.0
    fit = slope * co2
    signal, rest = (
        float(np.std(values[known])) if known.any() else 0.0 for values in (fit, so2 - fit)
    )
    columns = {"time_s": record.time}
    columns |= {f"{gas}_{UNITS[gas]}": record.of(gas) for gas in used_gases(record)}
    excesses = {
        "co2_excess_ppm": co2 - level,
        "so2_excess_ppb": so2 - slope * level,
        "fit_ppb": fit - slope * level,
        "residual_ppb": so2 - fit,
    }
    columns |= {name: np.where(known, values, math.nan) for name, values in excesses.items()}
    return pd.DataFrame(columns), signal / rest if rest > 0.0 else math.inf
