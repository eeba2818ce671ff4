"""Of a module that is compiled, its source is run if it was edited since, or is asked for."""

import os
import shutil
import subprocess
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EDITED, COMPILED = 1_700_000_000, 1_700_000_060


@pytest.fixture(scope="module")
def packages(tmp_path_factory):
    """Copies of the packages, in which a file that is no module stands for what was compiled."""
    folder = tmp_path_factory.mktemp("packages")
    for name in ("common", "gnc"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("*.so", "__pycache__"))
    form = folder / "gnc" / "estimation" / f"health{EXTENSION_SUFFIXES[0]}"
    form.touch()
    for source in (folder / "gnc").rglob("*.py"):
        os.utime(source, (EDITED, EDITED))
    os.utime(form, (COMPILED, COMPILED))
    return folder


def imported(packages, **environment):
    """Import the module in a process of its own."""
    kept = {name: value for name, value in os.environ.items() if name != "PLUME_FLIGHT_SOURCES"}
    code = "import gnc.estimation.health as module; print(module.__file__)"
    return subprocess.run(
        [sys.executable, "-c", code], cwd=packages, env={**kept, **environment}, capture_output=True, text=True, check=False
    )


def test_what_was_compiled_after_the_last_edit_is_run(packages):
    # It is no module, and so cannot be.
    run = imported(packages)
    assert run.returncode == 1
    assert "ImportError" in run.stderr


def test_a_source_is_run_if_it_is_asked_for(packages):
    assert imported(packages, PLUME_FLIGHT_SOURCES="1").stdout.strip().endswith("health.py")


def test_a_source_that_was_edited_since_is_run(packages):
    source = packages / "gnc" / "estimation" / "health.py"
    os.utime(source, (COMPILED + 1, COMPILED + 1))
    run = imported(packages)
    os.utime(source, (EDITED, EDITED))
    assert run.stdout.strip().endswith("health.py")


def test_what_another_python_has_compiled_is_nothing_to_this_one(packages):
    form = packages / "gnc" / "estimation" / f"health{EXTENSION_SUFFIXES[0]}"
    other = form.rename(form.with_name("health.cpython-3-other.so"))
    run = imported(packages)
    other.rename(form)
    assert run.stdout.strip().endswith("health.py")
