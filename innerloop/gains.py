"""Servo LQR at one airspeed: gains from the linearisation, nothing pasted.

Why a servo LQR: the plant is multivariable (elevator and throttle both move airspeed and altitude), every state it feeds back
is one that a small autopilot measures, integral action comes with the design, and one set of deviations scales to the next
aircraft.

Servo and propeller states are left out of the feedback (nobody measures a hobby servo's position) and out of the Riccati
equation, where they stand for their static gain; the margins are then computed with them and with the computing delay.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import control
import numpy as np
import numpy.typing as npt

from aircraft.linearise import BODY_STATES
from innerloop.weights import DesignWeights

LONGITUDINAL = ("airspeed", "climb_rate", "q", "pitch", "altitude")
"""Measured longitudinal states. Climb rate stands for angle of attack, which small aircraft do not measure."""

LATERAL = ("p", "r", "roll")
"""Measured lateral states. Sideslip, not measured either, is in the Riccati equation but not fed back."""

Matrix = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Gains:
    """Feedback at one airspeed.

    Attributes
    ----------
    airspeed : [m/s]
    longitudinal : shape (2, 5), from deviations of ``LONGITUDINAL`` to elevator and throttle [-]
    longitudinal_integral : shape (2, 2), from the integrals of airspeed and altitude error to elevator and throttle [-]
    lateral : shape (3,), from deviations of ``LATERAL`` to aileron [-]
    heading_integral : from the integral of heading-rate error to bank command [rad/rad]
    roll_rate_feedforward, roll_acceleration_feedforward : aileron for the model's roll rate and acceleration [s, s^2]
    """

    airspeed: float
    longitudinal: Matrix
    longitudinal_integral: Matrix
    lateral: Matrix
    heading_integral: float
    roll_rate_feedforward: float
    roll_acceleration_feedforward: float


def design_gains(model: control.StateSpace, airspeed: float, weights: DesignWeights) -> Gains:
    """Design the feedback for a linear model from ``aircraft.linearise`` at ``airspeed`` [m/s]."""
    plant = _quasi_static(model)
    longitudinal, longitudinal_integral = _longitudinal(plant, weights)
    lateral, aileron_integral, a_p, b_p = _lateral(plant, weights)
    return Gains(
        airspeed=airspeed,
        longitudinal=longitudinal,
        longitudinal_integral=longitudinal_integral,
        lateral=lateral,
        heading_integral=aileron_integral / float(lateral[LATERAL.index("roll")]),
        roll_rate_feedforward=-a_p / b_p,
        roll_acceleration_feedforward=1.0 / b_p,
    )


def _quasi_static(model: control.StateSpace) -> control.StateSpace:
    """Replace every state that follows an input by its static gain."""
    labels: Sequence[str] = model.state_labels
    rigid = [i for i, name in enumerate(labels) if name in BODY_STATES]
    driven = [i for i, name in enumerate(labels) if name not in BODY_STATES]
    a, b, c, d = model.A, model.B, model.C, model.D
    inverse = -np.linalg.inv(a[np.ix_(driven, driven)])
    by_rigid, by_input = inverse @ a[np.ix_(driven, rigid)], inverse @ b[driven]
    return control.ss(
        a[np.ix_(rigid, rigid)] + a[np.ix_(rigid, driven)] @ by_rigid,
        b[rigid] + a[np.ix_(rigid, driven)] @ by_input,
        c[:, rigid] + c[:, driven] @ by_rigid,
        d + c[:, driven] @ by_input,
        states=[labels[i] for i in rigid],
        inputs=model.input_labels,
        outputs=model.output_labels,
    )


def _pick(plant: control.StateSpace, states: Sequence[str], inputs: Sequence[str], outputs: Sequence[str]) -> tuple[Matrix, ...]:
    rows = [plant.state_labels.index(name) for name in states]
    columns = [plant.input_labels.index(name) for name in inputs]
    reads = [plant.output_labels.index(name) for name in outputs]
    return (
        plant.A[np.ix_(rows, rows)],
        plant.B[np.ix_(rows, columns)],
        plant.C[np.ix_(reads, rows)],
        plant.D[np.ix_(reads, columns)],
    )


def _bryson(*deviations: float) -> Matrix:
    return np.diag([0.0 if d == 0.0 else 1.0 / d**2 for d in deviations])


def _servo(a: Matrix, b: Matrix, c: Matrix, d: Matrix, q: Matrix, r: Matrix) -> Matrix:
    """LQR on the plant with the integral of -y appended."""
    n, m = c.shape[1], c.shape[0]
    a_servo = np.block([[a, np.zeros((n, m))], [-c, np.zeros((m, m))]])
    gain, _, _ = control.lqr(a_servo, np.vstack([b, -d]), q, r)
    return np.asarray(gain)


def _longitudinal(plant: control.StateSpace, w: DesignWeights) -> tuple[Matrix, Matrix]:
    states = ("airspeed", "alpha", "q", "pitch", "altitude")
    a, b, c, d = _pick(plant, states, ("elevator", "throttle"), ("airspeed", "altitude"))
    q = _bryson(w.airspeed, 0.0, 0.0, w.pitch, w.altitude, w.airspeed_integral, w.altitude_integral)
    gain = _servo(a, b, c, d, q, _bryson(w.elevator, w.throttle))
    _, _, measured, _ = _pick(plant, states, ("elevator",), LONGITUDINAL)
    return gain[:, :5] @ np.linalg.inv(measured), -gain[:, 5:]


def _lateral(plant: control.StateSpace, w: DesignWeights) -> tuple[Matrix, float, float, float]:
    states = ("beta", *LATERAL)
    a, b, c, d = _pick(plant, states, ("aileron",), ("heading_rate",))
    q = _bryson(0.0, w.roll_rate, 0.0, w.roll, w.heading_integral)
    gain = _servo(a, b, c, d, q, _bryson(w.aileron))
    return gain[0, 1:4], -float(gain[0, 4]), float(a[1, 1]), float(b[1, 0])
