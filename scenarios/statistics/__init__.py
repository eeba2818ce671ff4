"""Statistics of independent flights: intervals, sensitivity indices and stopping rules."""

from common.intervals import Interval, clopper_pearson, quantile_interval, upper_bound
from scenarios.statistics.estimates import study_statistics
from scenarios.statistics.sensitivity import InputIndices, Sensitivity, sensitivity_indices
from scenarios.statistics.stopping import confidence_at, looks, tight_enough
from scenarios.statistics.violations import Violations, count_violations

__all__ = [
    "InputIndices",
    "Interval",
    "Sensitivity",
    "Violations",
    "clopper_pearson",
    "confidence_at",
    "count_violations",
    "looks",
    "quantile_interval",
    "sensitivity_indices",
    "study_statistics",
    "tight_enough",
    "upper_bound",
]
