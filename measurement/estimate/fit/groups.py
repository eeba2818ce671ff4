"""Sulphur content of groups of passes, and whether they agree."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc

from measurement.estimate.fit.background import without
from measurement.estimate.fit.regression import noise_covariance
from measurement.estimate.fit.response import equalised, shifted
from measurement.estimate.fit.signals import Signals
from measurement.estimate.passes import Pass, co2_excesses
from measurement.sniffer.lag import Array

GROUPS_MAX = 8
"""Groups of passes at most: single passes overlap in a slow sensor, and tell little apart."""

_TELLING = 0.1
"""Size of a group's CO2 beside the background over the median's, from which on the group has a
content of its own [-].
"""

_INDEPENDENT = 1e-6
"""Least size of what is particular to a group, relative to all."""


@dataclass(frozen=True, kw_only=True)
class Groups:
    """Slopes of groups of neighbouring passes.

    Attributes
    ----------
    slopes, deviations : of each group, and its noise [ppb/ppm]
    agreement : probability that groups of one slope differ as much; not a number for fewer than two
        groups
    """

    slopes: tuple[float, ...]
    deviations: tuple[float, ...]
    agreement: float


def grouped(
    signals: Signals, passes: Sequence[Pass], slope: float, *, misfit: float, response: float
) -> Groups:
    """Return the slopes of groups of passes, fitted together: each group's CO2 excess, equalised,
    is a signal of its own.

    Parameters
    ----------
    signals : of the whole record
    passes : through the plume
    slope, misfit : of the whole record
    response : standard deviation of the slope by response and delay [ppb/ppm]; groups may differ by
        as much, as a wrong response distorts each of them in its own way
    """
    nothing = Groups(slopes=(), deviations=(), agreement=math.nan)
    if len(passes) < 2 or not math.isfinite(slope):
        return nothing
    parts = np.array_split(np.arange(len(passes)), min(GROUPS_MAX, len(passes)))
    cuts = [0.5 * (passes[part[-1]].end_s + passes[part[-1] + 1].start_s) for part in parts[:-1]]
    bounds = zip([-math.inf, *cuts], [*cuts, math.inf], strict=True)
    co2 = np.stack([_part(signals, low, high) for low, high in bounds], axis=1)
    co2 = without(signals.basis, signals.known[:, np.newaxis] * co2)
    # Of some groups little or nothing may be known.
    norms = np.linalg.norm(co2, axis=0)
    co2 = co2[:, norms > _TELLING * np.median(norms)]
    if co2.shape[1] < 2:
        return nothing
    sizes = np.linalg.svd(co2, compute_uv=False)
    if sizes[-1] <= _INDEPENDENT * sizes[0]:
        return nothing
    weights = np.asarray(np.linalg.pinv(co2), dtype=np.float64)
    found = weights @ signals.excess()[1]
    covariance = max(1.0, misfit) * noise_covariance(signals, weights.T, slope)
    agreement = math.nan
    if covariance.any():
        inverse = np.linalg.inv(covariance + response**2 * np.eye(len(found)))
        mean = float(inverse.sum(axis=0) @ found / inverse.sum())
        agreement = float(
            chdtrc(len(found) - 1, max(0.0, float((found - mean) @ inverse @ (found - mean))))
        )
    return Groups(
        slopes=tuple(float(v) for v in found),
        deviations=tuple(float(v) for v in np.sqrt(np.diagonal(covariance))),
        agreement=agreement,
    )


def _part(signals: Signals, start: float, end: float) -> Array:
    """Return the equalised CO2 excess of the readings between two times."""
    record, channel = signals.record, signals.instrument.known("co2")
    late = signals.late("co2")
    parts = []
    for time, excess in zip(record.times, co2_excesses(record, channel.noise), strict=True):
        inside = np.where((time >= start) & (time < end), excess / channel.gain, 0.0)
        parts.append(
            shifted(
                equalised(inside, record.step, channel.constants, signals.common), record.step, late
            )
        )
    return np.concatenate(parts)
