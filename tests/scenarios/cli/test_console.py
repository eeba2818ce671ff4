"""The console command hands on to the command lines of the project, and says what is known of keys."""

import importlib.metadata
import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from common.registry import announced
from measurement.log.command import main as estimate_logged
from scenarios import fly
from scenarios.cli.describe import described
from scenarios.cli.main import commands
from scenarios.cli.template import template
from scenarios.experiment.points import points_of
from scenarios.scenario.documentation import documented_sections
from scenarios.scenario.effect import unused
from scenarios.scenario.files import CATALOG, catalog, load_study
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.experiment import TrialList
from tests.in_process import assert_refused, run_command

ROOT = Path(__file__).parents[3]

SHORT = """
title = "Two short flights"
fidelity = "kinematic"
guidance.rate_hz = 10.0
histories = 5

[sweep]
nu = [0.3, 0.5]

[flight]
crossings = 2

[criteria]
crossing_interval_error = false
tracking_error_rms_m = false

[vessel]
course_deg = 45.0
"""


def console(*arguments):
    return run_command("scenarios.cli.main", *arguments)


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "short.toml"
    path.write_text(SHORT, encoding="utf-8")
    return path


def test_the_commands_are_these():
    words = [
        "run",
        "design",
        "estimate",
        "calibrate",
        "report",
        "export",
        "describe",
        "new",
        "schema",
    ]
    added = announced("command")
    assert [word for word in commands() if word != "compare" and word not in added] == words
    assert importlib.metadata.version("plume-flight-study") in console("--version").out
    for word in commands():
        assert word in console("--help").out
        assert f"plume-flight {word}" in console(word, "--help").out


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
@pytest.mark.parametrize(
    ("words", "completed"), [("des", {"design", "describe"}), ("describe --he", {"--help"})]
)
def test_a_shell_completes_commands_and_options(words, completed, shell, monkeypatch):
    monkeypatch.setenv("_PLUME_FLIGHT_COMPLETE", f"complete_{shell}")
    # Bash has the words and the number of the last one, the others a line.
    monkeypatch.setenv("COMP_WORDS", f"plume-flight {words}")
    monkeypatch.setenv("COMP_CWORD", str(len(words.split())))
    monkeypatch.setenv("_TYPER_COMPLETE_ARGS", f"plume-flight {words}")
    monkeypatch.setenv("_TYPER_COMPLETE_FISH_ACTION", "get-args")
    said = console().out
    # Zsh has each word in quotation marks, fish before its help; bash has words alone.
    found = {
        "bash": said.split(),
        "zsh": re.findall(r'"([\w-]+)":', said),
        "fish": [line.partition("\t")[0] for line in said.splitlines()],
    }[shell]
    assert {*found} == completed


@pytest.mark.usefixtures("sketched")
def test_a_run_is_flown_reported_and_exported(file, tmp_path):
    out = tmp_path / "run"
    ended = console("run", file, "--out", out, "--jobs", "1", "--no-report")
    assert (ended.status, "results: " in ended.out) == (0, True)
    assert console("report", out).status == 0
    assert (out / "report.html").is_file()
    again = console("run", file, "--out", out, "--jobs", "1", "--resume").out.splitlines()
    assert again[-3:] == [
        "nothing was left to fly: the run was complete",
        *(f"report: {out}/report.{end}" for end in ("html", "pdf")),
    ]
    ended = console("export", out, "--to", "geojson,tracks_csv", "--flight", "nu_0.50")
    assert ended.out.count("export: ") == 2
    assert (
        json.loads((out / "export" / "short.nu_0.50.geojson").read_text(encoding="utf-8"))["type"]
        == "FeatureCollection"
    )


def test_a_log_is_estimated_as_by_the_program_that_stands_alone(tmp_path, capsys):
    log, config = (
        ROOT / "docs" / "examples" / "example_flight.csv",
        ROOT / "docs" / "examples" / "example_instrument.toml",
    )
    ended = console("estimate", log, "--config", config, "--out", tmp_path / "one", "--no-report")
    assert (
        ended.status
        == estimate_logged(
            [str(log), "--config", str(config), "--out", str(tmp_path / "two"), "--no-report"]
        )
        == 0
    )
    assert ended.out.replace("one", "two") == capsys.readouterr().out
    assert_refused(console("estimate", tmp_path / "none.csv"), "none.csv")


def test_a_log_has_to_lie_beside_its_ship_where_a_file_says_where_that_was(tmp_path):
    plain = pd.read_csv(ROOT / "docs" / "examples" / "example_flight.csv")
    # The ship of the file begins at 57.2 deg north, 11.3 deg east, when the log does.
    degree = 111_195.0
    log = plain.drop(columns=["north_m", "east_m"]).assign(
        latitude_deg=57.2 + plain["north_m"] / degree,
        longitude_deg=11.3 + plain["east_m"] / (degree * np.cos(np.radians(57.2))),
    )
    beside, exchanged = tmp_path / "beside.csv", tmp_path / "exchanged.csv"
    log.to_csv(beside, index=False)
    log.rename(columns={"latitude_deg": "longitude_deg", "longitude_deg": "latitude_deg"}).to_csv(
        exchanged, index=False
    )
    words = (
        *("--config", ROOT / "docs" / "examples" / "example_instrument.toml"),
        *("--out", tmp_path / "out", "--no-report"),
        *("--ais", CATALOG / "ais" / "synthetic_danish.csv"),
    )
    several = console("estimate", beside, *words)
    assert_refused(several, "it has 2 vessels", "--mmsi")
    found = console("estimate", beside, *words, "--mmsi", 219999001)
    assert (found.status, "km from MMSI 219999001 (synthetic_danish.csv)" in found.out) == (0, True)
    flight = json.loads((tmp_path / "out" / "estimate.json").read_text(encoding="utf-8"))["flight"]
    assert f"ship: {flight['ships'][0]}\n" in found.out
    mistaken = console("estimate", exchanged, *words, "--mmsi", 219999001)
    assert_refused(mistaken, "with latitude and longitude exchanged it would be", "20.0 km")
    assert_refused(console("estimate", beside, *words, "--mmsi", 5), "no row of MMSI 5", "--mmsi")
    assert_refused(console("estimate", beside, *words[:5], "--mmsi", 5), "--mmsi", "--ais FILE")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), ("Missing command", "plume-flight --help")),
        (("rum",), ("No such command 'rum'",)),
        (("run", "sweep_un"), ("did you mean 'sweep_nu'?",)),
        (("run", "sweep_nu", "--sed", "3"), ("No such option",)),
        (("export", "."), ("--to", "--stream udp://HOST:PORT")),
        (("export", ".", "--to", "kmz"), ("holds no run",)),
        (("report", "."), ("holds no run",)),
        (("run", "sweep_nu", "--set", "title="), ("title: value is ''; give one word at least",)),
        (("design", "x9"), ("unknown aircraft 'x9'",)),
        (
            ("describe", "wind.sped_mps"),
            ("unknown key 'wind.sped_mps'; did you mean 'wind.speed_mps'?",),
        ),
        (
            ("describe", "guidance.lead_s"),
            (
                "did you mean 'guidance.law'? A key of a part of your own (FILE.py:NAME) is described in",
            ),
        ),
        (
            ("describe", "gravity_of_the_situation"),
            ("unknown key", "plume-flight describe lists the sections"),
        ),
        (("new", "mine.toml", "--from", "sweep_un"), ("did you mean 'sweep_nu'?",)),
        (("new", "missing/mine.toml"), ("'missing/mine.toml' cannot be written",)),
    ],
)
def test_bad_input_is_one_line(arguments, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert_refused(console(*arguments), *words)
    assert list(tmp_path.iterdir()) == []


def test_what_is_swept_is_described_as_the_key_that_it_is():
    assert (
        console("describe", "sweep.wind.speed_mps").out == console("describe", "wind.speed_mps").out
    )
    assert console("describe", "sweep.nu").out == console("describe", "nu").out


def test_a_key_is_described_with_unit_range_and_default():
    found = console("describe", "wind.speed_mps").out
    for words in (
        "Wind speed.",
        "a number from 0 to 40",
        "m/s",
        "default   0.0",
        "monte_carlo",
        "acts with a wind that is not read from a table",
    ):
        assert words in found


def test_keys_of_entries_of_parts_and_of_other_studies_are_described():
    assert described("vessel.manoeuvres.at_s") == described("vessel.manoeuvres.0.at_s")
    assert "Time at which the manoeuvre begins." in "".join(described("vessel.manoeuvres.at_s"))
    assert "guidance.law 'npfg'" in "".join(described("guidance.npfg_period_s"))
    assert "".join(described("seed")).count("studies") == 3
    assert "Keys, each with a list of values" in "".join(described("nu"))
    assert "alphasense_a4 or alphasense_b4 or electrochemical or fast or laser" in "".join(
        described("payload.sensor")
    )


def test_sections_are_listed_and_described():
    listed = described()
    for section in documented_sections():
        assert any(line.startswith(section.name.replace(".0", "") or "(top)") for line in listed)
    assert any(line.strip().startswith("speed_mps") for line in described("wind"))
    # The list names the keys outside of sections so; in a shell brackets need quotes.
    assert described("(top)") == described("top")
    assert any(line.strip().startswith("flight_seed") for line in described("top"))
    # And a section of the study of convergence alone.
    assert any(line.strip().startswith("trajectories") for line in described("ensemble"))


def test_a_base_is_described_though_it_is_no_key():
    assert "a name of the catalog" in " ".join(described("extends"))


def test_a_unit_follows_a_number_alone():
    """Of a criterion that is off the default is false, and 0 is a number that Python takes for
    false.
    """
    defaults = {
        line.split()[0]: " ".join(line.split()[1:3])
        for line in described("criteria")
        if line.startswith("  ")
    }
    assert defaults["tracking_error_rms_m"] == "1.5 m"
    assert defaults["tracking_error_end_m"] == "false Largest"
    assert any(line.split()[:3] == ["speed_mps", "0.0", "m/s"] for line in described("wind"))


def test_a_section_is_described_with_the_keys_of_its_parts():
    plume = described("plume")
    assert any(line.startswith("With plume.model 'fluctuating' also:") for line in plume)
    assert any(line.strip().startswith("meander_length_up") for line in plume)
    assert not any("sniffer" in line for line in plume)
    assert any(line.strip().startswith("sensor") for line in described("payload"))


def test_a_new_file_holds_every_key_with_its_meaning():
    text = template("sweep_nu", "mine.toml")
    for section in documented_sections(Scenario):
        for key in section.keys:
            name = key.key.rpartition(".")[2]
            assert (
                f"\n{name} = " in text
                or f"\n# {name} =" in text
                or f"#   {name}: " in text
                or name == "sweep"
            ), key.key
    assert max(map(len, (line for line in text.splitlines() if line.startswith("# ")))) <= 120


@pytest.mark.parametrize("name", catalog())
def test_a_new_file_says_what_the_scenario_says_that_it_is_made_from(name, tmp_path):
    path = tmp_path / f"{name}.toml"
    assert console("new", path, "--from", name).status == 0
    made, source = load_study(str(path)), load_study(name)
    theirs, mine = _leaves(source.model_dump()), _leaves(made.model_dump())
    differing = {key for key in theirs | mine if theirs.get(key) != mine.get(key)}
    # What a base sets and no part of the flights uses is not said again.
    assert all(isinstance(source, Scenario) and unused(source, key) for key in differing), differing


@pytest.mark.parametrize(
    "text",
    [
        'study = "monte_carlo"\nextends = "sweep_nu"\nsweep = { nu = [0.3] }\ncomparison = { nu = [], variants = [] }\n',
        'study = "falsify"\nextends = false\nvessel = { speed_ratio = 0.3 }\n',
    ],
)
def test_a_new_file_of_a_study_with_a_base_of_its_own_has_no_other_base_than_its_source(
    text, tmp_path
):
    source, path = tmp_path / "source.toml", tmp_path / "mine.toml"
    draws = '[[draws]]\nkey = "start.range_m"\nuniform = [400.0, 900.0]\n'
    source.write_text(f'title = "Mine"\n{text}{draws}', encoding="utf-8")
    assert console("new", path, "--from", source).status == 0
    made, given = load_study(str(path)), load_study(str(source))
    assert made.model_dump() == given.model_dump()
    # Not that of the base operational.
    assert given.guidance.mission is None


def _leaves(values, before=""):
    leaves = {}
    for key, value in values.items():
        leaves |= (
            _leaves(value, f"{before}{key}.")
            if isinstance(value, dict) and value
            else {f"{before}{key}": value}
        )
    return leaves


def test_a_new_file_flies_the_same(file, tmp_path):
    assert console("new", tmp_path / "mine.toml", "--from", file).status == 0
    assert fly(tmp_path / "mine.toml", nu=0.5).history.equals(fly(file, nu=0.5).history)


@pytest.mark.parametrize(("swept", "compared"), [([0.3], []), ([0.15, 0.3], [0.15])])
def test_a_new_file_flies_the_comparisons_of_its_source(swept, compared, tmp_path):
    # Those of sweep_nu are of 0.15 and 0.5; the first of these sources flies none, and the second
    # at one ratio.
    source, path = tmp_path / "source.toml", tmp_path / "mine.toml"
    source.write_text(
        f'title = "Own"\nextends = "sweep_nu"\nsweep = {{ nu = {swept} }}\n', encoding="utf-8"
    )
    assert console("new", path, "--from", source).status == 0
    for file in (source, path):
        points = points_of(load_study(str(file)))
        assert [point.nu for point in points if point.variant == "no_preview"] == compared


def test_a_file_that_is_there_is_not_overwritten(file):
    assert_refused(console("new", file), f"'{file}' is there already, and is not overwritten")
    assert file.read_text(encoding="utf-8") == SHORT


def test_a_new_list_of_trials_has_the_keys_of_one():
    lines = template("sea_trial", "mine.toml").splitlines()
    written = {line.removeprefix("# ").partition(" =")[0] for line in lines if " =" in line}
    assert written == {
        key.key.rpartition(".")[2]
        for section in documented_sections(TrialList)
        for key in section.keys
    }


@pytest.mark.parametrize("command", [("report",), ("export", "--to", "kmz")])
def test_a_file_of_a_run_is_refused_with_the_name_of_its_directory(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "report.html").touch()
    refused = console(command[0], "run/report.html", *command[1:])
    assert_refused(refused, "'run/report.html' is a file; name the directory of its run, 'run'")


@pytest.mark.parametrize("key", ["emission.ship.stack_height", "payload.sensor.channels.so2.t90_s"])
def test_a_key_of_a_table_of_ones_own_is_described_by_the_key_that_may_be_one(key):
    # --set takes them: docs/howto/measuring.md.
    first, *others = described(key)
    assert first.startswith(f"{key} is a key of the table that")
    assert ".".join(key.split(".")[:2]) in others
