"""Maps about a ship: its hull to scale, its plume up the page, the keep-out area, wind and
north.
"""

import math
from collections.abc import Sequence

import numpy as np

from reports.document.chart import Line, Note, Panel, circle
from reports.document.map_marks import hull_line, on_map, plume_lines
from reports.document.palette import Meaning
from reports.run.columns import Array
from reports.run.ship import Hull
from reports.run.surroundings import Surroundings

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
    shown, aspect : as of ``map_marks.on_map``
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
