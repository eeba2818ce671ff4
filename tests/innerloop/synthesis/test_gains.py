"""Feedback gains: their signs, a second Riccati solver, and what a rudder is for."""

import math

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are

from innerloop.synthesis.gains import LATERAL, LONGITUDINAL
from innerloop.synthesis.quasi_static import quasi_static
from innerloop.synthesis.schedule import GAIN_BANKS, LEVEL_GAINS
from innerloop.synthesis.weights import control_weights

NAMES = ("x8", "aerosonde", "T37")
POINTS = [(name, i, j) for name in NAMES for i in (0, 2, 4) for j in range(len(GAIN_BANKS))]
LEVEL_POINTS = [(name, i) for name in NAMES for i in range(5)]


def at_rest(model, states, inputs, outputs=()):
    """A, B, C and D with servos and engines at rest, solved for them: 0 = A_dr x + A_dd d + B_d u."""
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
    by_state, by_input = (
        rest @ model.A[np.ix_(driven, rigid)],
        rest @ model.B[np.ix_(driven, columns)],
    )
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
    q = np.diag(
        [0.0 if x == 0.0 else x**-2 for x in deviations]
    )  # Bryson's rule; 0 stands for no weight
    r = np.diag([x**-2 for x in controls])
    return np.linalg.solve(r, b_servo.T @ solve_continuous_are(a_servo, b_servo, q, r))


def allowed(designed, i):
    """What the controls may do at an airspeed: Bryson's deviations of the level model."""
    schedule = designed.design.schedule
    return control_weights(
        schedule.models[i][LEVEL_GAINS], designed.design.bandwidths, schedule.weights
    )


@pytest.mark.parametrize(("name", "i", "j"), POINTS)
def test_the_longitudinal_gains_are_those_of_a_servo_lqr(designs, name, i, j):
    schedule = designs(name).design.schedule
    w, found, model = schedule.weights, schedule.gains[i][j], schedule.models[i][j]
    states = ("airspeed", "alpha", "q", "pitch", "altitude")
    plant = at_rest(model, states, ("elevator", "throttle"), ("airspeed", "altitude"))
    deviations = (
        w.airspeed,
        0.0,
        w.pitch_rate,
        w.pitch,
        w.altitude,
        w.airspeed_integral,
        w.altitude_integral,
    )
    controls = allowed(designs(name), i)
    gain = servo_lqr(*plant, deviations, (controls.elevator, controls.throttle))
    # Climb rate in place of angle of attack: what the five states are in the measured ones.
    *_, measured, _ = at_rest(model, states, ("elevator",), LONGITUDINAL)
    # Riccati solvers agree to about 1e-7 of each control's largest gain; states differ in size by a
    # hundred and more.
    flown = found.longitudinal @ measured
    scale = np.abs(gain).max(axis=1, keepdims=True)
    np.testing.assert_allclose(flown / scale, gain[:, :5] / scale, atol=1e-5)
    np.testing.assert_allclose(found.longitudinal_integral / scale, -gain[:, 5:] / scale, atol=1e-5)


@pytest.mark.parametrize(("i", "j"), [(i, j) for i in range(5) for j in range(len(GAIN_BANKS))])
def test_without_a_rudder_the_lateral_gains_are_those_of_a_servo_lqr_on_the_aileron(designs, i, j):
    schedule = designs("x8").design.schedule
    w, found = schedule.weights, schedule.gains[i][j]
    plant = at_rest(
        schedule.models[i][j], ("beta", "p", "r", "roll"), ("aileron",), ("heading_rate",)
    )
    gain = servo_lqr(
        *plant,
        (0.0, w.roll_rate, 0.0, w.roll, w.heading_integral),
        (allowed(designs("x8"), i).aileron,),
    )[0]
    # Sideslip is not measured and its gain left out. The integral goes to the bank command, which
    # the roll gain turns into aileron. Riccati solvers agree to about 1e-7 here.
    np.testing.assert_allclose(found.lateral[0], [*gain[1:4], 0.0], rtol=1e-5)
    assert found.heading_integral * found.lateral[0, LATERAL.index("roll")] == pytest.approx(
        -gain[4], rel=1e-5
    )
    # There is nothing that a rudder would do.
    assert not found.lateral[1].any()
    assert found.sideslip_integral == 0.0
    assert (found.roll_rate_feedforward[1], found.roll_acceleration_feedforward[1]) == (0.0, 0.0)


@pytest.mark.parametrize(("name", "i", "j"), [point for point in POINTS if point[0] != "x8"])
def test_with_a_rudder_the_lateral_gains_are_those_of_a_servo_lqr_that_regulates_sideslip_too(
    designs, name, i, j
):
    schedule = designs(name).design.schedule
    w, found = schedule.weights, schedule.gains[i][j]
    controls = allowed(designs(name), i)
    plant = at_rest(
        schedule.models[i][j],
        ("beta", "p", "r", "roll"),
        ("aileron", "rudder"),
        ("heading_rate", "beta"),
    )
    deviations = (w.sideslip, w.roll_rate, 0.0, w.roll, w.heading_integral, w.sideslip_integral)
    gain = servo_lqr(*plant, deviations, (controls.aileron, controls.rudder))
    scale = np.abs(gain).max(axis=1, keepdims=True)
    # The order of LATERAL: p, r, roll, beta. Riccati solvers agree to about 1e-7.
    np.testing.assert_allclose(found.lateral / scale, gain[:, [1, 2, 3, 0]] / scale, atol=1e-5)
    assert found.heading_integral * found.lateral[0, LATERAL.index("roll")] == pytest.approx(
        -gain[0, 4], rel=1e-5
    )
    # The law adds its integral of beta, where the design has that of -beta and a minus.
    assert found.sideslip_integral == pytest.approx(gain[1, 5], rel=1e-5)


@pytest.mark.parametrize(("name", "i"), LEVEL_POINTS)
def test_gains_oppose_the_deviations_they_answer(designs, name, i):
    schedule = designs(name).design.schedule
    gains, plant = schedule.gains[i][LEVEL_GAINS], quasi_static(schedule.models[i][LEVEL_GAINS])
    assert gains.longitudinal.shape == (2, len(LONGITUDINAL))
    assert gains.lateral.shape == (2, len(LATERAL))

    def sign(state, control):
        return np.sign(plant.B[plant.state_labels.index(state), plant.input_labels.index(control)])

    up = sign("q", "elevator")  # whether a positive elevator pitches up (stock aircraft differ)
    elevator = dict(zip(LONGITUDINAL, up * gains.longitudinal[0], strict=True))
    # Commands are minus gain times deviation: too high, climbing, nose up or pitching up asks for
    # nose down. Too fast asks for less throttle. Too much roll or roll rate asks for aileron
    # against it.
    assert min(elevator[state] for state in ("climb_rate", "q", "pitch", "altitude")) > 0.0
    assert gains.longitudinal[1, LONGITUDINAL.index("airspeed")] > 0.0
    assert gains.longitudinal_integral[1, 0] > 0.0
    assert up * gains.longitudinal_integral[0, 1] > 0.0
    against = sign("p", "aileron") * gains.lateral[0]
    assert min(against[LATERAL.index("p")], against[LATERAL.index("roll")]) > 0.0
    assert gains.heading_integral > 0.0


@pytest.mark.parametrize(("name", "i"), [point for point in LEVEL_POINTS if point[0] != "x8"])
def test_the_rudder_turns_the_nose_into_the_wind_and_damps_yaw(designs, name, i):
    schedule = designs(name).design.schedule
    gains, plant = schedule.gains[i][LEVEL_GAINS], quasi_static(schedule.models[i][LEVEL_GAINS])
    yaw_by_rudder = plant.B[plant.state_labels.index("r"), plant.input_labels.index("rudder")]
    by = dict(
        zip(LATERAL, -gains.lateral[1] * yaw_by_rudder, strict=True)
    )  # yaw acceleration per deviation
    # Sideslip is positive with air from the right, and turning right takes it out; so does its
    # integral. A yaw rate is opposed.
    assert by["beta"] > 0.0
    assert gains.sideslip_integral * yaw_by_rudder > 0.0
    assert by["r"] < 0.0


@pytest.mark.parametrize(
    ("name", "i"), [(name, i) for name in ("aerosonde", "T37") for i in (0, 2, 4)]
)
def test_rolling_under_the_feedforward_the_nose_goes_round_with_the_turn(designs, name, i):
    schedule = designs(name).design.schedule
    gains, level = schedule.gains[i][LEVEL_GAINS], schedule.level(i)
    a, b, _, _ = quasi_static(schedule.models[i][LEVEL_GAINS]).pick(
        ("p", "r"), ("aileron", "rudder"), ("p",)
    )
    rate, acceleration = 0.2, 0.5
    controls = (
        gains.roll_rate_feedforward * rate + gains.roll_acceleration_feedforward * acceleration
    )
    # Asked for: p_dot = acceleration; and r grows as the turn does in a roll about the velocity,
    # omega = g tan(bank)/V, of which r is the part cos(bank): r_dot = g/V p at wings level, to 1e-7
    # at half a milliradian.
    np.testing.assert_allclose(
        a[:, 0] * rate + b @ controls, [acceleration, 9.80665 / level.airspeed * rate], atol=1e-6
    )


@pytest.mark.parametrize("i", range(5))
def test_without_a_rudder_roll_feedforward_is_the_inverse_of_the_roll_equation(x8_schedule, i):
    model, gains = x8_schedule.models[i][LEVEL_GAINS], x8_schedule.gains[i][LEVEL_GAINS]
    row, aileron = model.state_labels.index("p"), model.state_labels.index("aileron_position")
    full = 0.5236  # rad of deflection for a command of 1 (model file)
    by_aileron, by_rate = model.A[row, aileron] * full, model.A[row, row]
    # p_dot = L_p p + L_da da solved for the aileron. Propeller speed does not depend on roll rate,
    # so nothing else enters.
    assert gains.roll_acceleration_feedforward[0] == pytest.approx(1.0 / by_aileron, rel=1e-6)
    assert gains.roll_rate_feedforward[0] == pytest.approx(-by_rate / by_aileron, rel=1e-6)


def test_gains_change_little_from_one_bank_to_the_same_on_the_other_side(designs):
    schedule = designs("T37").design.schedule
    # The model is the same to both sides: it trims level without bank or aileron (to 1e-15), so
    # nothing turns one way.
    for row in schedule.gains:
        for left, right in zip(row, reversed(row), strict=True):
            assert left.bank == pytest.approx(-right.bank, abs=2e-3)
            np.testing.assert_allclose(
                left.longitudinal,
                right.longitudinal,
                rtol=0.05,
                atol=0.02 * np.abs(right.longitudinal).max(),
            )
    assert math.degrees(schedule.gains[0][0].bank) == pytest.approx(-0.82 * 1.1 * 35.0, abs=0.1)
