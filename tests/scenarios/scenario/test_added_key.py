"""A scenario key is added in two files, the section that has it and the code that uses it: a copy of
the package gets one, and everything that is said of keys says it.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[3]

SECTION = "scenarios/scenario/sections/world.py"
ANCHOR = '    @field_validator("track")'
FIELD = '''\
    current_mps: Annotated[float, Field(ge=-3.0, le=3.0), OWN_TRACK] = 0.0
    """Current that carries the vessel along [m/s]."""

'''
USE = "scenarios/scenario/scenario.py"
SPEED = "return self.vessel.speed_mps if ratio is None else ratio * self.guidance.airspeed_mps"

LOOK = """
import json, sys
from scenarios.cli.describe import described
from scenarios.cli.template import template
from scenarios.errors import InputError
from scenarios.scenario.files import load_study
from scenarios.studies.manifest import parameters
sys.path.insert(0, sys.argv[1])
from reference_pages.keys import keys_page

def refusal(name, *overrides):
    try:
        load_study(name, overrides)
    except InputError as error:
        return str(error)

carried = load_study("sea_approach", ["vessel.current_mps=1.5"])
print(json.dumps({
    "help": described("vessel.current_mps"),
    "page": [line for line in keys_page().splitlines() if "current_mps" in line],
    "template": [of for of in template("sweep_nu", "x.toml").splitlines() if "current_mps" in of],
    "manifest": [of for of in parameters(carried) if of["key"] == "vessel.current_mps"],
    "used": carried.vessel_speed - load_study("sea_approach", ["vessel.current_mps=0"]).vessel_speed,
    "limit": refusal("sea_approach", "vessel.current_mps=9"),
    "name": refusal("sea_approach", "vessel.curent_mps=1"),
    "idle": refusal("ship_from_ais", "vessel.current_mps=1"),
}))
"""


def test_a_key_is_added_in_its_section_and_where_it_is_used(tmp_path):
    leave = shutil.ignore_patterns("*.so", "__pycache__")
    shutil.copytree(ROOT / "scenarios", tmp_path / "scenarios", ignore=leave)
    before = sources(tmp_path)
    edit(tmp_path / SECTION, ANCHOR, FIELD + ANCHOR)
    edit(
        tmp_path / USE, SPEED, f"{SPEED.replace('return ', 'return (')}) + self.vessel.current_mps"
    )
    after = sources(tmp_path)
    assert {path for path in after if after[path] != before.get(path)} == {SECTION, USE}

    ended = subprocess.run(
        [sys.executable, "-c", LOOK, ROOT / "docs" / "_ext"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": f"{tmp_path}{os.pathsep}{ROOT}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    found = json.loads(ended.stdout)
    described = "\n".join(found["help"])
    assert "Current that carries the vessel along." in described
    assert "a number from -3 to 3" in described
    assert "a vessel whose track is not from a file" in described
    (row,) = found["page"]
    assert "m/s" in row
    assert found["template"] == ["# current_mps = 0.0"]
    (parameter,) = found["manifest"]
    assert (parameter["value"], parameter["unit"]) == (1.5, "m/s")
    assert found["used"] == 1.5
    assert found["limit"] == (
        "vessel.current_mps is 9; input should be less than or equal to 3 [m/s]"
    )
    assert found["name"].endswith("did you mean 'vessel.current_mps'?")
    assert "'vessel.current_mps' has no effect here: it is used by a vessel whose" in found["idle"]


def edit(path, old, new):
    text = path.read_text(encoding="utf-8")
    assert text.count(old) == 1
    path.write_text(text.replace(old, new), encoding="utf-8")


def sources(folder):
    return {
        str(path.relative_to(folder)): path.read_text(encoding="utf-8")
        for path in folder.rglob("*.py")
    }
