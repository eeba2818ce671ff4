"""Numbers of every size, names of every kind, machines without a home: one line and status 2, or it
works.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.scenarios.short_trial import short_trial

ROOT = Path(__file__).parents[2]
TRIAL = short_trial(flights=2, duration=5.0)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "short.toml").write_text(TRIAL, encoding="utf-8")
    return tmp_path


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
