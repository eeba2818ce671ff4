"""The report of an arena: a reader ranks the laws at a glance, and sees how each was tuned."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
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
from reports.design.section import design_words
from reports.document.blocks import (
    Block,
    Card,
    Findings,
    Fold,
    Heading,
    Section,
    Table,
    Text,
    Verdict,
)
from reports.document.chart import Chart, Line, Note, Panel, Style
from reports.document.palette import Meaning
from reports.document.parameters import parameter_blocks, parameter_value
from reports.document.ship_map import ship_panel
from reports.document.state import state_words
from reports.document.tables import (
    Cell,
    number,
    outcome,
    rows_table,
)
from reports.flights.added import added_sections
from reports.flights.content import flights_content
from reports.flights.first_page import flights_in_words
from reports.flights.names import name_in_run
from reports.flights.trials.tables import nearest_cells
from reports.run.columns import Array, column, flights_flown, lost, total
from reports.run.flight_config import flight_config
from reports.run.run_data import RunData
from reports.run.surroundings import surroundings
from reports.run.time_history import about_the_plume
from reports.run.trials import read_trials

_BOLD = (
    "Bold: no flight shows with 95 % confidence that another law is better (multiple comparisons"
    " with the best, by a paired bootstrap over starts and air). Brackets: 95 % interval of the"
    " mean. A law that lacks flights which another flew is not compared and stands last; beside its"
    " mean stands the number of its flights."
)

_TRACKING = (
    "Error: distance to the oscillating reference. Effort: heading rate commanded. Both over the"
    " end of each flight, settled or not. Excess effort is what differs from the reference's"
    " heading rate. Laws on a tangent (M1) have no feedback along the track, so that their errors"
    " depend on the start. The airspeed law is the same for all."
)

_STANDOFF = (
    "Error: distance to the circle about the vessel. Near the circle a law closes in on the radius"
    " on which the keep-out guard just need not act."
)

_PLUME = (
    "Both tasks, by what the mission is for. A law that tracks badly may cross as often as one that"
    " tracks well, but elsewhere and at times that nobody can predict."
)

_SULPHUR = (
    "The simulated plume rises, spreads, meanders and fluctuates; inside is where the concentration"
    " is above exp(-2) of that on the axis. Every law carries the same sniffer. The sulphur error"
    " of a minute is the standard uncertainty by noise that the estimator states: the inverse root"
    " of the mean information 1/σ². A result that is not admitted has none. Errors that do not"
    " average out come on top, and are the same for every law."
)

_TUNING = (
    "Each law had the same number of settings to try: the default first, half of them spread evenly"
    " over the ranges, half by Nelder and Mead's simplex, on flights of the kinematic vehicle with"
    " the aircraft's lag and with seeds that the comparison does not use. The cost is the rms error"
    " of the end of a flight, and what the excess effort counts as."
)

_ONCE = (
    "One flight in each condition says nothing of other starts and other air: there are no"
    " intervals, and no law can be told from the others."
)
"""What is said of laws that were flown once in each condition."""


def arena_content(run: RunData) -> Findings:
    """Return the findings of an arena."""
    arena = read_arena(run)
    if arena is None:
        # It was interrupted: there are flights, and nothing to rank.
        return flights_content(run)
    trials = {trial.key: trial for trial in read_trials(run)}

    def name(row: "pd.Series[Any]") -> str:
        return name_in_run(trials[row["trial"]], row)

    sections = [
        _section("conditions", "Conditions", "Conditions", [condition_table(arena)]),
        _section("tracking", "Tracking the oscillating reference", "Tracking", _tracking(arena)),
        _section("standoff", "Circling the vessel", "Circling", _standoff(arena)),
        _section("plume", "Measuring the plume", "Plume", _plume(arena)),
        _section("tuning", "Tuning of each law", "Tuning", _tuned(arena)),
        *added_sections(run, list(trials.values()), name),
        _section(
            "parameters",
            "Parameters",
            "Parameters",
            [*parameter_blocks(run), *design_words(run)],
        ),
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
    tracked = bool(arena.in_task(tracking=True))
    picture = effort_chart(arena) if tracked else merit_chart(arena, [CROSSINGS])
    return Findings(flown=flown, verdict=_verdict(arena), picture=picture, sections=sections)


def _section(anchor: str, title: str, nav_title: str, blocks: list[Block]) -> Section:
    return Section(anchor=anchor, title=title, nav_title=nav_title, blocks=blocks)


def _tracking(arena: Arena) -> list[Block]:
    if not arena.in_task(tracking=True):
        return []
    tracks = track_charts(arena, tracking=True)
    return [
        Text(f"{_TRACKING} {_BOLD if arena.flights > 1 else _ONCE}"),
        tracking_table(arena, tracking=True),
        *tracks[:1],
        Fold(
            title="Tracking by condition, and the tracks of the other laws",
            blocks=[by_condition_table(arena, ERROR, tracking=True), *tracks[1:]],
        ),
    ]


def _standoff(arena: Arena) -> list[Block]:
    if not arena.in_task(tracking=False):
        return []
    return [
        Text(_STANDOFF),
        tracking_table(arena, tracking=False),
        Fold(
            title="Circling by condition, and the tracks of the laws",
            blocks=[
                by_condition_table(arena, ERROR, tracking=False),
                *track_charts(arena, tracking=False),
            ],
        ),
    ]


def _plume(arena: Arena) -> list[Block]:
    figures = [figure for figure in (SULPHUR, PLUME_TIME, CROSSINGS) if arena.has(figure)]
    by_condition = [by_condition_table(arena, figure) for figure in figures]
    return [
        Text(f"{_PLUME} {_SULPHUR}" if SULPHUR in figures else _PLUME),
        *([merit_chart(arena, figures)] if figures else []),
        plume_table(arena),
        Fold(title="Measuring the plume, by condition", blocks=by_condition),
    ]


def _tuned(arena: Arena) -> list[Block]:
    table = Fold(title="Parameters of each law", blocks=[tuning_table(arena)])
    if not arena.refused:
        return [Text(_TUNING), table]
    return [Text(_TUNING), table, Heading("Laws that cannot do a task"), refused_table(arena)]


def _verdict(arena: Arena) -> Verdict:
    verdict, counts = arena.run.verdict, arena.run.verdict.counts
    violations, gone = counts.violated, counts.lost
    failures = _unflown(arena)
    if violations:
        failures.append(
            _VIOLATED.format(
                flights=violations,
                flown=counts.flown,
                laws=_laws_with(arena, lambda rows: total(rows, "keepout_violations") > 0),
            )
        )
    if gone:
        laws = _laws_with(arena, lambda rows: bool(lost(rows).any()))
        failures.append(_GONE.format(flights=gone, laws=laws))
    state = state_words(
        "flights",
        counts.flown,
        counts.planned,
        is_done=verdict.is_done and counts.flown == counts.planned,
        interrupted=verdict.interrupted,
    )
    return Verdict(
        holds=counts.flown > 0 and not violations and not gone,
        complete=not state and not counts.unknown,
        headline=". ".join([*state, _headline(arena) if counts.flown else "Nothing was flown"]),
        detail=_DETAIL + (_ONCE if arena.flights == 1 else _APART),
        failures=failures,
        figures=_cards(arena),
    )


_VIOLATED = "keep-out violations in {flights} of {flown} flights: of {laws}"
_GONE = "{flights} flights lost the aircraft: of {laws}"
_DETAIL = "Means over all conditions, over the end of each flight. "
_APART = (
    "Two laws can be told apart if the paired bootstrap shows with 95 % confidence that one is"
    " better, and if their intervals do not overlap."
)


def _laws_with(arena: Arena, has: Callable[[pd.DataFrame], bool]) -> str:
    return ", ".join(entrant.title for entrant in arena.entrants if has(entrant.rows))


def _cards(arena: Arena) -> list[Card]:
    """Return the best mean of each figure with the laws that cannot be told from it, and what must
    not happen.
    """
    counts = arena.run.verdict.counts
    figures = [
        ("Tracking error", ERROR, arena.in_task(tracking=True)),
        ("Circling error", ERROR, arena.in_task(tracking=False)),
        *(
            (arena.figure(figure).column.title, figure, arena.entrants)
            for figure in (CROSSINGS, SULPHUR)
        ),
    ]
    best = [
        Card(
            f"{title}, best mean: {_few_of(alike)}",
            f"{arena.text(figure, alike[0])}{arena.figure(figure).column.after}",
            _interval_of(arena, figure, alike[0]),
        )
        for title, figure, entrants in figures
        if (alike := arena.alike(figure, entrants))
    ]
    flown = counts.flown > 0
    return [
        *best,
        Card(
            "Keep-out violations",
            f"{counts.keepout_violations:,}",
            "0",
            flown and not counts.violated,
        ),
        Card("Aircraft lost", f"{counts.lost:,}", "0", flown and not counts.lost),
    ]


def _few_of(alike: Sequence[Entrant]) -> str:
    """Return the first of some laws, and how many cannot be told from it."""
    more = len(alike) - 1
    return f"{alike[0].title}, and {more} alike" if more else alike[0].title


def _interval_of(arena: Arena, figure: str, entrant: Entrant) -> str:
    of, text = arena.of(figure, entrant, arena.together), arena.figure(figure).text
    return "" if math.isnan(of.low) else f"95 %: {text(of.low)} to {text(of.high)}"


_NAMED = 3
"""Laws that the headline names of those that cannot be told apart."""

_TASKS = {True: "Tracking", False: "Circling"}

_WHICH = {
    "none": "{task}: no law is compared, as each lacks flights",
    "only": "{task}: only {first} is compared, {error} m rms",
    "best": "{task}: {first} is best, {error} m rms",
    "alike": "{task}: {laws} cannot be told apart, {error} m rms",
}
"""What the headline says of a task."""


def _headline(arena: Arena) -> str:
    """Return for each task which laws cannot be told from the best."""
    return "; ".join(
        _which(arena, title, entrants)
        for tracking, title in _TASKS.items()
        if (entrants := arena.in_task(tracking=tracking))
    )


def _which(arena: Arena, task: str, entrants: Sequence[Entrant]) -> str:
    alike = arena.alike(ERROR, entrants)
    if not alike:
        return _WHICH["none"].format(task=task)
    first, errors = alike[0].title, [arena.text(ERROR, entrant) for entrant in alike]
    if len(alike) == 1:
        kind = "only" if arena.compared(ERROR, entrants) == 1 else "best"
        return _WHICH[kind].format(task=task, first=first, error=errors[0])
    if len(alike) > _NAMED:
        laws = f"{first} and {len(alike) - 1} others"
    else:
        laws = " and ".join(entrant.title for entrant in alike)
    return _WHICH["alike"].format(task=task, laws=laws, error=f"{errors[0]} to {errors[-1]}")


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


# ---------------------------------------------------------------- Tables


def condition_table(arena: Arena) -> Table:
    """Return the conditions, and which keys each sets."""
    cells = [
        Cell("Condition", lambda of: str(of["name"]).replace("_", " ")),
        Cell("In words", "title", width=2.4),
        Cell("Keys", lambda of: parameter_value(of["set"]), width=5.0),
    ]
    return rows_table(
        arena.run.manifest["config"]["arena"]["conditions"],
        cells,
        caption="The conditions, in each of which every law is flown, and the keys that each sets.",
        left_columns=3,
        prose=True,
    )


_NUMBER = Cell("No.", lambda entrant: str(entrant.number), width=0.4)


def _violations(arena: Arena) -> list[Cell]:
    """Return the column of keep-out violations, where there are any."""
    if not arena.run.verdict.counts.keepout_violations:
        return []
    name = "Keep-out violations"
    return [Cell(name, lambda entrant: str(total(entrant.rows, "keepout_violations")))]


def _law(width: float) -> Cell:
    return Cell("Law", lambda entrant: entrant.title, width=width)


def tracking_table(arena: Arena, *, tracking: bool) -> Table:
    """Return the figures of tracking of the laws of a task, over all conditions."""
    means = _means(arena, TRACKING_FIGURES, arena.together, (2.0, 2.0, 2.0, 1.6))
    cells = [
        Cell("Settled", lambda entrant: f"{len(_settling(entrant))} of {len(entrant.rows)}"),
        Cell("Settling, median [s]", _settled_at, "{:.0f}", 0.9),
        *_violations(arena),
    ]
    entrants = arena.ranked(ERROR, arena.in_task(tracking=tracking))
    return _ranked_table(
        arena,
        entrants,
        [_NUMBER, _law(2.2)],
        dict(zip(TRACKING_FIGURES, means, strict=True)),
        cells,
        caption=f"{_TASKS[tracking]}, over all conditions.",
    )


def _settling(entrant: Entrant) -> Array:
    times = column(entrant.rows, "settling_time_s")
    return times[np.isfinite(times)]


def _settled_at(entrant: Entrant) -> float | None:
    times = _settling(entrant)
    return float(np.median(times)) if len(times) else None


def plume_table(arena: Arena) -> Table:
    """Return the figures of measuring the plume of every law, over all conditions."""
    figures = [figure for figure in MEASURING_FIGURES if arena.has(figure)]
    widths = [2.6 if figure == SULPHUR else 1.9 for figure in figures]
    means = _means(arena, figures, arena.together, widths)
    task = Cell("Task", lambda entrant: "tracks" if entrant.tracks else "circles", width=0.6)
    closest = Cell(
        "Closest approach [m]", lambda entrant: nearest_cells(entrant.rows)[0], width=0.9
    )
    return _ranked_table(
        arena,
        arena.ranked(CROSSINGS, arena.entrants),
        [_NUMBER, _law(2.3), task],
        dict(zip(figures, means, strict=True)),
        [closest, *_violations(arena)],
        caption="Measuring the plume, over all conditions.",
    )


def _means(
    arena: Arena, figures: Sequence[str], condition: str, widths: Sequence[float]
) -> list[Cell]:
    """Return a column for the mean of each figure, with its interval."""

    def cell(figure: str, width: float) -> Cell:
        of = arena.figure(figure)

        def text(entrant: Entrant) -> str:
            estimate = arena.of(figure, entrant, condition)
            return _interval(estimate, of) + few(arena, estimate, condition)

        return Cell(of.column.row, text, width=width)

    return [cell(figure, width) for figure, width in zip(figures, widths, strict=True)]


def _ranked_table(
    arena: Arena,
    entrants: Sequence[Entrant],
    before: Sequence[Cell],
    means: Mapping[str, Cell],
    after: Sequence[Cell],
    *,
    caption: str,
) -> Table:
    """Return a row for each law, with those means in bold that may be the best."""
    bold = [
        (i, len(before) + j)
        for i, entrant in enumerate(entrants)
        for j, figure in enumerate(means)
        if arena.flights > 1 and arena.of(figure, entrant, arena.together).as_good
    ]
    return rows_table(
        entrants,
        [*before, *means.values(), *after],
        left_columns=len(before),
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
    return Table(
        head=head,
        rows=rows,
        widths=widths,
        left_columns=2,
        bold=bold,
        breakable=True,
        caption=f"{arena.figure(figure).column.row}, by condition.",
    )


def tuning_table(arena: Arena) -> Table:
    """Return the tuning of each law: what it makes use of, its parameters, and what either set
    costs the tuner.
    """

    def parameters(entrant: Entrant) -> str:
        pairs = (
            f"{key} {value:.3g} → {entrant.tuned.get(key, value):.3g}"
            for key, value in entrant.defaults.items()
        )
        return ", ".join(pairs) or "none"

    def costs(entrant: Entrant) -> str:
        found = (entrant.cost_default, entrant.cost_tuned)
        return " → ".join(number(cost, "{:.2f}") for cost in found)

    cells = [
        _NUMBER,
        _law(1.6),
        Cell("What it makes use of", lambda entrant: entrant.inputs, width=2.7),
        Cell("Parameters: default → tuned", parameters, width=3.4),
        Cell("Cost [m]", costs, width=1.2),
    ]
    return rows_table(
        arena.entrants,
        cells,
        caption="What each law makes use of, its parameters, and what either set costs the tuner.",
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


def effort_chart(arena: Arena) -> Chart:
    """Return tracking error against control effort over all conditions, with one mark a law."""
    entrants = arena.in_task(tracking=True)
    return Chart(
        name="effort",
        caption=_EFFORT,
        panels=[_effort_panel(arena, entrants, arena.together, _WORD)],
        panel_height=0.5,
    )


_EFFORT = (
    "Distance to the oscillating reference against the heading rate commanded, each as its root"
    " mean square over the end of the flights, settled or not; a mark a law, numbered as in the"
    " tables. Down and to the left is better. What tracks the reference exactly needs the"
    " reference's own heading rate."
)


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


def _family(entrant: Entrant) -> str:
    forward, tangent, place, unknown = (label for label, _, _ in _FAMILIES)
    if "turn rate" in entrant.inputs or "curvature" in entrant.inputs:
        return forward
    if "M1" in entrant.inputs or "M2" in entrant.inputs:
        return tangent
    return place if "M3" in entrant.inputs else unknown


def merit_chart(arena: Arena, figures: Sequence[str]) -> Chart:
    """Return figures of every law over all conditions, the best on the first of them first."""
    entrants = arena.ranked(figures[0], arena.entrants)
    return Chart(
        name="merit",
        caption=_MERIT + _WITH_INTERVAL * (arena.flights > 1),
        panels=[_merit_panel(arena, entrants, of, named=of == figures[0]) for of in figures],
        columns=len(figures),
        panel_height=0.1 + 0.02 * len(entrants),
    )


_MERIT = (
    "What a minute of each law is worth, over the end of the flights in all conditions: a mark is"
    " the mean."
)
_WITH_INTERVAL = " Lines: its 95 % interval."


def _merit_panel(arena: Arena, entrants: Sequence[Entrant], figure: str, *, named: bool) -> Panel:
    rows = {entrant.name: float(len(entrants) - 1 - i) for i, entrant in enumerate(entrants)}
    lines: list[Line] = []
    for tracking, label, colour in (
        (True, "tracks the oscillating reference", "blue"),
        (False, "circles the vessel", "orange"),
    ):
        members = [entrant for entrant in entrants if entrant.tracks == tracking]
        found = [arena.of(figure, entrant, arena.together) for entrant in members]
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
    names = [
        (rows[entrant.name], f"{entrant.title} {entrant.number}" if named else "")
        for entrant in entrants
    ]
    drawn = np.concatenate([line.x for line in lines])
    farthest = float(np.max(drawn[np.isfinite(drawn)], initial=0.0)) or 1.0
    return Panel(
        x_label=arena.figure(figure).column.row,
        y_label="Law" if named else "",
        lines=lines,
        x_range=(0.0, _BEYOND * farthest),
        y_names=names,
        y_range=(float(ends[0]), float(ends[1])),
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
        f" {first}. Seen from the ship, to scale, with its plume up the page. The best on the"
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
        Line(
            x=reference[0],
            y=reference[1],
            label="reference",
            colour=Meaning.COMMANDED,
            style="thin",
        ),
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
