"""The report of an arena: a reader ranks the laws at a glance, and sees how each was tuned."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from extensions.arena import ALL
from extensions.arena.paired_bootstrap import Estimate
from extensions.arena.record import (
    CROSSINGS,
    EFFORT,
    ERROR,
    MEASURING_FIGURES,
    PLUME_TIME,
    SULPHUR,
    TRACKING_FIGURES,
    Arena,
    Entrant,
    Figure,
    read_arena,
)
from reports.design.section import innerloop_section
from reports.document.blocks import Block, Card, Findings, Heading, Section, Table, Text, Verdict
from reports.document.chart import Chart, Line, Note, Panel, Style
from reports.document.palette import Meaning
from reports.document.ship_map import ship_panel
from reports.document.tables import number, outcome, parameter_blocks, parameter_value
from reports.flights.added import added_sections
from reports.flights.content import flights_content
from reports.flights.first_page import flights_in_words
from reports.flights.names import told_name
from reports.flights.trials.tables import nearest_cells
from reports.run.columns import column, flights_flown, lost, total
from reports.run.flight_config import flight_config
from reports.run.run_data import RunData
from reports.run.surroundings import surroundings
from reports.run.time_history import about_the_plume
from reports.run.trials import read_trials

_BOLD = (
    "In bold: the laws that may be the best, as the flights do not show with 95 % confidence that"
    " another is better (multiple comparisons with the best, by a paired bootstrap over starts"
    " and air). In brackets are 95 % intervals of the mean. A law that lacks flights which"
    " another flew is not compared: it is never in bold, it stands last, and beside its mean is"
    " of how many flights that is."
)

_TRACKING = (
    "Errors are distances to the oscillating reference, as the guidance has it, and the effort is"
    " the heading rate commanded, both over the end of each flight, settled or not; excess effort"
    " is what of it differs from the reference's own heading rate. Laws without feedback along"
    " the track, those on a tangent (M1), depend on where they start. The airspeed law, which is"
    " the same for all, keeps pace with the reference besides."
)

_STANDOFF = (
    "On a circle about the vessel the error is the distance to the circle. It closes in on its"
    " radius, on which the keep-out guard just need not act, once the law is near it."
)

_PLUME = (
    "Both tasks by what the mission is for: crossings of the plume's axis, time in the plume, and"
    " the distance from the funnel at which it was crossed. A law that tracks badly may cross as"
    " often as one that tracks well, but elsewhere and at times that nobody can predict."
)

_SULPHUR = (
    "The plume is the one that the exhaust makes: it rises, spreads, meanders and fluctuates."
    " Inside is where the concentration is above exp(-2) of that on the axis. Every law carries"
    " the same sniffer. The sulphur error is the standard uncertainty by noise of the fuel's"
    " sulphur content that a minute leaves, as the estimator states it: the inverse root of the"
    " mean information 1/σ², which adds up over minutes and flights, and is 0 of a result that is"
    " not admitted. Errors of the instrument that do not average out come on top, and are the"
    " same for every law."
)

_TUNING = (
    "Each law had the same number of settings to try, the default first, half of them spread"
    " evenly over the ranges and half by Nelder and Mead's simplex, which tries the best of these"
    " again, on flights of the kinematic vehicle with the aircraft's lag and with seeds that the"
    " comparison does not use. The cost is the rms error of the end of a flight and what the"
    " heading rate in excess of the reference's counts as."
)

_ONCE = (
    "One flight in each condition says nothing of other starts and other air: intervals have no"
    " width, and which law is best is not shown."
)
"""What is said of laws that were flown once in each condition."""

_NONE_BEST = "no law is called best, as each lacks flights"
"""What is said of a task in which no law is compared."""


def arena_content(run: RunData) -> Findings:
    """Return the findings of an arena."""
    arena = read_arena(run)
    if arena is None:
        # It was interrupted: there are flights, and nothing to rank.
        return flights_content(run)
    trials = {trial.key: trial for trial in read_trials(run)}

    def name(row: "pd.Series[Any]") -> str:
        return told_name(trials[row["trial"]], row)

    sections = [
        _section("conditions", "Conditions", "Conditions", [condition_table(arena)]),
        _section("tracking", "Tracking the oscillating reference", "Tracking", _tracking(arena)),
        _section("standoff", "Circling the vessel", "Circling", _standoff(arena)),
        _section("plume", "Measuring the plume", "Plume", _plume(arena)),
        _section(
            "tuning",
            "Tuning of each law",
            "Tuning",
            [Text(_TUNING), tuning_table(arena), *_refused(arena)],
        ),
        *added_sections(run, list(trials.values()), name),
        *([innerloop_section(run.innerloop)] if run.innerloop else []),
        _section("parameters", "Parameters", "Parameters", parameter_blocks(run)),
    ]
    both = len(arena.entrants) - len({entrant.law for entrant in arena.entrants})
    laws = f"{len(arena.entrants) - both} steering laws" + f", {both} of them in both tasks" * (
        both > 0
    )
    often = {1: "once", 2: "twice"}.get(arena.flights, f"{arena.flights} times")
    flown = (
        f"{laws}, each flown {often} in each of {len(arena.conditions)} conditions:"
        f" {flights_in_words(run, flights_flown(run.summary))}."
    )
    pictures = effort_charts(arena) if arena.in_task(tracking=True) else [crossing_chart(arena)]
    return Findings(flown=flown, verdict=_verdict(arena), picture=pictures[0], sections=sections)


def _section(anchor: str, title: str, nav_title: str, blocks: list[Block]) -> Section:
    return Section(anchor=anchor, title=title, nav_title=nav_title, blocks=blocks)


def _tracking(arena: Arena) -> list[Block]:
    if not arena.in_task(tracking=True):
        return []
    return [
        Text(_TRACKING),
        Heading("Over all conditions"),
        Text(_BOLD if arena.flights > 1 else _ONCE),
        tracking_table(arena, tracking=True),
        Heading("Tracking error by condition, rms [m]"),
        by_condition_table(arena, ERROR, tracking=True),
        *effort_charts(arena),
        *track_charts(arena, tracking=True),
    ]


def _standoff(arena: Arena) -> list[Block]:
    if not arena.in_task(tracking=False):
        return []
    return [
        Text(_STANDOFF),
        tracking_table(arena, tracking=False),
        Heading("Distance to the circle by condition, rms [m]"),
        by_condition_table(arena, ERROR, tracking=False),
        *track_charts(arena, tracking=False),
    ]


def _plume(arena: Arena) -> list[Block]:
    measured: list[Block] = [Text(_SULPHUR), worth_chart(arena)] if arena.has(SULPHUR) else []
    by_condition = [figure for figure in (CROSSINGS, PLUME_TIME, SULPHUR) if arena.has(figure)]
    return [
        Text(_PLUME),
        *measured,
        plume_table(arena),
        crossing_chart(arena),
        *(
            block
            for figure in by_condition
            for block in (
                Heading(f"{arena.figure(figure).column.row}, by condition"),
                by_condition_table(arena, figure),
            )
        ),
    ]


def _refused(arena: Arena) -> list[Block]:
    if not arena.refused:
        return []
    return [Heading("Laws that cannot do a task"), refused_table(arena)]


def _verdict(arena: Arena) -> Verdict:
    verdict, counts = arena.run.verdict, arena.run.verdict.counts
    violations, gone = counts.violated, counts.lost
    best = [
        (task, first)
        for task in (True, False)
        if (first := arena.best(ERROR, arena.in_task(tracking=task)))
    ]
    failures = _unflown(arena)
    if violations:
        laws = [
            entrant.title for entrant in arena.entrants if total(entrant.rows, "keepout_violations")
        ]
        failures.append(
            f"keep-out violations in {violations} of {counts.flown} flights: of {', '.join(laws)}"
        )
    if gone:
        laws = [entrant.title for entrant in arena.entrants if lost(entrant.rows).any()]
        failures.append(f"{gone} flights lost the aircraft: of {', '.join(laws)}")
    figures = [
        *(
            Card(
                f"{'Tracking' if task else 'Circling'} error, rms, of the best: {entrant.title}",
                f"{arena.text(ERROR, entrant)} m",
            )
            for task, entrant in best
        ),
        *(
            Card(
                f"Best on {arena.figure(figure).column.title.lower()}:"
                f" {_best_of(arena, first, figure)}",
                f"{arena.text(figure, first)}{arena.figure(figure).column.after}",
            )
            for figure in (CROSSINGS, SULPHUR)
            if (first := arena.best(figure, arena.entrants))
        ),
        Card(
            "Keep-out violations",
            f"{counts.keepout_violations:,}",
            "0",
            counts.flown > 0 and not violations,
        ),
        Card("Aircraft lost", f"{gone:,}", "0", counts.flown > 0 and not gone),
        Card(
            "Flights flown",
            f"{counts.flown:,} of {counts.planned:,}",
            "all",
            counts.flown == counts.planned,
        ),
        Card("Laws in a task", f"{len(arena.entrants)}"),
        Card(
            "Conditions, and flights of each law in each",
            f"{len(arena.conditions)} × {arena.flights}",
        ),
    ]
    return Verdict(
        holds=counts.flown > 0 and not violations and not gone,
        complete=verdict.is_done and counts.flown == counts.planned and not counts.unknown,
        headline=_headline(arena, best) if counts.flown else "Nothing was flown",
        detail="Means over all conditions, over the end of each flight."
        f" {_ONCE if arena.flights == 1 else _alike(arena, best)}",
        failures=failures,
        figures=figures,
    )


def _headline(arena: Arena, best: list[tuple[bool, Entrant]]) -> str:
    """Return which law is best in each task, or that none can be called so."""
    found, leads = dict(best), "is best" if arena.flights > 1 else "has the least error"
    words = [
        f"{'tracking' if task else 'circling'}: "
        + (
            f"{found[task].title} {leads}, {arena.text(ERROR, found[task])} m rms"
            if task in found
            else _NONE_BEST
        )
        for task in (True, False)
        if arena.in_task(tracking=task)
    ]
    headline = "; ".join(words)
    return headline[:1].upper() + headline[1:]


def _unflown(arena: Arena) -> list[str]:
    """Return a line for each law of which flights could not be flown: how many, and why the first
    of them could not.
    """
    lines = []
    for entrant in arena.entrants:
        rows, lacking = entrant.rows, entrant.unflown
        if len(lacking):
            compared = arena.of(ERROR, entrant, arena.together).whole
            apart = "" if compared or len(lacking) == len(rows) else ", and it is not compared"
            reasons = list(dict.fromkeys(outcome(row) for _, row in lacking.iterrows()))
            more = (
                f"; and for {len(reasons) - 1} other reason{'s' * (len(reasons) > 2)}"
                if len(reasons) > 1
                else ""
            )
            lines.append(
                f"{entrant.title}: {len(lacking)} of {len(rows)} flights could not be"
                f" flown{apart}: {reasons[0]}{more}"
            )
    return lines


def _alike(arena: Arena, best: list[tuple[bool, Entrant]]) -> str:
    """Return which laws the flights do not tell from the best of their task."""
    words = []
    for task, first in best:
        others = [
            entrant.title
            for entrant in arena.ranked(ERROR, arena.in_task(tracking=task))
            if entrant is not first and arena.of(ERROR, entrant, arena.together).as_good
        ]
        if others:
            words.append(f"The flights do not tell {' and '.join(others)} from {first.title}.")
    return " ".join(words)


def _best_of(arena: Arena, first: Entrant, figure: str) -> str:
    """Return the law with the best mean, and how many others have the same, as it is written."""
    mean = arena.text(figure, first)
    same = sum(
        of is not first
        and arena.of(figure, of, arena.together).whole
        and arena.text(figure, of) == mean
        for of in arena.entrants
    )
    return f"{first.title} and {same} more" if same else first.title


# ---------------------------------------------------------------- Tables


def condition_table(arena: Arena) -> Table:
    """Return the conditions, and which keys each sets."""
    given = arena.run.manifest["config"]["arena"]["conditions"]
    rows = [
        [str(of["name"]).replace("_", " "), of["title"], parameter_value(of["set"])] for of in given
    ]
    return Table(
        caption="The conditions, in each of which every law is flown, and the keys that each sets.",
        head=["Condition", "In words", "Keys"],
        rows=rows,
        widths=[1.0, 2.4, 5.0],
        left_columns=3,
        prose=True,
    )


def tracking_table(arena: Arena, *, tracking: bool) -> Table:
    """Return the figures of tracking of the laws of a task, over all conditions."""
    entrants = arena.ranked(ERROR, arena.in_task(tracking=tracking))
    head = [
        "No.",
        "Law",
        *(arena.figure(figure).column.row for figure in TRACKING_FIGURES),
        "Settled",
        "Settling, median [s]",
        "Keep-out violations",
    ]
    extra = [_ending(entrant) for entrant in entrants]
    what = "Tracking" if tracking else "Circling"
    widths = [0.4, 2.0, 1.75, 1.9, 1.9, 1.45, 0.85, 0.95, 0.95]
    return _table(
        arena,
        entrants,
        TRACKING_FIGURES,
        head,
        extra,
        widths=widths,
        caption=f"{what}, over all conditions.",
    )


def _ending(entrant: Entrant) -> list[str]:
    rows = entrant.rows
    settling = column(rows, "settling_time_s")
    known = settling[np.isfinite(settling)]
    return [
        f"{len(known)} of {len(rows)}",
        number(float(np.median(known)) if len(known) else None, "{:.0f}"),
        str(total(rows, "keepout_violations")),
    ]


def plume_table(arena: Arena) -> Table:
    """Return the figures of measuring the plume of every law, over all conditions."""
    entrants = arena.ranked(CROSSINGS, arena.entrants)
    figures = [figure for figure in MEASURING_FIGURES if arena.has(figure)]
    head = [
        "No.",
        "Law",
        "Task",
        *(arena.figure(figure).column.row for figure in figures),
        "Closest approach [m]",
        "Keep-out violations",
    ]
    extra = [
        [_closest(entrant), str(total(entrant.rows, "keepout_violations"))] for entrant in entrants
    ]
    tasks = [["tracks" if entrant.tracks else "circles"] for entrant in entrants]
    widths = [0.4, 2.0, 0.6, *(2.4 if figure == SULPHUR else 1.7 for figure in figures), 0.9, 0.95]
    caption = "Measuring the plume, over all conditions."
    return _table(
        arena, entrants, figures, head, extra, widths=widths, caption=caption, before=tasks
    )


def _closest(entrant: Entrant) -> str:
    return nearest_cells(entrant.rows)[0]


def _table(
    arena: Arena,
    entrants: Sequence[Entrant],
    figures: Sequence[str],
    head: list[str],
    extra: Sequence[list[str]],
    *,
    widths: list[float],
    caption: str,
    before: Sequence[list[str]] = (),
) -> Table:
    rows, bold = [], []
    for i, entrant in enumerate(entrants):
        found = [(figure, arena.of(figure, entrant, arena.together)) for figure in figures]
        ahead = [str(entrant.number), entrant.title, *(before[i] if before else [])]
        means = [
            _interval(estimate, arena.figure(figure)) + few(arena, estimate, arena.together)
            for figure, estimate in found
        ]
        rows.append([*ahead, *means, *extra[i]])
        bold += [
            (i, len(ahead) + j)
            for j, (_, estimate) in enumerate(found)
            if arena.flights > 1 and estimate.as_good
        ]
    left = 3 if before else 2
    return Table(
        head=head,
        rows=rows,
        widths=widths,
        left_columns=left,
        bold=bold,
        print_size_pt=6.4,
        breakable=True,
        caption=caption,
    )


def _interval(estimate: Estimate, figure: Figure) -> str:
    mean, low, high = (figure.text(value) for value in (estimate.mean, estimate.low, estimate.high))
    return mean if math.isnan(estimate.low) else f"{mean} ({low}\N{EN DASH}{high})"


def few(arena: Arena, estimate: Estimate, condition: str) -> str:
    """Return of how many flights a mean is, to stand beside it: nothing where it is of all, or
    there is none.
    """
    planned = arena.flights_of(condition)
    return f", {estimate.flights} of {planned}" if 0 < estimate.flights < planned else ""


def by_condition_table(arena: Arena, figure: str, *, tracking: bool | None = None) -> Table:
    """Return a figure by condition, a row for each law: of a task, or of both.

    Parameters
    ----------
    figure : which
    tracking : which task; both if it is None
    """
    members = arena.entrants if tracking is None else arena.in_task(tracking=tracking)
    entrants = arena.ranked(figure, members)
    conditions = [*arena.conditions, *([ALL] if len(arena.conditions) > 1 else [])]
    written = arena.figure(figure).text
    rows, bold = [], []
    for i, entrant in enumerate(entrants):
        found = [arena.of(figure, entrant, condition) for condition in conditions]
        few_of = [
            few(arena, estimate, condition)
            for estimate, condition in zip(found, conditions, strict=True)
        ]
        means = [
            written(estimate.mean) + words for estimate, words in zip(found, few_of, strict=True)
        ]
        rows.append([str(entrant.number), entrant.title, *means])
        bold += [
            (i, 2 + j) for j, estimate in enumerate(found) if arena.flights > 1 and estimate.as_good
        ]
    if figure == CROSSINGS and arena.limits:
        most = [written(arena.limits.get(condition, math.nan)) for condition in conditions]
        rows.append(["", "limit of any path", *most])
    head = ["No.", "Law", *(condition.replace("_", " ") for condition in conditions)]
    widths = [0.4, 2.4, *(1.0 for _ in conditions)]
    return Table(head=head, rows=rows, widths=widths, left_columns=2, bold=bold, breakable=True)


def tuning_table(arena: Arena) -> Table:
    """Return the tuning of each law: what it makes use of, its parameters, and what either set costs
    the tuner.
    """
    rows = []
    for entrant in arena.entrants:
        tuned = entrant.tuned
        parameters = ", ".join(
            f"{key} {value:.3g} → {tuned.get(key, value):.3g}"
            for key, value in entrant.defaults.items()
        )
        before, after = (
            number(cost, "{:.2f}") for cost in (entrant.cost_default, entrant.cost_tuned)
        )
        costs = f"{before} → {after}"
        rows.append(
            [str(entrant.number), entrant.title, entrant.inputs, parameters or "none", costs]
        )
    head = ["No.", "Law", "What it makes use of", "Parameters: default → tuned", "Cost [m]"]
    return Table(
        caption="What each law makes use of, its parameters, and what either set costs the tuner.",
        head=head,
        rows=rows,
        widths=[0.4, 1.6, 2.7, 3.4, 1.2],
        left_columns=5,
        prose=True,
        breakable=True,
        print_size_pt=6.4,
    )


def refused_table(arena: Arena) -> Table:
    """Return which laws do not take part in a task, by the reason."""
    tasks = {"tracking": "track the oscillation", "standoff": "circle the vessel"}
    laws: dict[tuple[str, str], list[str]] = {}
    for entry in arena.refused:
        laws.setdefault((tasks.get(entry["task"], entry["task"]), entry["reason"]), []).append(
            entry["law"].replace("_", " ")
        )
    rows = [[task, ", ".join(names), reason] for (task, reason), names in laws.items()]
    head = ["Cannot", "Laws", "because"]
    return Table(
        head=head, rows=rows, widths=[1.2, 3.0, 3.0], left_columns=3, prose=True, breakable=True
    )


# ---------------------------------------------------------------- Figures

_FAMILIES: tuple[tuple[str, str, Style], ...] = (
    ("with the reference's turn fed forward", "blue", "points"),
    ("without it, on its tangent or circle (M1, M2)", "green", "diamonds"),
    ("without it, at its place (M3)", "orange", "square"),
    ("it does not say what it makes use of", "grey", "cross"),
)
"""What a law makes use of, and the colour and style of its mark."""

_WORD = (0.04, 0.03)
"""Width and height of a law's number, over those of a panel as wide as the page."""

_LETTER, _OFF = 0.25, 0.35
"""Width of a letter, and distance of a number from its mark, over the width of a law's number."""

_MAPS = 6
"""Tracks in a figure, in three columns: two such figures fill a page."""

_SHOWN_S = 120.0
"""End of a flight that is drawn [s]."""

_BEYOND = 1.08
"""Largest abscissa that is drawn, over the largest mark."""


def effort_charts(arena: Arena) -> list[Chart]:
    """Return tracking error against control effort with one mark a law: over all conditions, and a
    panel for each.
    """
    entrants = arena.in_task(tracking=True)
    together = Chart(
        name="effort",
        caption="Distance to the oscillating reference against the heading rate commanded, each"
        " as its root mean square over the end of the flights, settled or not; a mark a law,"
        " numbered as in the tables. Down and to the left is better. What tracks the reference"
        " exactly needs the reference's own heading rate.",
        panels=[_effort_panel(arena, entrants, arena.together, _WORD)],
        panel_height=0.5,
    )
    if len(arena.conditions) == 1:
        return [together]
    each = Chart(
        name="efforts",
        caption="The same for each condition.",
        panels=[
            _effort_panel(arena, entrants, condition, (3.0 * _WORD[0], 2.0 * _WORD[1]))
            for condition in arena.conditions
        ],
        columns=3,
        panel_height=0.34,
    )
    return [together, each]


def _effort_panel(
    arena: Arena, entrants: Sequence[Entrant], condition: str, word: tuple[float, float]
) -> Panel:
    """Return a mark a law; of those that are nearer to each other than ``word``, over the panel's
    sizes, numbers are together.
    """
    efforts = {entrant.name: arena.of(EFFORT, entrant, condition).mean for entrant in entrants}
    errors = {
        entrant.name: math.log10(max(arena.of(ERROR, entrant, condition).mean, 1e-3))
        for entrant in entrants
    }
    lines, notes = [], []
    for label, colour, style in _FAMILIES:
        members = [entrant for entrant in entrants if _family(entrant) == label]
        x, y = (
            np.array([values[entrant.name] for entrant in members]) for values in (efforts, errors)
        )
        if members:
            lines.append(Line(x=x, y=y, label=label, colour=colour, style=style))
    known = [value for value in errors.values() if math.isfinite(value)] or [0.0]
    low, high = math.floor(min(known) - 0.1), math.ceil(max(known) + 0.1)
    reach = [value for value in efforts.values() if math.isfinite(value)] or [0.0]
    span = max(reach) - min(reach) or 0.1
    marks = {
        entrant.number: (efforts[entrant.name] / (1.16 * span), errors[entrant.name] / (high - low))
        for entrant in entrants
    }
    for numbers, (x_mark, y_mark) in clusters(marks, word):
        text = ", ".join(map(str, numbers))
        off, width, height = _OFF * word[0], _LETTER * word[0] * len(text), (high - low) * y_mark
        # To the left of its marks where there is no room to the right.
        if 1.16 * span * (x_mark + off + width) <= max(reach) + 0.1 * span:
            notes.append(Note(x=1.16 * span * (x_mark + off), y=height, text=text, align="left"))
        else:
            first = min(marks[mark][0] for mark in numbers)
            notes.append(Note(x=1.16 * span * (first - off), y=height, text=text, align="right"))
    return Panel(
        x_label="Heading rate, rms [rad/s]",
        y_label="Tracking error, rms [m]",
        title=_title(condition),
        lines=lines,
        notes=notes,
        x_range=(min(reach) - 0.06 * span, max(reach) + 0.1 * span),
        y_range=(float(low), float(high)),
        y_names=[(float(decade), f"{10.0**decade:g}") for decade in range(low, high + 1)],
    )


def clusters(
    marks: Mapping[int, tuple[float, float]], word: tuple[float, float]
) -> Iterator[tuple[list[int], tuple[float, float]]]:
    """Yield marks whose numbers would hide each other, together: their numbers, and the place of
    their words.

    Parameters
    ----------
    marks : place of each by its number, over the width and the height of the panel; some may be not
        a number
    word : width and height of a number, as the places
    """
    left = sorted(
        (mark for mark, place in marks.items() if all(map(math.isfinite, place))),
        key=lambda mark: marks[mark][1],
    )
    while left:
        cluster = [left.pop(0)]
        for mark in list(left):
            if any(_near(marks[mark], marks[other], word) for other in cluster):
                cluster.append(mark)
                left.remove(mark)
        x, y = zip(*(marks[mark] for mark in cluster), strict=True)
        yield sorted(cluster), (max(x), sum(y) / len(y))


def _near(one: tuple[float, float], other: tuple[float, float], word: tuple[float, float]) -> bool:
    return all(abs(a - b) < size for a, b, size in zip(one, other, word, strict=True))


def _title(condition: str) -> str:
    """Return the name of a condition in words."""
    return (
        "All conditions"
        if condition == ALL
        else condition[:1].upper() + condition[1:].replace("_", " ")
    )


def _family(entrant: Entrant) -> str:
    forward, tangent, place, unknown = (label for label, _, _ in _FAMILIES)
    if "turn rate" in entrant.inputs or "curvature" in entrant.inputs:
        return forward
    if "M1" in entrant.inputs or "M2" in entrant.inputs:
        return tangent
    return place if "M3" in entrant.inputs else unknown


def crossing_chart(arena: Arena) -> Chart:
    """Return the crossings per minute of every law, a panel for each condition, with the limit
    where it is known.
    """
    entrants = arena.ranked(CROSSINGS, arena.entrants)
    reach = _BEYOND * max(_most(arena, CROSSINGS, arena.conditions), *arena.limits.values(), 0.0)
    panels = [
        _merit_panel(arena, entrants, CROSSINGS, condition, reach=reach, named=i == 0)
        for i, condition in enumerate(arena.conditions)
    ]
    limit = (
        " The dashed line is the most that any path allows at these speed ratios."
        if arena.limits
        else ""
    )
    return Chart(
        name="crossings",
        caption="Plume crossings per minute over the end of the flights; a mark is a law's"
        f" mean{_interval_words(arena)}.{limit}",
        panels=panels,
        columns=len(panels),
        panel_height=0.1 + 0.025 * len(entrants),
    )


def worth_chart(arena: Arena) -> Chart:
    """Return what a minute of every law is worth to the measurement, over all conditions."""
    entrants = arena.ranked(SULPHUR, arena.entrants)
    figures = (SULPHUR, PLUME_TIME, CROSSINGS)
    reaches = [_BEYOND * _most(arena, figure, [arena.together]) for figure in figures]
    panels = [
        _merit_panel(arena, entrants, figure, arena.together, reach=reach, named=figure == SULPHUR)
        for figure, reach in zip(figures, reaches, strict=True)
    ]
    return Chart(
        name="worth",
        caption="What a minute is worth, over all conditions: the standard uncertainty by noise"
        " that the fuel's sulphur content is left with after it, the time that it has in the"
        f" plume, and its crossings. A mark is a law's mean{_interval_words(arena)}. The best on"
        " the sulphur content come first.",
        panels=panels,
        columns=len(panels),
        panel_height=0.1 + 0.025 * len(entrants),
    )


def _merit_panel(
    arena: Arena,
    entrants: Sequence[Entrant],
    figure: str,
    condition: str,
    *,
    reach: float,
    named: bool,
) -> Panel:
    rows = {entrant.name: float(len(entrants) - 1 - i) for i, entrant in enumerate(entrants)}
    lines: list[Line] = []
    for tracking, label, colour in (
        (True, "tracks the oscillating reference", "blue"),
        (False, "circles the vessel", "orange"),
    ):
        members = [entrant for entrant in entrants if entrant.tracks == tracking]
        found = [arena.of(figure, entrant, condition) for entrant in members]
        x = np.array([value for of in found for value in (of.low, of.high, math.nan)])
        y = np.array([rows[entrant.name] for entrant in members for _ in range(3)])
        if members:
            places = np.array([rows[entrant.name] for entrant in members])
            lines += [
                Line(x=x, y=y, label="", colour=colour),
                Line(
                    x=np.array([of.mean for of in found]),
                    y=places,
                    label=label,
                    colour=colour,
                    style="points",
                ),
            ]
    ends = np.array([-0.7, len(entrants) - 0.3])
    if figure == CROSSINGS and (most := arena.limits.get(condition)) is not None:
        lines.append(
            Line(
                x=np.array([most, most]),
                y=ends,
                label="limit of any path",
                colour=Meaning.LIMIT,
                style="dash",
            )
        )
    names = [
        (rows[entrant.name], f"{entrant.title} {entrant.number}" if named else "")
        for entrant in entrants
    ]
    return Panel(
        x_label=arena.figure(figure).column.row,
        y_label="Law" if named else "",
        title="" if condition == arena.together else _title(condition),
        lines=lines,
        x_range=(0.0, reach or 1.0),
        y_names=names,
        y_range=(float(ends[0]), float(ends[1])),
    )


def _most(arena: Arena, figure: str, conditions: Iterable[str]) -> float:
    """Return the largest value of a figure that is drawn."""
    found = [
        arena.of(figure, entrant, condition)
        for condition in conditions
        for entrant in arena.entrants
    ]
    # A mean of too few flights has no interval.
    return max(
        (value for of in found for value in (of.mean, of.high) if math.isfinite(value)), default=0.0
    )


def track_charts(arena: Arena, *, tracking: bool) -> list[Chart]:
    """Return the end of the first flight of each law in the first condition, seen from the vessel
    with its plume up the page.
    """
    ranked = arena.ranked(ERROR, arena.in_task(tracking=tracking))
    panels = [
        panel
        for entrant in ranked
        if (panel := _track_panel(arena, entrant, tracking=tracking)) is not None
    ]
    first = next(iter(arena.conditions.values()), "")
    what = "The oscillating reference tracked" if tracking else "The vessel circled"
    caption = (
        f"{what}: the last {_SHOWN_S:g} s of one flight a law, the same start for all; condition:"
        f" {first}. Seen from the ship, to scale, with her plume up the page. The best on the"
        " tracking error come first."
    )
    return [
        Chart(
            name=f"{'tracks' if tracking else 'circles'}{i // _MAPS + 1}",
            caption=caption if not i else f"{what} by the laws that come next, in the same flight.",
            panels=panels[i : i + _MAPS],
            columns=3,
            panel_height=0.33,
        )
        for i in range(0, len(panels), _MAPS)
    ]


def _track_panel(arena: Arena, entrant: Entrant, *, tracking: bool) -> Panel | None:
    first = next(iter(arena.conditions))
    flown = [row for _, row in entrant.rows.iterrows() if row["trial"] == first]
    row = next((row for row in flown if arena.run.has_history(str(row["flight_id"]))), None)
    history = None if row is None else arena.run.history(str(row["flight_id"]))
    if row is None or history is None:
        return None
    time = column(history, "time_s")
    shown = history[time >= time[-1] - _SHOWN_S]
    about = surroundings(flight_config(arena.run, row), row, shown)
    reference, own = about_the_plume(shown, "reference_"), about_the_plume(shown)
    lines = [
        Line(x=own[0], y=own[1], label="flown", colour=Meaning.FLOWN),
        Line(x=reference[0], y=reference[1], label="reference", colour=Meaning.ASKED, style="thin"),
    ]
    # The same part of the plume for every law, however far from it one is.
    middle, half = (
        (1.3 * about.radius, 0.8 * about.radius) if tracking else (0.0, 1.6 * about.radius)
    )
    return ship_panel(
        about, lines, title=f"{entrant.number} {entrant.title}", shown=[_square(middle, half)]
    )


def _square(middle: float, half: float) -> Line:
    """Return what a panel has to show: a square about a place on the plume's axis."""
    return Line(
        x=np.array([-half, half]),
        y=np.array([middle - half, middle + half]),
        label="",
        colour=Meaning.PLUME,
    )


def _interval_words(arena: Arena) -> str:
    """Return what is drawn beside a mean: of one flight in each condition there is no interval."""
    return ", with its 95 % interval" if arena.flights > 1 else ""
