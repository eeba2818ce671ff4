"""Counts of a study's flights, updated row by row."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

from common.intervals import CONFIDENCE, TELLING, percent, upper_bound
from common.physics import SECONDS_PER_HOUR
from common.premises import EXCEEDED, TERMS, UNEXPLAINED, exceeded_terms
from common.run_layout import SUMMARY
from measurement.estimate.verdict import (
    content_words,
    counted_verdicts,
    repeated_words,
    suspect_words,
    verdict_words,
)
from scenarios.engine.task import Row
from scenarios.flight.outcome import Outcome
from scenarios.world.faults import OF_SNIFFER

NOT_MET_SHOWN = 20
"""Flights that did not meet every criterion, or reasons why they measured nothing, that are named
on the console, at most.
"""

_MEASURED_FROM = {
    "sphere": "from the centre of the keep-out sphere",
    "cylinder": "horizontally, from the axis of the cylinder",
}
"""What distances are measured from, by the shape of the keep-out area."""


POINTS_OF_SWEEP = {
    "own": "points of the sweep: each has starts, noise and sampled instruments of its own",
    "common": "points of the sweep: all have the same starts, noise and sampled instruments",
}
"""What the verdict says of the points of a sweep, by whose random numbers they have."""


@dataclass(slots=True, kw_only=True)
class FlightCounts:
    """Counts of flights.

    Attributes
    ----------
    planned : number of planned flights
    done, flown : number of flights that are done, and of those that were measured
    kept_out : number of flights that kept out of the keep-out area to their end, as far as it is
        known
    without_area : number of flights that completed without a vessel, and so without an area to keep
        out of
    met : number of flights that met every criterion: they kept out, completed, and kept their
        aircraft
    passed : number of flights that did what exit status 0 requires of them
    outcomes : number of flights by their outcome
    required : number of flights by what exit status 0 requires of them
    violating : number of flights with a keep-out violation
    keepout_violations : number of keep-out violations
    with_premises, exceeding : number of flights whose guard has premises that were measured, and of
        those in which one did not hold
    exceeded : number of flights by the premise that did not hold
    shapes : number of flights by the shape of their keep-out area, which distances are measured
        from
    nearest : closest approach to the vessel, infinite if no flight is done [m]
    duration : of all flights [s]
    unflown_manoeuvres : number of flights that ended before a manoeuvre of their vessel began
    beside_smoke : height above the plume's axis of each flight that crossed the plume, but never
        its smoke [m]
    not_met : rows of the first flights that did not meet every criterion
    sulphur : row of the first flight with a sulphur content of the fuel
    verdicts : number of such flights by verdict and quality
    unmeasured : number of flights whose sniffer gave no sulphur content, by the reason
    sniffer_faults : number of flights in which a fault of the sniffer began, by its kind
    """

    planned: int
    done: int = 0
    flown: int = 0
    kept_out: int = 0
    without_area: int = 0
    met: int = 0
    passed: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    required: Counter[str] = field(default_factory=Counter)
    violating: int = 0
    keepout_violations: int = 0
    with_premises: int = 0
    exceeding: int = 0
    exceeded: Counter[str] = field(default_factory=Counter)
    shapes: Counter[str] = field(default_factory=Counter)
    nearest: float = math.inf
    duration: float = 0.0
    unflown_manoeuvres: int = 0
    beside_smoke: list[float] = field(default_factory=list)
    not_met: list[Row] = field(default_factory=list)
    sulphur: Row | None = None
    verdicts: Counter[tuple[str, str]] = field(default_factory=Counter)
    unmeasured: Counter[str] = field(default_factory=Counter)
    sniffer_faults: Counter[str] = field(default_factory=Counter)

    @classmethod
    def of(cls, rows: Iterable[Row], planned: int) -> Self:
        """Return the counts of the rows of a summary."""
        counts = cls(planned=planned)
        for row in rows:
            counts.add(row)
        return counts

    def add(self, row: Row) -> None:
        """Count a row."""
        required, kept_out = row.get("required", "criteria"), bool(row.get("kept_out", False))
        self.done += 1
        self.flown += "duration_s" in row
        self.kept_out += kept_out
        self.without_area += (
            row["outcome"] == Outcome.COMPLETED.value and "keepout_violations" not in row
        )
        self.outcomes[row["outcome"]] += 1
        self.required[required] += 1
        # What failed after its flight, as an instrument may, has kept out, but does not count as
        # done.
        done = kept_out and row["outcome"] != Outcome.FAILED.value
        self.passed += done if required == "keep_out" else bool(row["criteria_met"])
        self.violating += row.get("keepout_violations", 0) > 0
        self.keepout_violations += int(row.get("keepout_violations", 0))
        terms = exceeded_terms(row)
        self.with_premises += EXCEEDED in row
        self.exceeding += bool(terms)
        self.exceeded.update(terms)
        if "keepout_shape" in row:
            self.shapes[row["keepout_shape"]] += 1
        self.nearest = min(self.nearest, row.get("min_distance_m", math.inf))
        self.duration += row.get("duration_s", 0.0)
        self.unflown_manoeuvres += row.get("manoeuvres_unflown", 0) > 0
        if row.get("plume_axis_crossings", 0) and not row["smoke_passes"]:
            self.beside_smoke.append(row["axis_height_error_mean_m"])
        if row.get("fault") in OF_SNIFFER and row["fault_time_s"] <= row.get("duration_s", 0.0):
            self.sniffer_faults[row["fault"]] += 1
        if math.isfinite(row.get("fsc_percent", math.nan)):
            self.sulphur = self.sulphur or row
            self.verdicts[row["sulphur_verdict"], row["sulphur_quality"]] += 1
        elif "sulphur_reason" in row:
            self.unmeasured[row["sulphur_reason"]] += 1
        if row["criteria_met"]:
            self.met += 1
        elif len(self.not_met) < NOT_MET_SHOWN:
            self.not_met.append(row)

    @property
    def completed(self) -> int:
        """Number of flights that completed their mission."""
        return self.outcomes[Outcome.COMPLETED.value]

    @property
    def beside(self) -> int:
        """Number of flights beside a vessel, those that could not be flown among them: others have
        nothing to keep out of.
        """
        return self.done - self.without_area

    @property
    def lost(self) -> int:
        """Number of flights whose aircraft was lost."""
        return self.outcomes[Outcome.AIRCRAFT_LOST.value] + self.outcomes[Outcome.DIVERGED.value]

    def line(self) -> str:
        """Return the counts in a line: planned, flown, completed, met, and how the keep-out area
        was kept.
        """
        lost = f", {self.lost} lost the aircraft" if self.lost else ""
        counts = f"{self.planned} planned, {self.flown} flown, {self.completed} completed, {self.met} met every criterion{lost}"
        if math.isinf(self.nearest):
            return counts
        beside = (
            f"{self.flown - self.without_area}{' beside a vessel' if self.without_area else ''}"
        )
        violations = (
            f"{self.keepout_violations} keep-out violation{'s' * (self.keepout_violations != 1)}"
        )
        kept = f"{self.kept_out} of {beside} kept out, {violations}"
        about = f" ({_MEASURED_FROM[next(iter(self.shapes))]})" if len(self.shapes) == 1 else ""
        return f"{counts}; {kept}, closest approach {self.nearest:.1f} m{about}"

    @property
    def unexplained(self) -> int:
        """Number of flights with a keep-out violation although every premise held."""
        return self.outcomes[Outcome.UNEXPLAINED_VIOLATION.value]

    def unexplained_lines(self) -> list[str]:
        """Return that the theorem of the guard or its code is wrong, where a flight shows it."""
        if not self.unexplained:
            return []
        flights = f"{self.unexplained} flight{'s' * (self.unexplained > 1)}"
        return [
            f"THE KEEP-OUT GUARD IS WRONG: in {flights} with a keep-out violation {UNEXPLAINED}"
        ]

    def premise_lines(self) -> list[str]:
        """Return in how many flights a premise of the keep-out guard did not hold, and which."""
        if not self.with_premises:
            return []
        of = f"{self.with_premises} flight{'s' * (self.with_premises > 1)}"
        if not self.exceeding:
            return [f"premises of the keep-out guard: all held in {of}"]
        terms = ", ".join(f"{TERMS[term]} in {n}" for term, n in self.exceeded.most_common())
        return [f"premises of the keep-out guard: exceeded in {self.exceeding} of {of}: {terms}"]

    def sulphur_lines(self) -> list[str]:
        """Return what was measured of the fuel: of one flight content and verdict, of several how
        many were called what.

        And in how many flights the sniffer failed: nothing else on the console says so.
        """
        faults = [
            f"a fault of the sniffer began in {count} of {self.flown} flight{'s' * (self.flown > 1)}: {kind}"
            for kind, count in self.sniffer_faults.items()
        ]
        return [*self._content_lines(), *faults]

    def _content_lines(self) -> list[str]:
        row = self.sulphur
        if row is None:
            return [
                f"no fuel sulphur content in {count} flight{'s' * (count > 1)}: {why}"
                for why, count in self.unmeasured.most_common(NOT_MET_SHOWN)
            ]
        if (flights := self.verdicts.total()) > 1:
            of = f"{flights} of {self.done}" if flights < self.done else flights
            return [f"fuel sulphur of {of} flights: {counted_verdicts(self.verdicts.elements())}"]
        words = verdict_words(
            row["sulphur_verdict"],
            row["sulphur_limit_percent"],
            row["probability_above"],
            row["sulphur_quality"],
        ) + repeated_words(row.get("verdict_looks", 0), row.get("verdict_guard", math.nan))
        low, high = row["fsc_low_percent"], row["fsc_high_percent"]
        suspect = suspect_words(
            row.get("sulphur_suspect"),
            row.get("suspect_false_alarm", math.nan),
            row.get("suspect_miss", math.nan),
        )
        content = f"fuel sulphur {content_words(row['fsc_percent'], low, high)}: {words}"
        return [content, *([suspect] if suspect else [])]

    def bound_line(self, samples: int) -> str:
        """Return in how many flights the keep-out area was violated, with the bound on the
        probability of that.

        It is one if flights are a random sample, and not those of a search. One that could not be
        flown counts as violated, too.

        Parameters
        ----------
        samples : number of those that differ in what is random: of others each counts as one, and
            each violation as of another
        """
        not_kept = self.beside - self.kept_out
        upper = upper_bound(min(not_kept, samples), samples)
        return self.violation_line(
            self.violating,
            not_kept - self.violating,
            self.beside,
            upper,
            CONFIDENCE,
            samples=samples,
        )

    def violation_line(
        self,
        violating: int,
        unknown: int,
        flights: int,
        upper: float,
        confidence: float,
        *,
        samples: int,
    ) -> str:
        """Return what is known of keep-out violations, and the bound on their probability if that
        says anything.

        Parameters
        ----------
        violating, unknown : number of flights with a violation, and of those of which nobody knows
        flights : number of all these flights
        upper, confidence : bound on the probability, in which unknown flights count as violations
            [-]
        samples : number of flights that differ in what is random
        """
        hours = self.duration / SECONDS_PER_HOUR
        known = (
            f"in {violating} of {flights} flights"
            if violating
            else f"none known in {flights} flight{'s' * (flights != 1)}"
        )
        more = (
            f", unknown in {unknown}, which count{'s' * (unknown == 1)} as violated"
            if unknown
            else ""
        )
        line = f"keep-out violations: {known} ({hours:.3g} h simulated){more}"
        line += (
            f"; they share {samples} random sample{'s' * (samples != 1)}"
            if samples < flights
            else ""
        )
        if upper > TELLING:
            return f"{line}; too few{'' if samples < flights else ' flights'} to bound their probability"
        bound, sure = (percent(p).replace("\N{NO-BREAK SPACE}", " ") for p in (upper, confidence))
        return f"{line}; at most {bound} of flights sampled as these were, at {sure} confidence"

    def exit_line(self, *, left: int = 0) -> str:
        """Return the exit status of a run that is done, and how many flights did what status 0
        requires of each.

        Parameters
        ----------
        left : number of flights of comparisons that are still to be flown, without which no run is
            done
        """
        about = {"criteria": "met every criterion", "keep_out": "kept out"}
        kinds = [about[kind] for kind in about if self.required[kind]] or ["met every criterion"]
        flights, each = ("flight", "it") if self.planned == 1 else ("flights", "each")
        did = f"{self.passed} of {self.planned} {flights} {' or '.join(kinds)}, which is required of {each}"
        if left or self.done < self.planned:
            return f"so far {did} for exit status 0"
        return f"exit status {int(self.passed != self.planned)}: {did}"

    def warnings(self) -> list[str]:
        """Return what of the scenario had no effect on flights, and where these missed what they
        were to measure.
        """
        lines = []
        if count := self.unflown_manoeuvres:
            lines.append(
                f"warning: in {count} flight{'s' * (count > 1)} a manoeuvre of the vessel begins after the end of the flight, and"
                " was never flown; let it begin earlier (vessel.manoeuvres), or fly longer (flight.duration_max_s,"
                " flight.crossings)"
            )
        if heights := self.beside_smoke:
            farthest = max(heights, key=abs)
            lines.append(
                f"warning: in {len(heights)} flight{'s' * (len(heights) > 1)} the UAV never passed through the smoke, and crossed"
                f" its axis up to {abs(farthest):.0f} m {'above' if farthest > 0.0 else 'below'} it: flight.altitude_min_m and"
                " altitude_max_m may not let it reach the smoke, or the ship is not as the guidance takes her to be"
                " (following.source_height_m, following.load)"
            )
        return lines

    def not_met_lines(self, indent: str) -> list[str]:
        """Return a line for each of the first flights that did not meet every criterion, and one
        for the rest.
        """
        lines = [
            f"{indent}{row['flight_id']}: {row['outcome']}: {row['message']}"
            for row in self.not_met
        ]
        more = self.done - self.met - len(self.not_met)
        return [*lines, f"{indent}and {more} more, see {SUMMARY}"] if more else lines

    def manifest(self) -> dict[str, Any]:
        """Return the entries of a manifest."""
        return {
            "outcomes": {outcome.value: self.outcomes[outcome.value] for outcome in Outcome},
            "flights_kept_out": self.kept_out,
            "flights_met_criteria": self.met,
            "flights_passed": self.passed,
            "flights_with_a_premise_exceeded": self.exceeding,
            "premises_exceeded": dict(self.exceeded),
        }


def comparison_lines(
    planned: Mapping[str, int], rows: Iterable[Row], left_out: Sequence[float]
) -> list[str]:
    """Return a line for each comparison: its flights, which do not count.

    Parameters
    ----------
    planned : number of flights of each
    rows : of all of them
    left_out : speed ratios of comparisons at none of which the study has a flight, or none
    """
    if left_out:
        return [
            f"  comparisons: none flown, as no flight is at a speed ratio of comparison.nu, {list(left_out)}"
        ]
    counts = {variant: FlightCounts(planned=flights) for variant, flights in planned.items()}
    for row in rows:
        counts[row["variant"]].add(row)
    return [
        f"  comparison {variant}, not counted above: {of.line()}" for variant, of in counts.items()
    ]
