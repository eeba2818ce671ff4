"""Aircraft, computing delay and autopilot, connected: the linear closed loop from commands and
gusts.
"""

import functools

import control

from aircraft.linearise import LinearModel
from innerloop.law.control_law import COMMANDS


@functools.cache
def pade(delay: float) -> control.StateSpace:
    """Return the second-order Pade approximation of a delay [s]."""
    return control.ss(control.tf(*control.pade(delay, 2)))


def closed_loop(aircraft: LinearModel, autopilot: LinearModel, delay: float) -> control.StateSpace:
    """Return the closed loop from the autopilot's commands to every output of the aircraft and to
    the controls.

    The aircraft's other inputs, such as gusts, follow the commands. The ``delay`` is that between
    measurement and servo [s].
    """
    controls = autopilot.output_labels
    others = [name for name in aircraft.input_labels if name not in controls]
    plant, law, one = _named(aircraft, "aircraft"), _named(autopilot, "autopilot"), pade(delay)
    delays = [
        control.ss(one, inputs=[f"{name}_delayed_in"], outputs=[name], name=f"{name}_delay")
        for name in controls
    ]
    connections: list[list[object]] = [
        [f"autopilot.{name}", f"aircraft.{name}"]
        for name in autopilot.input_labels
        if name not in COMMANDS
    ]
    for block, name in zip(delays, controls, strict=True):
        connections += [
            [f"aircraft.{name}", f"{block.name}.{name}"],
            [f"{block.name}.{name}_delayed_in", f"autopilot.{name}"],
        ]
    return control.interconnect(
        [plant, law, *delays],
        connections=connections,
        inplist=[
            *(f"autopilot.{name}" for name in COMMANDS),
            *(f"aircraft.{name}" for name in others),
        ],
        outlist=[
            *(f"aircraft.{name}" for name in aircraft.output_labels),
            *(f"autopilot.{name}" for name in controls),
        ],
        inputs=[*COMMANDS, *others],
        outputs=[*aircraft.output_labels, *(f"{name}_command" for name in controls)],
        warn_duplicate=False,
        check_unused=False,
    )


def _named(model: LinearModel, name: str) -> control.StateSpace:
    """Return a linear model as python-control connects it, by its own name and those of its inputs
    and outputs.
    """
    return control.ss(
        model.A,
        model.B,
        model.C,
        model.D,
        inputs=model.input_labels,
        outputs=model.output_labels,
        name=name,
    )
