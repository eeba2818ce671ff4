"""What a manifest says of command line and host: no name and no path of a machine."""

import pytest

from common.provenance import command_line


@pytest.mark.parametrize(
    ("arguments", "shown"),
    [
        (["sweep_nu", "--set", "sweep.nu=[0.3,0.6]"], "sweep_nu --set 'sweep.nu=[0.3,0.6]'"),
        (["/home/somebody/my study/mine.toml", "--out", "/data/run 1"], "mine.toml --out 'run 1'"),
        (["--set", "report.logo=/home/some body/logo.png"], "--set report.logo=logo.png"),
        (["--set", 'payload=["/home/a/b.py:X","c.py:Y"]'], '--set \'payload=["b.py:X","c.py:Y"]\''),
        (["C:\\Users\\somebody\\mine.toml", "~/runs/flights/nu_0.50"], "mine.toml nu_0.50"),
        (["runs/sweep/flights/nu_0.50"], "runs/sweep/flights/nu_0.50"),
        (["--scheduler", "tcp://host:8786"], "--scheduler HOST:PORT"),
        (["--scheduler=tcp://host:8786"], "--scheduler=HOST:PORT"),
    ],
)
def test_a_command_line_names_no_host_and_no_folder_of_a_machine(arguments, shown):
    assert (
        command_line("scenarios.run", ["scenarios/run.py", *arguments])
        == f"python -m scenarios.run {shown}"
    )
