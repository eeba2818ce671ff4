"""Finding aircraft by name: those of this project, those of JSBSim, and why some of those cannot be
flown.
"""

import re
from pathlib import Path

import jsbsim
import pytest

from aircraft.fdm import Fdm
from aircraft.fleet.find import aircraft_names, find_spec, stock_names
from aircraft.fleet.x8 import X8
from aircraft.spec import AircraftError
from aircraft.trim import trim

STOCK = Path(jsbsim.get_default_root_dir()) / "aircraft"


def reason(name):
    with pytest.raises(AircraftError) as caught:
        find_spec(name)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_every_aircraft_of_jsbsim_is_found_or_refused_with_a_reason():
    found = []
    for name in stock_names():
        try:
            spec, refusal = find_spec(name), ""
        except AircraftError as error:
            spec, refusal = None, str(error)
        if spec is None:
            assert re.fullmatch(rf"aircraft '{name}' cannot be flown: [^\n]{{10,}}", refusal)
            continue
        assert (spec.name, spec.model, spec.root) == (name, name, STOCK.parent)
        assert {i.name for i in spec.inputs} == {"elevator", "aileron", "throttle", "rudder"}
        # A throttle for each engine in the model's file.
        text = (STOCK / name / f"{name}.xml").read_text(encoding="utf-8", errors="replace")
        engines = len(re.findall(r"<engine\s", re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)))
        commands = spec.input("throttle").commands
        assert len(commands) == len(set(commands)) == engines, name
        found.append(name)
    assert {"c172x", "c310", "T37", "737", "J3Cub"} <= set(found)


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


SOURCE = """
from dataclasses import replace

from aircraft.fleet.x8 import X8

TRAINER = replace(X8, name="trainer", title="X8 of another name")
NOT_AN_AIRCRAFT = 3.0
UNTRIMMED = replace(X8, settle_time=-1.0)
"""


@pytest.fixture
def added_file(tmp_path):
    path = tmp_path / "added_aircraft.py"
    path.write_text(SOURCE, encoding="utf-8")
    return path


def test_an_aircraft_of_a_python_file_is_found_and_trims_as_the_original(added_file):
    spec = find_spec(f"{added_file}:TRAINER")
    assert (spec.name, spec.title) == ("trainer", "X8 of another name")
    found, original = (trim(Fdm(each), airspeed=20.0, altitude=100.0) for each in (spec, X8))
    assert found == original  # the same model, so the same search to the last bit


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("{file}:UNTRIMMED", "settle_time is -1 s"),
        ("{file}:NOT_AN_AIRCRAFT", "is of type float; it must be an AircraftSpec"),
        ("{file}:TRAINR", "has no 'TRAINR'; did you mean 'TRAINER'?"),
        ("absent.py:TRAINER", "absent.py: cannot be read"),
    ],
)
def test_what_does_not_load_or_is_no_aircraft_is_one_line_with_the_reason(added_file, name, why):
    assert why in reason(name.format(file=added_file))


def test_an_aircraft_of_an_installed_package_is_listed_and_found(added_file, monkeypatch):
    """As after pip install: a file on the path, and entry points."""
    metadata = added_file.parent / "added_aircraft-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Name: added-aircraft\nVersion: 1.0\n", encoding="utf-8")
    points = "trainer = added_aircraft:TRAINER\nnumber = added_aircraft:NOT_AN_AIRCRAFT\n"
    text = f"[plume_flight_study.aircraft]\n{points}lost = added_aircraft:LOST\n"
    (metadata / "entry_points.txt").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(added_file.parent)
    assert "trainer" in aircraft_names()
    assert find_spec("trainer").title == "X8 of another name"
    assert "did you mean 'trainer'?" in reason("trayner")
    assert "'number' is of type float; it must be an AircraftSpec" in reason("number")
    assert "'lost' of package added_aircraft:LOST: load() failed: AttributeError" in reason("lost")
