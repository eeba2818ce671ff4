"""A first look at an aircraft of the user, in a process of its own: JSBSim ends the whole process
with some faulty models.
"""

import itertools
import os
import pickle
import subprocess
import sys
import tempfile
from pathlib import Path

from aircraft.errors import AircraftError
from aircraft.model_files import stock_root
from aircraft.simulation.fdm import Fdm
from aircraft.simulation.model_copy import copy_model
from aircraft.spec import MODELS, AircraftSpec

_STEPS = 3
"""Time steps in which every function of a model is computed."""

_TIME_MAX = 120.0
"""Longest time of the look [s]; it takes half a second."""

_REFUSED = 3
"""Exit status of the process with an error of ours, in a line."""

_TRACEBACK = "Traceback (most recent call last):"
"""First line of a traceback; those of its frames are indented, the error itself is not."""


def check_user_aircraft(spec: AircraftSpec) -> None:
    """See that JSBSim loads and runs an aircraft, and that it has the properties of its spec.

    Models of the project and of JSBSim are known to: only those whose files stand elsewhere are
    looked at, however they are named.

    Raises
    ------
    AircraftError : JSBSim refuses the model, or there is no such property, or it takes no writes
    """
    if all(map(_supplied, (spec.files.folder, *spec.files.roots))):
        return
    project = str(Path(__file__).parents[2])
    paths = os.pathsep.join([project, *filter(None, [os.environ.get("PYTHONPATH")])])
    try:
        done = subprocess.run(
            [sys.executable, "-m", __name__],
            input=pickle.dumps(spec),
            capture_output=True,
            check=False,
            timeout=_TIME_MAX,
            env=os.environ | {"PYTHONPATH": paths},
        )
    except subprocess.TimeoutExpired:
        raise AircraftError(
            f"aircraft '{spec.name}': JSBSim did not run its model within {_TIME_MAX:g} s; correct it"
        ) from None
    if done.returncode == 0:
        return
    lines = done.stderr.decode(errors="replace").splitlines()
    said = " ".join(" ".join(lines).split())
    if done.returncode == _REFUSED:
        raise AircraftError(said)
    if raised := _raised(lines):
        raise AircraftError(
            f"aircraft '{spec.name}': its model does not run: {raised}; correct {spec.files.file}"
        )
    reason = said.rpartition("what():")[2].strip() or f"exit status {done.returncode}"
    raise AircraftError(
        f"aircraft '{spec.name}': JSBSim ends the whole process with its model: {reason}; correct {spec.files.file}"
    )


def _supplied(folder: Path) -> bool:
    """Return whether a folder is of the project's own models or of JSBSim's."""
    return any(folder.resolve().is_relative_to(root.resolve()) for root in (MODELS, stock_root()))


def _raised(lines: list[str]) -> str:
    """Return the error that a traceback ends with, in a line; empty if there is no traceback."""
    begun = [i for i, line in enumerate(lines) if line.endswith(_TRACEBACK)]
    if not begun:
        return ""
    error = itertools.dropwhile(lambda line: not line or line[0].isspace(), lines[begun[-1] + 1 :])
    return " ".join(" ".join(error).split()).rstrip(".;")


def _look(spec: AircraftSpec) -> None:
    # With its ground contacts, which designs leave out: a fault in them would show only in flight.
    with tempfile.TemporaryDirectory() as folder:
        copy_model(spec.files, Path(folder))
        fdm = Fdm(spec, Path(folder))
    for name in (
        *(command for control in spec.inputs for command in control.commands),
        *(name for name, _ in spec.configuration),
    ):
        fdm.writable_node(name)
    fdm.step(_STEPS)


if __name__ == "__main__":
    try:
        _look(pickle.loads(sys.stdin.buffer.read()))
    except AircraftError as error:
        print(error, file=sys.stderr)
        sys.exit(_REFUSED)
