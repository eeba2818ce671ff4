"""Slope of SO2 over CO2: regression, response and delay of SO2 that fit best, groups of passes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.special import chdtrc

from measurement.errors import MeasurementError
from measurement.estimate.passes import Pass, co2_excesses
from measurement.estimate.record import Record
from measurement.estimate.signals import Signals, equalised, make_signals, shifted, without
from measurement.sniffer.lag import Array
from measurement.sniffer.spec import SnifferSpec

# Regression


@dataclass(frozen=True, kw_only=True)
class Slope:
    """Slope of a regression.

    Attributes
    ----------
    slope : SO2 over CO2 [ppb/ppm]
    noise : standard deviation of the slope by the noise [ppb/ppm]
    misfit : mean square of the residuals over that of the stated noise [-]
    residual_energy : sum of squares of the residuals [ppb^2]
    """

    slope: float
    noise: float
    misfit: float
    residual_energy: float


def fit_slope(signals: Signals) -> tuple[float, Array]:
    """Return the slope [ppb/ppm] and the residuals, shape (n,) [ppb].

    The slope is corrected for the noise of CO2, which would attenuate it. It is NaN where CO2 is
    noise alone, or too few samples are known.
    """
    co2, so2 = signals.excess
    energy = float(co2 @ co2) - _noise_energy(signals, 0.0, 1.0)
    slope = float(co2 @ so2) / energy if energy > 0.0 and signals.enough else math.nan
    return slope, so2 - slope * co2


def regress(signals: Signals) -> Slope:
    """Return the slope with its noise.

    Where residuals are larger than the noise of the instrument's figures predicts, the noise is
    scaled by the root of the misfit.
    """
    slope, residual = fit_slope(signals)
    co2, _ = signals.excess
    residual_energy = float(residual @ residual)
    energy = float(co2 @ co2) - _noise_energy(signals, 0.0, 1.0)
    misfit = variance = math.nan
    if math.isfinite(slope):
        expected = _noise_energy(signals, 1.0, -slope)
        misfit = residual_energy / expected if expected > 0.0 else 1.0
        variance = float(noise_covariance(signals, (co2 / energy)[:, np.newaxis], slope)[0, 0])
        correlation = signals.count * sum(
            (in_co2 * signals.noise(gas)) ** 4 * signals.noise_correlation(gas)
            for gas, (_, in_co2) in signals.shares.items()
            if in_co2
        )
        variance += slope**2 * correlation / energy**2
    return Slope(
        slope=slope,
        noise=math.sqrt(variance * max(1.0, misfit)),
        misfit=misfit,
        residual_energy=residual_energy,
    )


def noise_covariance(signals: Signals, weights: Array, slope: float) -> Array:
    """Return the covariance by noise and drift of weighted sums of ``so2 - slope co2``.

    Parameters
    ----------
    weights : of the samples in k sums, shape (n, k)
    """
    covariance = np.zeros((weights.shape[1],) * 2)
    for gas, (in_so2, in_co2) in signals.shares.items():
        drift = signals.instrument.known(gas).random_walk
        part = (in_so2 - slope * in_co2) * signals.backwards(gas, weights)
        covariance += signals.noise(gas) ** 2 * part.T @ part
        if drift > 0.0:
            walk = np.cumsum(part[::-1], axis=0)
            covariance += drift**2 * signals.record.step * walk.T @ walk
    return covariance


def _noise_energy(signals: Signals, so2: float, co2: float) -> float:
    """Return the expected noise energy of ``so2 SO2 + co2 CO2`` beside the background."""
    return sum(
        (so2 * in_so2 + co2 * in_co2) ** 2 * signals.noise(gas) ** 2 * signals.noise_energy(gas)
        for gas, (in_so2, in_co2) in signals.shares.items()
        if so2 * in_so2 + co2 * in_co2
    )


def _residual_variance(signals: Signals, slope: float) -> float:
    """Return the mean square of the residuals that the stated noise explains."""
    return _noise_energy(signals, 1.0, -slope) / signals.count


# Response time and delay of SO2, found from the record where they are not stated

DELAY_MOST = 30.0
"""Largest delay of SO2 after CO2 that is sought [s]."""

_DELAY_SEARCH = tuple(float(d) for d in np.arange(-5.0, DELAY_MOST + 1.0, 1.0))
_T90_SEARCH = tuple(float(t) for t in np.geomspace(0.5, 120.0, 14))
"""Grids of delay and t90 [s] that are searched first."""

_ROUNDS, _ROUNDS_NEAR = 8, 2
"""Gauss-Newton steps at most, from the grid and from a start near the end."""

_SMALL = 1e-3
"""Step of log(t90) and delay [s] at which the fit has settled."""

_STEPS = np.array([0.02, 0.1])
"""Steps of the numerical derivatives in log(t90) and delay [s]."""

_JUMPS = np.array([0.3, 1.0])
"""Largest changes of log(t90) and delay [s] in one Gauss-Newton step."""


@dataclass(frozen=True, kw_only=True)
class Alignment:
    """Response and delay of SO2.

    Attributes
    ----------
    instrument : with the response and delay that fit best, where they are not stated
    slope_deviation : standard deviation of the slope by what noise does to the fit; 0 where both
        are stated [ppb/ppm]
    t90_sd_s, delay_sd_s : standard deviations of t90 of SO2, and of its delay after CO2, without
        the error by the time between readings [s]
    """

    instrument: SnifferSpec
    slope_deviation: float = math.nan
    t90_sd_s: float = math.nan
    delay_sd_s: float = math.nan


def stated_alignment(instrument: SnifferSpec) -> Alignment:
    """Return response and delay as the instrument's figures state them.

    Raises
    ------
    MeasurementError : they are not stated
    """
    so2, co2 = instrument.known("so2"), instrument.known("co2")
    t90_sd_s = so2.t90_s * so2.t90_sd
    delay_sd_s = math.hypot(so2.delay_sd_s, co2.delay_sd_s)
    if not (math.isfinite(t90_sd_s) and math.isfinite(delay_sd_s)):
        raise MeasurementError(
            f"t90 and delay of '{instrument.name}' are not both given; give them, or use the"
            " regression"
        )
    return Alignment(
        instrument=instrument, slope_deviation=0.0, t90_sd_s=t90_sd_s, delay_sd_s=delay_sd_s
    )


def align(record: Record, instrument: SnifferSpec, start: SnifferSpec | None = None) -> Alignment:
    """Return response and delay of SO2, those not stated with the least squared residuals.

    Parameters
    ----------
    record, instrument : an infinite deviation of t90 or delay of SO2 means that it is not stated
    start : instrument with response and delay to start from; without it a grid is searched first
    """
    so2, co2 = instrument.known("so2"), instrument.known("co2")
    free = np.flatnonzero(np.isinf([so2.t90_sd, so2.delay_sd_s]))
    if not len(free):
        return stated_alignment(instrument)
    timing = _timing(start) if start else _grid_search(record, instrument, free)
    covariance, slope_deviation = np.zeros((2, 2)), math.nan
    for _ in range(_ROUNDS if start is None else _ROUNDS_NEAR):
        step, covariance, slope_deviation = _gauss_newton(record, instrument, timing, free)
        timing = timing + step
        if np.abs(step).max() < _SMALL:
            break
    found = _with_timing(instrument, timing)
    spread = np.sqrt(np.diagonal(covariance))
    return Alignment(
        instrument=found,
        slope_deviation=slope_deviation,
        t90_sd_s=found.known("so2").t90_s * (float(spread[0]) if 0 in free else so2.t90_sd),
        delay_sd_s=float(spread[1]) if 1 in free else math.hypot(so2.delay_sd_s, co2.delay_sd_s),
    )


def with_instrument_errors(
    alignment: Alignment, known: SnifferSpec, others: Sequence[SnifferSpec]
) -> Alignment:
    """Return an alignment whose deviations by noise include the effect of the instrument's errors.

    Parameters
    ----------
    known, others : the instrument aligned as it is known, and with one error each
    """
    so2 = alignment.instrument.known("so2")
    moves = [_timing(other) - _timing(known) for other in others] or np.zeros((1, 2))
    log_t90, delay = np.linalg.norm(moves, axis=0).tolist()
    t90_sd_s, delay_sd_s = alignment.t90_sd_s, alignment.delay_sd_s
    if math.isinf(so2.t90_sd):
        t90_sd_s = math.hypot(t90_sd_s, so2.t90_s * log_t90)
    if math.isinf(so2.delay_sd_s):
        delay_sd_s = math.hypot(delay_sd_s, delay)
    return replace(alignment, t90_sd_s=t90_sd_s, delay_sd_s=delay_sd_s)


def _timing(instrument: SnifferSpec) -> Array:
    """Return log(t90) of SO2 and its delay after CO2 [s], shape (2,)."""
    so2 = instrument.known("so2")
    return np.array([math.log(so2.t90_s), so2.delay_s - instrument.known("co2").delay_s])


def _with_timing(instrument: SnifferSpec, timing: Array) -> SnifferSpec:
    """Return the instrument with log(t90) of SO2 and its delay after CO2 [s], of either sign."""
    late = max(0.0, -float(timing[1]) - instrument.known("co2").delay_s)
    if late:
        channels = tuple(
            replace(channel, delay_s=channel.delay_s + late) for channel in instrument.channels
        )
        instrument = replace(instrument, channels=channels)
    delay = max(0.0, instrument.known("co2").delay_s + float(timing[1]))
    return instrument.with_channel(
        replace(instrument.known("so2"), t90_s=math.exp(float(timing[0])), delay_s=delay)
    )


def _gauss_newton(
    record: Record, instrument: SnifferSpec, timing: Array, free: npt.NDArray[np.int64]
) -> tuple[Array, Array, float]:
    """Return the step of the timing, its covariance, and the deviation it adds to the slope."""
    signals = make_signals(record, _with_timing(instrument, timing))
    slope, residual = fit_slope(signals)
    if not math.isfinite(slope):
        return np.zeros(2), np.zeros((2, 2)), math.nan
    by_timing = [_derivative(signals, instrument, timing, i, slope) for i in free]
    derivatives = np.stack([-signals.excess[0], *by_timing], axis=1)
    inverse = np.linalg.pinv(derivatives.T @ derivatives, hermitian=True)
    step = np.zeros(2)
    step[free] = np.clip(-(inverse @ (derivatives.T @ residual))[1:], -_JUMPS[free], _JUMPS[free])
    # The noise of the residuals is not white: it reaches the fit by its covariance.
    expected = _residual_variance(signals, slope) * signals.count
    misfit = max(1.0, float(residual @ residual) / expected) if expected > 0.0 else 1.0
    noise = misfit * noise_covariance(signals, derivatives, slope)
    spread = inverse @ noise @ inverse
    covariance = np.zeros((2, 2))
    covariance[np.ix_(free, free)] = spread[1:, 1:]
    with_timing_known = float(noise[0, 0]) / float(derivatives[:, 0] @ derivatives[:, 0]) ** 2
    return step, covariance, math.sqrt(max(0.0, float(spread[0, 0]) - with_timing_known))


def _derivative(
    signals: Signals, instrument: SnifferSpec, timing: Array, i: int, slope: float
) -> Array:
    """Return the derivative of residuals, over SO2's noise, by log(t90) or delay, shape (n,)."""
    sides, noise, known = [], _so2_noise(signals), signals.known
    for sign in (1.0, -1.0):
        moved = timing.copy()
        moved[i] += sign * _STEPS[i]
        other = make_signals(signals.record, _with_timing(instrument, moved))
        co2, so2 = other.excess
        sides.append((so2 - slope * co2) * math.sqrt(noise / _so2_noise(other)))
        known = known * other.known
    return np.asarray(known * (sides[0] - sides[1]) / (2.0 * _STEPS[i]))


def _so2_noise(signals: Signals) -> float:
    """Return the mean square of the noise of the SO2 signal, or 1 if it has none or is too short.

    A small t90 of SO2 smooths it most: without this scale it would have the least residuals.
    """
    found = _residual_variance(signals, 0.0)
    return found if found > 0.0 and signals.enough else 1.0


def _grid_search(record: Record, instrument: SnifferSpec, free: npt.NDArray[np.int64]) -> Array:
    """Return log(t90) and delay [s] on the grid that leave least of SO2 unexplained, over noise."""
    best, least = _timing(instrument), math.inf
    stated_delay = float(best[1])
    for log_t90 in np.log(_T90_SEARCH) if 0 in free else best[:1]:
        timing = np.array([log_t90, stated_delay])
        signals = make_signals(record, _with_timing(instrument, timing))
        _, so2 = signals.excess
        energy, noise = float(so2 @ so2), _so2_noise(signals)
        for delay in _DELAY_SEARCH if 1 in free else (stated_delay,):
            moved = shifted(signals.co2, record.step, delay - stated_delay)
            co2 = without(signals.basis, signals.known * moved)
            # SO2 does not fall where CO2 rises: a negative share is none.
            explained = max(0.0, float(co2 @ so2)) / max(float(np.linalg.norm(co2)), 1e-30)
            unexplained = (energy - explained**2) / noise
            if unexplained < least:
                best, least = np.array([log_t90, delay]), unexplained
    return best


# Sulphur content of groups of passes, and whether they agree

_GROUPS_MAX = 8
"""Groups of passes at most: single passes overlap in a slow sensor and have large errors."""

_TELLING = 0.1
"""Least CO2 of a group beside the background, relative to the median group [-]."""

_INDEPENDENT = 1e-6
"""Least singular value of the groups' CO2, relative to the largest."""


@dataclass(frozen=True, kw_only=True)
class Groups:
    """Slopes of groups of neighbouring passes.

    Attributes
    ----------
    slopes, deviations : of each group, and its noise [ppb/ppm]
    agreement : probability that groups of one slope differ as much; NaN for fewer than two groups
    """

    slopes: tuple[float, ...] = ()
    deviations: tuple[float, ...] = ()
    agreement: float = math.nan


def fit_groups(
    signals: Signals, passes: Sequence[Pass], slope: float, *, misfit: float, response: float
) -> Groups:
    """Return the slopes of groups of passes, fitted together.

    The equalised CO2 excess of each group is one signal of the fit.

    Parameters
    ----------
    signals, slope, misfit : of the whole record
    response : standard deviation of the slope by response and delay [ppb/ppm]; groups may differ by
        as much, as a wrong response distorts each of them differently
    """
    if len(passes) < 2 or not math.isfinite(slope):
        return Groups()
    parts = np.array_split(np.arange(len(passes)), min(_GROUPS_MAX, len(passes)))
    cuts = [0.5 * (passes[part[-1]].end_s + passes[part[-1] + 1].start_s) for part in parts[:-1]]
    bounds = zip([-math.inf, *cuts], [*cuts, math.inf], strict=True)
    co2 = np.stack([_co2_between(signals, low, high) for low, high in bounds], axis=1)
    co2 = without(signals.basis, signals.known[:, np.newaxis] * co2)
    # Of some groups little or nothing may be known.
    norms = np.linalg.norm(co2, axis=0)
    co2 = co2[:, norms > _TELLING * np.median(norms)]
    if co2.shape[1] < 2:
        return Groups()
    sizes = np.linalg.svd(co2, compute_uv=False)
    if sizes[-1] <= _INDEPENDENT * sizes[0]:
        return Groups()
    weights = np.asarray(np.linalg.pinv(co2), dtype=np.float64)
    found = weights @ signals.excess[1]
    covariance = max(1.0, misfit) * noise_covariance(signals, weights.T, slope)
    return Groups(
        slopes=tuple(float(v) for v in found),
        deviations=tuple(float(v) for v in np.sqrt(np.diagonal(covariance))),
        agreement=_agreement(found, covariance, response),
    )


def _agreement(slopes: Array, covariance: Array, response: float) -> float:
    """Return the probability that slopes of one mean differ as much; NaN without noise."""
    if not covariance.any():
        return math.nan
    inverse = np.linalg.inv(covariance + response**2 * np.eye(len(slopes)))
    mean = float(inverse.sum(axis=0) @ slopes / inverse.sum())
    chi_squared = float((slopes - mean) @ inverse @ (slopes - mean))
    return float(chdtrc(len(slopes) - 1, max(0.0, chi_squared)))


def _co2_between(signals: Signals, start: float, end: float) -> Array:
    """Return the equalised CO2 excess of the readings between two times [s], shape (n,)."""
    record, channel = signals.record, signals.instrument.known("co2")
    delay = signals.delay_to_so2("co2")
    parts = []
    for time, excess in zip(record.times, co2_excesses(record, channel.noise), strict=True):
        inside = np.where((time >= start) & (time < end), excess / channel.gain, 0.0)
        filtered = equalised(inside, record.step, channel.constants, signals.common)
        parts.append(shifted(filtered, record.step, delay))
    return np.concatenate(parts)
