"""Figures of an arena: error against effort, crossings per minute against what is possible, and
tracks.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from reports.arena.data import ALL, Arena, Entrant
from reports.arena.figures import CROSSINGS, EFFORT, ERROR, PLUME_TIME, SULPHUR, Figure
from reports.document.chart import Chart, Line, Note, Panel, Style
from reports.document.palette import Meaning
from reports.document.ship_map import ship_panel
from reports.run.columns import column
from reports.run.flight_config import flight_config
from reports.run.surroundings import surroundings
from reports.run.time_history import about_the_plume

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
        caption="Distance to the oscillating reference against the heading rate commanded, each as its root mean square over the"
        " end of the flights, settled or not; a mark a law, numbered as in the tables. Down and to the left is better. What tracks"
        " the reference exactly needs the reference's own heading rate.",
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
            first = min(marks[number][0] for number in numbers)
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
        (number for number, place in marks.items() if all(map(math.isfinite, place))),
        key=lambda number: marks[number][1],
    )
    while left:
        cluster = [left.pop(0)]
        for number in list(left):
            if any(_near(marks[number], marks[other], word) for other in cluster):
                cluster.append(number)
                left.remove(number)
        x, y = zip(*(marks[number] for number in cluster), strict=True)
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
    if "turn rate" in entrant.given or "curvature" in entrant.given:
        return forward
    if "M1" in entrant.given or "M2" in entrant.given:
        return tangent
    return place if "M3" in entrant.given else unknown


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
        caption=f"Plume crossings per minute over the end of the flights; a mark is a law's mean{_interval_words(arena)}.{limit}",
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
        _merit_panel(arena, entrants, figure, arena.together, reach=reach, named=figure is SULPHUR)
        for figure, reach in zip(figures, reaches, strict=True)
    ]
    return Chart(
        name="worth",
        caption="What a minute is worth, over all conditions: the standard uncertainty by noise that the fuel's sulphur content is"
        " left with after it, the time that it has in the plume, and its crossings. A mark is a law's mean"
        f"{_interval_words(arena)}."
        " The best on the sulphur content come first.",
        panels=panels,
        columns=len(panels),
        panel_height=0.1 + 0.025 * len(entrants),
    )


def _merit_panel(
    arena: Arena,
    entrants: Sequence[Entrant],
    figure: Figure,
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
    if figure is CROSSINGS and (most := arena.limits.get(condition)) is not None:
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
        x_label=figure.title,
        y_label="Law" if named else "",
        title="" if condition == arena.together else _title(condition),
        lines=lines,
        x_range=(0.0, reach or 1.0),
        y_names=names,
        y_range=(float(ends[0]), float(ends[1])),
    )


def _most(arena: Arena, figure: Figure, conditions: Iterable[str]) -> float:
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
        f"{what}: the last {_SHOWN_S:g} s of one flight a law, the same start for all; condition: {first}. Seen from the ship, to"
        " scale, with her plume up the page. The best on the tracking error come first."
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
