"""The core without its extensions: it imports, flies, reports and exports."""

import os
import shutil
import subprocess
import sys

import pytest

from tests.standing_alone import ROOT

pytestmark = pytest.mark.slow

CORE = ("aircraft", "common", "gnc", "innerloop", "measurement", "reports", "scenarios")

WITHOUT_EXTENSIONS = """
import sys

class Bar:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == "extensions":
            raise ModuleNotFoundError("there are no extensions", name=name)

sys.meta_path.insert(0, Bar())
"""
"""The environment's own installation would find them where they were."""

SCRIPT = """
import importlib, pkgutil, sys
from pathlib import Path
from unittest import mock

from common.registry import announced

# Commands first: they show that nothing has to be imported before them.
def command(*arguments):
    from scenarios.cli.main import main

    with mock.patch.object(sys, "argv", ["plume-flight", *arguments]):
        try:
            main()
        except SystemExit as ended:
            assert ended.code in (None, 0, 1), (arguments, ended.code)

command("run", "--list")
short = ("fidelity=kinematic", "sweep.nu=[0.5]", "flight.crossings=3", "comparison.nu=[]")
settings = [word for one in short for word in ("--set", one)]
command("run", "sweep_nu", *settings, "--jobs", "1", "--out", "run")
command("export", "run", "--to", "kmz,geojson")
assert [*announced("exporter")] == []
for room in ROOMS:
    package = importlib.import_module(room)
    assert Path(package.__file__).parent == Path.cwd() / room
    for found in pkgutil.walk_packages(package.__path__, f"{room}."):
        if not found.name.endswith("__main__"):
            importlib.import_module(found.name)
"""


def test_it_flies_reports_exports_and_imports_where_there_are_no_extensions(tmp_path):
    # A copy of the rooms, and an installation that announces no part of any extension.
    for room in CORE:
        shutil.copytree(
            ROOT / room, tmp_path / room, ignore=shutil.ignore_patterns("__pycache__", "*.so")
        )
    metadata = tmp_path / "plume_flight_study-1.0.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: plume-flight-study\nVersion: 1.0.0\n", encoding="utf-8"
    )
    (tmp_path / "sitecustomize.py").write_text(WITHOUT_EXTENSIONS, encoding="utf-8")
    ran = subprocess.run(
        [sys.executable, "-c", f"ROOMS = {CORE}\n{SCRIPT}"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=500,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout[-3000:] + ran.stderr[-3000:]
    assert "sweep_nu" in ran.stdout
    assert "sweep_nu.kmz" in ran.stdout
    for name in ("report.html", "report.pdf", "summary.csv", "columns.json"):
        assert (tmp_path / "run" / name).stat().st_size > 0
