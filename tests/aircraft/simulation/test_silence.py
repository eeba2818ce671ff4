"""What JSBSim prints is kept off standard output, also where that is a file or a pipe."""

import os
import subprocess
import sys

PRINTING = """
import ctypes
from aircraft.simulation.silence import silenced

print("before")
with silenced():
    print("of Python")
    ctypes.CDLL(None).puts(b"of C")
print("after")
"""


def test_what_is_buffered_while_silenced_is_not_printed_later():
    # JSBSim's warnings of the F-16 were printed by a first design whose output went into a file.
    buffered = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    done = subprocess.run(
        [sys.executable, "-c", PRINTING], capture_output=True, text=True, check=True, env=buffered
    )
    assert done.stdout.split() == ["before", "after"]
