"""The core without its extensions: it imports, flies, reports and exports, and its tests pass."""

import os
import shutil
import subprocess
import sys

import pytest

from tests.standing_alone import ROOT

pytestmark = pytest.mark.slow

CORE = ("aircraft", "common", "gnc", "innerloop", "measurement", "reports", "scenarios")

# Fast ones.
TESTS = ("tests/common", "tests/reports/export")

WITHOUT_EXTENSIONS = """
import sys

class Bar:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == "extensions":
            raise ModuleNotFoundError("there are no extensions", name=name)

sys.meta_path.insert(0, Bar())
"""
"""The environment's own installation would find them where they were."""

IMPORTS = """
import importlib, pkgutil, sys
for room in sys.argv[1:]:
    package = importlib.import_module(room)
    for found in pkgutil.walk_packages(package.__path__, f"{room}."):
        if not found.name.endswith("__main__"):
            importlib.import_module(found.name)
"""


class Core:
    """A copy of the project in which there are no extensions, and nothing announces any."""

    def __init__(self, folder):
        self.folder = folder / "core"
        shutil.copytree(
            ROOT,
            self.folder,
            ignore=shutil.ignore_patterns(
                ".*", "extensions", "__pycache__", "build", "runs", "_build", "generated", "*.so"
            ),
        )
        metadata = self.folder / "plume_flight_study-1.0.0.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text(
            "Metadata-Version: 2.1\nName: plume-flight-study\nVersion: 1.0.0\n", encoding="utf-8"
        )
        hook = self.folder / "hook"
        hook.mkdir()
        (hook / "sitecustomize.py").write_text(WITHOUT_EXTENSIONS, encoding="utf-8")

    def python(self, *arguments):
        """Run Python there, and return what it printed."""
        ran = subprocess.run(
            [sys.executable, *arguments],
            cwd=self.folder,
            env={
                **os.environ,
                "PYTHONPATH": os.pathsep.join(map(str, (self.folder / "hook", self.folder))),
                "PYTEST_ADDOPTS": "",
            },
            capture_output=True,
            text=True,
            timeout=500,
            check=False,
        )
        assert ran.returncode == 0, ran.stdout[-3000:] + ran.stderr[-3000:]
        return ran.stdout

    def command(self, *arguments):
        """Run ``plume-flight`` there."""
        return self.python("-c", "from scenarios.cli.main import main; main()", *arguments)


@pytest.fixture(scope="module")
def core(tmp_path_factory):
    return Core(tmp_path_factory.mktemp("alone"))


def test_there_are_no_extensions(core):
    script = "from common.registry import announced; print([*announced('exporter')])"
    assert core.python("-c", script).strip() == "[]"
    script = "import scenarios; print(scenarios.__file__)"
    assert core.python("-c", script).strip() == str(core.folder / "scenarios" / "__init__.py")


def test_every_module_of_the_core_imports(core):
    core.python("-c", IMPORTS, *CORE)


def test_it_flies_reports_and_exports(core):
    listed = core.command("run", "--list")
    assert "sweep_nu" in listed
    short = ("fidelity=kinematic", "sweep.nu=[0.5]", "flight.crossings=3", "comparison.nu=[]")
    settings = [word for one in short for word in ("--set", one)]
    core.command("run", "sweep_nu", *settings, "--jobs", "1", "--out", "run")
    for name in ("report.html", "report.pdf", "summary.csv", "columns.json"):
        assert (core.folder / "run" / name).stat().st_size > 0
    assert "sweep_nu.kmz" in core.command("export", "run", "--to", "kmz,geojson")


def test_its_tests_pass(core):
    told = core.python("-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", *TESTS)
    assert " passed" in told or "100%" in told
