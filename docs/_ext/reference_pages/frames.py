"""The sketch of frames and axes: ship, plume, keep-out area and orbit from above, as SVG."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from gnc.paper import eta_for_speed_ratio

Place = tuple[float, float]
"""On the picture: to the right, and down [pixels]."""

_TITLE = "Ship, plume, keep-out area and orbit from above"
_NU = 0.5
_AXIS = math.radians(200.0)
"""Course along which the plume trails, of a ship to the north [rad]."""
_SHIP = (380.0, 190.0)
_KEEPOUT, _CENTRE, _END = 150.0, 240.0, 400.0
"""Radius of the keep-out area, and how far the centre of oscillation and the end of the plume are
from the funnel [pixels].
"""
_VEHICLE = 145
"""Place of the UAV among the points of the orbit."""
_SCALE = 105.0
"""Pixels per V/omega_0."""

_STYLE = (
    "text{font:15px sans-serif;fill:#222}.thin{stroke:#555;stroke-width:1.2;fill:none}"
    ".dash{stroke-dasharray:5"
    " 4}.orbit{stroke:#0072b2;stroke-width:2.2;fill:none}.keepout{stroke:#d55e00;stroke-width:2;"
    "fill:#d55e00;fill-opacity:.07}.plume{fill:#777;fill-opacity:.28}.ship{fill:#222}.uav{fill:#0072b2}"
)
_TIP = (
    '<marker id="tip" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" markerHeight="7"'
    ' orient="auto">'
    '<path d="M0 0 10 5 0 10z" fill="#555"/></marker>'
)


def frames_svg() -> str:
    """Return the sketch."""
    orbit = _orbit()
    points = " ".join(_point(place) for place in orbit)
    plume = " ".join(
        _point(place) for place in (_SHIP, _along_plume(_END, -42.0), _along_plume(_END, 42.0))
    )
    return "\n".join(
        (
            (
                '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 760 600" role="img"'
                f' aria-label="{_TITLE}">'
            ),
            f"<style>{_STYLE}</style><defs>{_TIP}</defs>",
            '<rect width="760" height="600" fill="#fff"/>',
            f'<polygon class="plume" points="{plume}"/>',
            *_ship(),
            _line(_SHIP, _along_plume(_END + 15.0), "thin dash"),
            f'<polyline class="orbit" points="{points}"/>',
            *_centre(),
            *_vehicle(orbit),
            *_axes(),
            "</svg>",
        )
    )


def _ship() -> Iterator[str]:
    x, y = _SHIP
    edge = (x + _KEEPOUT * math.cos(0.35), y - _KEEPOUT * math.sin(0.35))
    yield f'<circle class="keepout" cx="{x}" cy="{y}" r="{_KEEPOUT}"/>'
    yield (
        f'<path class="ship" d="M{x} {y - 44} l11 22 v48 h-22 v-48z"/><circle cx="{x}" cy="{y}"'
        ' r="4" fill="#fff"/>'
    )
    yield _arrow((x, y - 46), (x, 14))
    yield _text((x + 12, 24), "course of the ship")
    yield _text((x - 18, y + 5), "funnel", anchor="end")
    yield _arrow(_SHIP, edge)
    yield _text((edge[0] + 10, edge[1] + 4), "r_min: keep-out area")
    yield _text(
        (_along_plume(_END)[0] + 56, _along_plume(_END - 18)[1]), "plume, along the apparent wind"
    )


def _centre() -> Iterator[str]:
    x, y = _along_plume(_CENTRE)
    yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="#0072b2"/>'
    yield _line((x + 6, y + 6), (x + 62, y + 56), "thin")
    yield _text((x + 66, y + 66), "centre of oscillation, r_co from the funnel")


def _vehicle(orbit: Sequence[Place]) -> Iterator[str]:
    x, y = orbit[_VEHICLE]
    # Its course over the ground; as the ship sees it, it moves along the orbit.
    course = eta_for_speed_ratio(_NU) * math.cos(2.0 * math.pi * _VEHICLE / (len(orbit) - 1))
    yield _line((x, y), (x, y - 96), "thin dash")
    yield _arrow((x, y), (x + 100 * math.sin(course), y - 100 * math.cos(course)))
    yield _text((x - 12, y - 84), "course χ, from north", anchor="end")
    yield f'<g transform="translate({x:.1f} {y:.1f}) rotate({math.degrees(course):.1f})">'
    yield '<path class="uav" d="M0-14 18 10 0 3-18 10z"/></g>'
    yield _text((x - 4, y + 40), "UAV, on the reference", anchor="end")


def _axes() -> Iterator[str]:
    yield _arrow((60, 560), (60, 496))
    yield _arrow((60, 560), (124, 560))
    yield _text((30, 484), "north")
    yield _text((130, 565), "east")


def _line(start: Place, end: Place, kind: str, more: str = "") -> str:
    return (
        f'<line class="{kind}" x1="{start[0]:.1f}" y1="{start[1]:.1f}" x2="{end[0]:.1f}"'
        f' y2="{end[1]:.1f}"{more}/>'
    )


def _arrow(start: Place, end: Place) -> str:
    return _line(start, end, "thin", ' marker-end="url(#tip)"')


def _text(place: Place, text: str, anchor: str = "start") -> str:
    return f'<text x="{place[0]:.1f}" y="{place[1]:.1f}" text-anchor="{anchor}">{text}</text>'


def _point(place: Place) -> str:
    return f"{place[0]:.1f},{place[1]:.1f}"


def _along_plume(distance: float, across: float = 0.0) -> Place:
    """Return the place on the plume's axis, and to its right, on the picture [pixels]."""
    north = distance * math.cos(_AXIS) - across * math.sin(_AXIS)
    east = distance * math.sin(_AXIS) + across * math.cos(_AXIS)
    return _SHIP[0] + east, _SHIP[1] - north


def _orbit() -> list[Place]:
    """Return the reference's orbit about the centre of oscillation, as the ship sees it: equations
    (2) to (5).
    """
    phase = np.linspace(0.0, 2.0 * np.pi, 241)
    offset = eta_for_speed_ratio(_NU) * np.cos(phase)
    rates = np.stack([np.cos(offset) - _NU, np.sin(offset)])
    steps = 0.5 * (rates[:, 1:] + rates[:, :-1]) * (phase[1] - phase[0])
    along, right = np.concatenate([np.zeros((2, 1)), np.cumsum(steps, axis=1)], axis=1) * _SCALE
    x, y = _along_plume(_CENTRE)
    return [(x + float(east), y - float(north)) for north, east in zip(along, right, strict=True)]
