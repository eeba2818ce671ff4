"""Tables of an arena, with the best of each figure in bold."""

import math
from collections.abc import Sequence

import numpy as np

from reports.arena.data import ALL, Arena, Entrant, Estimate
from reports.arena.figures import (
    CROSSINGS,
    ERROR,
    MEASURING_FIGURES,
    SULPHUR,
    TRACKING_FIGURES,
    Figure,
)
from reports.document.blocks import Table
from reports.document.tables import number, parameter_value
from reports.flights.trials.tables import nearest_cells
from reports.run.columns import column, total


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
        *(figure.title for figure in TRACKING_FIGURES),
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
        *(figure.title for figure in figures),
        "Closest approach [m]",
        "Keep-out violations",
    ]
    extra = [
        [_closest(entrant), str(total(entrant.rows, "keepout_violations"))] for entrant in entrants
    ]
    tasks = [["tracks" if entrant.tracks else "circles"] for entrant in entrants]
    widths = [0.4, 2.0, 0.6, *(2.4 if figure is SULPHUR else 1.7 for figure in figures), 0.9, 0.95]
    caption = "Measuring the plume, over all conditions."
    return _table(
        arena, entrants, figures, head, extra, widths=widths, caption=caption, before=tasks
    )


def _closest(entrant: Entrant) -> str:
    return nearest_cells(entrant.rows)[0]


def _table(
    arena: Arena,
    entrants: Sequence[Entrant],
    figures: Sequence[Figure],
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
            _interval(estimate, figure) + few(arena, estimate, arena.together)
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
    mean, low, high = (
        figure.written(value) for value in (estimate.mean, estimate.low, estimate.high)
    )
    return mean if math.isnan(estimate.low) else f"{mean} ({low}\N{EN DASH}{high})"


def few(arena: Arena, estimate: Estimate, condition: str) -> str:
    """Return of how many flights a mean is, to stand beside it: nothing where it is of all, or
    there is none.
    """
    planned = arena.flights_of(condition)
    return f", {estimate.flights} of {planned}" if 0 < estimate.flights < planned else ""


def by_condition_table(arena: Arena, figure: Figure, *, tracking: bool | None = None) -> Table:
    """Return a figure by condition, a row for each law: of a task, or of both.

    Parameters
    ----------
    figure : which
    tracking : which task; both if it is None
    """
    members = arena.entrants if tracking is None else arena.in_task(tracking=tracking)
    entrants = arena.ranked(figure, members)
    conditions = [*arena.conditions, *([ALL] if len(arena.conditions) > 1 else [])]
    rows, bold = [], []
    for i, entrant in enumerate(entrants):
        found = [arena.of(figure, entrant, condition) for condition in conditions]
        few_of = [
            few(arena, estimate, condition)
            for estimate, condition in zip(found, conditions, strict=True)
        ]
        means = [
            figure.written(estimate.mean) + words
            for estimate, words in zip(found, few_of, strict=True)
        ]
        rows.append([str(entrant.number), entrant.title, *means])
        bold += [
            (i, 2 + j) for j, estimate in enumerate(found) if arena.flights > 1 and estimate.as_good
        ]
    if figure is CROSSINGS and arena.limits:
        most = [figure.written(arena.limits.get(condition, math.nan)) for condition in conditions]
        rows.append(["", "limit of any path", *most])
    head = ["No.", "Law", *(condition.replace("_", " ") for condition in conditions)]
    widths = [0.4, 2.4, *(1.0 for _ in conditions)]
    return Table(head=head, rows=rows, widths=widths, left_columns=2, bold=bold, breakable=True)


def given_table(arena: Arena) -> Table:
    """Return what each law was given: its way to the reference, its parameters, and what either set
    costs the tuner.
    """
    rows = []
    for entrant in arena.entrants:
        tuned = entrant.tuned
        parameters = ", ".join(
            f"{key} {value:.3g} → {tuned.get(key, value):.3g}"
            for key, value in entrant.defaults.items()
        )
        costs = f"{number(entrant.cost_default, '{:.2f}')} → {number(entrant.cost_tuned, '{:.2f}')}"
        rows.append(
            [str(entrant.number), entrant.title, entrant.given, parameters or "none", costs]
        )
    head = ["No.", "Law", "What it makes use of", "Parameters: default → tuned", "Cost [m]"]
    return Table(
        caption="What each law was given: its way to the reference, its parameters, and what either set costs the tuner.",
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
