"""What every command line does with its output."""

import subprocess
import sys
from typing import Annotated

import pytest
import typer

from common.command_line import run_command

PROGRAM = """
import sys
from common.command_line import run_command

def command():
    for line in range(100_000 if {long} else 1):
        try:
            print(line, file=sys.{stream})
        except OSError:
            print("a file that cannot be written", file=sys.{other})

run_command(command, "program")
"""


@pytest.mark.parametrize("long", [True, False])
@pytest.mark.parametrize(("stream", "other"), [("stdout", "stderr"), ("stderr", "stdout")])
def test_a_command_whose_reader_is_gone_ends_without_a_word(stream, other, long):
    program = PROGRAM.format(stream=stream, other=other, long=long)
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as running:
        getattr(running, stream).close()
        said = getattr(running, other).read()
    assert said == b""
    # As a shell says of a program that SIGPIPE ended: 128 + 13.
    assert running.returncode == 141


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (
            ["--jobs", "0"],
            "error: --jobs is 0; it must be greater than or equal to 1; see program --help\n",
        ),
        (["--jobs=two"], "error: --jobs is two; it must be a valid integer; see program --help\n"),
        (
            ["--job", "2"],
            "error: No such option: --job (Possible options: --jobs); see program --help\n",
        ),
    ],
)
def test_an_option_that_is_out_of_range_is_told_with_its_value(given, told, monkeypatch, capsys):
    def command(jobs: Annotated[int, typer.Option(min=1)] = 1) -> None:
        raise AssertionError(jobs)

    monkeypatch.setattr(sys, "argv", ["program", *given])
    with pytest.raises(SystemExit) as ended:
        run_command(command, "program")
    assert (ended.value.code, capsys.readouterr().err) == (2, told)
