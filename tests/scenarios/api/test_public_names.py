"""Names that scripts rely on.

Where the first of these tests fails, scripts of users break: change docs/reference/api.md with it.
"""

import subprocess
import sys
from pathlib import Path

import scenarios


def test_the_public_names_are_these():
    assert scenarios.__all__ == [
        "Flight",
        "InputError",
        "Run",
        "Scenario",
        "Statistics",
        "fly",
        "load",
        "read_ais",
        "run",
    ]
    assert set(scenarios.__all__) <= set(dir(scenarios))


def python(code):
    found = subprocess.run(
        [sys.executable, "-c", code],
        cwd=Path(__file__).parents[3],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (found.returncode, found.stderr) == (0, ""), found.stderr


def test_importing_the_package_imports_nothing_of_others_and_its_names_no_simulator_and_no_figures():
    python(
        "import sys, scenarios\n"
        "heavy = {'numpy', 'scipy', 'pandas', 'control', 'jsbsim', 'matplotlib', 'pydantic', 'typer'}\n"
        "if found := sorted(heavy & set(sys.modules)): sys.exit('the package: ' + ', '.join(found))\n"
        "from scenarios import fly, load, run, Scenario\n"
        "heavy = {'pandas', 'control', 'jsbsim', 'matplotlib', 'typst'}\n"
        "if found := sorted(heavy & set(sys.modules)): sys.exit('the names: ' + ', '.join(found))"
    )
