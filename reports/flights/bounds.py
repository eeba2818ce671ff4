"""The bound on the probability of a keep-out violation that follows from flights, where it says
anything.
"""

from collections.abc import Sequence

from common.intervals import TELLING, percent
from reports.run.run_data import RunData
from reports.run.trials import Trial


def violation_bound(run: RunData) -> tuple[float, float] | None:
    """Return the bound on the probability of a keep-out violation and its confidence; none where
    flights are no random sample, or too few.

    That of a subset simulation is in its statistics; any other is in the verdict.
    """
    statistics = run.statistics
    if statistics is not None and statistics.get("method") == "subset":
        upper, confidence = (
            statistics["violation"]["pessimistic"]["upper"],
            statistics["confidence"],
        )
        return (upper, confidence) if upper <= TELLING else None
    bound = run.verdict.whole.bound
    return (bound.upper, bound.confidence) if bound and bound.upper <= TELLING else None


def bound_note(run: RunData, trials: Sequence[Trial]) -> list[str]:
    """Return what bound on the rate of keep-out violations follows from the flights, as small print
    of how many kept out; nothing where the headline has it.
    """
    if run.statistics is not None:
        return []
    if not all(trial.sampled_at_random for trial in trials):
        return ["no random sample, so no bound on the rate"]
    if (found := violation_bound(run)) is None:
        return ["too few for a bound on the rate"]
    upper, confidence = found
    words = f"rate of violations below {percent(upper)} at {percent(confidence)}"
    bound = run.verdict.whole.bound
    if bound and bound.unknown:
        words += f", with {bound.unknown:,} unknown as violated"
    return [words]


def trial_bound(trial: Trial) -> float | None:
    """Return the bound that follows from the flights of one trial."""
    bound = trial.verdict.bound
    return bound.upper if bound and bound.upper <= TELLING else None
