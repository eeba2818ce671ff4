"""The picture of the house: its rooms, who imports whom, and the way of a flight, as SVG."""

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

_HOUSE = Path(__file__).parents[3]

_TITLE = "Rooms of the program, imports between them, and the way of a flight"


class _Box(NamedTuple):
    """A room on the picture: left, top, width and height [pixels], and what is in it."""

    left: float
    top: float
    width: float
    height: float
    holds: str


_ROOMS = {
    "extensions": _Box(20, 20, 500, 64, "arena, patrol, convergence, gym, telemetry"),
    "scenarios": _Box(20, 150, 500, 64, "file, world, closed loop, studies, measures"),
    "innerloop": _Box(20, 280, 310, 64, "the autopilot: synthesis, margins, flight"),
    "reports": _Box(370, 280, 150, 64, "a run to its pages"),
    "aircraft": _Box(20, 410, 150, 64, "JSBSim, trim"),
    "gnc": _Box(180, 410, 150, 64, "the guidance"),
    "measurement": _Box(370, 410, 150, 64, "plume, sniffer, fuel"),
    "common": _Box(20, 540, 500, 64, "text, physics, tables, plug-ins, verdict"),
}
"""From top to bottom. `innerloop` has its reports built, and knows nothing of how."""

_WAY = (
    ("scenarios/scenario", "the file, read and checked"),
    ("scenarios/experiment", "one request for each flight"),
    ("scenarios/engine", "processes, journal, run directory"),
    ("scenarios/flight_runner.py", "one flight, from its task to its row"),
    ("scenarios/planning", "orbit, margin, vehicle"),
    ("scenarios/flight", "the closed loop, 20 times a second:"),
    ("gnc/guidance.py", "reference, law, keep-out guard"),
    ("innerloop/law.py", "airspeed, altitude, heading rate"),
    ("aircraft/fdm.py", "JSBSim flies on, at 120 Hz"),
    ("scenarios/measures", "figures, crossings, verdict"),
    ("reports/build.py", "pages from the run directory"),
)
"""Places that a flight passes, in their order, and what happens there."""

_INNER = range(6, 9)
"""Those within the closed loop."""

_STYLE = (
    "text{font:14px sans-serif;fill:#222}.name{font-weight:bold}.small{font-size:12px;fill:#555}"
    ".room{fill:#eef4f8;stroke:#0072b2;stroke-width:1.4}.import{stroke:#777;stroke-width:1.2;fill:none}"
    ".step{fill:#fff;stroke:#d55e00;stroke-width:1.2}.way{stroke:#d55e00;stroke-width:1.6;fill:none}"
)
_TIPS = "".join(
    f'<marker id="{name}" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7"'
    ' markerHeight="7" orient="auto">'
    f'<path d="M0 0 10 5 0 10z" fill="{colour}"/></marker>'
    for name, colour in (("import", "#777"), ("way", "#d55e00"))
)
_STEP_LEFT, _STEP_WIDTH, _STEP_HEIGHT, _STEP_GAP, _INDENT = 570.0, 320.0, 42.0, 12.0, 24.0


def house_svg() -> str:
    """Return the picture.

    Raises
    ------
    FileNotFoundError : a place on the way of a flight is not there
    """
    return "\n".join(
        (
            (
                '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 910 640" role="img"'
                f' aria-label="{_TITLE}">'
            ),
            f"<style>{_STYLE}</style><defs>{_TIPS}</defs>",
            '<rect width="910" height="640" fill="#fff"/>',
            *_imports(),
            *_rooms(),
            *_way(),
            "</svg>",
        )
    )


def imported_rooms(room: str) -> set[str]:
    """Return the other rooms that a room imports from, within functions as well."""
    found = set()
    for path in (_HOUSE / room).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module and not node.level:
                found.add(node.module.partition(".")[0])
            elif isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
    return (found & set(_ROOMS)) - {room}


def _rooms() -> Iterator[str]:
    for name, box in _ROOMS.items():
        lines = sum(
            len(path.read_text("utf-8").splitlines()) for path in (_HOUSE / name).rglob("*.py")
        )
        yield (
            f'<rect class="room" x="{box.left}" y="{box.top}" width="{box.width}"'
            f' height="{box.height}" rx="5"/>'
        )
        yield _text(box.left + 12, box.top + 21, name, "name")
        yield _text(box.left + 12, box.top + 40, box.holds, "small")
        yield _text(box.left + 12, box.top + 58, f"{lines / 1000:.0f} thousand lines", "small")


def _imports() -> Iterator[str]:
    """Yield an arrow from each room to those that it imports from. If a room lower down on the same
    way imports from it as well, the arrow begins there.
    """
    imports = {room: imported_rooms(room) for room in _ROOMS}
    for room, others in imports.items():
        for other in sorted(others - set().union(*(imports[each] for each in others))):
            yield _arrow(_ROOMS[room], _ROOMS[other])


def _arrow(start: _Box, end: _Box) -> str:
    if start.top == end.top:
        y = start.top + 0.5 * start.height
        ends = (start.left + start.width, y, end.left, y)
    else:
        narrow = min(start, end, key=lambda box: box.width)
        x = narrow.left + 0.5 * narrow.width
        ends = (x, start.top + start.height, x, end.top)
    x1, y1, x2, y2 = ends
    return (
        f'<line class="import" x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" marker-end="url(#import)"/>'
    )


def _way() -> Iterator[str]:
    for number, (place, happens) in enumerate(_WAY):
        if not (_HOUSE / place).exists():
            raise FileNotFoundError(f"the way of a flight passes '{place}', which is not there")
        left = _STEP_LEFT + (_INDENT if number in _INNER else 0.0)
        top = 20.0 + number * (_STEP_HEIGHT + _STEP_GAP)
        width = _STEP_WIDTH - (left - _STEP_LEFT)
        yield (
            f'<rect class="step" x="{left}" y="{top}" width="{width}" height="{_STEP_HEIGHT}"'
            ' rx="5"/>'
        )
        yield _text(left + 10, top + 18, f"{number + 1}  {place}", "name")
        yield _text(left + 10, top + 35, happens, "small")
        if number:
            x = _STEP_LEFT + 0.5 * _STEP_WIDTH
            yield (
                f'<line class="way" x1="{x}" y1="{top - _STEP_GAP}" x2="{x}" y2="{top}"'
                ' marker-end="url(#way)"/>'
            )


def _text(x: float, y: float, text: str, kind: str, anchor: str = "start") -> str:
    return f'<text class="{kind}" x="{x}" y="{y}" text-anchor="{anchor}">{text}</text>'
