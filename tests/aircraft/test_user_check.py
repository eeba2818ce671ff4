"""A user's aircraft is run before use, whatever its name; supplied ones are not."""

import shutil
import subprocess

import pytest

from aircraft.fleet.find import find_spec
from aircraft.spec import MODELS, AircraftError
from aircraft.user_check import check_user_aircraft

MINE = """
from dataclasses import replace
from pathlib import Path
from aircraft.fleet.x8 import X8
MINE = replace(X8, name="mine", root=Path(__file__).parent)
"""


def test_a_fault_in_the_root_of_a_python_files_aircraft_is_reported_in_a_line(tmp_path):
    shutil.copytree(MODELS, tmp_path, dirs_exist_ok=True)
    model = tmp_path / "aircraft" / "x8" / "x8.xml"
    (tmp_path / "mine.py").write_text(MINE, encoding="utf-8")
    name = f"{tmp_path / 'mine.py'}:MINE"
    check_user_aircraft(find_spec(name))
    text = model.read_text(encoding="utf-8")
    function = (
        '<axis name="DRAG"><function name="aero/x"><property>no/such</property></function></axis>'
    )
    model.write_text(text.replace("<aerodynamics>", f"<aerodynamics>{function}"), encoding="utf-8")
    with pytest.raises(
        AircraftError,
        match=r"aircraft 'mine': JSBSim ends the whole process with its model: .*no/such",
    ) as caught:
        check_user_aircraft(find_spec(name))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["x8", "c172p"])
def test_models_of_the_project_and_of_jsbsim_are_not_looked_at(name, monkeypatch):
    def run(*_, **__):
        raise AssertionError(name)

    monkeypatch.setattr(subprocess, "run", run)
    check_user_aircraft(find_spec(name))
