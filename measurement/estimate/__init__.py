"""Fuel sulphur content of a ship from a sniffer's readings: uncertainty, quality and verdicts."""

from measurement.estimate.estimator import estimate, over_time, time_to_verdict
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
