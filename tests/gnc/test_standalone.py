"""gnc stands alone: its modules import and its tests are collected where only numpy, scipy, common, pytest and hypothesis are."""

import ast
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
# "control>=0.10.2" and the like; each is imported by the name it is installed by.
DEPENDENCIES = {requirement.partition(">=")[0] for requirement in PROJECT["project"]["dependencies"]}
BARRED = sorted(
    (DEPENDENCIES | {name.rstrip("*") for name in PROJECT["tool"]["setuptools"]["packages"]["find"]["include"]})
    - {"gnc", "common", "numpy", "scipy"}
)
MODULES = sorted(".".join(path.relative_to(ROOT).with_suffix("").parts) for path in (ROOT / "gnc").rglob("*.py"))

BAR = f"""
import sys

class Bar:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {BARRED!r}:
            raise ModuleNotFoundError(f"{{name}} is barred", name=name)

sys.meta_path.insert(0, Bar())
"""


def run(script):
    """Run a script behind the bar, in the root of the checkout; an interpreter that is started anew has imported nothing yet."""
    return subprocess.run([sys.executable, "-c", BAR + script], cwd=ROOT, capture_output=True, text=True, timeout=300, check=False)


@pytest.mark.parametrize("name", ["jsbsim", "control", "aircraft.simulation.fdm", "scenarios"])
def test_the_bar_keeps_out_what_gnc_must_not_know(name):
    outcome = run(f"import {name}")
    assert outcome.returncode == 1
    assert f"{name.partition('.')[0]} is barred" in outcome.stderr


def test_every_module_of_gnc_imports_with_numpy_scipy_and_what_all_rooms_share():
    assert {"gnc.laws.cascade", "gnc.laws.lyapunov", "gnc.laws.delta", "gnc.tracker", "gnc.reference.oscillating"} <= set(MODULES)
    outcome = run("".join(f"import {module}\n" for module in MODULES))
    assert outcome.returncode == 0, outcome.stderr


def test_the_tests_of_gnc_are_collected_with_numpy_and_scipy_alone():
    # What tests/conftest.py imports counts, too.
    outcome = run("import pytest; sys.exit(pytest.main(['--collect-only', '-p', 'no:cacheprovider', 'tests/gnc']))")
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr
    assert "test_cascade.py::test_equation_35_is_23_whatever_the_state" in outcome.stdout


def test_no_test_of_gnc_asks_for_an_aircraft():
    # The fixtures of tests/conftest.py import theirs only when they are used.
    for path in (ROOT / "tests" / "gnc").rglob("test_*.py"):
        functions = [node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.FunctionDef)]
        assert not {argument.arg for node in functions for argument in node.args.args if argument.arg.startswith("x8_")}
