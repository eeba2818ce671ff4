"""What the page of a report holds for the replay of its flights: a library, scripts, and the scenes as plain data."""

import base64
from pathlib import Path
from typing import Any

import numpy as np

from reports.document.blocks import FlightPicker
from reports.document.palette import COLOURS, Meaning
from reports.document.scene import Scene
from reports.render.script_data import for_script
from reports.run.columns import Array

THREE = Path(__file__).parent / "bundle" / "three.min.js"
"""Library that draws in three dimensions; ``bundle/README.md`` says where it comes from."""

SCRIPTS = tuple(
    Path(__file__).parent / "player" / f"{name}.js" for name in ("flight", "shapes", "world", "camera", "plot", "replay")
)
"""What draws the replay with it, in the order in which the page reads them."""

_LEVELS = 65535
"""Steps between the least and the greatest value of a column."""

_STRAIGHT = 1e-6
"""Deviation from a straight line over time that a column is sent as one despite [m, rad]."""

_MEANINGS = {
    "flown": Meaning.FLOWN,
    "reference": Meaning.ASKED,
    "limit": Meaning.LIMIT,
    "guard": Meaning.GUARD,
    "guardLost": Meaning.GUARD_LOST,
    "crossing": Meaning.CROSSING,
    "ship": Meaning.SHIP,
    "plume": Meaning.PLUME,
}
"""What the replay shows, and what its colour means, as in the figures."""

Data = dict[str, Any]


def colours() -> dict[str, str]:
    """Return the colour of everything that the replay shows."""
    return {name: COLOURS[colour] for name, colour in _MEANINGS.items()}


def wanted(picker: FlightPicker) -> bool:
    """Return whether any of the flights can be replayed: a page without one has no use for the library."""
    return any(flight.scene for flight in picker.flights)


def library() -> str:
    """Return the library that draws in three dimensions."""
    return THREE.read_text(encoding="utf-8")


def scripts() -> str:
    """Return the scripts of the replay."""
    return "\n".join(path.read_text(encoding="utf-8") for path in SCRIPTS)


def data(picker: FlightPicker) -> str:
    """Return what the scripts of the replay read: the scenes of the flights that have one, and their colours."""
    scenes = {flight.flight_id: draw_scene(flight.scene) for flight in picker.flights if flight.scene}
    return for_script({"flights": scenes, "colours": colours()})


def draw_scene(scene: Scene) -> Data:
    """Return a scene as the replay reads it.

    A column that is straight over time is sent by its ends. Any other is sent as whole numbers of 16 bits, between its least and
    its greatest value: a place within 2 km is good to 1.5 cm, a turn of 360 degrees to 0.003 degrees.
    """
    plume = scene.plume
    sections = (plume.distance, plume.height, plume.half_width, plume.half_height)
    return {
        "start": scene.start,
        "interval": scene.interval,
        "samples": len(scene.columns["north"]),
        "columns": {name: _column(values) for name, values in scene.columns.items()},
        "guard": [list(stretch) for stretch in scene.guard],
        "crossings": np.round(scene.crossings, 2).tolist(),
        "keepout": {"radius": scene.keepout_radius, "shape": scene.keepout_shape, "height": scene.source_height},
        "hull": {"length": scene.hull_length, "beam": scene.hull_beam},
        "plume": np.round(np.column_stack(sections), 1).tolist(),
    }


def _column(values: Array) -> Data:
    first, last = float(values[0]), float(values[-1])
    if np.abs(values - np.linspace(first, last, len(values))).max() <= _STRAIGHT:
        return {"first": first, "last": last}
    low, high = float(values.min()), float(values.max())
    levels = np.round((values - low) * (_LEVELS / (high - low))).astype("<u2")
    return {"low": low, "high": high, "data": base64.b64encode(levels.tobytes()).decode("ascii")}
