"""A first look at an aircraft of the user, in a process of its own: JSBSim ends the whole process with some faulty models."""

import os
import pickle
import subprocess
import sys
from pathlib import Path

from aircraft.errors import AircraftError
from aircraft.simulation.fdm import Fdm
from aircraft.spec import AircraftSpec

_STEPS = 3
"""Time steps in which every function of a model is computed."""

_TIME_MAX = 120.0
"""Longest time of the look [s]; it takes half a second."""

_REFUSED = 3
"""Exit status of the process with an error of ours, in a line."""


def check_user_aircraft(spec: AircraftSpec) -> None:
    """See that JSBSim loads and runs an aircraft of a folder, and that it has the properties of its spec; others are known to.

    Raises
    ------
    AircraftError : JSBSim refuses the model, or there is no such property, or it takes no writes
    """
    if spec.folder is None:
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
        raise AircraftError(f"aircraft '{spec.name}': JSBSim did not run its model within {_TIME_MAX:g} s; correct it") from None
    if done.returncode == 0:
        return
    told = " ".join(done.stderr.decode(errors="replace").split())
    if done.returncode == _REFUSED:
        raise AircraftError(told)
    reason = told.rpartition("what():")[2].strip() or f"exit status {done.returncode}"
    raise AircraftError(
        f"aircraft '{spec.name}': JSBSim ends the whole process with its model: {reason}; correct {spec.files.file}"
    )


def _look(spec: AircraftSpec) -> None:
    fdm = Fdm(spec)
    for name in (*(command for control in spec.inputs for command in control.commands), *(name for name, _ in spec.configuration)):
        fdm.writable_node(name)
    fdm.step(_STEPS)


if __name__ == "__main__":
    try:
        _look(pickle.loads(sys.stdin.buffer.read()))
    except AircraftError as error:
        print(error, file=sys.stderr)
        sys.exit(_REFUSED)
