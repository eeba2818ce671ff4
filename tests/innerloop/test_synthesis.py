"""Weights by hand for a simple aircraft; gains by a second solver; the bank for a turn."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are

from aircraft.fleet.x8 import X8
from aircraft.linearise import LinearModel
from aircraft.spec import AircraftError
from common.physics import STANDARD_GRAVITY
from innerloop.designer import linear_grid
from innerloop.schedule import GAIN_BANKS, LATERAL, LEVEL_GAINS, LONGITUDINAL
from innerloop.synthesis import control_weights, reachable_bandwidths

STATES = ["airspeed", "alpha", "beta", "p", "q", "r", "roll", "pitch", "altitude"]
STATES += ["elevator_effect", "throttle_effect"]
INPUTS = ["elevator", "aileron", "throttle", "rudder"]
LAG, ENGINE_LAG = 0.04, 0.5  # s, of elevator and engine; aileron and rudder have none
DELAY = 0.0125  # s, of the autopilot's steps


def simple(aileron=30.0, roll_damping=-4.0, elevator=-20.0, z_alpha=-3.0):
    """An aircraft with one number for each thing that the bandwidths depend on [1/s, 1/s^2]."""
    a, b = np.zeros((11, 11)), np.zeros((11, 4))
    entries = {
        ("alpha", "alpha"): z_alpha,
        ("p", "p"): roll_damping,
        ("q", "q"): -5.0,
        ("r", "r"): -1.5,
        ("r", "beta"): 8.0,
        ("q", "elevator_effect"): elevator,
        ("airspeed", "throttle_effect"): 6.0,
        ("elevator_effect", "elevator_effect"): -1.0 / LAG,
        ("throttle_effect", "throttle_effect"): -1.0 / ENGINE_LAG,
    }
    for (row, column), value in entries.items():
        a[STATES.index(row), STATES.index(column)] = value
    forcing = {
        ("p", "aileron"): aileron,
        ("r", "rudder"): 5.0,
        ("elevator_effect", "elevator"): 1.0 / LAG,
        ("throttle_effect", "throttle"): 1.0 / ENGINE_LAG,
    }
    for (row, column), value in forcing.items():
        b[STATES.index(row), INPUTS.index(column)] = value
    return LinearModel(
        A=a,
        B=b,
        C=np.eye(11),
        D=np.zeros((11, 4)),
        state_labels=STATES,
        input_labels=INPUTS,
        output_labels=STATES,
    )


BANK = 0.6  # rad; half of it is the step that half the authority is to turn


@pytest.mark.parametrize(
    ("loop", "changes", "expected"),
    [
        # A tenth of a radian and more of phase for delays: 0.18 rad over 12.5 ms without a servo.
        ("lateral", {"aileron": 1000.0}, 0.18 / DELAY),
        # Authority: w^2 times 0.3 rad from half of 2 1/s^2.
        ("lateral", {"aileron": 2.0, "roll_damping": -0.1}, math.sqrt(0.5 * 2.0 / 0.3)),
        # Roll damping: 0.42 w times 0.3 rad is as fast as half of 10 1/s^2 rolls against 20 1/s.
        ("lateral", {"aileron": 10.0, "roll_damping": -20.0}, 0.5 * 10.0 / 20.0 / (0.42 * 0.3)),
        ("longitudinal", {"elevator": -1000.0, "z_alpha": -50.0}, 0.18 / (LAG + DELAY)),
        # Either sign of the elevator: 0.15 rad from half of 1 1/s^2.
        ("longitudinal", {"elevator": 1.0}, math.sqrt(0.5 * 1.0 / 0.15)),
        ("longitudinal", {"elevator": -1.0}, math.sqrt(0.5 * 1.0 / 0.15)),
        # Three quarters of what lift follows the angle of attack with.
        ("longitudinal", {"z_alpha": -1.2}, 0.75 * 1.2),
        # Lift allows 2.25 rad/s, of which 0.27; the engine 0.3 over its lag.
        ("airspeed", {}, 0.3 / (ENGINE_LAG + DELAY)),
        ("airspeed", {"z_alpha": -1.2}, 0.27 * 0.9),
    ],
)
def test_each_loop_is_as_fast_as_delay_authority_damping_and_lift_allow(loop, changes, expected):
    found = getattr(reachable_bandwidths([simple(**changes)], BANK), loop)
    assert found == pytest.approx(expected, rel=1e-12)


NAMES = ("x8", "aerosonde", "T37")


def grid_points(name):
    """The indices of airspeeds and gain banks at which the gains of an aircraft are compared."""
    airspeeds = range(5) if name == "x8" else (0, 2, 4)
    return itertools.product(airspeeds, range(len(GAIN_BANKS)))


def at_rest(model, states, inputs, outputs=()):
    """A, B, C and D with servos and engines at rest: 0 = A_dr x + A_dd d + B_d u solved for d."""
    names = list(model.state_labels)
    rigid = [names.index(n) for n in states]
    driven = [
        k
        for k, n in enumerate(names)
        if n.endswith(("_position", "_speed", "_effect", "_effect_rate"))
    ]
    columns = [model.input_labels.index(n) for n in inputs]
    rows = [model.output_labels.index(n) for n in outputs]
    rest = -np.linalg.inv(model.A[np.ix_(driven, driven)])
    by_state = rest @ model.A[np.ix_(driven, rigid)]
    by_input = rest @ model.B[np.ix_(driven, columns)]
    return (
        model.A[np.ix_(rigid, rigid)] + model.A[np.ix_(rigid, driven)] @ by_state,
        model.B[np.ix_(rigid, columns)] + model.A[np.ix_(rigid, driven)] @ by_input,
        model.C[np.ix_(rows, rigid)] + model.C[np.ix_(rows, driven)] @ by_state,
        model.D[np.ix_(rows, columns)] + model.C[np.ix_(rows, driven)] @ by_input,
    )


def servo_lqr(a, b, c, d, deviations, controls):
    """Gain of u = -K (x, integral of -y), by scipy's Riccati solver, which is not the package's."""
    states, outputs = a.shape[0], c.shape[0]
    a_servo = np.block([[a, np.zeros((states, outputs))], [-c, np.zeros((outputs, outputs))]])
    b_servo = np.vstack([b, -d])
    # Bryson's rule; 0 stands for no weight.
    q = np.diag([0.0 if x == 0.0 else x**-2 for x in deviations])
    r = np.diag([x**-2 for x in controls])
    return np.linalg.solve(r, b_servo.T @ solve_continuous_are(a_servo, b_servo, q, r))


def allowed(design, i):
    """Acceptable deviations of the controls at an airspeed, from the level model."""
    schedule = design.schedule
    return control_weights(schedule.models[i][LEVEL_GAINS], design.bandwidths, schedule.weights)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_longitudinal_gains_are_those_of_a_servo_lqr(designs, name):
    design = designs(name).design
    schedule, w = design.schedule, design.schedule.weights
    states = ("airspeed", "alpha", "q", "pitch", "altitude")
    deviations = (
        w.airspeed,
        0.0,
        w.pitch_rate,
        w.pitch,
        w.altitude,
        w.airspeed_integral,
        w.altitude_integral,
    )
    for i, j in grid_points(name):
        found, model, controls = schedule.gains[i][j], schedule.models[i][j], allowed(design, i)
        plant = at_rest(model, states, ("elevator", "throttle"), ("airspeed", "altitude"))
        gain = servo_lqr(*plant, deviations, (controls.elevator, controls.throttle))
        # Climb rate replaces angle of attack: the five states in terms of the measured ones.
        *_, measured, _ = at_rest(model, states, ("elevator",), LONGITUDINAL)
        # Riccati solvers agree to about 1e-7 of each control's largest gain; states differ in size
        # by a hundred and more.
        flown = found.longitudinal @ measured
        scale = np.abs(gain).max(axis=1, keepdims=True)
        np.testing.assert_allclose(flown / scale, gain[:, :5] / scale, atol=1e-5)
        np.testing.assert_allclose(
            found.longitudinal_integral / scale, -gain[:, 5:] / scale, atol=1e-5
        )


@pytest.mark.parametrize("name", NAMES)
def test_the_lateral_gains_are_those_of_a_servo_lqr_that_regulates_sideslip_with_a_rudder(
    designs, name
):
    design = designs(name).design
    schedule, w = design.schedule, design.schedule.weights
    deviations = [w.sideslip, w.roll_rate, 0.0, w.roll, w.heading_integral, w.sideslip_integral]
    inputs, outputs = ("aileron", "rudder"), ("heading_rate", "beta")
    if "rudder" not in schedule.controls:
        # Sideslip is not measured then.
        deviations, inputs, outputs = [0.0, *deviations[1:5]], inputs[:1], outputs[:1]
    for i, j in grid_points(name):
        found, model, controls = schedule.gains[i][j], schedule.models[i][j], allowed(design, i)
        plant = at_rest(model, ("beta", "p", "r", "roll"), inputs, outputs)
        weights = [getattr(controls, control) for control in inputs]
        gain = servo_lqr(*plant, deviations, weights)
        scale = np.abs(gain).max(axis=1, keepdims=True)
        # The order of LATERAL: p, r, roll, beta. Riccati solvers agree to about 1e-7.
        expected = (gain / scale)[:, [1, 2, 3, 0]]
        expected[:, 3] *= len(inputs) > 1
        np.testing.assert_allclose(found.lateral[: len(inputs)] / scale, expected, atol=1e-5)
        # The integral goes to the bank command, which the roll gain turns into aileron.
        assert found.heading_integral * found.lateral[0, LATERAL.index("roll")] == pytest.approx(
            -gain[0, 4], rel=1e-5
        )
        # The law adds its integral of beta, where the design has that of -beta and a minus.
        sideslip = gain[1, 5] if len(inputs) > 1 else 0.0
        assert found.sideslip_integral == pytest.approx(sideslip, rel=1e-5)
        if len(inputs) == 1:
            # A rudder that is absent has no gains.
            assert not found.lateral[1].any()
            assert found.roll_rate_feedforward[1] == found.roll_acceleration_feedforward[1] == 0.0


@pytest.mark.parametrize("index", range(5))
def test_the_bank_for_a_turn_is_that_of_the_equilibrium_with_this_yaw_rate(x8_schedule, index):
    airspeed = x8_schedule.airspeeds[index]
    turns = np.array([airspeed * t.yaw_rate / STANDARD_GRAVITY for t in x8_schedule.trims[index]])
    banks = x8_schedule.bank_for_turn(turns)[:, index]
    # At the nodes: rounding.
    np.testing.assert_allclose(banks, [t.roll for t in x8_schedule.trims[index]], atol=1e-12)


def test_a_design_condition_that_cannot_be_flown_is_refused():
    too_slow = replace(X8, envelope=replace(X8.envelope, airspeed_min=5.0))
    with pytest.raises(AircraftError, match="5 m/s"):
        linear_grid(too_slow, 100.0)
