"""An installed package adds to the program through entry points alone, as extensions do."""

import csv
import json
import re
from html import unescape

import pytest

from tests.extensions.added_package import AddedPackage

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


def test_its_scenario_is_in_the_catalog_and_flies_its_study_with_its_keys_and_report(package):
    assert re.search(r"^weaving_about +Weaving$", package.command("run", "--list").stdout, re.M)
    ran = package.command(
        "run", "weaving_about", "--set", "weaves=3", "--out", "run", "--jobs", "1"
    )
    assert ran.returncode in (0, 1), ran.stderr
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
    assert (run / "report.pdf").is_file()


def test_its_keys_are_described_and_stand_in_templates(package):
    told = package.command("describe", "weaving").stdout
    assert "Flights that weave." in told
    assert "width_m" in told
    assert "flights that weave" in package.command("describe", "weaves").stdout
    package.command("new", "all.toml", "--from", "weaving_about")
    text = (package.folder / "all.toml").read_text(encoding="utf-8")
    assert "[weaving]" in text
    assert "width_m = 12.0" in text


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ["sweep_nu", "--set", "weaving.width_m=3"],
            "it is used by flights that weave: set study to 'weaving'",
        ),
        (["weaving_about", "--set", "weaving.width_m=-3"], "weaving.width_m is -3"),
        (["weaving_about", "--set", "weaving.wdth_m=3"], "weaving.width_m"),
    ],
)
def test_what_is_wrong_with_its_keys_is_one_line(package, arguments, words):
    ran = package.command("run", *arguments)
    assert ran.returncode == 2
    assert words in ran.stderr
    assert ran.stderr.count("\n") == 1


def test_its_command_stands_beside_the_others(package):
    assert "weave" in package.command("--help").stdout
    assert package.command("weave", "--times", "2").stdout == "wove 2 times\n"


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
    assert broken.command("run", "--list").returncode == 0
    for study in ("lost", "found"):
        ran = broken.command("run", "sweep_nu", "--set", f"study={study}")
        assert ran.returncode == 2
        assert "No module named 'no_such_module'" in ran.stderr
        assert ran.stderr.count("\n") == 1
