"""The autopilot as a linear system about level flight: what margins and predicted responses are computed from."""

import math

import control
import numpy as np

from innerloop.gains import LATERAL, LONGITUDINAL
from innerloop.schedule import BANKS_DEG, STANDARD_GRAVITY, Schedule

COMMANDS = ("airspeed_command", "altitude_command", "heading_rate_command")
"""Commands: deviations in m/s, m and rad/s."""

MEASUREMENTS = (*LONGITUDINAL, *LATERAL, "heading_rate")
"""Measured quantities, named as in the linear model."""

CONTROLS = ("elevator", "aileron", "throttle")
"""Control inputs [-]."""


def linear_controller(schedule: Schedule, index: int) -> control.StateSpace:
    """Return the autopilot at design airspeed ``index``, linear about level flight.

    Inputs are ``COMMANDS`` and ``MEASUREMENTS``, outputs are ``CONTROLS``, all as deviations from trim. States are the three error
    integrals and the heading-rate model with its rate.
    """
    gains, weights = schedule.gains[index], schedule.weights
    inputs = [*COMMANDS, *MEASUREMENTS]
    column = {name: i for i, name in enumerate(inputs)}
    states = ["elevator_integral", "throttle_integral", "bank_integral", "model_rate", "model_acceleration"]
    a, b = np.zeros((5, 5)), np.zeros((5, len(inputs)))
    c, d = np.zeros((3, 5)), np.zeros((3, len(inputs)))
    elevator, aileron, throttle = range(3)

    for row, state in ((0, elevator), (1, throttle)):
        k = gains.longitudinal_integral[row]
        b[row, column["airspeed_command"]] = k[0]
        b[row, column["airspeed"]] = -k[0]
        b[row, column["altitude_command"]] = k[1]
        b[row, column["altitude"]] = -k[1]
        c[state, row] = 1.0
        feedback = gains.longitudinal[row]
        for j, name in enumerate(LONGITUDINAL):
            d[state, column[name]] -= feedback[j]
        d[state, column["airspeed_command"]] += feedback[LONGITUDINAL.index("airspeed")]
        d[state, column["altitude_command"]] += feedback[LONGITUDINAL.index("altitude")]
        name = CONTROLS[state]
        # Equilibria move with the commanded airspeed (scheduling) and with bank (turn compensation).
        d[state, column["airspeed_command"]] += _slope_over_airspeed(schedule, index, name)
        d[state, column["airspeed_command"]] += feedback[3] * _slope_over_airspeed(schedule, index, "pitch")
        by_bank = _slope_over_bank(schedule, index, name)
        by_bank += feedback[2] * _slope_over_bank(schedule, index, "q") + feedback[3] * _slope_over_bank(schedule, index, "pitch")
        d[state, column["roll"]] += by_bank

    frequency, damping = weights.model_frequency, weights.model_damping
    a[3, 4] = 1.0
    a[4, 3], a[4, 4] = -(frequency**2), -2.0 * damping * frequency
    b[4, column["heading_rate_command"]] = frequency**2
    a[2, 3], b[2, column["heading_rate"]] = gains.heading_integral, -gains.heading_integral

    bank_per_rate = bank_slope(schedule, index) * gains.airspeed / STANDARD_GRAVITY
    k_p, k_r, k_roll = (float(k) for k in gains.lateral)
    to_bank_command = k_roll + _slope_over_bank(schedule, index, "aileron")
    c[aileron, 2] = to_bank_command
    c[aileron, 3] = to_bank_command * bank_per_rate
    roll_rate_gain = k_p + gains.roll_rate_feedforward
    c[aileron, 4] = roll_rate_gain * bank_per_rate
    acceleration = gains.roll_acceleration_feedforward * bank_per_rate
    c[aileron] += acceleration * a[4]
    d[aileron] += acceleration * b[4]
    d[aileron, column["p"]] -= k_p
    d[aileron, column["r"]] -= k_r
    d[aileron, column["roll"]] += -k_roll + k_r * _slope_over_bank(schedule, index, "r")
    return control.ss(a, b, c, d, states=states, inputs=inputs, outputs=list(CONTROLS), name="autopilot")


def bank_slope(schedule: Schedule, index: int) -> float:
    """Return tan(bank) over dimensionless turn V omega/g near level flight: 1 where turns are coordinated."""
    low, high = schedule.bank_for_turn(np.array([-0.2, 0.2]))[:, index]
    return (math.tan(high) - math.tan(low)) / 0.4


def _slope_over_bank(schedule: Schedule, index: int, quantity: str) -> float:
    """Mean of the table's slopes on both sides of level flight."""
    values = schedule.over_bank(quantity)[:, index]
    level = BANKS_DEG.index(0.0)
    return float(values[level + 1] - values[level - 1]) / math.radians(BANKS_DEG[level + 1] - BANKS_DEG[level - 1])


def _slope_over_airspeed(schedule: Schedule, index: int, quantity: str) -> float:
    """Central slope where there are neighbours, one-sided at the ends."""
    values = schedule.over_bank(quantity)[BANKS_DEG.index(0.0)]
    return float(np.gradient(values, np.array(schedule.airspeeds))[index])
