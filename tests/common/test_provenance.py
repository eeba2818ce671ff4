"""What a manifest says of command line and host: no name and no path of a machine."""

import pytest

from common.provenance import command_line, provenance


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


@pytest.mark.parametrize(
    "program", ["plume-flight", "/usr/local/bin/plume-flight", "plume-flight.exe"]
)
def test_a_command_line_is_the_one_that_was_typed(program):
    assert (
        command_line("scenarios.run", [program, "run", "sweep_nu"]) == "plume-flight run sweep_nu"
    )


def test_a_host_is_described_by_its_kind():
    host = provenance()
    assert host["cores"] >= 1
    assert len(host["platform"].split()) == 2
