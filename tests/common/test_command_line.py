"""What every command line does with its output."""

import subprocess
import sys

import pytest

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
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        getattr(running, stream).close()
        said = getattr(running, other).read()
    assert said == b""
    # As a shell says of a program that SIGPIPE ended: 128 + 13.
    assert running.returncode == 141
