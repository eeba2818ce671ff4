"""The bound on the probability of a keep-out violation that follows from flights, where it says anything."""

import pandas as pd

from common.intervals import CONFIDENCE, TELLING, upper_bound
from reports.run.columns import count, kept_out
from reports.run.run_data import RunData
from reports.run.trials import Trial


def violation_bound(run: RunData, trials: list[Trial], flown: pd.DataFrame) -> tuple[float, float] | None:
    """Return the bound on the probability of a keep-out violation and its confidence; none where flights are no random sample.

    A Monte Carlo study has its own, which allows for how often it was evaluated.
    """
    if run.statistics is not None:
        return _telling(run.statistics["violation"]["pessimistic"]["upper"], run.statistics["confidence"])
    return _telling(upper_bound(count(~kept_out(flown)), len(flown)), CONFIDENCE) if sampled(trials) and len(flown) else None


def trial_bound(trial: Trial) -> float | None:
    """Return that of one trial, with the confidence of all bounds."""
    flown = trial.flown
    known = trial.sampled_at_random and len(flown)
    found = _telling(upper_bound(count(~kept_out(flown)), len(flown)), CONFIDENCE) if known else None
    return found[0] if found else None


def sampled(trials: list[Trial]) -> bool:
    """Return whether the flights of all trials are a random sample."""
    return all(trial.sampled_at_random for trial in trials)


def _telling(bound: float, confidence: float) -> tuple[float, float] | None:
    return (bound, confidence) if bound <= TELLING else None
