"""Try a user's aircraft in a separate process, because JSBSim can end its process."""

import os
import pickle
import subprocess
import sys
import tempfile
from pathlib import Path

from aircraft.fdm import Fdm
from aircraft.model import copy_model, stock_root
from aircraft.spec import MODELS, AircraftError, AircraftSpec

_STEPS = 3
"""Time steps of the run: enough to compute every function of a model."""

_TIME_MAX = 120.0
"""Time limit of the run [s]; a run takes half a second."""

_REFUSED = 3
"""Exit status of a process that has printed an error message of the project."""


def check_user_aircraft(spec: AircraftSpec) -> None:
    """Check that JSBSim loads and runs an aircraft, and that the properties of its spec exist.

    An aircraft is not run if all its files belong to the project or to JSBSim.

    Raises
    ------
    AircraftError : JSBSim refuses the model, or a property does not exist or is read-only
    """
    if all(_is_supplied(folder) for folder in (spec.files.folder, *spec.files.roots)):
        return
    search_path = [str(Path(__file__).parents[1])]
    if "PYTHONPATH" in os.environ:
        search_path.append(os.environ["PYTHONPATH"])
    try:
        done = subprocess.run(
            [sys.executable, "-m", __name__],
            input=pickle.dumps(spec),
            capture_output=True,
            check=False,
            timeout=_TIME_MAX,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(search_path)},
        )
    except subprocess.TimeoutExpired:
        raise AircraftError(
            f"aircraft '{spec.name}': JSBSim did not run its model within {_TIME_MAX:g} s;"
            " correct it"
        ) from None
    if done.returncode == 0:
        return
    printed = " ".join(done.stderr.decode(errors="replace").split())
    if done.returncode == _REFUSED:
        raise AircraftError(printed)
    # C++ prints the uncaught exception that has ended the process.
    reason = printed.rpartition("what():")[2].strip() or f"exit status {done.returncode}"
    raise AircraftError(
        f"aircraft '{spec.name}': JSBSim ends the whole process with its model: {reason};"
        f" correct {spec.files.file}"
    )


def _is_supplied(folder: Path) -> bool:
    """Whether a folder belongs to the project's own models or to JSBSim."""
    return any(folder.resolve().is_relative_to(root.resolve()) for root in (MODELS, stock_root()))


def _run_model(spec: AircraftSpec) -> None:
    # The run includes the ground contacts, whose faults a design without them would not show.
    with tempfile.TemporaryDirectory() as folder:
        copy_model(spec.files, Path(folder))
        fdm = Fdm(spec, Path(folder))
    commands = [command for control_input in spec.inputs for command in control_input.commands]
    configured = [name for name, _ in spec.configuration]
    for name in (*commands, *configured):
        fdm.writable_node(name)
    fdm.step(_STEPS)


def _main() -> int:
    spec: AircraftSpec = pickle.loads(sys.stdin.buffer.read())
    try:
        _run_model(spec)
    except AircraftError as error:
        print(error, file=sys.stderr)
        return _REFUSED
    except Exception as error:  # noqa: BLE001 - JSBSim raises many kinds of errors
        what = f"{type(error).__name__}: {error}".rstrip(".;")
        print(
            f"aircraft '{spec.name}': its model does not run: {what}; correct {spec.files.file}",
            file=sys.stderr,
        )
        return _REFUSED
    return 0


if __name__ == "__main__":
    sys.exit(_main())
