"""The slope of SO2 over CO2, for noise in both, and its standard deviation."""

import math
from dataclasses import dataclass

import numpy as np

from measurement.estimate.fit.signals import Signals
from measurement.sniffer.lag import Array


@dataclass(frozen=True, kw_only=True)
class Slope:
    """A slope.

    Attributes
    ----------
    slope : SO2 over CO2 [ppb/ppm]
    noise : its standard deviation by the noise [ppb/ppm]
    misfit : mean square of the residuals over that of the stated noise [-]
    residual_energy : sum of squares of the residuals [ppb^2]
    """

    slope: float
    noise: float
    misfit: float
    residual_energy: float


def fitted(signals: Signals) -> tuple[float, Array]:
    """Return the slope and the residuals.

    The slope is corrected for the noise of CO2, which would attenuate it; it is not a number where
    CO2 is noise alone, or too few samples are known.
    """
    co2, so2 = signals.excess()
    energy = float(co2 @ co2) - _noise_energy(signals, 0.0, 1.0)
    slope = float(co2 @ so2) / energy if energy > 0.0 and signals.enough else math.nan
    return slope, so2 - slope * co2


def regress(signals: Signals) -> Slope:
    """Return the slope with its noise.

    The noise that the instrument's figures predict is widened by the root of the misfit where the
    residuals are larger than that.
    """
    slope, residual = fitted(signals)
    co2, _ = signals.excess()
    residual_energy = float(residual @ residual)
    energy = float(co2 @ co2) - _noise_energy(signals, 0.0, 1.0)
    if not math.isfinite(slope):
        misfit = variance = math.nan
    else:
        expected = _noise_energy(signals, 1.0, -slope)
        misfit = residual_energy / expected if expected > 0.0 else 1.0
        variance = float(noise_covariance(signals, (co2 / energy)[:, np.newaxis], slope)[0, 0])
        variance += slope**2 * _correlated(signals) / energy**2
    return Slope(
        slope=slope,
        noise=math.sqrt(variance * max(1.0, misfit)),
        misfit=misfit,
        residual_energy=residual_energy,
    )


def noise_covariance(signals: Signals, weights: Array, slope: float) -> Array:
    """Return the covariance of weighted sums of ``so2 - slope co2`` by noise and drift, for weights
    of shape (n, k).
    """
    covariance = np.zeros((weights.shape[1],) * 2)
    for gas, (in_so2, in_co2) in signals.shares.items():
        channel = signals.instrument.channel(gas)
        part = (in_so2 - slope * in_co2) * signals.backwards(gas, weights)
        covariance += signals.noise(gas) ** 2 * part.T @ part
        if channel and channel.random_walk > 0.0:
            walk = np.cumsum(part[::-1], axis=0)
            covariance += channel.random_walk**2 * signals.record.step * walk.T @ walk
    return covariance


def _noise_energy(signals: Signals, so2: float, co2: float) -> float:
    """Return the expected sum of squares of the noise of ``so2 SO2 + co2 CO2`` beside the
    background.
    """
    return sum(
        (so2 * in_so2 + co2 * in_co2) ** 2 * signals.noise(gas) ** 2 * signals.noise_energy(gas)
        for gas, (in_so2, in_co2) in signals.shares.items()
        if so2 * in_so2 + co2 * in_co2
    )


def _correlated(signals: Signals) -> float:
    """Return N times the sum of the squared autocovariance of the CO2 signal's noise."""
    return signals.count * sum(
        (in_co2 * signals.noise(gas)) ** 4 * signals.noise_correlation(gas)
        for gas, (_, in_co2) in signals.shares.items()
        if in_co2
    )


def residual_variance(signals: Signals, slope: float) -> float:
    """Return the mean square that the residuals have by the stated noise."""
    return _noise_energy(signals, 1.0, -slope) / signals.count
