"""The verdict of a run, which its study reaches once and writes as ``verdict.json``.

Console, exit status, reports, comparisons and Python read this verdict. ``KeepOut.of`` classifies a
single flight from its row.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from enum import StrEnum
from pathlib import Path
from typing import Any, Self

MET, NOT_MET, UNEXPLAINED, INTERRUPTED = 0, 1, 3, 130
"""Exit statuses of a run.

``MET``: every flight met its requirement. ``NOT_MET``: a flight did not. ``UNEXPLAINED``: a flight
entered the keep-out area although every premise of its guard held. ``INTERRUPTED``: the run was
interrupted.
"""

COMPLETED, LOST, DIVERGED, FAILED = "completed", "aircraft_lost", "diverged", "failed"
"""Outcomes of flights that influence a verdict; ``scenarios.flight.outcome`` has all of them."""

GONE = (LOST, DIVERGED)
"""Outcomes of flights whose aircraft is lost."""


class KeepOut(StrEnum):
    """Whether a flight kept out of the keep-out area.

    ``KEPT_OUT`` flights stayed outside and came back. ``OUTSIDE`` flights stayed outside but lost
    their aircraft or failed. ``UNKNOWN`` flights were not flown, or went out of control.
    """

    KEPT_OUT = "kept_out"
    OUTSIDE = "outside"
    VIOLATED = "violated"
    UNKNOWN = "unknown"
    NO_AREA = "no_area"

    @classmethod
    def of(cls, row: Mapping[Any, Any]) -> "KeepOut":
        """Classify a flight by its row in the summary or the journal."""
        violations, outcome = row.get("keepout_violations", math.nan), row.get("outcome")
        if violations > 0:
            return cls.VIOLATED
        if violations == 0 and outcome != DIVERGED:
            return cls.OUTSIDE if outcome in (LOST, FAILED) else cls.KEPT_OUT
        # A flight planned without a vessel has no area; an unplanned one may have one.
        planned, area = (_known(row.get(name)) for name in ("required", "keepout_radius_m"))
        return cls.NO_AREA if planned and not area else cls.UNKNOWN

    @property
    def is_known_outside(self) -> bool:
        """Whether the flight stayed outside of the area, even if it lost its aircraft."""
        return self in (KeepOut.KEPT_OUT, KeepOut.OUTSIDE)


def did_what_is_required(row: Mapping[Any, Any]) -> bool:
    """Return whether a flight met its requirement for exit status 0.

    A flight that is only required to keep out may lose its aircraft outside of the area. A flight
    with a failure after its end, such as an instrument's, has not met its requirement.
    """
    if row.get("required") == "keep_out":
        return KeepOut.of(row).is_known_outside and row["outcome"] != FAILED
    return bool(row["criteria_met"])


def _known(value: object) -> bool:
    return value is not None and not (isinstance(value, float) and math.isnan(value))


@dataclass(frozen=True, slots=True, kw_only=True)
class Counts:
    """Numbers of flights, or of a study's other items.

    Attributes
    ----------
    planned, done, flown : flights planned, flights done, and done flights that flew for any time
    completed, met, passed : flights that completed their mission, met every criterion, or met their
        requirement for exit status 0
    kept_out, outside, violated, unknown, no_area : flights by ``KeepOut``; their sum is ``done``
    lost, diverged, failed : flights whose aircraft was lost (diverged ones included), flights that
        diverged, and flights that failed
    keepout_violations : keep-out violations of all flights
    unexplained : flights with a violation although every premise of the guard held
    hours : simulated flight time [h]
    outcomes : number of flights with each outcome
    required : number of flights with each requirement for exit status 0
    """

    planned: int
    done: int = 0
    flown: int = 0
    completed: int = 0
    met: int = 0
    passed: int = 0
    kept_out: int = 0
    outside: int = 0
    violated: int = 0
    unknown: int = 0
    no_area: int = 0
    lost: int = 0
    diverged: int = 0
    failed: int = 0
    keepout_violations: int = 0
    unexplained: int = 0
    hours: float = 0.0
    outcomes: Mapping[str, int] = field(default_factory=dict)
    required: Mapping[str, int] = field(default_factory=dict)

    @property
    def left(self) -> int:
        """Number of flights that are still to be flown."""
        return self.planned - self.done

    @property
    def not_flown(self) -> int:
        """Number of done flights that could not be flown."""
        return self.done - self.flown

    @property
    def beside(self) -> int:
        """Number of done flights that have a keep-out area, because they are beside a vessel."""
        return self.done - self.no_area


@dataclass(frozen=True, slots=True, kw_only=True)
class Worst:
    """The worst value of a figure, and its flight.

    Attributes
    ----------
    value : value in the unit of the column; text if the criterion is about text
    flight : name of the flight
    limit : limit of the criterion in that flight, or None
    """

    value: float | str
    flight: str
    limit: Any = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Criterion:
    """A criterion on a figure, and its result.

    Attributes
    ----------
    key : key of the scenario's section ``criteria``, or ``keep_out``, ``mission``,
        ``crossing_clearance``, ``heading_rate``
    column : column of the summary, or figure derived from it; empty if there is none
    limits : limits in the judged flights: one, unless cases or a sweep set others
    worst_of_all : worst value of all flights that have the figure
    worst : worst value of the judged flights
    judged, failed : number of judged flights, and of those that failed or lack the figure
    """

    key: str
    column: str = ""
    limits: Sequence[Any] = ()
    worst_of_all: Worst | None = None
    worst: Worst | None = None
    judged: int = 0
    failed: int = 0

    @property
    def met(self) -> bool | None:
        """Whether every judged flight meets the criterion; None if no flight is judged."""
        return self.failed == 0 if self.judged else None


@dataclass(frozen=True, slots=True, kw_only=True)
class Closest:
    """The flight that came closest to its keep-out area.

    Attributes
    ----------
    flight : name of the flight
    distance_m, radius_m : closest approach, and r_min
    shape : shape of the area
    """

    flight: str
    distance_m: float
    radius_m: float
    shape: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bound:
    """Upper bound on the probability of a keep-out violation, from a number of flights.

    Attributes
    ----------
    upper, confidence : bound for a flight from the same distribution, and its confidence [-]
    flights, violated, unknown : number of flights, of those with a violation, and of those with an
        unknown result, which count as violations
    samples : number of different random samples; flights with the same sample count as one
    """

    upper: float
    confidence: float
    flights: int
    violated: int
    unknown: int
    samples: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Premises:
    """Results of the keep-out guard's premises.

    Attributes
    ----------
    measured, exceeded : number of flights with measured premises, and of those in which one failed
    terms : number of flights by the premise that failed
    """

    measured: int = 0
    exceeded: int = 0
    terms: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialVerdict:
    """Verdict on the flights of one trial, or of all trials."""

    counts: Counts
    criteria: Sequence[Criterion] = ()
    closest: Closest | None = None
    bound: Bound | None = None

    def criterion(self, key: str) -> Criterion:
        """Return a criterion by its key; an unknown key gives a criterion that judges no flight."""
        return next((of for of in self.criteria if of.key == key), Criterion(key=key))


@dataclass(frozen=True, slots=True, kw_only=True)
class RunVerdict:
    """Verdict on a run.

    Attributes
    ----------
    what : name of the counted items, in the plural
    required_met : whether every planned item is done and met its requirement
    whole : verdict on all items of the study, without comparisons
    trials : verdict on each trial
    flights : names of flights by ``violated``, ``unknown``, ``lost``, ``diverged``, ``failed``, and
        ``not_passed`` if they did not meet their requirement
    premises : results of the guard's premises
    comparisons : counts of the flights of each comparison
    comparisons_left : number of flights of comparisons that are still to be flown
    interrupted : whether the run ended before everything was done
    """

    what: str
    required_met: bool
    whole: TrialVerdict
    trials: Mapping[str, TrialVerdict] = field(default_factory=dict)
    flights: Mapping[str, Sequence[str]] = field(default_factory=dict)
    premises: Premises = field(default_factory=Premises)
    comparisons: Mapping[str, Counts] = field(default_factory=dict)
    comparisons_left: int = 0
    interrupted: bool = False

    @classmethod
    def of_items(
        cls, what: str, *, planned: int, done: int, met: int, required_met: bool | None = None
    ) -> Self:
        """Return the verdict on a study whose items are not flights, from their numbers.

        Parameters
        ----------
        what : name of the items, in the plural
        planned, done, met : numbers of items
        required_met : whether the requirement is met; by default every item has to be met
        """
        counts = Counts(planned=planned, done=done, flown=done, met=met, passed=met)
        as_required = met == planned if required_met is None else required_met
        return cls(what=what, required_met=as_required, whole=TrialVerdict(counts=counts))

    @property
    def counts(self) -> Counts:
        """Return the numbers of the study's items."""
        return self.whole.counts

    @property
    def exit_status(self) -> int:
        """Return the exit status: ``MET``, ``NOT_MET``, ``UNEXPLAINED`` or ``INTERRUPTED``."""
        if self.interrupted:
            return INTERRUPTED
        if self.counts.unexplained:
            return UNEXPLAINED
        return MET if self.required_met else NOT_MET

    @property
    def is_done(self) -> bool:
        """Whether everything that was planned is done."""
        return not (self.interrupted or self.counts.left or self.comparisons_left)

    @property
    def all_kept_out(self) -> bool:
        """Whether the run is complete and every flight with a keep-out area has ``KEPT_OUT``."""
        return self.is_done and self.counts.kept_out == self.counts.beside

    @property
    def lost_against_requirement(self) -> int:
        """Number of flights that lost their aircraft and did not meet their requirement."""
        return len({*self.flights.get("lost", ())} & {*self.flights.get("not_passed", ())})

    def once_interrupted(self, *, interrupted: bool) -> Self:
        """Return the verdict with ``interrupted`` set."""
        return replace(self, interrupted=interrupted)

    def to_json(self) -> dict[str, Any]:
        """Return the content of ``verdict.json``."""
        return {
            "exit_status": self.exit_status,
            "left": self.counts.left,
            **asdict(self),
        }


def read_verdict(path: Path) -> RunVerdict:
    """Return the verdict from a file.

    Raises
    ------
    OSError : the file cannot be read
    ValueError, TypeError, LookupError, AttributeError : the file has no verdict of this version
    """
    said = json.loads(path.read_text(encoding="utf-8"))
    return RunVerdict(
        what=said["what"],
        required_met=said["required_met"],
        whole=_trial(said["whole"]),
        trials={name: _trial(of) for name, of in said["trials"].items()},
        flights=said["flights"],
        premises=Premises(**said["premises"]),
        comparisons={name: Counts(**of) for name, of in said["comparisons"].items()},
        comparisons_left=said["comparisons_left"],
        interrupted=said["interrupted"],
    )


def _trial(said: Mapping[str, Any]) -> TrialVerdict:
    return TrialVerdict(
        counts=Counts(**said["counts"]),
        criteria=[_criterion(of) for of in said["criteria"]],
        closest=Closest(**said["closest"]) if said["closest"] else None,
        bound=Bound(**said["bound"]) if said["bound"] else None,
    )


def _criterion(said: Mapping[str, Any]) -> Criterion:
    worst = {
        name: Worst(**said[name]) if said[name] else None for name in ("worst_of_all", "worst")
    }
    return Criterion(**{**said, **worst})
