"""The tables of the autopilot: their signs and symmetry, and the bank for a turn."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are

from aircraft.errors import TrimError
from aircraft.fdm import Fdm
from aircraft.spec import X8
from aircraft.trim import trim
from innerloop.flight import AutopilotedAircraft
from innerloop.gains import LATERAL, LONGITUDINAL
from innerloop.jsbsim_root import write_root
from innerloop.responses import flown_step
from innerloop.schedule import BANKS_DEG, STANDARD_GRAVITY, design_schedule
from innerloop.weights import DesignWeights

LEVEL = BANKS_DEG.index(0.0)


def even_and_odd(table):
    """Even and odd part over bank, relative to level flight."""
    change = table - table[LEVEL]
    return 0.5 * (change + change[::-1]), 0.5 * (change - change[::-1])


def test_banks_are_symmetric_about_level():
    assert [-b for b in reversed(BANKS_DEG)] == list(BANKS_DEG)


def test_level_is_the_straight_equilibrium_of_each_airspeed(x8_schedule):
    for index, airspeed in enumerate(X8.design_airspeeds):
        found = x8_schedule.level(index)
        assert (found.airspeed, found.yaw_rate, found.altitude) == (airspeed, 0.0, 100.0)


@pytest.mark.parametrize("quantity", ["elevator", "throttle", "pitch", "q"])
def test_what_a_turn_asks_for_in_the_plane_of_symmetry_is_nearly_even_over_bank(x8_schedule, quantity):
    even, odd = even_and_odd(x8_schedule.over_bank(quantity))
    # Odd is what the propeller does: its torque, and its gyroscopic moment H r of 0.1 N m at most against 8 N m a unit of elevator.
    # A fifth of the even part in the elevator and in pitch.
    assert np.abs(odd).max() < 0.25 * np.abs(even).max()


@pytest.mark.parametrize(("quantity", "share"), [("r", 0.05), ("yaw_rate", 0.05), ("p", 0.15), ("aileron", 0.6)])
def test_what_a_turn_asks_for_across_it_is_nearly_odd_over_bank(x8_schedule, quantity, share):
    even, odd = even_and_odd(x8_schedule.over_bank(quantity))
    # Even is what the propeller does: its gyroscopic moment H q of 0.15 N m makes sideslip to the same side in either turn, and
    # without rudder the aileron answers the rolling moment of that: half of the little aileron that a slow steep turn needs.
    assert np.abs(even).max() < share * np.abs(odd).max()


def test_a_turn_asks_for_more_lift_and_more_power(x8_schedule):
    banks = np.abs(BANKS_DEG)
    order = np.argsort(banks[: LEVEL + 1])
    for side in (slice(None, LEVEL + 1), slice(None, LEVEL - 1 if LEVEL else None, -1)):
        elevator, throttle, pitch_rate = (x8_schedule.over_bank(name)[side][order] for name in ("elevator", "throttle", "q"))
        assert (np.diff(elevator, axis=0) < 0.0).all()  # trailing edge up pitches up
        assert (np.diff(throttle, axis=0) > 0.0).all()
        assert (np.diff(pitch_rate, axis=0) > 0.0).all()  # nose up in a turn to either side


def test_a_turn_goes_where_the_aircraft_banks(x8_schedule):
    yaw_rates = x8_schedule.over_bank("yaw_rate")
    assert (np.sign(yaw_rates) == np.sign(BANKS_DEG)[:, None]).all()
    assert (np.diff(yaw_rates, axis=0) > 0.0).all()


def test_faster_flight_needs_less_angle_of_attack_and_more_throttle(x8_schedule):
    assert (np.diff(x8_schedule.over_bank("pitch")[LEVEL]) < 0.0).all()
    assert (np.diff(x8_schedule.over_bank("throttle")[LEVEL]) > 0.0).all()


@pytest.mark.parametrize("index", range(5))
def test_the_bank_for_a_turn_is_that_of_the_equilibrium_with_this_yaw_rate(x8_schedule, index):
    airspeed = x8_schedule.airspeeds[index]
    turns = np.array([airspeed * t.yaw_rate / STANDARD_GRAVITY for t in x8_schedule.trims[index]])
    banks = x8_schedule.bank_for_turn(turns)[:, index]
    np.testing.assert_allclose(banks, [t.roll for t in x8_schedule.trims[index]], atol=1e-12)  # at the nodes: rounding


@pytest.mark.parametrize("bank", [-50.0, -28.0, -11.0, 11.0, 28.0, 50.0])
def test_between_equilibria_the_bank_for_a_turn_is_within_a_tenth_of_a_degree(x8_schedule, bank):
    found = trim(Fdm(X8), airspeed=20.0, altitude=100.0, bank=math.radians(bank))
    turn = np.array([20.0 * found.yaw_rate / STANDARD_GRAVITY])
    # tan(bank) is nearly proportional to V omega/g; half-way between two equilibria it is off by second order of that "nearly".
    assert math.degrees(float(x8_schedule.bank_for_turn(turn)[0, 2])) == pytest.approx(bank, abs=0.1)


def test_past_the_steepest_equilibrium_the_bank_goes_on_growing_and_stays_short_of_a_right_angle(x8_schedule):
    turns = np.linspace(-3.0, 3.0, 61)
    banks = x8_schedule.bank_for_turn(turns)
    assert banks.shape == (61, 5)
    assert (np.diff(banks, axis=0) > 0.0).all()
    assert np.abs(banks).max() < 0.5 * math.pi


def test_a_table_has_a_row_for_each_bank_and_a_column_for_each_airspeed(x8_schedule):
    table = x8_schedule.over_bank("aileron")
    assert table.shape == (len(BANKS_DEG), len(X8.design_airspeeds))
    assert table[2, 3] == x8_schedule.trims[3][2].inputs["aileron"]
    # A trim's quantities by their names.
    assert x8_schedule.over_bank("q")[1, 0] == x8_schedule.trims[0][1].rates_body[1]
    assert x8_schedule.over_bank("pitch")[1, 0] == x8_schedule.trims[0][1].pitch


@pytest.mark.parametrize("index", range(5))
def test_gains_oppose_the_deviations_they_answer(x8_schedule, index):
    gains = x8_schedule.gains[index]
    assert gains.airspeed == x8_schedule.airspeeds[index]
    assert gains.longitudinal.shape == (2, len(LONGITUDINAL))
    assert gains.lateral.shape == (len(LATERAL),)
    elevator = dict(zip(LONGITUDINAL, gains.longitudinal[0], strict=True))
    throttle = dict(zip(LONGITUDINAL, gains.longitudinal[1], strict=True))
    # Commands are minus gain times deviation, and positive elevator pitches down: too high, climbing, nose up or pitching up asks
    # for a positive elevator. Too fast asks for less throttle. Too much roll or roll rate asks for less aileron.
    assert max(elevator[name] for name in ("climb_rate", "q", "pitch", "altitude")) < 0.0
    assert throttle["airspeed"] > 0.0
    assert gains.lateral.min() > 0.0
    assert gains.longitudinal_integral[1, 0] > 0.0
    assert gains.longitudinal_integral[0, 1] < 0.0
    assert gains.heading_integral > 0.0


@pytest.mark.parametrize("index", range(5))
def test_roll_feedforward_is_the_inverse_of_the_roll_equation(x8_schedule, index):
    model, gains = x8_schedule.models[index], x8_schedule.gains[index]
    row, aileron = model.state_labels.index("p"), model.state_labels.index("aileron_position")
    full = 0.5236  # rad of deflection for a command of 1 (model file)
    by_aileron, by_rate = model.A[row, aileron] * full, model.A[row, row]
    # p_dot = L_p p + L_da da solved for the aileron. Propeller speed does not depend on roll rate, so nothing else enters.
    assert gains.roll_acceleration_feedforward == pytest.approx(1.0 / by_aileron, rel=1e-6)
    assert gains.roll_rate_feedforward == pytest.approx(-by_rate / by_aileron, rel=1e-6)


def quasi_static(model, states, inputs, outputs=()):
    """A, B, C and D with servos and propeller at rest: 0 = A_dr x + A_dd d + B_d u."""
    names = list(model.state_labels)
    rigid = [names.index(n) for n in states]
    driven = [names.index(n) for n in ("elevator_position", "aileron_position", "propeller_speed")]
    columns = [model.input_labels.index(n) for n in inputs]
    rows = [model.output_labels.index(n) for n in outputs]
    rest = -np.linalg.inv(model.A[np.ix_(driven, driven)])
    by_state, by_input = rest @ model.A[np.ix_(driven, rigid)], rest @ model.B[np.ix_(driven, columns)]
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
    q = np.diag([0.0 if x == 0.0 else x**-2 for x in deviations])  # Bryson's rule; 0 stands for no weight
    r = np.diag([x**-2 for x in controls])
    return np.linalg.solve(r, b_servo.T @ solve_continuous_are(a_servo, b_servo, q, r))


@pytest.mark.parametrize("index", range(5))
def test_the_longitudinal_gains_are_those_of_a_servo_lqr(x8_schedule, index):
    w, found, airspeed = x8_schedule.weights, x8_schedule.gains[index], x8_schedule.airspeeds[index]
    states = ("airspeed", "alpha", "q", "pitch", "altitude")
    plant = quasi_static(x8_schedule.models[index], states, ("elevator", "throttle"), ("airspeed", "altitude"))
    deviations = (w.airspeed, 0.0, 0.0, w.pitch, w.altitude, w.airspeed_integral, w.altitude_integral)
    gain = servo_lqr(*plant, deviations, (w.elevator, w.throttle))
    # Climb rate in place of angle of attack: h_dot = V (pitch - alpha) in level flight, so a gain on it is one on both.
    by_alpha = -airspeed * found.longitudinal[:, 1]
    by_pitch = found.longitudinal[:, 3] + airspeed * found.longitudinal[:, 1]
    flown = np.column_stack([found.longitudinal[:, 0], by_alpha, found.longitudinal[:, 2], by_pitch, found.longitudinal[:, 4]])
    # Of each control's largest gain 1e-3: climb rate's derivatives are measured ones, off from V by 1e-5 and from 0 by 1e-3
    # through sideslip and bank; and Riccati solvers agree to about 1e-7 here.
    scale = np.abs(gain).max(axis=1, keepdims=True)
    np.testing.assert_allclose(flown / scale, gain[:, :5] / scale, atol=1e-3)
    np.testing.assert_allclose(found.longitudinal_integral / scale, -gain[:, 5:] / scale, atol=1e-3)


@pytest.mark.parametrize("index", range(5))
def test_the_lateral_gains_are_those_of_a_servo_lqr(x8_schedule, index):
    w, found = x8_schedule.weights, x8_schedule.gains[index]
    plant = quasi_static(x8_schedule.models[index], ("beta", "p", "r", "roll"), ("aileron",), ("heading_rate",))
    gain = servo_lqr(*plant, (0.0, w.roll_rate, 0.0, w.roll, w.heading_integral), (w.aileron,))[0]
    # Sideslip is not measured and its gain left out. The integral goes to the bank command, which the roll gain turns into aileron.
    # Riccati solvers agree to about 1e-7 here.
    np.testing.assert_allclose(found.lateral, gain[1:4], rtol=1e-5)
    assert found.heading_integral * found.lateral[LATERAL.index("roll")] == pytest.approx(-gain[4], rel=1e-5)


def test_a_slower_heading_rate_model_is_designed_when_asked_for(tmp_path):
    two_airspeeds = replace(X8, design_airspeeds=(19.0, 20.0))
    schedule = design_schedule(two_airspeeds, weights=DesignWeights(model_frequency=3.0))
    aircraft = AutopilotedAircraft(two_airspeeds, write_root(schedule, tmp_path))
    flown = flown_step(aircraft, schedule.level(1), "heading_rate", 0.1, 6.0)
    # From 10 to 90 % a second-order answer with a damping of 0.9 takes 2.9/omega_n (1.8 at 0.5, 3.4 at 1: control textbooks); the
    # aircraft follows within a fifth.
    assert flown.rise_time() == pytest.approx(2.9 / 3.0, rel=0.2)


def test_a_design_condition_that_cannot_be_flown_is_refused(tmp_path):
    with pytest.raises(TrimError, match="5 m/s"):
        design_schedule(replace(X8, design_airspeeds=(5.0, 20.0)))
