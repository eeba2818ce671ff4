"""Surfaces with unequal travel are commanded by their effect; flight idle brakes most."""

from dataclasses import replace

import numpy as np
import pytest

from aircraft.controls import AXES, with_flight_idle, with_linearised_controls
from aircraft.envelope import first_trim
from aircraft.fdm import Fdm
from aircraft.fleet.find import find_spec
from aircraft.fleet.x8 import X8
from aircraft.spec import ControlInput
from aircraft.trim import trim

ALTITUDE = 100.0
KINKED = ControlInput(
    name="elevator",
    commands=("fcs/elevator-cmd-norm",),
    lower=-1.5,
    upper=0.5,
    effectiveness=((-1.5, -1.0), (0.0, 0.0), (0.5, 1.0)),
)


@pytest.fixture(scope="module")
def twin():
    """JSBSim's c310, whose elevator goes 14 degrees up and 4 down, in level flight, and its spec
    with linearised controls.
    """
    fdm = Fdm(find_spec("c310"))
    level = first_trim(fdm, ALTITUDE)
    return fdm, level, with_linearised_controls(fdm, level)


def moments(spec, level, name, values):
    """Angular acceleration about the surface's axis over an input's values [rad/s^2]."""
    fdm = Fdm(spec)
    old = level.inputs[name]
    start = float(
        np.interp(
            old,
            [c for _, c in spec.input(name).effectiveness],
            [e for e, _ in spec.input(name).effectiveness],
        )
    )
    found = []
    with fdm.frozen():
        for value in values:
            fdm.command({**level.inputs, name: start})
            fdm.command({name: float(value)})
            fdm.place(level.state())
            fdm.settle()
            found.append(fdm.angular_acceleration()[AXES[name]])
    return np.array(found)


def effect_of(command, control_input):
    effects, commands = zip(*control_input.effectiveness, strict=True)
    return float(np.interp(command, commands, effects))


def slopes(x, y):
    return np.diff(y) / np.diff(x)


def test_the_effect_of_a_nonlinear_elevator_becomes_linear(twin):
    _, level, spec = twin
    elevator = spec.input("elevator")
    assert elevator.effectiveness
    values = np.linspace(elevator.lower, elevator.upper, 15)
    found = slopes(values, moments(spec, level, "elevator", values))
    # Seventeen measured points with straight lines between: a few per cent where the surface itself
    # bends between two of them.
    assert np.ptp(found) < 0.12 * abs(found.mean())


@pytest.mark.parametrize(("lower", "upper"), [(-0.5, 0.5), (-0.75, 0.25)])
def test_a_surface_is_commanded_within_the_range_that_its_spec_states(twin, lower, upper):
    fdm, level, whole = twin
    stated = replace(
        fdm.spec,
        inputs=tuple(
            replace(i, lower=lower, upper=upper) if i.name in AXES else i for i in fdm.spec.inputs
        ),
    )
    elevator = with_linearised_controls(Fdm(stated), level).input("elevator")
    commands = [command for _, command in elevator.effectiveness]
    assert (commands[0], commands[-1]) == (lower, upper)
    assert (elevator.command(elevator.lower), elevator.command(elevator.upper)) == (lower, upper)
    # The same surface: effects of the commands that both have are in proportion, but for a bend
    # between two measured points.
    both = (lower, 0.5 * lower, 0.5 * upper, upper)
    ratio = np.divide(
        *([effect_of(command, i) for command in both] for i in (elevator, whole.input("elevator")))
    )
    assert np.ptp(ratio) < 0.02 * ratio.mean()


@pytest.mark.parametrize(
    ("effect", "command"),
    # Past the ends as before them.
    [(-1.5, -1.0), (-0.75, -0.5), (0.0, 0.0), (0.25, 0.5), (0.5, 1.0), (-3.0, -2.0), (1.0, 2.0)],
)
def test_an_effect_is_named_by_the_command_that_has_it(effect, command):
    assert KINKED.command(effect) == pytest.approx(command)


@pytest.fixture(scope="module")
def cruise():
    fdm = Fdm(X8)
    return fdm, trim(fdm, airspeed=20.0, altitude=60.0)


def deceleration(fdm, level, throttle):
    fdm.command({**level.inputs, "throttle": throttle})
    fdm.place(level.state())
    with fdm.frozen():
        fdm.step(600)
    return -fdm.acceleration_body()[0]


def test_an_electric_propeller_brakes_most_while_it_still_turns(cruise):
    fdm, level = cruise
    idle = with_flight_idle(fdm, level).input("throttle").lower
    # Read at 5 s after each throttle, many times the propeller's 0.04 s: a twentieth of the way to
    # either side brakes less, and closed throttle, where the propeller stands, by almost half.
    at_idle = deceleration(fdm, level, idle)
    assert at_idle > deceleration(fdm, level, idle - 0.05)
    assert at_idle > deceleration(fdm, level, idle + 0.05)
    assert at_idle > 1.8 * deceleration(fdm, level, 0.0)
