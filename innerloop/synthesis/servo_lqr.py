"""Servo LQR at one airspeed and bank: gains from the linearisation, nothing pasted.

Why a servo LQR: the plant is multivariable (elevator and throttle both move airspeed and altitude,
aileron and rudder both roll and yaw), every state it feeds back is one that an autopilot measures,
integral action comes with the design, and weights that follow from the aircraft's own frequencies
carry over to the next aircraft.

Servo and engine states are left out of the feedback (a hobby servo's position is not measured) and
out of the Riccati equation, where their static gain replaces them; the margins are then computed
with them and with the computing delay. At a bank, longitudinal and lateral motion couple; the gains
of each are computed as if the other were at rest, and the margins with both.
"""

import math

import control
import numpy as np

from aircraft.linearise import LinearModel, Matrix
from aircraft.trim import Trim
from common.physics.units import STANDARD_GRAVITY
from innerloop.synthesis.gains import LONGITUDINAL, Gains
from innerloop.synthesis.quasi_static import quasi_static
from innerloop.synthesis.weights import ControlWeights, DesignWeights


def design_gains(
    model: LinearModel, trim: Trim, weights: DesignWeights, controls: ControlWeights
) -> Gains:
    """Design the feedback for a linear model from ``aircraft.linearise`` about ``trim``."""
    plant = quasi_static(model)
    longitudinal, longitudinal_integral = _longitudinal(plant, weights, controls)
    lateral, heading_integral, sideslip_integral = _lateral(plant, weights, controls)
    by_rate, by_acceleration = _feedforward(plant, trim)
    return Gains(
        airspeed=trim.airspeed,
        bank=trim.roll,
        longitudinal=longitudinal,
        longitudinal_integral=longitudinal_integral,
        lateral=lateral,
        heading_integral=heading_integral,
        sideslip_integral=sideslip_integral,
        roll_rate_feedforward=by_rate,
        roll_acceleration_feedforward=by_acceleration,
    )


def _bryson(*deviations: float) -> Matrix:
    return np.diag([0.0 if d == 0.0 else 1.0 / d**2 for d in deviations])


def _servo(a: Matrix, b: Matrix, c: Matrix, d: Matrix, q: Matrix, r: Matrix) -> Matrix:
    """LQR on the plant with the integral of -y appended."""
    n, m = c.shape[1], c.shape[0]
    a_servo = np.block([[a, np.zeros((n, m))], [-c, np.zeros((m, m))]])
    gain, _, _ = control.lqr(a_servo, np.vstack([b, -d]), q, r)
    return np.asarray(gain)


def _longitudinal(
    plant: LinearModel, w: DesignWeights, controls: ControlWeights
) -> tuple[Matrix, Matrix]:
    states = ("airspeed", "alpha", "q", "pitch", "altitude")
    a, b, c, d = plant.pick(states, ("elevator", "throttle"), ("airspeed", "altitude"))
    q = _bryson(
        w.airspeed, 0.0, w.pitch_rate, w.pitch, w.altitude, w.airspeed_integral, w.altitude_integral
    )
    gain = _servo(a, b, c, d, q, _bryson(controls.elevator, controls.throttle))
    _, _, measured, _ = plant.pick(states, ("elevator",), LONGITUDINAL)
    return gain[:, :5] @ np.linalg.inv(measured), -gain[:, 5:]


def _lateral(
    plant: LinearModel, w: DesignWeights, controls: ControlWeights
) -> tuple[Matrix, float, float]:
    """Return the gains from ``LATERAL``, and those from the integrals of heading-rate error and of
    sideslip.
    """
    states = ("beta", "p", "r", "roll")
    if not _has_rudder(plant):
        a, b, c, d = plant.pick(states, ("aileron",), ("heading_rate",))
        q = _bryson(0.0, w.roll_rate, 0.0, w.roll, w.heading_integral)
        gain = _servo(a, b, c, d, q, _bryson(controls.aileron))[0]
        return np.array([[*gain[1:4], 0.0], np.zeros(4)]), -float(gain[4]) / float(gain[3]), 0.0
    a, b, c, d = plant.pick(states, ("aileron", "rudder"), ("heading_rate", "beta"))
    q = _bryson(w.sideslip, w.roll_rate, 0.0, w.roll, w.heading_integral, w.sideslip_integral)
    gain = _servo(a, b, c, d, q, _bryson(controls.aileron, controls.rudder))
    return gain[:, [1, 2, 3, 0]], -float(gain[0, 4]) / float(gain[0, 3]), float(gain[1, 5])


def _has_rudder(plant: LinearModel) -> bool:
    return "rudder" in plant.input_labels


def _feedforward(plant: LinearModel, trim: Trim) -> tuple[Matrix, Matrix]:
    """Return aileron and rudder for a roll rate and for a roll acceleration.

    The rudder cancels the yaw that rolling and aileron cause, and turns the nose with the turn: r
    grows by g cos(bank)/V times p.
    """
    axes, inputs = (
        (("p", "r"), ("aileron", "rudder")) if _has_rudder(plant) else (("p",), ("aileron",))
    )
    a, b, _, _ = plant.pick(axes, inputs, ("p",))
    turning = np.array([0.0, STANDARD_GRAVITY * math.cos(trim.roll) / trim.airspeed])[: len(axes)]
    inverse = np.linalg.inv(b)
    by_rate, by_acceleration = inverse @ (turning - a[:, 0]), inverse[:, 0]
    padding = np.zeros(2 - len(axes))
    return np.concatenate([by_rate, padding]), np.concatenate([by_acceleration, padding])
