"""The judge of a run: from the rows of its flights to its verdict."""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from common.intervals import CONFIDENCE, upper_bound
from common.physics import SECONDS_PER_HOUR
from common.premises import EXCEEDED, exceeded_terms
from common.verdict import (
    GONE,
    Bound,
    Closest,
    Counts,
    Criterion,
    KeepOut,
    Premises,
    RunVerdict,
    TrialVerdict,
    Worst,
    did_what_is_required,
)
from scenarios.engine.task import Row
from scenarios.flight.outcome import Outcome
from scenarios.measures.criteria import Judged, judged_criteria
from scenarios.scenario.sections.flight import CriteriaConfig

_NAMED: Mapping[str, Callable[[Row], bool]] = {
    "violated": lambda row: KeepOut.of(row) is KeepOut.VIOLATED,
    "unknown": lambda row: KeepOut.of(row) is KeepOut.UNKNOWN,
    "lost": lambda row: row["outcome"] in GONE,
    "diverged": lambda row: row["outcome"] == Outcome.DIVERGED.value,
    "failed": lambda row: row["outcome"] == Outcome.FAILED.value,
    "not_passed": lambda row: not did_what_is_required(row),
}
"""Flights that the verdict names, and how their rows are recognised."""


class Tally:
    """Counts of flights, row by row.

    Parameters
    ----------
    planned : number of these flights
    """

    def __init__(self, planned: int) -> None:
        self._planned = planned
        self._numbers = Counter[str]()
        self._outcomes = Counter[str]({outcome.value: 0 for outcome in Outcome})
        self._required = Counter[str]()
        self._seconds = 0.0

    def add(self, row: Row) -> None:
        """Count a flight."""
        outcome, kept = row["outcome"], KeepOut.of(row)
        said = {
            "done": True,
            "flown": "duration_s" in row,
            "completed": outcome == Outcome.COMPLETED.value,
            "met": bool(row["criteria_met"]),
            "passed": did_what_is_required(row),
            kept.value: True,
            "lost": outcome in GONE,
            "diverged": outcome == Outcome.DIVERGED.value,
            "failed": outcome == Outcome.FAILED.value,
            "unexplained": outcome == Outcome.UNEXPLAINED_VIOLATION.value,
        }
        self._numbers.update(name for name, is_so in said.items() if is_so)
        self._numbers["keepout_violations"] += int(row.get("keepout_violations", 0))
        self._outcomes[outcome] += 1
        self._required[row.get("required", "criteria")] += 1
        self._seconds += row.get("duration_s", 0.0)

    def counts(self) -> Counts:
        """Return the counts so far."""
        return Counts(
            planned=self._planned,
            **self._numbers,
            hours=self._seconds / SECONDS_PER_HOUR,
            outcomes=dict(self._outcomes),
            required=dict(self._required),
        )


def counts_of(rows: Iterable[Row], planned: int) -> Counts:
    """Return the counts of the flights of some rows."""
    tally = Tally(planned)
    for row in rows:
        tally.add(row)
    return tally.counts()


def bound_of(counts: Counts, samples: int) -> Bound:
    """Return the bound on the probability of a keep-out violation that follows from flights that
    are a random sample.

    A flight with an unknown end counts as a violation, too.

    Parameters
    ----------
    counts : of the flights
    samples : number of different random samples. Flights that share a sample count as one, and each
        violation is assumed to be in another sample
    """
    return Bound(
        upper=upper_bound(min(counts.violated + counts.unknown, samples), samples),
        confidence=CONFIDENCE,
        flights=counts.beside,
        violated=counts.violated,
        unknown=counts.unknown,
        samples=samples,
    )


@dataclass(slots=True)
class _CriterionTally:
    """The result of a criterion, flight by flight."""

    column: str
    limits: list[Any] = field(default_factory=list)
    worst_of_all: tuple[float, Worst | None] = (-math.inf, None)
    worst: tuple[float, Worst | None] = (-math.inf, None)
    judged: int = 0
    failed: int = 0

    def add(self, flight: str, found: Judged) -> None:
        this = Worst(value=found.value, flight=flight, limit=found.limit)
        # NaN is neither larger nor less.
        if self.worst_of_all[0] < found.worse < math.inf:
            self.worst_of_all = found.worse, this
        if not found.judges:
            return
        self.judged += 1
        self.failed += bool(found.message)
        if found.limit not in self.limits:
            self.limits.append(found.limit)
        if self.worst[0] < found.of_limit < math.inf:
            self.worst = found.of_limit, this

    def criterion(self, key: str) -> Criterion:
        return Criterion(
            key=key,
            column=self.column,
            limits=self.limits,
            worst_of_all=self.worst_of_all[1],
            worst=self.worst[1],
            judged=self.judged,
            failed=self.failed,
        )


class _TrialJudge:
    """Judges the flights of a trial, or of all of them."""

    def __init__(self, planned: int) -> None:
        self._tally = Tally(planned)
        self._criteria: dict[str, _CriterionTally] = {}
        self._closest: Closest | None = None
        self._clearance = math.inf

    def add(self, row: Row, judged: Iterable[Judged]) -> None:
        self._tally.add(row)
        for found in judged:
            tally = self._criteria.setdefault(found.key, _CriterionTally(found.column))
            tally.add(row["flight_id"], found)
        if "min_distance_m" in row:
            distance, radius = row["min_distance_m"], row["keepout_radius_m"]
            if distance - radius < self._clearance:
                self._clearance = distance - radius
                self._closest = Closest(
                    flight=row["flight_id"],
                    distance_m=distance,
                    radius_m=radius,
                    shape=row.get("keepout_shape", ""),
                )

    def verdict(self) -> TrialVerdict:
        return TrialVerdict(
            counts=self._tally.counts(),
            criteria=[
                tally.criterion(key)
                for key, tally in self._criteria.items()
                if tally.judged or tally.worst_of_all[1]
            ],
            closest=self._closest,
        )


class Judge:
    """Judges the flights of a study, row by row.

    Parameters
    ----------
    planned : number of flights of each trial
    """

    def __init__(self, planned: Mapping[str, int]) -> None:
        self._whole = _TrialJudge(sum(planned.values()))
        self._trials = {trial: _TrialJudge(flights) for trial, flights in planned.items()}
        self._flights: dict[str, list[str]] = {name: [] for name in _NAMED}
        self._measured, self._exceeded, self._terms = 0, 0, Counter[str]()

    def add(self, row: Row, criteria: CriteriaConfig) -> None:
        """Judge a flight of the study by the criteria of its scenario."""
        judged = list(judged_criteria(row, criteria))
        self._whole.add(row, judged)
        self._trials[row["trial"]].add(row, judged)
        for name, is_so in _NAMED.items():
            if is_so(row):
                self._flights[name].append(row["flight_id"])
        terms = exceeded_terms(row)
        self._measured += EXCEEDED in row
        self._exceeded += bool(terms)
        self._terms.update(terms)

    def verdict(
        self, *, what: str = "flights", comparisons: Mapping[str, Counts] | None = None
    ) -> RunVerdict:
        """Return the verdict on the flights so far, with the flights of comparisons."""
        whole, compared = self._whole.verdict(), dict(comparisons or {})
        left = sum(of.left for of in compared.values())
        return RunVerdict(
            what=what,
            required_met=whole.counts.passed == whole.counts.planned and not left,
            whole=whole,
            trials={trial: judge.verdict() for trial, judge in self._trials.items()},
            flights=self._flights,
            premises=Premises(
                measured=self._measured,
                exceeded=self._exceeded,
                terms=dict(self._terms.most_common()),
            ),
            comparisons=compared,
            comparisons_left=left,
        )
