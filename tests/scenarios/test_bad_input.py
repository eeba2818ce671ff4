"""Numbers of every size, names of every kind, machines without a home: one line and status 2, or it
works.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.in_process import assert_refused, run_command
from tests.scenarios.short_trial import short_trial

ROOT = Path(__file__).parents[2]
TRIAL = short_trial(flights=2, duration=5.0)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "short.toml").write_text(TRIAL, encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--time-limit", "inf"], ["--time-limit is inf s", "between 1 and 1e+06 s"]),
        (["--time-limit", "0"], ["--time-limit is 0 s"]),
        (["--memory-limit", "1e300"], ["--memory-limit is 1e+300 GiB"]),
        (["--out", "a" * 300], ["cannot be written: File name too long", "choose another --out"]),
        (
            ["--set", "reports.interval_s=[1e-9, 1e-9]"],
            [
                "reports.interval_s is [1e-09, 1e-09] s",
                "more than 200000 reports",
                "at least 2.5e-05 s pass",
            ],
        ),
    ],
)
def test_a_number_or_a_path_out_of_range_is_one_line(folder, arguments, words):
    assert_refused(run_command("scenarios.run", "short.toml", "--no-report", *arguments), *words)
    assert [path.name for path in folder.iterdir()] == ["short.toml"]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("a" * 300, "unknown scenario 'aaa"),
        ("a" * 300 + ".toml", "no scenario file 'aaa"),
        ("a" * 300 + "/flights/x", "unknown scenario"),
        ("a\nb.toml", "a flight would be called 'a\\nb"),
        ("b" * 230 + ".toml", "names have up to 200 bytes"),
    ],
)
def test_a_name_that_no_file_can_have_is_one_line(folder, name, words):
    if len(name) < 250 and name.endswith(".toml"):
        (folder / name).write_text(TRIAL, encoding="utf-8")
    assert_refused(run_command("scenarios.run", name, "--no-report", "--out", "run"), words)
    assert not (folder / "run").exists()


NO_HOME = """
import pwd, runpy, sys
def unknown(_):
    raise KeyError("no such user")
pwd.getpwuid = unknown
sys.argv = sys.argv[1:]
runpy.run_module("scenarios.run", run_name="__main__")
"""


@pytest.mark.slow
def test_no_home_and_a_terminal_with_ascii_alone_are_enough(folder):
    (folder / "é.toml").write_text(TRIAL, encoding="utf-8")
    homes = ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "MPLCONFIGDIR")
    environment = {name: value for name, value in os.environ.items() if name not in homes}
    environment |= {"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "ascii"}
    command = [
        sys.executable,
        "-c",
        NO_HOME,
        "run",
        "é.toml",
        "--no-report",
        "--out",
        "run",
        "--jobs",
        "1",
    ]
    ended = subprocess.run(
        command,
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert ended.returncode == 0, ended.stderr
    assert "\\xe9_00000: " in ended.stdout
