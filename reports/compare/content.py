"""The report of a comparison: what was changed, what came of it, and in which flights."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from common.columns import Column
from common.verdict import MET
from reports.compare.configuration import configuration_table, software_table, trials_apart
from reports.compare.pairs import (
    JUDGED,
    PAIRS_MIN,
    SPEED_RATIO,
    Difference,
    Pairs,
    Run,
    differences,
    measures,
    paired,
)
from reports.compare.tracks import most_changed
from reports.document.axes import mark_text
from reports.document.blocks import Block, Card, Content, Heading, Section, Table, Text, Verdict
from reports.document.chart import Chart
from reports.document.numbering import numbered
from reports.document.tables import ending, number
from reports.run.columns import (
    Array,
    Mask,
    column,
    count,
    judged,
    lost,
    met,
    total,
    violated,
    worst,
)
from reports.run.letterhead import letterhead

LISTED_MAX = 40
"""Flights that are listed one by one."""

_DIGITS_MAX = 5
"""Digits after the point at most of figures that are nearly 0."""

_COUNTS: dict[str, Callable[[Run], int]] = {
    "Flights that were flown": lambda run: run.data.verdict.counts.flown,
    "Flights that met every criterion": lambda run: run.data.verdict.counts.met,
    "Flights that are known to have kept out": lambda run: run.data.verdict.counts.kept_out,
    "Flights that violated the keep-out area": lambda run: run.data.verdict.counts.violated,
    "Flights of unknown end": lambda run: run.data.verdict.counts.unknown,
    "Missions completed": lambda run: run.data.verdict.counts.completed,
    "Aircraft lost": lambda run: run.data.verdict.counts.lost,
    "Flights in which the guard intervened": lambda run: count(
        column(run.data.summary, "guard_interventions") > 0.0
    ),
}
"""What is counted of each run."""


def _over_flights(figure: Column) -> dict[str, Callable[[Array], float]]:
    """Return what is taken of a figure over all flights, by the words for it: the sum, where that
    means something, else the median and, where there is a worse side, the worst.
    """
    if figure.adds_up:
        return {"all flights": lambda values: float(values.sum())}
    taken: dict[str, Callable[[Array], float]] = {"median": lambda values: float(np.median(values))}
    if figure.worse:
        end = "least" if figure.worse == "lower" else "worst"
        taken[end] = lambda values: worst(values, figure)
    return taken


def side_by_side(runs: Sequence[Run]) -> Table:
    """Return figures of each run, of all of its flights, and their differences from the first where
    as many flights have them.
    """
    tables = [run.data.summary for run in runs]
    sizes = [len(rows) for rows in tables]
    alike = [size == sizes[0] for size in sizes[1:]]
    rows = [
        [
            "Flights",
            *(f"{size:,}" for size in sizes),
            *(signed(size - sizes[0], 0) for size in sizes[1:]),
        ]
    ]
    for words, chosen in _COUNTS.items():
        counts = [chosen(run) for run in runs]
        changes = [
            signed(found - counts[0], 0) if same else "–"
            for found, same in zip(counts[1:], alike, strict=True)
        ]
        rows.append(
            [
                words,
                *(f"{found:,} of {size:,}" for found, size in zip(counts, sizes, strict=True)),
                *changes,
            ]
        )
    for name, figure in measures(run.data for run in runs).items():
        known = [_known(table, name, figure) for table in tables]
        for words, taken in _over_flights(figure).items():
            values = [taken(of) if len(of) else None for of in known]
            if all(value is None for value in values):
                continue
            digits = _digits(figure, values)
            changes = [
                _change(value, values[0], digits) if same and len(of) == len(known[0]) else "–"
                for value, of, same in zip(values[1:], known[1:], alike, strict=True)
            ]
            rows.append(
                [
                    f"{figure.title}, {words}{figure.bracket}",
                    *(number(value, _pattern(digits)) for value in values),
                    *changes,
                ]
            )
    letters = [run.letter for run in runs]
    return Table(
        head=["", *letters, *(f"{letter} − {letters[0]}" for letter in letters[1:])],
        rows=rows,
        widths=[3.0, *(1.0 for _ in rows[0][1:])],
        print_size_pt=8.0,
    )


def _known(rows: pd.DataFrame, name: str, figure: Column) -> Array:
    """Return the figure of the flights that have it, in its unit."""
    values: Array = figure.scale * judged(rows, name, figure)
    return values[np.isfinite(values)]


def _change(value: float | None, first: float | None, digits: int) -> str:
    return "–" if value is None or first is None else signed(value - first, digits)


def _digits(figure: Column, values: Sequence[float | None]) -> int:
    """Return how many digits after the point show two of the least value: of 0.003 and 0.006, not
    0.00 and 0.01.
    """
    known = [abs(value) for value in values if value]
    if not known or not figure.digits:
        return figure.digits
    return max(figure.digits, min(_DIGITS_MAX, 1 - math.floor(math.log10(min(known)))))


def signed(value: float, digits: int) -> str:
    """Return a difference with its sign: 0 where it is none at all, and two digits of one that is
    smaller than ``digits`` show.
    """
    if value == 0.0:
        return "0"
    if abs(value) >= 0.5 * 10.0**-digits:
        return number(value, _pattern(digits, "+"))
    small = number(value, "{:+.2g}")
    mantissa, _, exponent = small.partition("e")
    return f"{mantissa}·{mark_text(10.0 ** int(exponent))}" if exponent else small


def _pattern(digits: int, sign: str = "") -> str:
    """Return how a figure is written; the median of counts may lie between two of them."""
    return f"{{:{sign},.{digits}f}}" if digits else f"{{:{sign},.9g}}"


def difference_table(pairs: Pairs, found: dict[str, Difference]) -> Table:
    """Return how figures differ between the flights of a pair, of those that do: median, its
    interval, least and greatest.
    """
    rows, bold = [], []
    for i, difference in enumerate(
        of for name, of in found.items() if name == "keepout_violations" or not of.is_none
    ):
        figure, known = difference.figure, difference.known
        both = np.isfinite(difference.change)
        medians = [
            float(np.median(values[both])) for values in (difference.before, difference.after)
        ]
        digits = _digits(figure, medians)
        interval = (
            f"{signed(difference.low, digits)} to {signed(difference.high, digits)}"
            if np.isfinite([difference.low, difference.high]).all()
            else "–"
        )
        rows.append([
            figure.row,
            f"{len(known):,}",
            *(number(median, _pattern(digits)) for median in medians),
            signed(difference.median, digits),
            interval,
            f"{signed(float(known.min()), digits)} to {signed(float(known.max()), digits)}",
            f"{count(known < 0.0):,}, {count(known > 0.0):,}",
        ])  # fmt: skip
        bold += [(i, 5)] if difference.excludes_zero else []
    first, other = pairs.first.letter, pairs.other.letter
    head = [
        "Figure", "Pairs", f"Median in {first}", f"in {other}", f"Median of {other} − {first}",
        "95 % interval",
        "Least to greatest", "Lower, higher",
    ]  # fmt: skip
    return Table(head=head, rows=rows, widths=[2.7, 0.6, 0.9, 0.8, 1.0, 1.5, 1.6, 0.9], bold=bold)


def changed(pairs: Pairs) -> Mask:
    """Return which flights met, kept out or completed in one run alone."""
    either: Mask = np.logical_or.reduce([pairs.no_longer, *pairs.in_other_alone.values()])
    return either


def _in_one_alone(pairs: Pairs, i: int) -> str:
    """Return what a flight is in one run alone: where it is met there, nothing else."""
    found = [
        f"{words} in {run.letter} alone"
        for run, states in (
            (pairs.first, pairs.in_first_alone),
            (pairs.other, pairs.in_other_alone),
        )
        for words, mask in states.items()
        if mask[i]
    ]
    met_alone = [words for words in found if words.startswith("met ")]
    return ", ".join(met_alone or found)


def changed_table(pairs: Pairs) -> Table | None:
    """Return the flights that met, kept out or completed in one run alone, those that are no longer
    met first; None without any.
    """
    worse, all_of_them = pairs.no_longer, changed(pairs)
    order = (pairs.no_longer_met, worse & ~pairs.no_longer_met, all_of_them & ~worse)
    places = [int(i) for mask in order for i in np.flatnonzero(mask)]
    if not places:
        return None
    first, other = pairs.first.letter, pairs.other.letter
    rows = [
        [
            pairs.names[i],
            _in_one_alone(pairs, i),
            ending(pairs.before.iloc[i]),
            ending(pairs.after.iloc[i]),
        ]
        for i in places[:LISTED_MAX]
    ]
    return Table(
        head=["Flight", "Criteria", f"How it ended in {first}", f"How it ended in {other}"],
        rows=rows,
        widths=[1.3, 1.1, 2.8, 3.4],
        left_columns=4,
        prose=True,
        breakable=True,
    )


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
    keys = [row[0] for table in configuration if isinstance(table, Table) for row in table.rows]
    differ = ", ".join(keys[:_NAMED_MAX]) + " and others" * (len(keys) > _NAMED_MAX)
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
        flown=f"{described}. What was set otherwise: {differ or 'nothing'}.",
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
            first = f"; the first {LISTED_MAX} are listed" if number > LISTED_MAX else ""
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
