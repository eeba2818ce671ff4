"""The bound on the probability of a keep-out violation that follows from flights, where it says
anything.
"""

from common.intervals import TELLING
from common.verdict import Bound
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


def counted_as_violations(bound: Bound | None) -> str:
    """Return, in a sentence, how many flights a bound counts as violations though none is known of
    them; no word without such.
    """
    if bound is None or not bound.unknown:
        return ""
    flights = "1 flight" if bound.unknown == 1 else f"{bound.unknown:,} flights"
    each = "a keep-out violation" if bound.unknown == 1 else "keep-out violations"
    return f" The bound counts {flights} of unknown end as {each}."


def trial_bound(trial: Trial) -> float | None:
    """Return the bound that follows from the flights of one trial."""
    bound = trial.verdict.bound
    return bound.upper if bound and bound.upper <= TELLING else None


def sampled(trials: list[Trial]) -> bool:
    """Return whether the flights of all trials are a random sample."""
    return all(trial.sampled_at_random for trial in trials)
