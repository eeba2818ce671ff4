"""What was compiled is run until a source is edited, or sources are asked for; a part of it is not
run alone.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MODULE = "gnc.estimation.health"


@pytest.fixture
def packages(tmp_path):
    """Copies of the packages, and a module that stands for what was compiled of them."""
    for name in ("common", "gnc", "scenarios"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    found = asked(
        tmp_path,
        "from gnc.compiled import FOLDER, sources_hash; print(FOLDER); print(sources_hash())",
    )
    folder, sources = found.splitlines()
    Path(folder).mkdir(parents=True)
    (Path(folder) / "health.py").touch()
    index = {"sources": sources, "modules": {MODULE: "health.py"}}
    (Path(folder) / "index.json").write_text(json.dumps(index), encoding="utf-8")
    return tmp_path


def asked(packages, code, **environment):
    """Return what a program prints, in a process of its own."""
    kept = {name: value for name, value in os.environ.items() if name != "PLUME_FLIGHT_SOURCES"}
    run = subprocess.run(
        [sys.executable, "-c", code],
        cwd=packages,
        env={**kept, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return run.stdout.strip()


def is_compiled(packages, **environment):
    """Return which form of the module is imported."""
    file = asked(packages, f"import {MODULE} as module; print(module.__file__)", **environment)
    assert file.endswith("health.py")
    return "build" in Path(file).relative_to(packages).parts


def test_what_was_compiled_is_run_unless_sources_are_asked_for(packages):
    assert is_compiled(packages)
    assert not is_compiled(packages, PLUME_FLIGHT_SOURCES="1")


@pytest.mark.parametrize("edited", ["gnc/estimation/health.py", "scenarios/flight/record.py"])
def test_once_a_source_is_edited_the_sources_are_run(packages, edited):
    path = packages / edited
    times = path.stat()
    path.write_text(path.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    # Its time says nothing: a copy or an archive may bring an older one.
    os.utime(path, (times.st_atime, times.st_mtime))
    assert not is_compiled(packages)
