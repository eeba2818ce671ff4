"""The linear aircraft against the aircraft itself: small doublets of each control, flown in JSBSim
and predicted.
"""

from typing import Any

import control
import numpy as np
import numpy.typing as npt

from aircraft.fdm import Fdm
from aircraft.linearise import LinearModel
from aircraft.trim import Trim
from common.physics.units import METRES_PER_FOOT

OUTPUTS: dict[str, tuple[str, float]] = {
    "airspeed": ("velocities/vt-fps", METRES_PER_FOOT),
    "alpha": ("aero/alpha-rad", 1.0),
    "beta": ("aero/beta-rad", 1.0),
    "p": ("velocities/p-rad_sec", 1.0),
    "q": ("velocities/q-rad_sec", 1.0),
    "r": ("velocities/r-rad_sec", 1.0),
    "roll": ("attitude/phi-rad", 1.0),
    "pitch": ("attitude/theta-rad", 1.0),
}
"""States that are compared: JSBSim property and SI value of its unit."""

_SHOWN = {
    "elevator": ("alpha", "q", "pitch"),
    "aileron": ("p", "roll"),
    "rudder": ("beta", "r"),
    "throttle": ("airspeed",),
}
"""States that each control is meant to move: a relative error is of little use for a state that it
hardly moves.
"""

_DURATION = 6.0
_HALF = 1.0
_SIZE = 0.01
"""Duration of a flight and of each half of its doublet [s], and the size of the doublet [-]."""


_FINE = 8
"""Substeps of a time step [-]: the linear model does not have JSBSim's first-order integration
errors.
"""

_SETTLED = 1e-9
"""Change of acceleration a substep below which servos and engines count as at rest: behind an
engine as slow as a second, 1e-6 from the end, where a doublet accelerates the aircraft by 1e-2 and
more."""

Array = npt.NDArray[np.float64]


def verify_model(fdm: Fdm, model: LinearModel, level: Trim) -> list[dict[str, Any]]:
    """Return the largest error of each prediction over the largest excursion flown, by control and
    state.

    Parameters
    ----------
    fdm : the aircraft; another simulation of it flies at a finer time step
    model : its linear model about ``level``
    level : the equilibrium
    """
    fine = Fdm(fdm.spec, time_step=fdm.time_step / _FINE)
    records, system = [], control.ss(model.A, model.B, model.C, model.D, inputs=model.input_labels)
    for control_input in fdm.spec.inputs:
        name = control_input.name
        time, flown = _flown(fine, level, name)
        doublet = np.where(time < _HALF, _SIZE, np.where(time < 2.0 * _HALF, -_SIZE, 0.0))
        response = control.forced_response(system[:, name], time, doublet)
        for output in _SHOWN.get(name, ()):
            predicted = response.outputs[model.output_labels.index(output)]
            excursion = float(np.max(np.abs(flown[output])))
            error = float(np.max(np.abs(predicted - flown[output])))
            records.append(
                {"input": name, "output": output, "error": error / excursion if excursion else None}
            )
    return records


def _flown(fdm: Fdm, level: Trim, name: str) -> tuple[Array, dict[str, Array]]:
    """Return time [s] and the deviations of ``OUTPUTS`` after a doublet, one second each way."""
    count = round(_DURATION / fdm.time_step)
    run, reads = fdm.run, [fdm.node(prop).get_double_value for prop, _ in OUTPUTS.values()]
    fdm.command(dict(level.inputs))
    fdm.allow_engine_restart()
    fdm.place(level.state())
    with fdm.frozen():
        fdm.settle(_SETTLED, round(fdm.spec.settle_time / fdm.time_step))
    moved = fdm.spec.input(name)
    commands = [fdm.writable_node(commanded).set_double_value for commanded in moved.commands]
    read = []
    for i in range(count):
        read.append([each() for each in reads])
        t = i * fdm.time_step
        now = _SIZE if t < _HALF else -_SIZE if t < 2.0 * _HALF else 0.0
        value = moved.command(level.inputs[name] + now)
        for command in commands:
            command(value)
        run()
    values = {
        output: v * scale
        for (output, (_, scale)), v in zip(OUTPUTS.items(), np.array(read).T, strict=True)
    }
    return fdm.time_step * np.arange(count, dtype=np.float64), {
        output: v - v[0] for output, v in values.items()
    }
