"""The spec of an aircraft, read from its JSBSim model.

The files give engines and controls, and whether the model is an aeroplane at all. The envelope is
found by trimming (``aircraft.dynamics.envelope``).
"""

import math
import xml.etree.ElementTree as ET

from aircraft.errors import AircraftError
from aircraft.fleet.settings import ModelSettings
from aircraft.model_files import ModelFiles, read_model, read_xml
from aircraft.spec import AircraftSpec, ControlInput, numbered, surface, throttle

_SURFACES = ("elevator", "aileron", "rudder")
_RUNNING_ENGINES = ("piston_engine", "turbine_engine", "turboprop_engine")
"""Kinds of engine that have to be started and then run; electric ones turn when they get current.
"""

_ELECTRIC = ("electric_engine", "brushless_dc_motor")
_STAND_STILL = 20.0
"""Time that piston engines and their propellers need to stand still behind a held aircraft [s]."""


def spec_of_model(
    files: ModelFiles, *, name: str, source: str, settings: ModelSettings | None = None
) -> AircraftSpec:
    """Return the spec of an aircraft with engines and the usual controls.

    Parameters
    ----------
    files : of its model; the first root is that of the spec
    name : of the aircraft
    source : of the model's numbers
    settings : what the user says of it beyond the model, who may say more; None if it is no model
        of the user

    Raises
    ------
    AircraftError : a file is not XML, or an autopilot cannot fly the aircraft, with the reason
    """
    said = settings or ModelSettings()
    try:
        config = read_model(files).getroot()
        engines = [_kind(engine, files) for engine in config.iterfind("propulsion/engine")]
        thrusters = [
            _kind(thruster, files) for thruster in config.iterfind("propulsion/engine/thruster")
        ]
        lifting = any(
            _lifts(thruster) for thruster in config.iterfind("propulsion/engine/thruster")
        )
    except AircraftError as error:
        raise AircraftError(f"aircraft '{name}' cannot be flown: {error}") from None
    inputs = _inputs(len(engines), said)
    reason = _no_aeroplane(config, engines, thrusters, lifting=lifting)
    if reason := reason or _deaf(inputs, config, files, of_user=settings is not None):
        raise AircraftError(f"aircraft '{name}' cannot be flown: {reason}")
    root, *others = files.roots
    usual = {
        "gear/gear-cmd-norm": 0.0,
        "gear/gear-pos-norm": 0.0,
        "propulsion/fuel_freeze": 1.0,
        **{
            f"fcs/{lever}-cmd-norm{numbered(i)}": 1.0
            for lever in ("mixture", "advance")
            for i in range(len(engines))
        },
    }
    return AircraftSpec(
        name=name,
        title=_in_a_line(said.title) if said.title else _title(config, name),
        root=root,
        model=files.model,
        folder=None if files.folder == root / "aircraft" / files.model else files.folder,
        other_roots=tuple(others),
        inputs=inputs,
        envelope=None if said.envelope is None else said.envelope.envelope,
        configuration=tuple((usual | said.properties).items()),
        engine_flags=tuple(
            f"propulsion/engine{numbered(i)}/set-running"
            for i, kind in enumerate(engines)
            if kind in _RUNNING_ENGINES
        ),
        settle_time=_STAND_STILL if said.settle_time_s is None else said.settle_time_s,
        source=source,
    )


def _title(config: ET.Element, name: str) -> str:
    """Return the model's name for itself, unless it is a template's."""
    title = _in_a_line((config.get("name") or "").replace("_", " "))
    return f"{title} ({name})" if title and title.lower() != name.lower() else name


def _in_a_line(text: str) -> str:
    return " ".join(text.split())


def _kind(element: ET.Element, files: ModelFiles) -> str:
    """Return the tag of the file that an engine or a thruster names."""
    found = files.find(element)
    return read_xml(found).getroot().tag if found else f"missing ({element.get('file')})"


def _inputs(engines: int, said: ModelSettings) -> tuple[ControlInput, ...]:
    """Return the control inputs, with the command properties that are said or else usual."""
    usual = {"throttle": throttle(engines), **{name: surface(name) for name in _SURFACES}}
    given = {
        "throttle": said.throttle,
        "elevator": said.elevator,
        "aileron": said.aileron,
        "rudder": said.rudder,
    }
    found = []
    for name in ("elevator", "aileron", "throttle", "rudder"):
        control, commands = usual[name], given[name]
        if commands is None:
            found.append(control)
        elif commands:
            found.append(
                ControlInput(name=name, commands=commands, lower=control.lower, upper=control.upper)
            )
    return tuple(found)


def _lifts(thruster: ET.Element) -> bool:
    """Return whether a thruster lifts more than it drives."""
    try:
        pitch = float(thruster.findtext("orient/pitch", "0"))
    except ValueError:
        return False  # JSBSim refuses it in its own words
    unit = next((orient.get("unit") for orient in thruster.iterfind("orient")), None)
    return abs(math.radians(pitch) if unit == "DEG" else pitch) > math.pi / 4.0


def _no_aeroplane(
    config: ET.Element, engines: list[str], thrusters: list[str], *, lifting: bool
) -> str:
    """Return why this is no aeroplane with engines, or an empty text."""
    odd = [kind for kind in engines if kind not in (*_RUNNING_ENGINES, *_ELECTRIC)]
    reasons = (
        (config.find("buoyant_forces") is not None, "it is lighter than air"),
        ("rotor" in thrusters, "it is a rotorcraft"),
        (lifting, "its engines lift it"),
        (not engines, "it has no engine"),
        ("rocket_engine" in engines, "it flies on rocket engines, for minutes"),
        (bool(odd), f"its engine's file is {', '.join(odd)}"),
    )
    return next((reason for holds, reason in reasons if holds), "")


def _deaf(
    inputs: tuple[ControlInput, ...], config: ET.Element, files: ModelFiles, *, of_user: bool
) -> str:
    """Return which commands no control of the model takes, and what a user may say of it then; or
    an empty text.
    """
    text = _text(config, files)
    surfaces = [control for control in inputs if control.name in _SURFACES]
    missing = [
        control.name
        for control in surfaces
        if any(command not in text for command in control.commands)
    ]
    if not missing:
        return ""
    taken = [f'{name} = "PROPERTY"' for name in missing]
    remedy = f"; name what takes it in {files.model}.toml, {', '.join(taken)}{', or rudder = false' * ('rudder' in missing)}"
    return f"its controls take no {' and no '.join(missing)} command{remedy * of_user}"


def _text(config: ET.Element, files: ModelFiles) -> str:
    """Return the text of the model and of the files beside it, and of the systems that it shares."""
    shared = [found for system in config.iterfind("system[@file]") if (found := files.find(system))]
    beside = sorted(
        path for path in files.folder.rglob("*.xml") if path.is_file()
    )  # a link may lead nowhere
    return "".join(
        path.read_text(encoding="utf-8", errors="replace")
        for path in dict.fromkeys([*beside, *shared])
    )
