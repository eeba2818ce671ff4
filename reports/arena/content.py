"""The report of an arena: a reader ranks the laws at a glance, and sees what each was given."""

from reports.arena.charts import crossing_chart, effort_charts, track_charts, worth_chart
from reports.arena.data import Arena, Entrant, read_arena
from reports.arena.figures import CROSSINGS, ERROR, PLUME_TIME, SULPHUR, Figure
from reports.arena.tables import (
    by_condition_table,
    condition_table,
    given_table,
    plume_table,
    refused_table,
    tracking_table,
)
from reports.design.section import innerloop_section
from reports.document.blocks import Block, Card, Findings, Heading, Section, Text, Verdict
from reports.document.tables import outcome, parameter_blocks
from reports.flights.content import flights_content
from reports.flights.first_page import flights_in_words
from reports.run.columns import flights_flown, lost, total
from reports.run.run_data import RunData

_BOLD = (
    "In bold: the laws that may be the best, as the flights do not show with 95 % confidence that another is better (multiple"
    " comparisons with the best, by a paired bootstrap over starts and air). In brackets are 95 % intervals of the mean. A law that"
    " lacks flights which another flew is not compared: it is never in bold, it stands last, and beside its mean is of how many"
    " flights that is."
)

_TRACKING = (
    "Errors are distances to the oscillating reference, as the guidance has it, and the effort is the heading rate commanded, both"
    " over the end of each flight, settled or not; excess effort is what of it differs from the reference's own heading rate. Laws"
    " without feedback along the track, those on a tangent (M1), depend on where they start. The airspeed law, which is the same"
    " for all, keeps pace with the reference besides."
)

_STANDOFF = (
    "On a circle about the vessel the error is the distance to the circle. It closes in on its radius, on which the keep-out guard"
    " just need not act, once the law is near it."
)

_PLUME = (
    "Both tasks by what the mission is for: crossings of the plume's axis, time in the plume, and the distance from the funnel at"
    " which it was crossed. A law that tracks badly may cross as often as one that tracks well, but elsewhere and at times that"
    " nobody can predict."
)

_SULPHUR = (
    "The plume is the one that the exhaust makes: it rises, spreads, meanders and fluctuates. Inside is where the concentration"
    " is above exp(-2) of that on the axis. Every law carries the same sniffer. The sulphur error is the standard uncertainty by"
    " noise of the fuel's sulphur content that a minute leaves, as the estimator states it: the inverse root of the mean"
    " information 1/σ², which adds up over minutes and flights, and is 0 of a result that is not"
    " admitted. Errors of the instrument that do not average out come on top, and are the same for every law."
)

_GIVEN = (
    "Each law had the same number of settings to try, the default first, half of them spread evenly over the ranges and half by"
    " Nelder and Mead's simplex, which tries the best of these again, on flights of the kinematic vehicle with the aircraft's lag"
    " and with seeds that the comparison does not use. The cost is the rms error of the end of a flight and what the heading rate"
    " in excess of the reference's counts as."
)

_ONCE = (
    "One flight in each condition says nothing of other starts and other air: intervals have no width, and which law is best is not"
    " shown."
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
    sections = [
        _section("conditions", "Conditions", "Conditions", [condition_table(arena)]),
        _section("tracking", "Tracking the oscillating reference", "Tracking", _tracking(arena)),
        _section("standoff", "Circling the vessel", "Circling", _standoff(arena)),
        _section("plume", "Measuring the plume", "Plume", _plume(arena)),
        _section(
            "given",
            "What each law was given",
            "Given",
            [Text(_GIVEN), given_table(arena), *_refused(arena)],
        ),
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
                Heading(f"{figure.title}, by condition"),
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
                f"{_mean(arena, entrant, ERROR)} m",
            )
            for task, entrant in best
        ),
        *(
            Card(
                f"Best on {figure.quantity.lower()}: {_best_of(arena, first, figure)}",
                f"{_mean(arena, first, figure)} {figure.unit}",
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
        detail=f"Means over all conditions, over the end of each flight. {_ONCE if arena.flights == 1 else _alike(arena, best)}",
        failures=failures,
        figures=figures,
    )


def _headline(arena: Arena, best: list[tuple[bool, Entrant]]) -> str:
    """Return which law is best in each task, or that none can be called so."""
    found, leads = dict(best), "is best" if arena.flights > 1 else "has the least error"
    words = [
        f"{'tracking' if task else 'circling'}: "
        + (
            f"{found[task].title} {leads}, {_mean(arena, found[task], ERROR)} m rms"
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
                f"{entrant.title}: {len(lacking)} of {len(rows)} flights could not be flown{apart}: {reasons[0]}{more}"
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


def _best_of(arena: Arena, first: Entrant, figure: Figure) -> str:
    """Return the law with the best mean, and how many others have the same, as it is written."""
    mean = _mean(arena, first, figure)
    same = sum(
        of is not first
        and arena.of(figure, of, arena.together).whole
        and _mean(arena, of, figure) == mean
        for of in arena.entrants
    )
    return f"{first.title} and {same} more" if same else first.title


def _mean(arena: Arena, entrant: Entrant, figure: Figure) -> str:
    return figure.written(arena.of(figure, entrant, arena.together).mean)
