"""The console's lines on a study of flights: the verdict, and notes on the flights."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Self

from common.faults import faults_in
from common.hull import HULL_SHAPES
from common.intervals import TELLING, percent
from common.premises import TITLES, UNEXPLAINED
from common.run_layout import SUMMARY
from common.verdict import Bound, Counts, RunVerdict, TrialVerdict
from measurement.estimate.verdict import (
    content_words,
    counted_verdicts,
    repeated_words,
    suspect_words,
    verdict_words,
)
from scenarios.engine.task import Row
from scenarios.world.faults import OF_SNIFFER

NOT_MET_SHOWN = 20
"""Flights that did not meet every criterion, or reasons why they measured nothing, that are named
on the console, at most.
"""

_MEASURED_FROM = {
    "sphere": " (from the centre of the keep-out sphere)",
    "cylinder": " (horizontally, from the axis of the cylinder)",
    HULL_SHAPES["sphere"]: " (from the outline of the hull)",
    HULL_SHAPES["cylinder"]: " (horizontally, from the outline of the hull)",
}
"""What distances are measured from, by the shape of the keep-out area."""


POINTS_OF_SWEEP = {
    "own": "points of the sweep: each has starts, noise and sampled instruments of its own",
    "common": "points of the sweep: all have the same starts, noise and sampled instruments",
}
"""What the verdict says of the points of a sweep, by whose random numbers they have."""


def plural(number: int, noun: str) -> str:
    """Return a number and a noun, in the plural unless it is one."""
    return f"{number} {noun}{'s' * (number != 1)}"


def counts_line(counts: Counts) -> str:
    """Return the numbers of flights planned, flown, completed, met, and kept out, in a line.

    Flights that did not keep out are listed by reason. A flight that lost its aircraft, failed, or
    has an unknown end never counts as "kept out".
    """
    line = (
        f"{counts.planned} planned, {counts.flown} flown, {counts.completed} completed,"
        f" {counts.met} met every criterion"
    )
    apart = {
        "diverged": counts.diverged,
        "lost the aircraft": counts.lost - counts.diverged,
        "failed": counts.failed,
        "could not be flown": counts.not_flown,
    }
    line += "".join(f", {number} {what}" for what, number in apart.items() if number)
    if not counts.beside:
        return line
    kept = (
        f"{counts.kept_out} of {counts.beside}{' beside a vessel' * bool(counts.no_area)} kept out"
    )
    others = {
        "ended outside, lost or failed": counts.outside,
        "violated the area": counts.violated,
        "unknown": counts.unknown,
    }
    kept += "".join(f", {number} {what}" for what, number in others.items() if number)
    return f"{line}; {kept}; {plural(counts.keepout_violations, 'keep-out violation')}"


def trial_line(trial: TrialVerdict) -> str:
    """Return the counts of some flights in a line, with the closest approach."""
    line, closest = counts_line(trial.counts), trial.closest
    if closest is None:
        return line
    about = _MEASURED_FROM.get(closest.shape, "")
    return f"{line}, closest approach {closest.distance_m:.1f} m{about}"


def unexplained_lines(verdict: RunVerdict) -> list[str]:
    """Return the message that the guard's theorem or its code is wrong, if a flight shows it."""
    if not (wrong := verdict.counts.unexplained):
        return []
    flights = plural(wrong, "flight")
    return [f"THE KEEP-OUT GUARD IS WRONG: in {flights} with a keep-out violation {UNEXPLAINED}"]


def premise_lines(verdict: RunVerdict) -> list[str]:
    """Return the number of flights in which a premise of the keep-out guard did not hold, and the
    premises.
    """
    premises = verdict.premises
    if not premises.measured:
        return []
    of = plural(premises.measured, "flight")
    if not premises.exceeded:
        return [f"premises of the keep-out guard: all held in {of}"]
    terms = ", ".join(f"{TITLES[term]} in {number}" for term, number in premises.terms.items())
    return [f"premises of the keep-out guard: exceeded in {premises.exceeded} of {of}: {terms}"]


def bound_line(bound: Bound, hours: float) -> str:
    """Return a line on keep-out violations, with the bound on their probability unless it exceeds
    ``TELLING``.

    Parameters
    ----------
    bound : bound that follows from the flights
    hours : simulated time of these flights [h]
    """
    flights = plural(bound.flights, "flight")
    known = (
        f"in {bound.violated} of {bound.flights} flights"
        if bound.violated
        else f"none known in {flights}"
    )
    more = (
        f", unknown in {bound.unknown}, which count{'s' * (bound.unknown == 1)} as violated"
        if bound.unknown
        else ""
    )
    line = f"keep-out violations: {known} ({hours:.3g} h simulated){more}"
    shared = bound.samples < bound.flights
    if shared:
        line += f"; they share {plural(bound.samples, 'random sample')}"
    if bound.upper > TELLING:
        return f"{line}; too few{'' if shared else ' flights'} to bound their probability"
    upper, sure = (
        percent(p).replace("\N{NO-BREAK SPACE}", " ") for p in (bound.upper, bound.confidence)
    )
    return f"{line}; at most {upper} of flights sampled as these were, at {sure} confidence"


def exit_line(verdict: RunVerdict) -> str:
    """Return the exit status of a run that is done, and how many flights did what it requires."""
    counts, alone = verdict.counts, verdict.counts.required.get("keep_out", 0)
    every = "to meet every criterion"
    outside = "to stay outside of the keep-out area"
    required = (
        every
        if not alone
        else outside
        if alone == counts.done
        else f"{every}, of {alone} {outside}"
    )
    did = f"{counts.passed} of {plural(counts.planned, 'flight')} did what is required: {required}"
    return f"exit status {verdict.exit_status}: {did}" if verdict.is_done else f"so far {did}"


def comparison_lines(verdict: RunVerdict, left_out: Sequence[float]) -> list[str]:
    """Return a line for each comparison: its flights, which do not count.

    Parameters
    ----------
    verdict : with their counts
    left_out : speed ratios of comparisons at which the study has no flight; may be empty
    """
    if left_out:
        return [
            "  comparisons: none flown, as no flight is at a speed ratio of comparison.nu,"
            f" {list(left_out)}"
        ]
    return [
        f"  comparison {variant}, not counted above: {counts_line(counts)}"
        for variant, counts in verdict.comparisons.items()
    ]


@dataclass(slots=True, kw_only=True)
class FlightNotes:
    """Notes on flights, in addition to their verdict.

    Attributes
    ----------
    done, flown, met : number of flights that are done, were flown, met every criterion
    unflown_manoeuvres : number of flights that ended before a manoeuvre of their vessel began
    beside_smoke : height above the plume's axis of each flight that crossed the plume, but never
        its smoke [m]
    not_met : rows of the first flights that did not meet every criterion
    sulphur : row of the first flight with a sulphur content of the fuel
    verdicts : number of such flights by verdict and quality
    unmeasured : number of flights whose sniffer gave no sulphur content, by the reason
    sniffer_faults : number of flights in which a fault of the sniffer began, by its kind
    """

    done: int = 0
    flown: int = 0
    met: int = 0
    unflown_manoeuvres: int = 0
    beside_smoke: list[float] = field(default_factory=list)
    not_met: list[Row] = field(default_factory=list)
    sulphur: Row | None = None
    verdicts: Counter[tuple[str, str]] = field(default_factory=Counter)
    unmeasured: Counter[str] = field(default_factory=Counter)
    sniffer_faults: Counter[str] = field(default_factory=Counter)

    @classmethod
    def of(cls, rows: Iterable[Row]) -> Self:
        """Return the notes on the rows of a summary."""
        notes = cls()
        for row in rows:
            notes.add(row)
        return notes

    def add(self, row: Row) -> None:
        """Add a flight to the notes."""
        self.done += 1
        self.flown += "duration_s" in row
        self.unflown_manoeuvres += row.get("manoeuvres_unflown", 0) > 0
        if row.get("plume_axis_crossings", 0) and not row["smoke_passes"]:
            self.beside_smoke.append(row["axis_height_error_mean_m"])
        for kind, begins in faults_in(row):
            if kind in OF_SNIFFER and begins <= row.get("duration_s", 0.0):
                self.sniffer_faults[kind] += 1
        if math.isfinite(row.get("fsc_percent", math.nan)):
            self.sulphur = self.sulphur or row
            self.verdicts[row["sulphur_verdict"], row["sulphur_quality"]] += 1
        elif "sulphur_reason" in row:
            self.unmeasured[row["sulphur_reason"]] += 1
        if row["criteria_met"]:
            self.met += 1
        elif len(self.not_met) < NOT_MET_SHOWN:
            self.not_met.append(row)

    def sulphur_lines(self) -> list[str]:
        """Return lines on the measured fuel: content and verdict of a single flight, or the number
        of verdicts of several flights.

        A further line has the number of flights in which the sniffer failed, which no other line on
        the console has.
        """
        faults = [
            f"a fault of the sniffer began in {count} of {self.flown}"
            f" flight{'s' * (self.flown > 1)}: {kind}"
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

    def warnings(self) -> list[str]:
        """Return lines on parts of the scenario that had no effect on flights, and on flights that
        missed the smoke that they should measure.
        """
        lines = []
        if count := self.unflown_manoeuvres:
            lines.append(
                f"warning: in {count} flight{'s' * (count > 1)} a manoeuvre of the vessel begins"
                " after the end of the flight, and was never flown; let it begin earlier"
                " (vessel.manoeuvres), or fly longer (flight.duration_max_s, flight.crossings)"
            )
        if heights := self.beside_smoke:
            farthest = max(heights, key=abs)
            lines.append(
                f"warning: in {len(heights)} flight{'s' * (len(heights) > 1)} the UAV never"
                f" passed through the smoke, and crossed its axis up to {abs(farthest):.0f} m"
                f" {'above' if farthest > 0.0 else 'below'} it: flight.altitude_min_m and"
                " altitude_max_m may not let it reach the smoke, or the ship is not as the"
                " guidance takes it to be (following.source_height_m, following.load)"
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
