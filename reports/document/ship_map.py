"""Maps about a ship: its hull to scale, its plume up the page, the keep-out area, wind and
north.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from reports.document.chart import Line, Note, Panel, circle
from reports.document.palette import Meaning
from reports.run.columns import Array
from reports.run.flight_config import Hull
from reports.run.surroundings import Surroundings

_HULL = (
    (0.0, 1.0),
    (0.36, 0.9),
    (0.5, 0.76),
    (0.5, 0.03),
    (0.42, 0.0),
    (-0.42, 0.0),
    (-0.5, 0.03),
    (-0.5, 0.76),
    (-0.36, 0.9),
)
"""Outline of a hull seen from above, the bow first: to starboard over the beam, and ahead of the
stern over the length.
"""

SIZE_NOT_KNOWN = "size not known"
"""What a legend says of a ship that is drawn pale."""

_STRIP, _STRIP_MAX = 0.13, 0.28
"""Height of the strip above a map where bar and arrows are, over the whole height: of a map as high
as wide, and of a flat one.
"""

_ROOM = 0.04
"""Room about what a map shows, over its size."""

_LETTER = 0.024
"""Width of a letter of the words on a map, over its height."""

_BAR = 0.18
"""Longest scale bar, over the width of the map."""


def hull_line(hull: Hull, angle: float, x: float = 0.0, y: float = 0.0) -> Line:
    """Return a ship, its funnel at a place and its bow at an angle: to scale, or pale and dotted
    where its size is not known.
    """
    right, ahead = (np.array(side) for side in zip(*(*_HULL, _HULL[0]), strict=True))
    across, along = hull.beam * right + hull.aside, hull.length * (ahead - hull.funnel)
    return Line(
        x=x + math.cos(angle) * across + math.sin(angle) * along,
        y=y - math.sin(angle) * across + math.cos(angle) * along,
        label=f"ship, {'to scale' if hull.known else SIZE_NOT_KNOWN}",
        colour=Meaning.SHIP,
        style="thin" if hull.known else "dot",
        fill=True,
        opacity=0.55 if hull.known else 0.2,
    )


def arrow(x: float, y: float, angle: float, length: float, colour: str) -> list[Line]:
    """Return an arrow whose middle is at a place."""
    ahead, right = (
        np.array([math.sin(angle), math.cos(angle)]),
        np.array([math.cos(angle), -math.sin(angle)]),
    )
    tip, tail = np.array([x, y]) + 0.5 * length * ahead, np.array([x, y]) - 0.5 * length * ahead
    neck = tip - 0.4 * length * ahead
    head = np.array([tip, neck + 0.2 * length * right, neck - 0.2 * length * right, tip])
    shaft = np.array([tail, neck])
    return [
        Line(x=shaft[:, 0], y=shaft[:, 1], label="", colour=colour),
        Line(x=head[:, 0], y=head[:, 1], label="", colour=colour, fill=True, opacity=1.0),
    ]


def plume_lines(
    distance: Array, half_width: Array | None, angle: float = 0.0, x: float = 0.0, y: float = 0.0
) -> list[Line]:
    """Return the axis of a plume, and its width where it has one, from a place at an angle."""

    def placed(across: Array, along: Array) -> tuple[Array, Array]:
        return x + math.cos(angle) * across + math.sin(angle) * along, y - math.sin(
            angle
        ) * across + math.cos(angle) * along

    lines = []
    if half_width is not None:
        edge = placed(
            np.concatenate([half_width, -half_width[::-1]]),
            np.concatenate([distance, distance[::-1]]),
        )
        label = "plume, ±2 σ"
        lines.append(
            Line(
                x=edge[0],
                y=edge[1],
                label=label,
                colour=Meaning.PLUME,
                style="thin",
                fill=True,
                opacity=0.3,
            )
        )
    axis = placed(np.zeros(2), distance[[0, -1]])
    return [
        *lines,
        Line(x=axis[0], y=axis[1], label="plume's axis", colour=Meaning.PLUME, style="dash"),
    ]


def on_map(
    panel: Panel,
    *,
    north: float | None,
    wind: tuple[float, float] | None = None,
    shown: Sequence[Line] = (),
    aspect: float = 1.0,
) -> Panel:
    """Return a panel with scale bar, north arrow and wind in a strip above what it shows.

    Parameters
    ----------
    panel : in metres
    north : angle of north, or None where it is not known
    wind : speed [m/s] and the angle that it blows towards, or None where it is not known
    shown : lines that have to be seen whole, beside the words; all of the panel's if none
    aspect : width of the panel over its height
    """
    share = min(_STRIP_MAX, _STRIP * max(1.0, 0.5 * aspect))
    (left, right), (bottom, top) = _view(shown or panel.lines, panel.notes, aspect, share)
    width, strip = right - left, share * (top - bottom)
    middle, size = top - 0.5 * strip, 0.66 * strip
    bar = _round_length(_BAR * width)
    ends = np.array([left + 0.03 * width, left + 0.03 * width + bar])
    edges = (
        np.array([left, right, right, left, left]),
        top - strip * np.array([0.0, 0.0, 1.0, 1.0, 0.0]),
    )
    lines = [
        Line(
            x=edges[0], y=edges[1], label="", colour="white", style="thin", fill=True, opacity=1.0
        ),
        Line(x=ends, y=np.full(2, middle), label="", colour=Meaning.SHIP),
    ]
    text = f"{bar / 1000.0:g} km" if bar >= 1000.0 else f"{bar:g} m"
    notes = [Note(x=float(ends[1]), y=middle, text=f" {text}", align="left")]
    if wind is not None:
        speed, towards = wind
        at = left + 0.42 * width
        lines += arrow(at, middle, towards, size, Meaning.WIND) if speed > 0.0 else []
        words = f"wind {speed:.1f} m/s" if speed > 0.0 else "calm air"
        notes.append(
            Note(x=at + (0.6 * size if speed > 0.0 else 0.0), y=middle, text=words, align="left")
        )
    if north is not None:
        at = right - 0.03 * width - 0.5 * size
        lines += arrow(at, middle, north, size, Meaning.SHIP)
        notes.append(Note(x=at - 0.7 * size, y=middle, text="N", align="right"))
    # What lies outside has no entry in the legend.
    seen = [
        line
        for line in panel.lines
        if _within(line.x, left, right) and _within(line.y, bottom, top)
    ]
    return replace(
        panel,
        lines=[*seen, *lines],
        notes=[*panel.notes, *notes],
        equal=True,
        x_range=(left, right),
        y_range=(bottom, top),
    )


def _within(values: Array, low: float, high: float) -> bool:
    """Return whether a curve reaches into a range; one without any number does, as it hides
    nothing.
    """
    known = values[np.isfinite(values)]
    return not len(known) or bool(known.max() >= low and known.min() <= high)


def _view(
    lines: Sequence[Line], notes: Sequence[Note], aspect: float, strip: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return limits that hold all lines and words below a strip, which is a share of the height, of
    a panel of an aspect.
    """
    x, y = (
        np.concatenate([getattr(line, axis) for line in lines] or [np.empty(0)]) for axis in "xy"
    )
    size = max(float(np.ptp(y[np.isfinite(y)])), float(np.ptp(x[np.isfinite(x)])) / aspect)
    ends = [end for note in notes for end in _ends(note, _LETTER * size)]
    (left, right), (bottom, top) = (
        (float(np.nanmin(values)), float(np.nanmax(values)))
        for values in (np.append(x, ends), np.append(y, [note.y for note in notes]))
    )
    room = _ROOM * max(right - left, top - bottom) or 1.0
    width, height = right - left + 2.0 * room, (top - bottom + 2.0 * room) / (1.0 - strip)
    wider, higher = max(width, aspect * height), max(height, width / aspect)
    middle, spare = 0.5 * (left + right), 0.5 * (higher - height)
    return (middle - 0.5 * wider, middle + 0.5 * wider), (
        bottom - room - spare,
        bottom - room - spare + higher,
    )


def _ends(note: Note, letter: float) -> tuple[float, float]:
    """Return where a word begins and ends, given the width of a letter."""
    width = letter * len(note.text)
    left = note.x - {"left": 0.0, "center": 0.5, "right": 1.0}[note.align] * width
    return left, left + width


def _round_length(most: float) -> float:
    """Return the longest of 1, 2 and 5 times a power of ten that is no longer than ``most``."""
    power = 10.0 ** math.floor(math.log10(most))
    return max(
        factor * power for factor in (1.0, 2.0, 5.0) if factor * power <= most * (1.0 + 1e-9)
    )


_EDGE_POINTS = 181
"""Points of the edge of a keep-out area about a hull."""


def ship_lines(about: Surroundings, up: float, x: float = 0.0, y: float = 0.0) -> list[Line]:
    """Return keep-out area, plume and ship, on a page on which the course ``up`` [rad] is up, with
    its funnel at a place.
    """
    right, along = area_outline(about, about.heading - up)
    plume = about.plume
    return [
        Line(
            x=x + right, y=y + along, label="keep-out area, r_min", colour=Meaning.LIMIT, fill=True
        ),
        *plume_lines(
            plume.distance, plume.half_width if plume.smoke else None, about.axis - up, x, y
        ),
        hull_line(about.hull, about.heading - up, x, y),
    ]


def area_outline(about: Surroundings, angle: float) -> tuple[Array, Array]:
    """Return the edge of the keep-out area about the funnel, or about the hull whose bow points at
    an angle.
    """
    if about.outline is None:
        return circle(about.radius)
    bearing = np.append(np.linspace(0.0, 2.0 * np.pi, _EDGE_POINTS), 0.0)
    ahead, starboard = about.outline.around(about.radius, bearing)
    right = math.cos(angle) * starboard + math.sin(angle) * ahead
    return right, math.cos(angle) * ahead - math.sin(angle) * starboard


def ship_panel(
    about: Surroundings,
    lines: Sequence[Line],
    *,
    title: str = "",
    notes: Sequence[Note] = (),
    shown: Sequence[Line] = (),
    aspect: float = 1.0,
) -> Panel:
    """Return a map about the ship with its plume up the page.

    Parameters
    ----------
    about : ship, plume, keep-out area and wind
    lines, notes : seen from the ship, to the right of the plume's axis and along it [m]; the lines
        from back to front
    title : above the panel
    shown, aspect : those of ``on_map``
    """
    every = [*ship_lines(about, about.axis), *lines]
    panel = Panel(
        x_label="Across the plume [m]",
        y_label="Behind the stack [m]",
        title=title,
        lines=every,
        notes=notes,
    )
    speed, towards = about.wind
    return on_map(
        panel, north=-about.axis, wind=(speed, towards - about.axis), shown=shown, aspect=aspect
    )


def ship_words(*about: Surroundings) -> str:
    """Return what maps about the ship show, one or several side by side, for a caption, given what
    was about each.
    """
    hulls = "; or ".join(hull_words(hull) for hull in dict.fromkeys(of.hull for of in about))
    area = _area_words(about)
    return (
        f"{SEEN_FROM}{_SMOKE * any(of.plume.smoke for of in about)}"
        f" {area[0].upper()}{area[1:]}; {hulls}.{_CHANGING * any(of.changing for of in about)}"
    )


SEEN_FROM = "Seen from the ship, with the axis of its plume up the page."
"""What a caption says of maps on which neither ship nor keep-out area need be in sight."""

_SMOKE = " Its width is two standard deviations of the mean smoke to either side."
_CHANGING = " Ship, north and wind are as they were at the closest approach."


def _area_words(about: Sequence[Surroundings]) -> str:
    """Return what the keep-out area is about."""
    shapes = " or ".join(dict.fromkeys(of.shape for of in about if of.outline is None))
    words = [f"the keep-out {shapes} is about the stack"] if shapes else []
    if any(of.outline is not None for of in about):
        words.append(
            "the keep-out area is what is within r_min of the hull, the rectangle about the ship"
        )
    return "; or ".join(words)


def hull_words(hull: Hull) -> str:
    """Return how large a ship is drawn, and why."""
    size = f"{hull.length:g} m by {hull.beam:g} m"
    if hull.given:
        return f"its hull is {size}"
    if hull.known:
        return f"the scenario gives no hull: that of {hull.title}, {size}, is drawn"
    return f"the scenario gives no hull: {hull.title} of {size} is drawn"
