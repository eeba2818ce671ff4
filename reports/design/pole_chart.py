"""The s-plane of a design: its poles over the whole grid, open and closed."""

import math
from collections.abc import Sequence

import numpy as np

from reports.design.data import FAST, Record, speed
from reports.document.chart import Chart, Line, Note, Panel, upright
from reports.document.palette import series_colour

_SLOW = 1.5
"""Size of the magnified part about the origin [rad/s]."""

_DAMPING_RATIOS = (0.2, 0.4, 0.6, 0.8)


def pole_chart(design: Record) -> Chart:
    """Return the upper half of the s-plane, whole and near the origin, with rays of damping."""
    return Chart(
        name="gridpoles",
        caption=(
            "Poles at every point of the grid, by airspeed; the lower half is its mirror image."
            " Of the bare aircraft with servos and engine, and under the autopilot; then both"
            f" magnified about the origin. Poles beyond {FAST:g} rad/s (servos, delays) are left"
            " out. Rays: damping ratio ζ. Those of servos and propeller are as the simulation has"
            " them at its time step, up to a tenth faster than in continuous time."
        ),
        panels=[
            *(_panel(design, kind, title, _reach(design)) for kind, title in _KINDS),
            *(_panel(design, kind, "", _SLOW) for kind, _ in _KINDS),
        ],
        columns=2,
        panel_height=0.3,
    )


_KINDS = (("open_loop", "Aircraft"), ("closed_loop", "Under the autopilot"))


def _reach(design: Record) -> float:
    """Return the distance from the origin of the farthest pole that is shown."""
    sizes = [
        math.hypot(*pole) for poles in design["poles"] for kind, _ in _KINDS for pole in poles[kind]
    ]
    return max((size for size in sizes if size < FAST), default=FAST)


def _panel(design: Record, kind: str, title: str, reach: float) -> Panel:
    x_range, y_range = (-1.1 * reach, 0.3 * reach), (-0.04 * reach, 1.1 * reach)
    lines, notes = _rays(x_range, y_range, reach)
    airspeeds = sorted({float(poles["airspeed_mps"]) for poles in design["poles"]})
    for i, airspeed in enumerate(airspeeds):
        points = _points(
            [poles for poles in design["poles"] if poles["airspeed_mps"] == airspeed],
            kind,
            x_range,
            y_range,
        )
        lines.append(
            Line(
                x=points[:, 0],
                y=points[:, 1],
                label=speed(airspeed),
                colour=series_colour(i),
                style="points",
            )
        )
    return Panel(
        x_label="Real part [1/s]",
        y_label="Imaginary part [rad/s]",
        lines=lines,
        title=title,
        x_range=x_range,
        y_range=y_range,
        notes=notes,
    )


def _points(
    rows: Sequence[Record], kind: str, x_range: tuple[float, float], y_range: tuple[float, float]
) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Return the poles of ``rows`` inside a panel, shape (n, 2); nan where there is none, so that
    the legend is complete.
    """
    inside = [
        pole
        for poles in rows
        for pole in poles[kind]
        if pole[1] >= 0.0 and x_range[0] <= pole[0] <= x_range[1] and pole[1] <= y_range[1]
    ]
    return np.array(inside or [[math.nan, math.nan]])


def _rays(
    x_range: tuple[float, float], y_range: tuple[float, float], reach: float
) -> tuple[list[Line], list[Note]]:
    """Return the rays of equal damping with their figures, and the limit of stability."""
    lines = [upright(0.0, (0.0, y_range[1]), "limit of stability", "black")]
    notes = []
    for ratio in _DAMPING_RATIOS:
        direction = np.array([-ratio, math.sqrt(1.0 - ratio**2)])
        # To the nearer edge of the panel, and the figure a little before it.
        length = min(x_range[0] / direction[0], y_range[1] / direction[1])
        end = length * direction
        lines.append(
            Line(
                x=np.array([0.0, end[0]]),
                y=np.array([0.0, end[1]]),
                label="equal damping",
                colour="grey",
                style="dot",
            )
        )
        at = 0.88 * end
        # To the left of a ray to the upper edge, where the limit of stability is not, and to the
        # right of one to the left edge.
        upper = bool(end[0] > x_range[0])
        place = at + (-1.0 if upper else 1.0) * reach * np.array([0.03, 0.04])
        notes.append(
            Note(
                x=float(place[0]),
                y=float(place[1]),
                text=f"ζ = {ratio:g}",
                align="right" if upper else "left",
            )
        )
    return lines, notes
