"""The bound on the probability of a keep-out violation that follows from flights, where it says
anything.
"""

import pandas as pd

from common.intervals import CONFIDENCE, TELLING, upper_bound
from reports.run.columns import beside_vessel, count, kept_out, violated, was_flown
from reports.run.run_data import RunData
from reports.run.trials import Trial


def violation_bound(run: RunData, trials: list[Trial]) -> tuple[float, float] | None:
    """Return the bound on the probability of a keep-out violation and its confidence; none where
    flights are no random sample.

    A Monte Carlo study has its own, which allows for how often it was evaluated. Any other counts a
    flight that could not be flown, or not be measured to its end, as a violation, as that one does.
    """
    if run.statistics is not None:
        return _telling(
            run.statistics["violation"]["pessimistic"]["upper"], run.statistics["confidence"]
        )
    return _bound(trials) if sampled(trials) else None


def counted_as_violations(rows: pd.DataFrame) -> str:
    """Return, in a sentence, which flights the bound counts as violations though none is known of
    them; no word without such.
    """
    unknown = _beside(rows)
    unknown = unknown[~kept_out(unknown) & ~violated(unknown)]
    unflown = count(~was_flown(unknown))
    kinds = {"not flown": unflown, "not observed to their end": len(unknown) - unflown}
    told = (
        f"{number:,} flight{'s' * (number > 1)} {kind}" for kind, number in kinds.items() if number
    )
    each = "keep-out violations" if len(unknown) > 1 else "a keep-out violation"
    return f" The bound counts {' and '.join(told)} as {each}." if len(unknown) else ""


def trial_bound(trial: Trial) -> float | None:
    """Return that of one trial, with the confidence of all bounds."""
    found = _bound([trial]) if trial.sampled_at_random else None
    return found[0] if found else None


def sampled(trials: list[Trial]) -> bool:
    """Return whether the flights of all trials are a random sample."""
    return all(trial.sampled_at_random for trial in trials)


def _bound(trials: list[Trial]) -> tuple[float, float] | None:
    beside = [_beside(trial.rows) for trial in trials]
    # Flights that share what is random count as one, and each violation as one of another sample.
    samples = sum(
        len(rows) // trial.flights_per_sample for trial, rows in zip(trials, beside, strict=True)
    )
    violating = min(samples, sum(count(~kept_out(rows)) for rows in beside))
    flown = any(len(beside_vessel(trial.rows)) for trial in trials)
    return _telling(upper_bound(violating, samples), CONFIDENCE) if flown else None


def _beside(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the flights beside a vessel, also those that were not flown: one about a circle has
    nothing to keep out of.
    """
    return rows[~was_flown(rows) | rows["min_distance_m"].notna()]


def _telling(bound: float, confidence: float) -> tuple[float, float] | None:
    return (bound, confidence) if bound <= TELLING else None
