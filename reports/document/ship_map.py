"""Maps about a ship: her hull to scale, her plume up the page, the keep-out area, wind and north."""

from collections.abc import Sequence

from reports.document.chart import Line, Note, Panel, circle
from reports.document.map_marks import hull_line, on_map, plume_lines
from reports.document.palette import Meaning
from reports.run.ship import Hull
from reports.run.surroundings import Surroundings


def ship_lines(about: Surroundings, up: float, x: float = 0.0, y: float = 0.0) -> list[Line]:
    """Return keep-out area, plume and ship, on a page on which the course ``up`` [rad] is up, with her funnel at a place."""
    right, along = circle(about.radius)
    plume = about.plume
    return [
        Line(x=x + right, y=y + along, label="keep-out area, r_min", colour=Meaning.LIMIT, fill=True),
        *plume_lines(plume.distance, plume.half_width if plume.smoke else None, about.axis - up, x, y),
        hull_line(about.hull, about.heading - up, x, y),
    ]


def ship_panel(
    about: Surroundings,
    lines: Sequence[Line],
    *,
    title: str = "",
    notes: Sequence[Note] = (),
    shown: Sequence[Line] = (),
    aspect: float = 1.0,
) -> Panel:
    """Return a map about the ship with her plume up the page.

    Parameters
    ----------
    about : ship, plume, keep-out area and wind
    lines, notes : seen from the ship, to the right of the plume's axis and along it [m]; the lines from back to front
    title : above the panel
    shown, aspect : as of ``map_marks.on_map``
    """
    every = [*ship_lines(about, about.axis), *lines]
    panel = Panel(x_label="Right of the plume's axis [m]", y_label="Along it [m]", title=title, lines=every, notes=notes)
    speed, towards = about.wind
    return on_map(panel, north=-about.axis, wind=(speed, towards - about.axis), shown=shown, aspect=aspect)


def ship_words(*about: Surroundings) -> str:
    """Return what maps about the ship show, one or several side by side, for a caption."""
    shapes = " or ".join(dict.fromkeys(of.shape for of in about))
    hulls = "; or ".join(hull_words(hull) for hull in dict.fromkeys(of.hull for of in about))
    smoke, changing = any(of.plume.smoke for of in about), any(of.changing for of in about)
    width = " Its width is two standard deviations of the mean smoke to either side." if smoke else ""
    moved = " Ship, north and wind are as they were at the closest approach." if changing else ""
    return (
        f"Seen from the ship, with the axis of her plume up the page.{width} The keep-out {shapes} is about her funnel;"
        f" {hulls}.{moved}"
    )


def hull_words(hull: Hull) -> str:
    """Return how large a ship is drawn, and why."""
    size = f"{hull.length:g} m by {hull.beam:g} m"
    if hull.known:
        return f"her hull is that of {hull.title}, {size}, as the scenario gives none"
    return f"her size is not known, and drawn is {hull.title} of {size}"
