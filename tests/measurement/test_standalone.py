"""measurement stands alone: its modules import, and its tests are collected, where only numpy, scipy, pandas and pytest are."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
# "control>=0.10.2" and the like; each is imported by the name it is installed by.
INSTALLED = {requirement.partition(">=")[0] for requirement in PROJECT["project"]["dependencies"]} | {"hypothesis"}
ROOMS = {name.rstrip("*") for name in PROJECT["tool"]["setuptools"]["packages"]["find"]["include"]}
BARRED = sorted((INSTALLED | ROOMS) - {"measurement", "numpy", "pandas", "scipy"})
MODULES = sorted(".".join(path.relative_to(ROOT).with_suffix("").parts) for path in (ROOT / "measurement").rglob("*.py"))

BAR = f"""
import sys

class Bar:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {BARRED!r}:
            raise ModuleNotFoundError(f"{{name}} is barred", name=name)

sys.meta_path.insert(0, Bar())
"""


def run(script):
    return subprocess.run([sys.executable, "-c", BAR + script], cwd=ROOT, capture_output=True, text=True, timeout=300, check=False)


@pytest.mark.parametrize("name", ["common", "gnc", "hypothesis", "pydantic"])
def test_the_bar_keeps_out_what_measurement_must_not_know(name):
    outcome = run(f"import {name}")
    assert outcome.returncode == 1
    assert f"{name} is barred" in outcome.stderr


def test_every_module_imports():
    assert {"measurement.gases", "measurement.emission.emission", "measurement.plume.fluctuating_plume"} <= set(MODULES)
    outcome = run("".join(f"import {module.removesuffix('.__init__')}\n" for module in MODULES))
    assert outcome.returncode == 0, outcome.stderr


def test_the_tests_are_collected():
    # What tests/conftest.py imports counts, too.
    options = ["--collect-only", "-p", "no:cacheprovider", "-p", "no:hypothesispytest", "tests/measurement"]
    outcome = run(f"import pytest; sys.exit(pytest.main({options}))")
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr
    assert "test_flux.py::test_what_passes_a_plane_is_what_was_emitted" in outcome.stdout
