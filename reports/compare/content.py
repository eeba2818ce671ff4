"""The report of a comparison: what was changed, what came of it, and in which flights."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from common.verdict import MET
from reports.compare.configuration import configuration_table, software_table, trials_apart
from reports.compare.figures import JUDGED, PAIRS_MIN, Difference, differences
from reports.compare.pairs import SPEED_RATIO, Pairs, paired
from reports.compare.runs import Run
from reports.compare.tables import (
    LISTED_MAX,
    changed,
    changed_table,
    difference_table,
    side_by_side,
    signed,
)
from reports.compare.tracks import most_changed
from reports.document.blocks import Block, Card, Content, Heading, Section, Text, Verdict
from reports.document.chart import Chart
from reports.document.numbering import numbered
from reports.document.tables import number
from reports.run.columns import count, lost, met, total, violated
from reports.run.letterhead import letterhead

TIME_OF_COMPUTING = "wall_time_s"
"""The column of a summary that differs between any two runs."""

_CARDS = ("fsc_percent", *JUDGED)
_CARDS_MAX = 3
"""Figures at the head of the report on two runs: the first of those that the flights have."""

_PRACTICAL = (
    "clearance_m",
    "crossing_interval_mean_s",
    "crossing_distance_mean_m",
    "tracking_error_rms_m",
    "settling_time_s",
    "guard_time_s",
    "fsc_percent",
)
"""Figures that a headline is about: what a flight is for, and not how."""

_SAME = "No figure differs in {pairs:,} pairs of flights"
_SAME_BUT_ALONE = "No figure differs in {pairs:,} pairs of flights; other flights have no partner"
_UNSAFE = (
    "{new:,} of {pairs:,} shared flights violate the keep-out area or lose the aircraft in {other}"
    " alone"
)
_CHANGE = "{title} {before} in {first}, {after} in {other}"
_MET = "Of {pairs:,} shared flights {before:,} met their criteria in {first}, {after:,} in {other}"
_CALLED = "The verdict on the fuel is another in {called:,}"

_NAMED_MAX = 6
"""Keys that a sentence names."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Compared:
    """A run beside the first.

    Attributes
    ----------
    pairs : flights in common
    found : how their figures differ, by the names of the columns of ``differences.csv``
    differing : columns of the summary in which any pair differs
    """

    pairs: Pairs
    found: dict[str, Difference]
    differing: list[str]

    @property
    def identical(self) -> bool:
        """Whether both runs have the same flights, and no figure of any of them differs."""
        return not self.differing and self.pairs.alone == (0, 0)


def compare(runs: Sequence[Run]) -> list[Compared]:
    """Return each run but the first beside the first.

    Raises
    ------
    ReportError : one has no flight in common with the first
    """
    found = []
    for other in runs[1:]:
        pairs = paired(runs[0], other)
        # The name of a flight may have that of its trial before it, which changes nothing.
        differing = pairs.differing_figures(apart=(TIME_OF_COMPUTING, "flight_id", "trial"))
        found.append(Compared(pairs=pairs, found=differences(pairs), differing=differing))
    return found


def comparison_content(runs: Sequence[Run], compared: Sequence[Compared]) -> Content:
    """Return everything that the report shows."""
    configuration = _configuration(runs)
    tracks = [most_changed(of.pairs, of.found) if of.differing else None for of in compared]
    # Page 1 has the tracks of the first pair of runs.
    sections = [
        Section(
            anchor="changed",
            title="What differs in the configuration",
            nav_title="Configuration",
            blocks=configuration,
        ),
        Section(
            anchor="figures",
            title="Figures side by side",
            nav_title="Figures",
            blocks=[Text(_WHOLE), side_by_side(runs)],
        ),
        *(
            _pair_section(of, chart)
            for of, chart in zip(compared, [None, *tracks[1:]], strict=True)
        ),
        Section(anchor="provenance", title="Provenance", blocks=[software_table(runs)]),
    ]
    described = "; ".join(f"{run.title} ({run.manifest['title']}, {run.state})" for run in runs)
    picture, sections = numbered(tracks[0], sections)
    names = (
        " and ".join(run.name for run in runs)
        if len(runs) == 2
        else f"{runs[0].name} and {len(runs) - 1} others"
    )
    return Content(
        title=f"Comparison of {len(runs)} runs",
        letterhead=replace(letterhead(runs[0].data, {}), run=names, done=f"{runs[0].letter} flown"),
        description="",
        changes="",
        flown=f"{described}.",
        verdict=_verdict(runs, compared),
        picture=picture,
        sections=sections,
    )


def _configuration(runs: Sequence[Run]) -> list[Block]:
    table = configuration_table(runs)
    shown = table or Text("No key differs in the configuration of the flights.")
    return [shown, *(Text(sentence) for sentence in trials_apart(runs))]


_WHOLE = (
    "Of every flight of each run, whether or not another run has it too. Figures after settling are"
    " of flights that settled. No difference is shown between figures of different numbers of"
    " flights; those of the paired flights are below."
)


def _pair_section(compared: Compared, tracks: Chart | None) -> Section:
    pairs, letter = compared.pairs, compared.pairs.other.letter
    blocks: list[Block] = [Text(" ".join(pairing_sentences(pairs)))]
    if compared.differing:
        table = changed_table(pairs)
        differences = difference_table(pairs, compared.found)
        if differences.rows:
            samples = len(set(pairs.samples.tolist()))
            words = _DIFFERENCES.format(samples=samples, least=PAIRS_MIN)
            blocks += [Text(words), differences]
        if table is not None:
            number = count(changed(pairs))
            first = f", of which the first {LISTED_MAX} are listed" if number > LISTED_MAX else ""
            blocks += [
                Heading(
                    f"Flights that met, kept out or completed in one run alone: {number:,}{first}"
                ),
                table,
            ]
        blocks += [tracks] if tracks is not None else []
    else:
        blocks.append(
            Text(f"No figure of these flights differs between {pairs.first.letter} and {letter}.")
        )
    title = f"Flight by flight: {letter} against {pairs.first.letter}"
    return Section(
        anchor=f"flights{letter.lower()}",
        title=title,
        nav_title=f"{letter} − {pairs.first.letter}",
        blocks=blocks,
    )


_PAIRED = "{paired:,} flights are paired: the same point or case, number and seed."
_ALONE = (
    "Without a partner are {of_first:,} of {first} and {of_other:,} of {other}; {same:,} of them"
    " have"
    " the same name in both runs, but another seed."
)
_RATIOS = (
    "The speed ratio ν, which follows from the speeds of vessel, UAV and air, differs in {pairs:,}."
)
_INPUTS = "The flights of a pair differ in what was swept or sampled: {keys}{more}."


def pairing_sentences(pairs: Pairs) -> list[str]:
    """Return how many flights are paired, how many have no partner, and whether what was sampled
    agrees.
    """
    sentences = [_PAIRED.format(paired=len(pairs))]
    of_first, of_other = pairs.alone
    if of_first or of_other:
        letters = {"first": pairs.first.letter, "other": pairs.other.letter}
        counts = {"of_first": of_first, "of_other": of_other, "same": pairs.same_name}
        sentences.append(_ALONE.format(**letters, **counts))
    differing = pairs.differing_inputs()
    if ratios := differing.pop(SPEED_RATIO, 0):
        sentences.append(_RATIOS.format(pairs=ratios))
    if differing:
        named = list(differing.items())[:_NAMED_MAX]
        left = len(differing) - len(named)
        sentences.append(
            _INPUTS.format(
                keys=", ".join(f"{key} in {number:,}" for key, number in named),
                more=f" and {left} more keys" if left else "",
            )
        )
    return sentences


_DIFFERENCES = (
    "Differences are those of each pair; pairs that share their random sample count as one, with"
    " the mean of their differences: there are {samples:,} samples. The interval is the exact one"
    " of"
    " their median at 95 %, from order statistics, for any distribution; it takes {least} samples,"
    " and is bold where it leaves out 0, as one in twenty does by chance. Of flights that are no"
    " random sample it says how far they agree, not what others would show. Figures that are the"
    " same in every pair are left out."
)


def _verdict(runs: Sequence[Run], compared: Sequence[Compared]) -> Verdict:
    unsafe = [of for of in compared if _new(of.pairs)]
    failed = [run for run in runs if run.data.verdict.exit_status != MET]
    worse = sum(count(of.pairs.no_longer | of.pairs.other_verdict) for of in compared)
    return Verdict(
        holds=not unsafe,
        complete=worse == 0 and not failed,
        headline=headline(compared),
        detail=" ".join(
            f"{of.pairs.other.title}: {' '.join(pairing_sentences(of.pairs))}" for of in compared
        ),
        failures=[
            *(f"{run.letter}: {_fell_short(run)}" for run in failed),
            *(line for of in compared for line in _lines(of)),
        ],
        figures=[card for of in compared for card in _cards(of, alone=len(compared) == 1)],
        judges=False,
    )


def headline(compared: Sequence[Compared]) -> str:
    """Return the largest practical change of each run, and in how many flights criteria are met."""
    pairs = sum(len(of.pairs) for of in compared)
    if not any(of.differing for of in compared):
        words = _SAME if all(of.identical for of in compared) else _SAME_BUT_ALONE
        return words.format(pairs=pairs)
    return ". ".join(". ".join(_sentences(of, changes=3 - len(compared))) for of in compared)


def _sentences(compared: Compared, changes: int) -> Iterator[str]:
    """Yield what a headline says of a run beside the first: what must never happen, else the
    largest changes, one at least, and then how many flights met their criteria.
    """
    pairs, found = compared.pairs, largest_changes(compared)[: max(1, changes)]
    names = {"first": pairs.first.letter, "other": pairs.other.letter, "pairs": len(pairs)}
    if new := _new(pairs):
        yield _UNSAFE.format(new=new, **names)
    elif found:
        yield "; ".join(
            _CHANGE.format(title=of.figure.title, before=before, after=after, **names)
            for of, before, after in found
        )
    yield _MET.format(before=count(met(pairs.before)), after=count(met(pairs.after)), **names)
    if called := count(pairs.other_verdict):
        yield _CALLED.format(called=called)


def largest_changes(compared: Compared) -> list[tuple[Difference, str, str]]:
    """Return the figures that differ, with their medians in the first run and in the other, the
    largest change first.

    A change is as large as its median over what the figure usually is in the first run, or over the
    limit of its criterion where that is more: errors far below their limit do not matter.
    """
    limits = {
        of.column: abs(float(of.limits[0]))
        for of in compared.pairs.first.data.verdict.whole.criteria
        if of.judged and isinstance(of.limits[0], int | float)
    }
    sizes = []
    for name in _PRACTICAL:
        of = compared.found.get(name)
        if of is None:
            continue
        both = np.isfinite(of.change)
        before, after = (float(np.median(values[both])) for values in (of.before, of.after))
        usual = max(abs(before), of.figure.scale * limits.get(name, 0.0))
        pattern = f"{{:.{of.figure.digits}f}}{of.figure.after}"
        first, other = number(before, pattern), number(after, pattern)
        if first != other:
            size = abs(after - before) / usual if usual > 0.0 else math.inf
            sizes.append((size, (of, first, other)))
    return [found for _, found in sorted(sizes, key=lambda sized: -sized[0])]


def _new(pairs: Pairs) -> int:
    """Return how many flights violate the keep-out area or lose their aircraft in the other run
    alone.
    """
    bad = [violated(rows) | lost(rows) for rows in (pairs.before, pairs.after)]
    return count(~bad[0] & bad[1])


def _lines(compared: Compared) -> list[str]:
    pairs = compared.pairs
    first, other = pairs.first.letter, pairs.other.letter
    if compared.identical:
        return [f"{other}: no figure differs from {first}"]
    lines = []
    if new := _new(pairs):
        what = (
            "violate the keep-out area or lose the aircraft"
            if new > 1
            else "violates the keep-out area or loses the aircraft"
        )
        lines.append(f"{other}: {new:,} flight{'s' * (new > 1)} {what}, and not in {first}")
    turned = [
        *((words, mask, first) for words, mask in pairs.in_first_alone.items()),
        ("met", pairs.newly_met, other),
    ]
    for words, mask, where in turned:
        if count(mask):
            lines.append(
                f"{other}: {count(mask):,} of {len(pairs):,} paired flights {words} in {where}"
                " alone"
            )
    return lines


def _fell_short(run: Run) -> str:
    """Return what a run that did not end with exit status 0 fell short of."""
    verdict, counts = run.data.verdict, run.data.verdict.counts
    found = {
        "violated the keep-out area": counts.violated,
        "diverged": counts.diverged,
        "lost the aircraft": counts.lost - counts.diverged,
        "could not be flown": counts.not_flown,
        "not flown yet": counts.left,
    }
    words = "".join(f", {number:,} {what}" for what, number in found.items() if number)
    state = "the run was interrupted, " if verdict.interrupted else ""
    did = f"{counts.passed:,} of {counts.planned:,} flights did what is required{words}"
    return f"{state}{did}"


def _cards(compared: Compared, *, alone: bool) -> list[Card]:
    pairs = compared.pairs
    first, other = pairs.first.letter, pairs.other.letter
    cards = [
        Card(f"Flights paired, {other} with {first}", f"{len(pairs):,}"),
        Card(
            f"Met in {first} alone, in {other} alone",
            f"{count(pairs.no_longer_met):,}, {count(pairs.newly_met):,}",
        ),
    ]
    violations = [f"{total(rows, 'keepout_violations'):,}" for rows in (pairs.before, pairs.after)]
    cards.append(
        Card(f"Keep-out violations of paired flights in {first}, in {other}", ", ".join(violations))
    )
    if not alone:
        return cards
    for difference in [compared.found[name] for name in _CARDS if name in compared.found][
        :_CARDS_MAX
    ]:
        figure = difference.figure
        value = f"{signed(difference.median, figure.digits)}{figure.after}"
        cards.append(Card(f"{figure.title}: median of {other} − {first}", value))
    return cards
