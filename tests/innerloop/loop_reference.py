"""Loops opened in a block diagram by python-control, with the delay a rational function."""

import control

from innerloop.law import COMMANDS

PADE_ORDER = 4
"""Of delays up to 21 ms: exact to 1e-6 rad below 50 rad/s, where all crossovers lie."""


def delays(names, delay):
    """One delay for each control."""
    rational = control.ss(control.tf(*control.pade(delay, PADE_ORDER)))
    return [
        control.ss(rational, inputs=[f"{n}_asked"], outputs=[n], name=f"{n}_delay") for n in names
    ]


def named(model, name):
    """A linear model as python-control connects it."""
    return control.ss(
        model.A,
        model.B,
        model.C,
        model.D,
        inputs=model.input_labels,
        outputs=model.output_labels,
        name=name,
    )


def opened(aircraft, autopilot, delay, name):
    """The loop opened at a control or a measurement, closed elsewhere, for negative feedback."""
    controls = list(autopilot.output_labels)
    plant, law = named(aircraft, "aircraft"), named(autopilot, "law")
    wires = [
        [f"law.{m}", f"aircraft.{m}"]
        for m in autopilot.input_labels
        if m not in COMMANDS and m != name
    ]
    for c in controls:
        wires.append([f"aircraft.{c}", f"{c}_delay.{c}"])
        if c != name:
            wires.append([f"{c}_delay.{c}_asked", f"law.{c}"])
    into, out = (
        (f"{name}_delay.{name}_asked", f"law.{name}")
        if name in controls
        else (f"law.{name}", f"aircraft.{name}")
    )
    loop = control.interconnect(
        [plant, law, *delays(controls, delay)],
        connections=wires,
        inplist=[into],
        outlist=[out],
        warn_duplicate=False,
        check_unused=False,
    )
    return -control.ss(loop)
