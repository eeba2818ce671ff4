"""How much larger a vessel's disc has to be taken because her reports scatter: the guard keeps off
where they say she may be.

The orbit lies beside where the filter takes the vessel to be. The discs of
``gnc.estimation.vessel`` lie about what single reports say, which scatters more. So a disc
that is no larger than planned may all the same reach farther towards the orbit.
"""

import functools

import numpy as np

from common.physics import SECONDS_PER_HOUR
from gnc.estimation.vessel import (
    KEPT,
    FilterParameters,
    VesselFilter,
    VesselLimits,
    VesselReport,
    radius_after,
)

GUARDED_PER_HOUR = 1.0
"""How often the discs of a vessel at constant velocity may reach farther than is allowed for here
[1/h].
"""

_HOURS, _SEED = 20.0, 20261122
"""Flight time over which reports are drawn [h], and the seed: the same for every flight."""

_NO_OFTENER, _LEAST = 1.0, 100
"""Mean interval below which reports count no oftener [s], and how many are drawn at least [-]."""

_SETTLED = 50
"""Reports after which the filter's covariance no longer changes [-]."""


@functools.lru_cache(maxsize=64)
def scatter_allowance(
    limits: VesselLimits,
    known: FilterParameters,
    intervals: tuple[float, float],
    latency: float,
    *,
    plan_period: float,
    planned: float,
) -> float:
    """Return by how much a disc reaches farther than planned, ``GUARDED_PER_HOUR`` times an hour
    [m].

    Looked at just before each report, when its predecessors are oldest: of the newest discs the one
    counts that reaches least far in a direction, from where the filter takes the vessel to be.
    Discs are compared at the end of a turn away.

    Parameters
    ----------
    limits, known : what vessel and reports keep within, and the filter of the reports
    intervals, latency : between reports, shortest and longest, and how late they are at most [s]
    plan_period : time between looks at them [s]
    planned : radius of the disc that is planned with, at the end of a turn away [m]
    """
    generator = np.random.default_rng(_SEED)
    mean = mean_interval(intervals)
    shape = (max(_LEAST, round(_HOURS * SECONDS_PER_HOUR / mean)), KEPT)
    late = plan_period + generator.uniform(0.0, latency, (shape[0], 1))
    age = limits.horizon + late + np.cumsum(generator.uniform(*intervals, shape), axis=1)
    off = limits.position_sigma * generator.standard_normal(
        shape
    ) + limits.velocity_sigma * age * generator.standard_normal(shape)
    taken = _filter_sigma(known, mean) * generator.standard_normal(shape[0])
    reaches = np.min(radius_after(limits, age) + off, axis=1) - taken
    return max(
        0.0,
        float(np.quantile(reaches, max(0.0, 1.0 - GUARDED_PER_HOUR * mean / SECONDS_PER_HOUR)))
        - planned,
    )


def mean_interval(intervals: tuple[float, float]) -> float:
    """Return the mean interval [s] between reports, by the shortest and longest; looked at no
    oftener than once a second.
    """
    return max(_NO_OFTENER, 0.5 * sum(intervals))


def _filter_sigma(known: FilterParameters, interval: float) -> float:
    """Return the standard deviation of the vessel's place as the filter knows it, at the mean
    interval of her reports [m].
    """
    vessel = VesselFilter(known)
    for number in range(_SETTLED):
        vessel.report(VesselReport(number * interval, 0.0, 0.0, 0.0, 0.0))
    return vessel.at(_SETTLED * interval).sigma
