"""Aircraft that a Python file or an installed package adds are found, listed and trimmed; what is
not an aircraft is refused.
"""

import pytest

from aircraft.dynamics.trim import trim
from aircraft.errors import AircraftError
from aircraft.fleet.find import aircraft_names, find_spec
from aircraft.fleet.x8 import X8
from aircraft.simulation.fdm import Fdm

SOURCE = """
from dataclasses import replace

from aircraft.fleet.x8 import X8

TRAINER = replace(X8, name="trainer", title="X8 of another name")
NOT_AN_AIRCRAFT = 3.0
"""


@pytest.fixture
def added_file(tmp_path):
    path = tmp_path / "added_aircraft.py"
    path.write_text(SOURCE, encoding="utf-8")
    return path


@pytest.fixture
def installed(added_file, monkeypatch):
    """The file as a package whose entry points are known, as after pip install."""
    metadata = added_file.parent / "added_aircraft-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: added-aircraft\nVersion: 1.0\n", encoding="utf-8"
    )
    points = "trainer = added_aircraft:TRAINER\nnumber = added_aircraft:NOT_AN_AIRCRAFT\nlost = added_aircraft:LOST\n"
    (metadata / "entry_points.txt").write_text(
        f"[plume_flight_study.aircraft]\n{points}", encoding="utf-8"
    )
    monkeypatch.syspath_prepend(added_file.parent)


def assert_it_trims_as_the_x8_does(spec):
    found, original = (trim(Fdm(each), airspeed=20.0, altitude=100.0) for each in (spec, X8))
    assert found == original  # the same model, so the same search to the last bit


def test_an_aircraft_of_a_python_file_is_found_and_trims(added_file):
    spec = find_spec(f"{added_file}:TRAINER")
    assert (spec.name, spec.title) == ("trainer", "X8 of another name")
    assert_it_trims_as_the_x8_does(spec)


@pytest.mark.usefixtures("installed")
def test_an_aircraft_of_an_installed_package_is_listed_found_and_trims():
    assert "trainer" in aircraft_names()
    assert_it_trims_as_the_x8_does(find_spec("trainer"))
    with pytest.raises(AircraftError, match=r"did you mean 'trainer'\?"):
        find_spec("trayner")


def test_a_package_is_known_only_while_it_is_installed():
    assert "trainer" not in aircraft_names()


@pytest.mark.usefixtures("installed")
@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("number", "'number' is of type float; it must be an AircraftSpec of aircraft/spec.py"),
        ("lost", "'lost' of package added_aircraft:LOST: AttributeError"),
        ("{file}:NOT_AN_AIRCRAFT", "is of type float; it must be an AircraftSpec"),
        ("{file}:TRAINR", "has no 'TRAINR'; did you mean 'TRAINER'?"),
        ("absent.py:TRAINER", "absent.py: cannot be read"),
    ],
)
def test_what_does_not_load_or_is_no_aircraft_is_one_line_with_the_reason(added_file, name, why):
    with pytest.raises(AircraftError) as caught:
        find_spec(name.format(file=added_file))
    assert why in str(caught.value)
    assert "\n" not in str(caught.value)
