"""What a run has shown: judged once, by its study, and written as ``verdict.json``.

Console, exit status, reports, comparisons and Python read it; nothing else judges a run. Of a
single flight ``KeepOut.of`` says from its row whether it kept out.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from enum import StrEnum
from pathlib import Path
from typing import Any, Self

MET, NOT_MET, UNEXPLAINED, INTERRUPTED = 0, 1, 3, 130
"""Exit status of a run: every flight did what is required of it; one did not; one entered the
keep-out area although every premise of its guard held; the run was interrupted.
"""

COMPLETED, LOST, DIVERGED, FAILED = "completed", "aircraft_lost", "diverged", "failed"
"""Outcomes of flights that decide a verdict; ``scenarios.flight.outcome`` has all of them."""

GONE = (LOST, DIVERGED)
"""Outcomes of flights whose aircraft does not come back."""


class KeepOut(StrEnum):
    """How a flight kept out of the keep-out area.

    Only ``KEPT_OUT`` is said to have kept out. ``OUTSIDE`` was outside of the area to its end as
    well, but lost its aircraft or failed. Of ``UNKNOWN`` nobody knows: it was not flown, or went
    out of control.
    """

    KEPT_OUT = "kept_out"
    OUTSIDE = "outside"
    VIOLATED = "violated"
    UNKNOWN = "unknown"
    NO_AREA = "no_area"

    @classmethod
    def of(cls, row: Mapping[Any, Any]) -> "KeepOut":
        """Return it of a flight, by its row in the summary or the journal."""
        violations, outcome = row.get("keepout_violations", math.nan), row.get("outcome")
        if violations > 0:
            return cls.VIOLATED
        if violations == 0 and outcome != DIVERGED:
            return cls.OUTSIDE if outcome in (LOST, FAILED) else cls.KEPT_OUT
        # What was planned without a vessel has no area; what was never planned may have had one.
        planned, area = (_known(row.get(name)) for name in ("required", "keepout_radius_m"))
        return cls.NO_AREA if planned and not area else cls.UNKNOWN

    @property
    def is_known_outside(self) -> bool:
        """Whether the flight was outside of the area to its end, come back or not."""
        return self in (KeepOut.KEPT_OUT, KeepOut.OUTSIDE)


def did_what_is_required(row: Mapping[Any, Any]) -> bool:
    """Return whether a flight did what exit status 0 requires of it.

    Where it is required to keep out, and no more, it may lose its aircraft outside of the area.
    What failed after its flight, as an instrument may, does not count as done.
    """
    if row.get("required") == "keep_out":
        return KeepOut.of(row).is_known_outside and row["outcome"] != FAILED
    return bool(row["criteria_met"])


def _known(value: object) -> bool:
    return value is not None and not (isinstance(value, float) and math.isnan(value))


@dataclass(frozen=True, slots=True, kw_only=True)
class Counts:
    """Numbers of flights, or of whatever a study counts.

    Attributes
    ----------
    planned, done, flown : planned; done; and of these flown for any time
    completed, met, passed : completed their mission; met every criterion; did what exit status 0
        requires of them
    kept_out, outside, violated, unknown, no_area : by ``KeepOut``; they add up to ``done``
    lost, diverged, failed : whose aircraft was lost, those that diverged among them; by outcome
    keepout_violations : keep-out violations of all flights
    unexplained : violations although every premise of the guard held
    hours : simulated [h]
    outcomes : number of each outcome
    required : number of those of which exit status 0 requires each
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
        """Number of those that are still to be flown."""
        return self.planned - self.done

    @property
    def not_flown(self) -> int:
        """Number of those that are done and could not be flown."""
        return self.done - self.flown

    @property
    def beside(self) -> int:
        """Number of flights with an area to keep out of, flown or not."""
        return self.done - self.no_area


@dataclass(frozen=True, slots=True, kw_only=True)
class Worst:
    """The worst of a figure, and whose it is.

    Attributes
    ----------
    value : in the unit of the column; a word where the criterion is about one
    flight : name of the flight
    limit : of the criterion in that flight; None where it has none
    """

    value: float | str
    flight: str
    limit: Any = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Criterion:
    """What is required of a figure, and what came of it.

    Attributes
    ----------
    key : of the scenario's section ``criteria``; or ``keep_out``, ``mission``,
        ``crossing_clearance``, ``heading_rate``
    column : of the summary, or figure that follows from it; empty if it is in neither
    limits : of the flights that it judges: one, unless cases or a sweep set others
    worst_of_all : over all flights that have the figure, judged by it or not
    worst : over those that it judges
    judged, failed : number of flights that it judges, and of those that failed it, or lack the
        figure
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
        """Whether every flight that it judges meets it; None if it judges none."""
        return self.failed == 0 if self.judged else None


@dataclass(frozen=True, slots=True, kw_only=True)
class Closest:
    """The flight that stayed the least off its keep-out area.

    Attributes
    ----------
    flight : its name
    distance_m, radius_m : its closest approach, and its r_min
    shape : of its area
    """

    flight: str
    distance_m: float
    radius_m: float
    shape: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bound:
    """The bound on the probability of a keep-out violation that follows from flights.

    Attributes
    ----------
    upper, confidence : a flight sampled as these were violates the area with a probability of at
        most ``upper`` [-]
    flights, violated, unknown : these flights; those with a violation; and those of which nobody
        knows, which count as violations
    samples : number of those that differ in what is random: of others each counts as one
    """

    upper: float
    confidence: float
    flights: int
    violated: int
    unknown: int
    samples: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Premises:
    """How the premises of the keep-out guard held.

    Attributes
    ----------
    measured, exceeded : number of flights of which they are known, and in which one did not hold
    terms : number of flights by the premise that did not hold
    """

    measured: int = 0
    exceeded: int = 0
    terms: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialVerdict:
    """What the flights of one trial, or of all of them, have shown."""

    counts: Counts
    criteria: Sequence[Criterion] = ()
    closest: Closest | None = None
    bound: Bound | None = None

    def criterion(self, key: str) -> Criterion:
        """Return a criterion by its key; one that judges nothing where there is none."""
        return next((of for of in self.criteria if of.key == key), Criterion(key=key))


@dataclass(frozen=True, slots=True, kw_only=True)
class RunVerdict:
    """What a run has shown.

    Attributes
    ----------
    what : name of the items that are counted, in the plural
    required_met : whether every planned item is done, and all of them are as required
    whole : of all items of the study; those of comparisons do not count
    trials : the same of each trial
    flights : names of the flights that are ``violated``, ``unknown``, ``lost``, ``diverged``,
        ``failed``, and of those that did not do what is required of them (``not_passed``)
    premises : of the guard
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
        """Return the verdict of a study of items that are no flights, by their numbers.

        Parameters
        ----------
        what : name of the items, in the plural
        planned, done, met : their numbers
        required_met : whether they are as required; all of them have to be met if not given
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
        """Whether everything that was planned is done, and each flight that has an area to keep out
        of is known to have kept out, and came back: only then there was no violation.
        """
        return self.is_done and self.counts.kept_out == self.counts.beside

    @property
    def lost_against_requirement(self) -> int:
        """Number of flights that lost their aircraft, and did not do what is required of them."""
        return len({*self.flights.get("lost", ())} & {*self.flights.get("not_passed", ())})

    def once_interrupted(self, *, interrupted: bool) -> Self:
        """Return the verdict of a run that was interrupted, or was not."""
        return replace(self, interrupted=interrupted)

    def to_json(self) -> dict[str, Any]:
        """Return the content of ``verdict.json``."""
        return {
            "exit_status": self.exit_status,
            "left": self.counts.left,
            **asdict(self),
        }


def read_verdict(path: Path) -> RunVerdict:
    """Return the verdict that a run has written.

    Raises
    ------
    OSError : there is no such file
    ValueError, TypeError, LookupError, AttributeError : it is no verdict of this version
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
