"""Aircraft that come with JSBSim: their specs are read from their model files.

The files give engines and controls, and whether the model is an aeroplane at all. The envelope is found by trimming
(``aircraft.dynamics.envelope``).
"""

import xml.etree.ElementTree as ET
from pathlib import Path

import jsbsim

from aircraft.errors import AircraftError
from aircraft.spec import AircraftSpec, numbered, surface, throttle

_ELEVATOR, _AILERON, _RUDDER = surface("elevator"), surface("aileron"), surface("rudder")
_RUNNING_ENGINES = ("piston_engine", "turbine_engine", "turboprop_engine")
"""Kinds of engine that have to be started and then run; electric ones turn when they get current."""

_ELECTRIC = ("electric_engine", "brushless_dc_motor")
_STAND_STILL = 20.0
"""Time that piston engines and their propellers need to stand still behind a held aircraft [s]."""


def stock_names() -> list[str]:
    """Return the names of JSBSim's own aircraft."""
    folder = _root() / "aircraft"
    return sorted((entry.name for entry in folder.iterdir() if (entry / f"{entry.name}.xml").is_file()), key=str.lower)


def stock_spec(name: str) -> AircraftSpec:
    """Return the spec of one of JSBSim's own aircraft.

    Raises
    ------
    AircraftError : it is not an aeroplane with engines and the usual controls, with the reason
    """
    folder = _root() / "aircraft" / name
    try:
        config = ET.parse(folder / f"{name}.xml").getroot()
    except ET.ParseError as error:
        raise AircraftError(f"aircraft '{name}' cannot be flown: its model file is not valid XML: {error}") from None
    engines = _engine_kinds(config, folder)
    if reason := _no_aeroplane(config, folder, engines):
        raise AircraftError(f"aircraft '{name}' cannot be flown: {reason}")
    return AircraftSpec(
        name=name,
        title=_title(config, name),
        root=_root(),
        model=name,
        inputs=(_ELEVATOR, _AILERON, throttle(len(engines)), _RUDDER),
        configuration=(
            ("gear/gear-cmd-norm", 0.0),
            ("gear/gear-pos-norm", 0.0),
            ("propulsion/fuel_freeze", 1.0),
            *((f"fcs/{lever}-cmd-norm{numbered(i)}", 1.0) for lever in ("mixture", "advance") for i in range(len(engines))),
        ),
        engine_flags=tuple(
            f"propulsion/engine{numbered(i)}/set-running" for i, kind in enumerate(engines) if kind in _RUNNING_ENGINES
        ),
        settle_time=_STAND_STILL,
        source=f"JSBSim's own model '{name}', gear up, fuel held, its own autopilot off",
    )


def _root() -> Path:
    return Path(jsbsim.get_default_root_dir())


def _title(config: ET.Element, name: str) -> str:
    """Return the model's name for itself, unless it is a template's."""
    title = " ".join((config.get("name") or "").replace("_", " ").split())
    return f"{title} ({name})" if title and title.lower() != name.lower() else name


def _engine_kinds(config: ET.Element, folder: Path) -> list[str]:
    return [_kind(engine, folder) for engine in config.iterfind("propulsion/engine")]


def _kind(element: ET.Element, folder: Path) -> str:
    """Return the tag of the file that an engine or a thruster names."""
    name = f"{(element.get('file') or '').removesuffix('.xml')}.xml"
    for place in (folder, folder / "Engines", _root() / "engine"):
        if (place / name).is_file():
            return ET.parse(place / name).getroot().tag
    return "missing"


def _no_aeroplane(config: ET.Element, folder: Path, engines: list[str]) -> str:
    """Return why an aeroplane's autopilot cannot fly this model, or an empty text."""
    thrusters = [_kind(thruster, folder) for thruster in config.iterfind("propulsion/engine/thruster")]
    text = _text(config, folder)
    odd = [kind for kind in engines if kind not in (*_RUNNING_ENGINES, *_ELECTRIC)]
    missing = [i.name for i in (_ELEVATOR, _AILERON, _RUDDER) if i.commands[0] not in text]
    reasons = (
        (config.find("buoyant_forces") is not None, "it is lighter than air"),
        ("rotor" in thrusters, "it is a rotorcraft"),
        (not engines, "it has no engine"),
        ("rocket_engine" in engines, "it flies on rocket engines, for minutes"),
        (bool(odd), f"its engine's file is {', '.join(odd)}"),
        (bool(missing), f"its controls take no {' and no '.join(missing)} command"),
    )
    return next((reason for holds, reason in reasons if holds), "")


def _text(config: ET.Element, folder: Path) -> str:
    """Return the text of the model and of the files beside it."""
    files = sorted(path for path in folder.rglob("*.xml"))
    shared = [
        _root() / "systems" / f"{(system.get('file') or '').removesuffix('.xml')}.xml"
        for system in config.iterfind("system[@file]")
    ]
    return "".join(path.read_text(encoding="utf-8", errors="replace") for path in [*files, *filter(Path.is_file, shared)])
