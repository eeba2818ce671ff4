"""Fuel sulphur content of a ship from a sniffer's readings: uncertainty, quality and verdicts."""

from measurement.estimate.estimator import estimate, over_time, time_to_verdict
from measurement.estimate.repeated import RepeatedVerdict
from measurement.estimate.result import Figures, FscEstimate
from measurement.estimate.verdict import Decision, Verdict, decide, judged
from measurement.rules import RULES, DecisionRule

__all__ = [
    "RULES",
    "Decision",
    "DecisionRule",
    "Figures",
    "FscEstimate",
    "RepeatedVerdict",
    "Verdict",
    "decide",
    "estimate",
    "judged",
    "over_time",
    "time_to_verdict",
]
