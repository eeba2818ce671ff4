"""What the page of a report holds for the replay of its flights: a library, scripts, and the scenes
as plain data.
"""

import base64
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from reports.document.blocks import FlightPicker, Section
from reports.document.palette import COLOURS, Meaning
from reports.document.scene import Estimate, Gas, OtherTrack, Scene
from reports.document.ship_map import SIZE_NOT_KNOWN, hull_words
from reports.render.script_data import for_script
from reports.run.columns import Array
from reports.run.flight_config import ANY, Hull

THREE = Path(__file__).parent / "bundle" / "three.min.js"
"""Library that draws in three dimensions; ``bundle/README.md`` says where it comes from."""

SCRIPTS = tuple(
    Path(__file__).parent / "player" / f"{name}.js"
    for name in ("flight", "smoke", "shapes", "air", "world", "camera", "plot", "replay")
)
"""What draws the replay with it, in the order in which the page reads them."""

_PLACE, _ANGLE = 0.01, 0.002
"""Steps in which places and angles are sent [m, rad]: 1 cm, and 0.1 deg."""

_STEPS = {
    "gas": 0.1,
    "airspeed": 0.05,
    "wind_north": 0.05,
    "wind_east": 0.05,
    "apparent_drift": 0.1,
}
"""Those of other columns, in their units."""

_ANGLES = ("heading", "pitch", "roll", "vessel_heading", "plume_axis")

_STEPS_MAX = 2.0**40
"""Farthest that is sent, in steps: ten million kilometres, for a vehicle out of control."""

_STRAIGHT = 1e-6
"""Deviation from a straight line over time that a column is sent as one despite [m, rad]."""

_MEANINGS = {
    "flown": Meaning.FLOWN,
    # The track of hours is a heap that an aircraft of its colour is not seen on.
    "aircraft": "black",
    "reference": Meaning.COMMANDED,
    "limit": Meaning.LIMIT,
    "guard": Meaning.GUARD,
    "guardLost": Meaning.GUARD_LOST,
    "crossing": Meaning.CROSSING,
    "ship": Meaning.SHIP,
    "plume": Meaning.PLUME,
    "wind": Meaning.WIND,
}
"""What the scripts call what they draw, and what that means in figures."""

Data = dict[str, Any]


def colours() -> dict[str, str]:
    """Return the colour of everything that the replay shows."""
    return {name: COLOURS[meaning] for name, meaning in _MEANINGS.items()}


def has_replay(picker: FlightPicker) -> bool:
    """Return whether any of the flights can be replayed: a page without one has no use for the
    library.
    """
    return any(flight.scene for flight in picker.flights)


def within(section: Section) -> bool:
    """Return whether a section has a replay."""
    return any(isinstance(block, FlightPicker) and has_replay(block) for block in section.blocks)


def library() -> str:
    """Return the library that draws in three dimensions."""
    return THREE.read_text(encoding="utf-8")


def scripts() -> str:
    """Return the scripts of the replay."""
    return "\n".join(path.read_text(encoding="utf-8") for path in SCRIPTS)


def data(picker: FlightPicker) -> str:
    """Return what the scripts of the replay read: the scenes of the flights that have one, and
    their colours.
    """
    scenes = {
        flight.flight_id: draw_scene(flight.scene) for flight in picker.flights if flight.scene
    }
    return for_script({"flights": scenes, "colours": colours()})


def draw_scene(scene: Scene) -> Data:
    """Return a scene as the replay reads it.

    A column that is straight over time is sent by its ends, any other in whole steps.
    """
    return {
        "start": scene.start,
        "interval": scene.interval,
        "samples": len(scene.columns["north"]),
        "columns": {
            name: packed_column(values, _ANGLE if name in _ANGLES else _STEPS.get(name, _PLACE))
            for name, values in scene.columns.items()
        },
        "guard": [list(stretch) for stretch in scene.guard],
        "crossings": np.round(scene.crossings, 2).tolist(),
        "distances": [round(end, 2) for end in scene.distances],
        "keepout": {
            "radius": scene.keepout_radius,
            "shape": scene.keepout_shape,
            "height": scene.source_height,
            "sides": list(scene.outline.sides) if scene.outline else None,
        },
        "hull": _hull(scene.hull, scene.others),
        "utc": scene.utc,
        "events": [event._asdict() for event in scene.events],
        "gas": _gas(scene.gas),
        "estimate": _estimate(scene.estimate),
        "smoke": _smoke(scene.smoke) if scene.smoke else None,
        "others": [_other(ship) for ship in scene.others],
        "axis": {"length": scene.plume_length, "rise": scene.plume_rise},
    }


def _hull(hull: Hull, others: Sequence[OtherTrack] = ()) -> Data:
    """Return a hull's size, what the legend calls it, and what is said of its size and of other
    ships.
    """
    name = "ship" if hull.known else f"ship, {SIZE_NOT_KNOWN}"
    size = {
        "length": hull.length,
        "beam": hull.beam,
        "funnel": hull.funnel,
        "aside": hull.aside,
        "known": hull.known,
    }
    named = "; ".join(f"{other.name}, r = {other.radius:g} m" for other in others)
    ships = f" Other ships, pale, each in the area about it: {named}." if others else ""
    return size | {"name": name, "words": f"Of the ship: {hull_words(hull)}.{ships}"}


def _other(ship: OtherTrack) -> Data:
    """Return another ship as the replay reads it."""
    return {
        "name": ship.name,
        "radius": ship.radius,
        "known": list(ship.known),
        "columns": {
            "north": packed_column(ship.north, _PLACE),
            "east": packed_column(ship.east, _PLACE),
            "heading": packed_column(ship.heading, _ANGLE),
        },
        "hull": _hull(ANY),
    }


def _gas(gas: Gas | None) -> Data | None:
    """Return a gas with what the curve and the legend call it."""
    if gas is None:
        return None
    words = f"{gas.name} above the background {gas.source}, 0 to {gas.most:.0f} {gas.unit}"
    return gas._asdict() | {"label": f"{gas.name} [{gas.unit}]", "words": words}


def _estimate(estimate: Estimate | None) -> Data | None:
    """Return an estimate with the end of its scale: all limits, and the interval at its end."""
    if estimate is None:
        return None
    most = 1.25 * max([estimate.rows[-1][3], *estimate.limits])
    rows = [[*(round(value, 4) for value in row[:4]), row[4]] for row in estimate.rows]
    return {"rows": rows, "limits": list(estimate.limits), "most": most, "words": "Fuel sulphur"}


def _smoke(smoke: Mapping[str, Any]) -> Data:
    """Return the parcels of an exhaust as the replay reads them."""
    steps = {"north": 0.05, "east": 0.05, "wind": 0.05, "across": 0.01, "up": 0.01}
    steps |= {"drift_north": 0.05, "drift_east": 0.05}
    columns = {
        name: packed_column(np.asarray(smoke[name], dtype=np.float64), step)
        for name, step in steps.items()
    }
    return columns | {
        "count": len(smoke["north"]),
        **{name: smoke[name] for name in ("first", "step", "age_max", "winds", "table")},
    }


def packed_column(values: Array, step: float) -> Data:
    """Return a column of shape (n,) as the page has it: by its ends if it is straight, else to the
    nearest ``step``.
    """
    first, last = float(values[0]), float(values[-1])
    if np.abs(values - np.linspace(first, last, len(values))).max() <= _STRAIGHT:
        return {"first": first, "last": last}
    levels = np.round(np.clip(values / step, -_STEPS_MAX, _STEPS_MAX)).astype(np.int64)
    # Second differences are small: most are a byte.
    changes = np.diff(np.concatenate([[0, 0], levels]), n=2)
    return {"step": step, "data": base64.b64encode(_packed(changes)).decode("ascii")}


def _packed(numbers: npt.NDArray[np.int64]) -> bytes:
    """Return whole numbers as bytes: 0, -1, 1, -2, ... as 0, 1, 2, 3, ..., seven bits to a byte,
    the lowest first.

    The eighth bit of a byte says that more follow (LEB128, with the signs of Protocol Buffers'
    sint64).
    """
    unsigned = (numbers << 1) ^ (numbers >> 63)
    count = 1 + np.sum([unsigned >> (7 * k) > 0 for k in range(1, 9)], axis=0)
    place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    more = place < np.repeat(count, count) - 1
    packed: npt.NDArray[np.uint8] = (
        (np.repeat(unsigned, count) >> (7 * place)) & 127 | more * 128
    ).astype(np.uint8)
    return packed.tobytes()
