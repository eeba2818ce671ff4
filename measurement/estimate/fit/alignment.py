"""Response time and delay of SO2, found from the record where they are not given: those that fit
best.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from measurement.errors import MeasurementError
from measurement.estimate.fit.background import without
from measurement.estimate.fit.regression import fitted, noise_covariance, residual_variance
from measurement.estimate.fit.response import shifted
from measurement.estimate.fit.signals import Signals, make_signals
from measurement.estimate.record import Record
from measurement.sniffer.lag import Array
from measurement.sniffer.spec import SnifferSpec

_ROUNDS, _ROUNDS_NEAR = 8, 2
"""Gauss-Newton steps at most, and from a start that is near the end."""

_SMALL = 1e-3
"""Change of log(t90) and delay [s] at which the fit has settled."""

_STEPS, _JUMPS = np.array([0.02, 0.1]), np.array([0.3, 1.0])
"""Of the numerical derivatives, and the largest of one round: log(t90), delay [s]."""

_T90_SEARCH = tuple(float(t) for t in np.geomspace(0.5, 120.0, 14))
DELAY_MOST = 30.0
"""Up to which delay after CO2 SO2 is sought [s]."""

_DELAY_SEARCH = tuple(float(d) for d in np.arange(-5.0, DELAY_MOST + 1.0, 1.0))
"""Where a t90 [s], and a delay after CO2 [s], are sought first."""


@dataclass(frozen=True, kw_only=True)
class Alignment:
    """Response and delay.

    Attributes
    ----------
    instrument : with the response and delay that fit, where they were not given
    slope_deviation : standard deviation of the slope by what noise does to the fit; 0 where both
        were given [ppb/ppm]
    t90_sd_s, delay_sd_s : standard deviations of t90 of SO2, and of its delay after CO2, without
        what lies between readings [s]
    """

    instrument: SnifferSpec
    slope_deviation: float
    t90_sd_s: float
    delay_sd_s: float


def stated(instrument: SnifferSpec) -> Alignment:
    """Return response and delay as the instrument's figures say.

    Raises
    ------
    MeasurementError : they are not given
    """
    so2, co2 = instrument.known("so2"), instrument.known("co2")
    spread = so2.t90_s * so2.t90_sd, math.hypot(so2.delay_sd_s, co2.delay_sd_s)
    if not all(math.isfinite(value) for value in spread):
        raise MeasurementError(
            f"t90 and delay of '{instrument.name}' are not both given; give them, or use the regression"
        )
    return Alignment(
        instrument=instrument, slope_deviation=0.0, t90_sd_s=spread[0], delay_sd_s=spread[1]
    )


def align(record: Record, instrument: SnifferSpec, start: SnifferSpec | None = None) -> Alignment:
    """Return response and delay of SO2; of what is not given, the values with the least squared
    residuals.

    Parameters
    ----------
    record, instrument : an infinite deviation of t90 or delay of SO2 means that it is not given
    start : from which to seek; otherwise a grid is searched first
    """
    so2, co2 = instrument.known("so2"), instrument.known("co2")
    free = np.flatnonzero(np.isinf([so2.t90_sd, so2.delay_sd_s]))
    if not len(free):
        return stated(instrument)
    place = _place(start) if start else _searched(record, instrument, free)
    covariance, slope_deviation = np.zeros((2, 2)), math.nan
    for _ in range(_ROUNDS if start is None else _ROUNDS_NEAR):
        step, covariance, slope_deviation = _round(record, instrument, place, free)
        place = place + step
        if np.abs(step).max() < _SMALL:
            break
    found = _applied(instrument, place)
    spread = np.sqrt(np.diagonal(covariance))
    return Alignment(
        instrument=found,
        slope_deviation=slope_deviation,
        t90_sd_s=found.known("so2").t90_s * (float(spread[0]) if 0 in free else so2.t90_sd),
        delay_sd_s=float(spread[1]) if 1 in free else math.hypot(so2.delay_sd_s, co2.delay_sd_s),
    )


def widened(alignment: Alignment, known: SnifferSpec, others: Sequence[SnifferSpec]) -> Alignment:
    """Return an alignment whose deviations have what errors of the instrument do to what was found
    from the record.

    Parameters
    ----------
    alignment : with its deviations by noise
    known, others : the instrument aligned as it is known, and with one error each
    """
    so2 = alignment.instrument.known("so2")
    log_t90, delay = np.linalg.norm(
        [_place(other) - _place(known) for other in others] or np.zeros((1, 2)), axis=0
    ).tolist()
    return replace(
        alignment,
        t90_sd_s=math.hypot(alignment.t90_sd_s, so2.t90_s * log_t90)
        if math.isinf(so2.t90_sd)
        else alignment.t90_sd_s,
        delay_sd_s=math.hypot(alignment.delay_sd_s, delay)
        if math.isinf(so2.delay_sd_s)
        else alignment.delay_sd_s,
    )


def _place(instrument: SnifferSpec) -> Array:
    """Return log(t90) of SO2 and its delay after CO2 [s]."""
    return np.array(
        [
            math.log(instrument.known("so2").t90_s),
            instrument.known("so2").delay_s - instrument.known("co2").delay_s,
        ]
    )


def _applied(instrument: SnifferSpec, place: Array) -> SnifferSpec:
    """Return the instrument with log(t90) of SO2 and its delay after CO2 [s]; where that is
    negative, all others are later.
    """
    late = max(0.0, -float(place[1]) - instrument.known("co2").delay_s)
    if late:
        channels = tuple(
            replace(channel, delay_s=channel.delay_s + late) for channel in instrument.channels
        )
        instrument = replace(instrument, channels=channels)
    delay = max(0.0, instrument.known("co2").delay_s + float(place[1]))
    return instrument.with_channel(
        replace(instrument.known("so2"), t90_s=math.exp(float(place[0])), delay_s=delay)
    )


def _round(
    record: Record, instrument: SnifferSpec, place: Array, free: npt.NDArray[np.int64]
) -> tuple[Array, Array, float]:
    """Return the Gauss-Newton step, the covariance of log(t90) and delay, and what it adds to the
    slope's deviation.
    """
    signals = make_signals(record, _applied(instrument, place))
    slope, residual = fitted(signals)
    if not math.isfinite(slope):
        return np.zeros(2), np.zeros((2, 2)), math.nan
    derivatives = np.stack(
        [-signals.excess()[0], *(_derivative(signals, instrument, place, i, slope) for i in free)],
        axis=1,
    )
    inverse = np.linalg.pinv(derivatives.T @ derivatives, hermitian=True)
    step = np.zeros(2)
    step[free] = np.clip(-(inverse @ (derivatives.T @ residual))[1:], -_JUMPS[free], _JUMPS[free])
    # The residuals' noise is not white: it reaches the fit by its own covariance.
    expected = residual_variance(signals, slope) * signals.count
    misfit = max(1.0, float(residual @ residual) / expected) if expected > 0.0 else 1.0
    noise = misfit * noise_covariance(signals, derivatives, slope)
    spread = inverse @ noise @ inverse
    covariance = np.zeros((2, 2))
    covariance[np.ix_(free, free)] = spread[1:, 1:]
    alone = float(noise[0, 0]) / float(derivatives[:, 0] @ derivatives[:, 0]) ** 2
    return step, covariance, math.sqrt(max(0.0, float(spread[0, 0]) - alone))


def _derivative(
    signals: Signals, instrument: SnifferSpec, place: Array, i: int, slope: float
) -> Array:
    """Return what the residuals change by with log(t90) or delay, relative to the noise that SO2
    has left.
    """
    sides, noise, known = [], _noise(signals), signals.known
    for sign in (1.0, -1.0):
        moved = place.copy()
        moved[i] += sign * _STEPS[i]
        other = make_signals(signals.record, _applied(instrument, moved))
        co2, so2 = other.excess()
        sides.append((so2 - slope * co2) * math.sqrt(noise / _noise(other)))
        known = known * other.known
    return np.asarray(known * (sides[0] - sides[1]) / (2.0 * _STEPS[i]))


def _noise(signals: Signals) -> float:
    """Return the mean square of the noise that SO2 has left, 1 where it has none, or too few
    samples are known.

    SO2 is smoothed where CO2 or a gas that corrects it is slower, the more the faster SO2 is taken
    for: where its noise is large, the residuals would be least for a t90 of 0.
    """
    found = residual_variance(signals, 0.0)
    return found if found > 0.0 and signals.enough else 1.0


def _searched(record: Record, instrument: SnifferSpec, free: npt.NDArray[np.int64]) -> Array:
    """Return the place on the grid at which CO2 leaves least of SO2 unexplained, relative to the
    noise that SO2 has left.
    """
    best, least = _place(instrument), math.inf
    given = float(best[1])
    for log_t90 in np.log(_T90_SEARCH) if 0 in free else best[:1]:
        signals = make_signals(record, _applied(instrument, np.array([log_t90, given])))
        _, so2 = signals.excess()
        energy, noise = float(so2 @ so2), _noise(signals)
        for delay in _DELAY_SEARCH if 1 in free else (given,):
            co2 = without(
                signals.basis, signals.known * shifted(signals.co2, record.step, delay - given)
            )
            # SO2 does not fall where CO2 rises: a negative share is none.
            explained = max(0.0, float(co2 @ so2)) / max(float(np.linalg.norm(co2)), 1e-30)
            if (energy - explained**2) / noise < least:
                best, least = np.array([log_t90, delay]), (energy - explained**2) / noise
    return best
