"""Finding aircraft by name: those of this project, those of JSBSim, and why some of those cannot be
flown.
"""

import re
from dataclasses import replace
from pathlib import Path

import jsbsim
import numpy as np
import pytest

from aircraft.errors import AircraftError
from aircraft.fleet.aerosonde import AEROSONDE
from aircraft.fleet.find import aircraft_names, find_spec
from aircraft.fleet.stock import stock_names
from aircraft.fleet.x8 import X8
from aircraft.spec import Actuator, DrivenState, servo_position, surface, throttle

STOCK = Path(jsbsim.get_default_root_dir()) / "aircraft"


def reason(name):
    with pytest.raises(AircraftError) as caught:
        find_spec(name)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_the_projects_own_aircraft_are_found_first():
    assert find_spec("x8") is X8
    assert find_spec("aerosonde") is AEROSONDE
    assert aircraft_names()[:2] == ["aerosonde", "x8"]
    assert len(set(aircraft_names())) == len(aircraft_names())


def test_every_aircraft_that_jsbsim_brings_has_a_name_here():
    # A directory with a model file of its name, as JSBSim loads it.
    expected = {path.parent.name for path in STOCK.glob("*/*.xml") if path.stem == path.parent.name}
    assert set(stock_names()) == expected
    assert len(expected) > 40
    assert expected <= set(aircraft_names())


@pytest.mark.parametrize("name", stock_names())
def test_every_aircraft_of_jsbsim_is_found_or_refused_with_a_reason(name):
    try:
        spec = find_spec(name)
    except AircraftError as error:
        spec, refusal = None, str(error)
    if spec is None:
        assert re.fullmatch(rf"aircraft '{name}' cannot be flown: [^\n]{{10,}}", refusal)
        return
    assert (spec.name, spec.model, spec.root) == (name, name, STOCK.parent)
    assert {i.name for i in spec.inputs} == {"elevator", "aileron", "throttle", "rudder"}
    # A throttle for each engine in the model's own file.
    text = (STOCK / name / f"{name}.xml").read_text(encoding="utf-8", errors="replace")
    engines = len(re.findall(r"<engine\s", re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)))
    assert len(spec.input("throttle").commands) == engines
    assert len(set(spec.input("throttle").commands)) == engines
    assert "own autopilot off" in spec.source


@pytest.mark.parametrize("name", ["c172x", "c310", "T37", "737", "J3Cub"])
def test_aeroplanes_with_engines_are_found(name):
    assert find_spec(name).envelope is None  # which is found by trimming it


def test_a_spec_has_a_throttle_and_a_running_flag_for_each_engine_that_must_be_started():
    twin = find_spec("c310")
    assert twin.input("throttle").commands == ("fcs/throttle-cmd-norm", "fcs/throttle-cmd-norm[1]")
    assert twin.engine_flags == (
        "propulsion/engine/set-running",
        "propulsion/engine[1]/set-running",
    )
    # An electric motor turns when it gets current.
    assert X8.engine_flags == ()


# Each is what its name says; the reason names what it is or has not.
@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("ah1s", "rotorcraft"),
        ("weather-balloon", "lighter than air"),
        ("Submarine_Scout", "lighter than air"),
        ("F450", "its engines lift it"),
        ("J246", "rocket"),
        ("X15", "rocket"),
        ("SGS", "no engine"),
        ("ball", "no engine"),
    ],
)
def test_what_is_no_aeroplane_with_engines_is_refused_for_what_it_is(name, why):
    assert why in reason(name)


def test_an_unknown_name_is_refused_with_its_nearest_neighbour_and_where_names_are_listed():
    assert "unknown aircraft 'c172'; did you mean 'c172" in reason("c172")
    assert "unknown aircraft 'aerosond'; did you mean 'aerosonde'?" in reason("aerosond")
    assert "unknown aircraft 'Cessna'" in reason("Cessna")
    assert "did you mean 'x8'?" in reason("X8")
    assert "plume-flight design --list" in reason("zeppelin NT")
    assert "did you mean" not in reason("zzz")


@pytest.mark.parametrize("name", ["", "..", "."])
def test_what_is_no_name_is_unknown(name):
    assert "unknown aircraft" in reason(name)


@pytest.mark.parametrize("name", ["../aircraft/c172x", "c172x/", "none/c172x"])
def test_a_path_is_that_of_a_folder_and_no_name_of_jsbsims_own(name):
    assert f"aircraft '{name}': there is no such directory" in reason(name)


THREE = (surface("elevator"), surface("aileron"), throttle(1))
MAY = "; it needs elevator, aileron, throttle, may have rudder, and no others: correct its spec"


@pytest.mark.parametrize(
    ("parts", "why"),
    [
        (
            {"inputs": (*THREE, surface("flap"))},
            f"has the inputs elevator, aileron, throttle, flap{MAY}",
        ),
        (
            {"inputs": (*THREE, surface("rudder"), surface("flap"))},
            f"aileron, throttle, rudder, flap{MAY}",
        ),
        (
            {"inputs": (THREE[0], THREE[2], surface("rudder"))},
            f"has the inputs elevator, throttle, rudder{MAY}",
        ),
        (
            {"inputs": (*THREE, THREE[0])},
            f"has the inputs elevator, aileron, throttle, elevator{MAY}",
        ),
        ({"inputs": ()}, f"has the inputs (none){MAY}"),
        (
            {"driven_states": (servo_position("rudder"),)},
            "driven state 'rudder_position' follows input 'rudder', which is none of elevator, aileron, throttle; correct its spec",
        ),
        (
            {
                "driven_states": (
                    *X8.driven_states,
                    DrivenState(name="rpm", position="a/b", input="throttle"),
                )
            },
            ": driven state 'rpm' follows input 'throttle', as another one does; correct its spec",
        ),
        (
            {"inputs": (replace(THREE[0], commands=()), *THREE[1:])},
            "input 'elevator' has no commands; name the JSBSim properties",
        ),
        (
            {"inputs": (replace(THREE[0], lower=1.0, upper=-1.0), *THREE[1:])},
            "input 'elevator' ranges from 1 to -1; lower must be",
        ),
        (
            {"inputs": (replace(THREE[0], lower=0.1), *THREE[1:])},
            "'elevator' ranges from 0.1 to 1; lower must be below 0, and upper",
        ),
        (
            {"own_actuators": (Actuator(name="left elevon", commands=("a/b",)),)},
            "'left elevon' is no name of an actuator, or taken",
        ),
        (
            {"own_actuators": (*X8.own_actuators, X8.own_actuators[0])},
            "'left_elevon' is no name of an actuator, or taken; use let",
        ),
        (
            {"own_actuators": (Actuator(name="engine", commands=THREE[2].commands),)},
            "'engine' is no name of an actuator, or taken",
        ),
        (
            {"own_actuators": (Actuator(name="flap", commands=("fcs/flap",)),)},
            "actuator 'flap' has commands of its own and no feed",
        ),
        (
            {"own_actuators": (Actuator(name="flap", commands=()),)},
            "actuator 'flap' has no commands; name the JSBSim properties",
        ),
        (
            {"settle_time": -1.0},
            "settle_time is -1 s; it must lie between 0.1 and 120 s; correct its spec",
        ),
        (
            {"envelope": replace(X8.envelope, airspeed_max=15.0)},
            "airspeed is 19.42 m/s; it must lie between airspeed_min, 15, and",
        ),
        (
            {"envelope": replace(X8.envelope, airspeed_min=25.0, airspeed_max=15.0)},
            "airspeed_min, 25, and airspeed_max, 15 m/s",
        ),
        (
            {"envelope": replace(X8.envelope, airspeed_min=-1.0)},
            "airspeed_min, -1, and airspeed_max, 25 m/s, and these above 0",
        ),
        (
            {"envelope": replace(X8.envelope, bank=0.0)},
            "bank is 0 deg (0 rad); it must lie between 5 and 60 deg: give radians",
        ),
        (
            {"envelope": replace(X8.envelope, bank=45.0)},
            "bank is 2578.31 deg (45 rad); it must lie between 5 and 60 deg",
        ),
        (
            {"name": "A&B/C"},
            "'A&B/C' is no name of an aircraft; use letters, digits, '_', '-' and '.': correct its spec",
        ),
        # Of other types than the spec declares: each was a traceback, or was taken for something
        # else.
        ({"name": None}, "name is None, of type NoneType; it must be text; correct its spec"),
        (
            {"root": "models"},
            "aircraft 'own': root is 'models', of type str; it must be of type Path; correct its spec",
        ),
        ({"root": None}, "root is None, of type NoneType; it must be of type Path"),
        ({"folder": "x8"}, "folder is 'x8', of type str; it must be of type Path"),
        ({"settle_time": "2"}, "settle_time is '2', of type str; it must be a number"),
        ({"settle_time": True}, "settle_time is True, of type bool; it must be a number"),
        (
            {"configuration": {"fcs/flap": 0.3}},
            "configuration is {'fcs/flap': 0.3}, of type dict; it must be of type tuple[tuple[str, float], ...], as"
            " (('fcs/flap', 0.3),); correct its spec",
        ),
        (
            {"configuration": ("fcs/flap", 0.3)},
            "configuration[0] is 'fcs/flap', of type str; it must be of type tuple[str, float]",
        ),
        (
            {"configuration": (("fcs/flap", 0.3, 1.0),)},
            "configuration[0] is ('fcs/flap', 0.3, 1.0), of type tuple; it must be",
        ),
        (
            {"inputs": (replace(THREE[0], commands="fcs/elevator-cmd-norm"), *THREE[1:])},
            "inputs[0].commands is 'fcs/elevator-cmd-norm', of type str; it must be of type tuple[str, ...], which of one item has"
            " a comma: ('fcs/elevator-cmd-norm',); correct its spec",
        ),
        ({"inputs": THREE[0]}, "of type ControlInput; it must be of type tuple[ControlInput, ...]"),
        (
            {"envelope": (15.0, 25.0)},
            "envelope is (15.0, 25.0), of type tuple; it must be of type Envelope",
        ),
        (
            {"envelope": replace(X8.envelope, bank="45")},
            "envelope.bank is '45', of type str; it must be a number",
        ),
    ],
)
def test_an_aircraft_of_a_file_that_the_autopilot_cannot_fly_with_is_refused(
    tmp_path, monkeypatch, parts, why
):
    own = replace(X8, **{"name": "own", **parts})
    monkeypatch.setattr("common.registry.part_in_file", lambda _: own)
    assert why in reason(f"{tmp_path / 'own.py'}:OWN")


def test_lists_and_numbers_of_numpy_will_do_in_the_spec_of_a_file(tmp_path, monkeypatch):
    own = replace(
        X8,
        name="own",
        inputs=list(X8.inputs),
        settle_time=np.float32(2.0),
        configuration=[("fcs/flap", 1)],
    )
    monkeypatch.setattr("common.registry.part_in_file", lambda _: own)
    assert find_spec(f"{tmp_path / 'own.py'}:OWN") is own
