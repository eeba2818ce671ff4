"""The flown autopilot equals the designed one: its commands against gains and linear model.

The aircraft is held where it is put (``Fdm.frozen``), off trim by a small amount in one quantity at
a time, both ways; commands are read from JSBSim. Held integrators (``RESET``) leave the feedback
alone; running ones add what they gather in a known number of steps.
"""

import math
from dataclasses import replace

import control
import numpy as np
import pytest
from loop_reference import named

from aircraft.fleet.x8 import X8
from aircraft.state import body_velocity
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.jsbsim.system import HEADING_RATE, RESET, write_root
from innerloop.law import ControlLaw, linear_controller
from innerloop.schedule import LEVEL, LEVEL_GAINS, LONGITUDINAL, TRIM_BANKS

MIDDLE = 2
TIME_STEP = 1.0 / 120.0
SIZES = {
    "airspeed": 0.1,
    "climb_rate": 0.1,
    "q": 0.02,
    "pitch": 0.01,
    "altitude": 0.2,
    "p": 0.05,
    "r": 0.05,
    "roll": 0.02,
    "beta": 0.01,
    "airspeed_command": 0.1,
    "altitude_command": 0.2,
}
"""Deviations [m/s, m, rad, rad/s] at which nothing saturates."""

X8_SIZES = [name for name in SIZES if name != "beta"]  # without a rudder nothing answers sideslip


@pytest.fixture(scope="module")
def aerosonde(designs, tmp_path_factory):
    """The Aerosonde's schedule and root: an aircraft with a rudder."""
    schedule = designs("aerosonde").design.schedule
    return schedule, write_root(schedule, tmp_path_factory.mktemp("aerosonde"))


def state_off_trim(found, name, size):
    """The trim's state with one measured quantity moved and every other one as it was."""
    alpha, beta, airspeed, pitch, roll = (
        found.alpha,
        found.beta,
        found.airspeed,
        found.pitch,
        found.roll,
    )
    altitude, rates = found.altitude, list(found.rates_body)
    if name == "airspeed":
        airspeed += size  # level flight: the flight path, and so the climb rate, stays level
    elif name == "climb_rate":
        alpha -= math.asin(size / airspeed)  # at the same pitch
    elif name == "pitch":
        alpha, pitch = alpha + size, pitch + size  # at the same climb
    elif name == "altitude":
        altitude += size
    elif name == "roll":
        roll = size  # about wings level, where the tables have their kink
        beta = 0.0  # sideslip, rolled, would climb
    elif name == "beta":
        beta += size
        roll = 0.0  # sideslip, rolled, would climb
    elif name in ("p", "q", "r"):
        rates["pqr".index(name)] += size
    velocity = body_velocity(airspeed, alpha, beta)
    return replace(
        found.state(),
        altitude=altitude,
        roll=roll,
        pitch=pitch,
        velocity_body=velocity,
        rates_body=tuple(rates),
    )


def commands_off_trim(root, found, name, size, steps, running=False, spec=X8, properties=()):
    """Commands [-], or ``properties``, after some steps with one quantity off trim."""
    aircraft = AutopilotedAircraft(spec, root)
    fdm = aircraft.fdm
    aircraft.command_airspeed(found.airspeed + (size if name == "airspeed_command" else 0.0))
    aircraft.command_altitude(found.altitude + (size if name == "altitude_command" else 0.0))
    aircraft.command_heading_rate(0.0)
    fdm.write(RESET, -1.0)
    fdm.place(state_off_trim(found, name, size))
    with fdm.frozen():
        fdm.step(2)
        fdm.write(RESET, 0.0 if running else -1.0)
        fdm.step(steps)
    return np.array([fdm.read(prop) for prop in properties or [i.commands[0] for i in spec.inputs]])


def slope_of_commands(root, found, name, steps=3, running=False, spec=X8):
    size = SIZES.get(name, 1e-4)
    high, low = (
        commands_off_trim(root, found, name, sign * size, steps, running, spec)
        for sign in (1.0, -1.0)
    )
    return (high - low) / (2.0 * size)


def over_bank(schedule, quantity):
    """Mean slope of a trim quantity over bank on both sides of level flight, from equilibria."""
    left, middle, right = (quantity(schedule.trims[MIDDLE][LEVEL + i]) for i in (-1, 0, 1))
    to_right = (right - middle) / schedule.banks[LEVEL + 1]
    to_left = (middle - left) / -schedule.banks[LEVEL - 1]
    return 0.5 * (to_right + to_left)


def over_airspeed(schedule, quantity):
    """Mean of the slopes of a level-trim quantity over airspeed on both sides."""
    slower, faster = (quantity(schedule.level(MIDDLE + i)) for i in (-1, 1))
    return (faster - slower) / (schedule.airspeeds[MIDDLE + 1] - schedule.airspeeds[MIDDLE - 1])


def designed_slopes(schedule, name):
    """Elevator, aileron and throttle per deviation, from the gains and the equilibria."""
    gains = schedule.gains[MIDDLE][LEVEL_GAINS]
    elevator, throttle = -gains.longitudinal
    k_p, k_r, k_roll, _ = gains.lateral[0]
    if name in LONGITUDINAL:
        column = LONGITUDINAL.index(name)
        return np.array([elevator[column], 0.0, throttle[column]])
    if name == "p":
        return np.array([0.0, -k_p, 0.0])
    if name == "r":
        return np.array([0.0, -k_r, 0.0])
    if name == "roll":
        # Turn compensation: the equilibrium moves with bank, in controls, pitch, pitch rate and yaw
        # rate.
        pitch, q, r = (
            over_bank(schedule, f)
            for f in (lambda t: t.pitch, lambda t: t.rates_body[1], lambda t: t.rates_body[2])
        )
        controls = [
            over_bank(schedule, lambda t, name=name: t.inputs[name]) - row[2] * q - row[3] * pitch
            for name, row in (("elevator", elevator), ("throttle", throttle))
        ]
        return np.array([controls[0], -k_roll + k_r * r, controls[1]])
    if name == "airspeed_command":
        # The equilibrium moves with the commanded airspeed, in controls and pitch.
        pitch = over_airspeed(schedule, lambda t: t.pitch)
        controls = [
            over_airspeed(schedule, lambda t, name=name: t.inputs[name]) - row[0] - row[3] * pitch
            for name, row in (("elevator", elevator), ("throttle", throttle))
        ]
        return np.array([controls[0], 0.0, controls[1]])
    column = LONGITUDINAL.index("altitude")
    return np.array([-elevator[column], 0.0, -throttle[column]])


@pytest.mark.parametrize("index", [1, 2, 3])
def test_at_a_design_airspeed_the_held_aircraft_gets_the_equilibriums_controls(
    x8_schedule, x8_root, index
):
    found = x8_schedule.level(index)
    flown = commands_off_trim(x8_root, found, "nothing", 0.0, 3)
    # The tables have their kink at wings level, the equilibrium (propeller torque) its bank 0.3
    # mrad beside it: that far along slopes of up to 0.4 a radian, and on the aileron 2.3 a radian.
    assert flown[[0, 2]] == pytest.approx(
        [found.inputs["elevator"], found.inputs["throttle"]], abs=2e-4
    )
    assert flown[1] == pytest.approx(found.inputs["aileron"], abs=1.5e-3)


@pytest.mark.parametrize("index", [1, 2, 3])
def test_in_a_turning_equilibrium_turn_compensation_commands_its_elevator_and_throttle(
    x8_schedule, x8_root, index
):
    assert len(x8_schedule.trims[index]) == len(TRIM_BANKS)
    for found in x8_schedule.trims[index]:
        flown = commands_off_trim(x8_root, found, "nothing", 0.0, 3)
        # Every error of the longitudinal feedback is 0 in it, so the table alone acts; at its
        # nodes, in nine digits. At wings level the bank is 0.3 mrad from the node, see above.
        expected = [found.inputs["elevator"], found.inputs["throttle"]]
        assert flown[[0, 2]] == pytest.approx(expected, abs=2e-4 if found.yaw_rate == 0.0 else 1e-6)


@pytest.mark.parametrize("name", X8_SIZES)
def test_the_flown_feedback_is_the_designed_gain_times_the_deviation(x8_schedule, x8_root, name):
    flown = slope_of_commands(x8_root, x8_schedule.level(MIDDLE), name)
    expected = designed_slopes(x8_schedule, name)
    # Feedback is linear, so central differences are exact; numbers in the file have nine digits. A
    # moved airspeed command also moves the schedule, and with it gains that multiply what is left
    # of errors at trim; and at 0.3 mrad of bank a yaw rate is a little of a pitch rate: 1e-4
    # either.
    np.testing.assert_allclose(flown, expected, rtol=1e-3, atol=5e-4)


@pytest.mark.parametrize("name", X8_SIZES)
def test_the_linear_description_has_the_flown_feedback(x8_schedule, x8_root, name):
    assert_the_feedback_is_flown(x8_schedule, x8_root, name)


@pytest.mark.slow
@pytest.mark.parametrize("name", SIZES)
def test_the_linear_description_has_the_flown_feedback_with_a_rudder_too(aerosonde, name):
    assert_the_feedback_is_flown(*aerosonde, name)


def assert_the_feedback_is_flown(schedule, root, name):
    found = schedule.level(MIDDLE)
    flown = slope_of_commands(root, found, name, spec=schedule.spec)
    system = linear_controller(ControlLaw(schedule), found)
    # As above: the description, too, is that about wings level.
    np.testing.assert_allclose(
        flown, system.D[:, system.input_labels.index(name)], rtol=1e-3, atol=5e-4
    )


def test_a_heading_rate_command_moves_the_aileron_as_the_linear_description_says(
    x8_schedule, x8_root
):
    found = x8_schedule.level(MIDDLE)
    system = linear_controller(ControlLaw(x8_schedule), found)
    size, steps = 0.02, 120

    def fly(sign):
        aircraft = AutopilotedAircraft(X8, x8_root)
        fdm = aircraft.fdm
        aircraft.release(found.state(), airspeed=found.airspeed, altitude=found.altitude)
        rows = []
        with fdm.frozen():
            aircraft.command_heading_rate(sign * size)
            for _ in range(steps):
                fdm.step()
                rows.append((fdm.read(HEADING_RATE), fdm.read("fcs/aileron-cmd-norm")))
        return np.array(rows)

    measured, flown = (0.5 * (fly(1.0) - fly(-1.0))).T
    inputs = np.zeros((len(system.input_labels), steps))
    inputs[system.input_labels.index("heading_rate_command")] = size
    inputs[system.input_labels.index("heading_rate")] = (
        measured  # a held aircraft does not turn, but its ailerons push sideways
    )
    time = TIME_STEP * np.arange(1, steps + 1)
    answer = control.forced_response(named(system, "autopilot"), time - TIME_STEP, inputs)
    expected = answer.outputs[system.output_labels.index("aileron")]
    # At the steps at which the autopilot computes. Between them it holds, and before the first it
    # knows nothing of the command.
    computed = slice(x8_schedule.period - 1, None, x8_schedule.period)
    flown, expected, time = flown[computed], np.asarray(expected)[computed], time[computed]
    # JSBSim integrates the model in turn, a period behind itself, at 5 rad/s: 12 % of it while it
    # moves; tables kink at level.
    late = time > 0.6
    np.testing.assert_allclose(flown[late], expected[late], rtol=0.03)
    np.testing.assert_allclose(flown, expected, atol=0.1 * np.abs(expected).max())
