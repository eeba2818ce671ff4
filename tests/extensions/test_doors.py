"""An installed package adds to the program through entry points alone, as extensions do."""

import csv
import json
import os
import re
import subprocess
import sys
from html import unescape

import pytest

from tests.in_process import Ended, assert_refused
from tests.standing_alone import ROOT

pytestmark = pytest.mark.slow

KEYS = '''
from typing import Annotated

from pydantic import Field

from scenarios.scenario.sections.section import Section
from scenarios.scenario.study_keys import StudyKeys


class Weaving(Section):
    """Flights that weave."""

    width_m: Annotated[float, Field(gt=0.0)] = 30.0
    """Width of the weaving [m]."""


class WeavingKeys(StudyKeys):
    STUDY = "weaving"
    USED_BY = "flights that weave"
    ONE_POINT = "it weaves at one point"
    UNUSED = {"histories": "flights that weave keep none"}
    weaving: Weaving = Weaving()
    weaves: int = 2
    """How often they weave [-]."""
'''

STUDY = """
from scenarios.studies.base import FlightStudy


class WeavingStudy(FlightStudy):
    def postprocess(self, run, journal, progress):
        (scenario,) = (of.scenario for of in self.experiments.values())
        text = f"{scenario.weaves} times {scenario.weaving.width_m:g} m"
        (run.path / "weaving.txt").write_text(text, encoding="utf-8")
"""

REPORT = """
from reports.document.blocks import Section, Text
from reports.flights.content import flights_content


def woven(run):
    return f"Wove in {run.verdict.counts.completed} of {run.verdict.counts.planned} flights"


def weaving_content(run):
    found = flights_content(run, woven)
    text = (run.path / "weaving.txt").read_text(encoding="utf-8")
    found.sections.append(Section(anchor="weaving", title="Weaving", blocks=[Text(f"Wove {text}.")]))
    return found
"""

COMMAND = """
from typing import Annotated

import typer


def weave(times: Annotated[int, typer.Option(help="How often.")] = 1) -> None:
    \"\"\"Say it.\"\"\"
    print(f"wove {times} times")
"""

SCENARIO = """
study = "weaving"
title = "Weaving"
fidelity = "kinematic"

[vessel]
speed_ratio = 0.5

[flight]
crossings = 3

[guidance]
rate_hz = 10

[weaving]
width_m = 12.0
"""


COMMANDS = """
import dataclasses, json, sys
from tests.in_process import run_command

ended = [run_command("scenarios.cli.main", *each) for each in json.loads(sys.argv[1])]
print(json.dumps([dataclasses.asdict(each) for each in ended]))
"""


class AddedPackage:
    """A package in its folder, known to every process that it starts.

    Parameters
    ----------
    folder : that holds it
    files : their texts, by paths below the folder
    points : entry points ``name = module:object`` by the kind of part
    """

    def __init__(self, folder, files, points):
        self.folder = folder
        metadata = "added_package-1.0.dist-info"
        announced = [
            line
            for kind, named in points.items()
            for line in (
                f"[plume_flight_study.{kind}]",
                *(f"{name} = {value}" for name, value in named.items()),
            )
        ]
        written = {
            **files,
            f"{metadata}/METADATA": "Metadata-Version: 2.1\nName: added-package\nVersion: 1.0\n",
            f"{metadata}/entry_points.txt": "\n".join(announced) + "\n",
        }
        for name, text in written.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")

    def commands(self, *each):
        """Run ``plume-flight`` with each list of arguments, one after the other in one process where
        the package is installed; return how they ended.
        """
        ran = subprocess.run(
            [sys.executable, "-c", COMMANDS, json.dumps(each)],
            cwd=self.folder,
            env={**os.environ, "PYTHONPATH": f"{self.folder}{os.pathsep}{ROOT}"},
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        assert ran.returncode == 0, ran.stderr
        return [Ended(**ended) for ended in json.loads(ran.stdout)]


FLY = ("run", "weaving_about", "--set", "weaves=3", "--out", "run", "--jobs", "1")


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    return AddedPackage(
        tmp_path_factory.mktemp("weaving"),
        {
            "weaving/__init__.py": "",
            "weaving/keys.py": KEYS,
            "weaving/study.py": STUDY,
            "weaving/report.py": REPORT,
            "weaving/commands.py": COMMAND,
            "weaving/catalog/weaving_about.toml": SCENARIO,
        },
        {
            "keys": {"weaving": "weaving.keys:WeavingKeys"},
            "study": {"weaving": "weaving.study:WeavingStudy"},
            "report": {"weaving": "weaving.report:weaving_content"},
            "catalog": {"weaving": "weaving"},
            "command": {"weave": "weaving.commands:weave"},
        },
    )


def test_a_package_adds_a_scenario_a_study_keys_a_report_and_a_command(package):
    listed, ran, keys, key, _, helped, woven = package.commands(
        ("run", "--list"), FLY, ("describe", "weaving"), ("describe", "weaves"),
        ("new", "all.toml", "--from", "weaving_about"), ("--help",), ("weave", "--times", "2"),
    )  # fmt: skip
    assert re.search(r"^weaving_about +Weaving$", listed.out, re.M)
    assert ran.status in (0, 1), ran.errors
    run = package.folder / "run"
    assert (run / "weaving.txt").read_text(encoding="utf-8") == "3 times 12 m"
    with (run / "summary.csv").open(encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == 1
    config = json.loads((run / "manifest.json").read_text(encoding="utf-8"))["config"]
    assert (config["weaves"], config["weaving"]) == (3, {"width_m": 12.0})
    html = unescape((run / "report.html").read_text(encoding="utf-8"))
    assert "Wove 3 times 12 m." in html
    # Page 1 answers the question of the study in its own words.
    assert "<strong>✓ Wove in 1 of 1 flights</strong>" in html
    assert "Flights that weave." in keys.out
    assert "width_m" in keys.out
    assert "flights that weave" in key.out
    template = (package.folder / "all.toml").read_text(encoding="utf-8")
    assert "[weaving]" in template
    assert "width_m = 12.0" in template
    assert "weave" in helped.out
    assert woven.out == "wove 2 times\n"


def test_what_is_wrong_with_its_keys_is_one_line(package):
    wrong = {
        (
            "sweep_nu",
            "weaving.width_m=3",
        ): "it is used by flights that weave: set study to 'weaving'",
        ("weaving_about", "weaving.width_m=-3"): "weaving.width_m is -3",
        ("weaving_about", "weaving.wdth_m=3"): "weaving.width_m",
    }
    ended = package.commands(*(("run", scenario, "--set", key) for scenario, key in wrong))
    for found, words in zip(ended, wrong.values(), strict=True):
        assert_refused(found, words)


def test_a_package_that_does_not_load_is_in_the_way_of_its_own_study_alone(tmp_path):
    broken = AddedPackage(
        tmp_path,
        {"lost.py": "import no_such_module\n"},
        {
            "keys": {"lost": "lost:Keys"},
            "study": {"lost": "lost:Study"},
            "scenario": {"found": "lost:File"},
        },
    )
    listed, *refused = broken.commands(
        ("run", "--list"),
        *(("run", "sweep_nu", "--set", f"study={study}") for study in ("lost", "found")),
    )
    assert listed.status == 0
    for ended in refused:
        assert_refused(ended, "No module named 'no_such_module'")
