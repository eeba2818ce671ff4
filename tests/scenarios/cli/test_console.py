"""The console command hands on to the command lines of the project, and says what is known of keys."""

import json
import re

import pytest

from tests.in_process import run_command

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


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_shell_completes_commands(shell, monkeypatch):
    words, completed = "des", {"design", "describe"}
    monkeypatch.setenv("_PLUME_FLIGHT_COMPLETE", f"complete_{shell}")
    # Bash has the words and the number of the last one, the others a line.
    monkeypatch.setenv("COMP_WORDS", f"plume-flight {words}")
    monkeypatch.setenv("COMP_CWORD", "1")
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


@pytest.mark.slow
@pytest.mark.usefixtures("sketched")
def test_a_run_is_flown_reported_and_exported(tmp_path):
    out, file = tmp_path / "run", tmp_path / "short.toml"
    file.write_text(SHORT, encoding="utf-8")
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
    exported = json.loads((out / "export" / "short.nu_0.50.geojson").read_text(encoding="utf-8"))
    assert exported["type"] == "FeatureCollection"
