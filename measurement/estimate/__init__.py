"""The fuel sulphur content of readings, its uncertainty, its quality, and the verdict."""

from measurement.estimate.estimator import estimate
from measurement.estimate.over_time import over_time, time_to_verdict
from measurement.estimate.result import Figures, FscEstimate
from measurement.estimate.verdict import Verdict, judged

__all__ = [
    "Figures",
    "FscEstimate",
    "Verdict",
    "estimate",
    "judged",
    "over_time",
    "time_to_verdict",
]
