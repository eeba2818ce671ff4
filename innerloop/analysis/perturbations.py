"""Perturbations of the aircraft under which margins are checked: effectiveness, mass, inertia, and
a longer delay.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from aircraft.linearise import BODY_STATES, LinearModel
from aircraft.model import PERTURBATIONS, Perturbation
from aircraft.trim import Trim
from common.physics.units import STANDARD_GRAVITY
from innerloop.analysis.checks import NOMINAL

Change = Callable[[LinearModel, Trim], LinearModel]


def _unchanged(model: LinearModel, trim: Trim) -> LinearModel:
    del trim
    return model


def _effectiveness(factor: float) -> Change:
    """Return a change of the effectiveness of every control.

    That of the throttle is among them: thrust changes by the factor, too. In a perturbed model,
    which the search over reversals flies, only surfaces change
    (``aircraft.model``): less effectiveness leaves the throttle's loop less
    margin there than here, where it also lowers the loop's gain.
    """

    def change(model: LinearModel, trim: Trim) -> LinearModel:
        del trim
        b = model.B.copy()
        rows = [i for i, name in enumerate(model.state_labels) if name in BODY_STATES]
        driven = [i for i, name in enumerate(model.state_labels) if name not in BODY_STATES]
        a, c, d = model.A.copy(), model.C.copy(), model.D * factor
        b[rows] *= factor
        a[np.ix_(rows, driven)] *= factor
        extras = [i for i, name in enumerate(model.output_labels) if name not in model.state_labels]
        c[np.ix_(extras, driven)] *= factor
        return replace(model, A=a, B=b, C=c, D=d)

    return change


def _inertia(factor: float) -> Change:
    """Return a change of all moments of inertia: angular accelerations by air and engine divide by
    it.
    """

    def change(model: LinearModel, trim: Trim) -> LinearModel:
        del trim
        a, b = model.A.copy(), model.B.copy()
        rows = [model.state_labels.index(name) for name in "pqr"]
        a[rows] /= factor
        b[rows] /= factor
        return replace(model, A=a, B=b)

    return change


def _mass(factor: float) -> Change:
    """Return a change of mass: accelerations by air and engine divide by it, those by gravity and
    turning do not.
    """

    def change(model: LinearModel, trim: Trim) -> LinearModel:
        a, b, c, d = (m.copy() for m in (model.A, model.B, model.C, model.D))
        rows = [model.state_labels.index(name) for name in ("airspeed", "alpha", "beta")]
        kinematic = gravity_and_turning(trim, model.state_labels)
        a[rows] = kinematic + (a[rows] - kinematic) / factor
        b[rows] /= factor
        # Rate of the course: side force over mass and speed, but for what attitude gives: an
        # aircraft in equilibrium carries its weight whatever that is, so bank turns it by g/V as
        # before.
        row = model.output_labels.index("heading_rate")
        columns = [i for i, name in enumerate(model.state_labels) if name not in ("roll", "pitch")]
        c[row, columns] /= factor
        d[row] /= factor
        return replace(model, A=a, B=b, C=c, D=d)

    return change


def gravity_and_turning(trim: Trim, states: tuple[str, ...]) -> npt.NDArray[np.float64]:
    """Return how airspeed, angle of attack and sideslip change without any force of air or engine,
    shape (3, states).

    Differences of the rigid body's own equations: gravity along the body's axes, and the axes'
    turning.
    """
    names = ("airspeed", "alpha", "beta", "p", "q", "r", "roll", "pitch")
    point = np.array(
        [trim.airspeed, trim.alpha, trim.beta, *trim.rates_body, trim.roll, trim.pitch]
    )

    def rates(x: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        v, alpha, beta, p, q, r, roll, pitch = x
        along, side, down = (
            math.cos(alpha) * math.cos(beta),
            math.sin(beta),
            math.sin(alpha) * math.cos(beta),
        )
        u, w = v * along, v * down
        g = STANDARD_GRAVITY
        gravity = (
            -g * math.sin(pitch),
            g * math.sin(roll) * math.cos(pitch),
            g * math.cos(roll) * math.cos(pitch),
        )
        u_dot = gravity[0] - (q * w - r * v * side)
        side_dot = gravity[1] - (r * u - p * w)
        w_dot = gravity[2] - (p * v * side - q * u)
        v_dot = along * u_dot + side * side_dot + down * w_dot
        alpha_dot = (u * w_dot - w * u_dot) / (u * u + w * w)
        return np.array([v_dot, alpha_dot, (side_dot - v_dot * side) / (v * math.cos(beta))])

    result = np.zeros((3, len(states)))
    for i, name in enumerate(names):
        step = np.zeros(len(names))
        step[i] = 1e-5
        result[:, states.index(name)] = (rates(point + step) - rates(point - step)) / 2e-5
    return result


def _changed(by: Perturbation) -> Change:
    """Return the changes of a linear aircraft that are those of its model."""
    changes = [
        change(factor)
        for change, factor in (
            (_effectiveness, by.effectiveness),
            (_mass, by.mass),
            (_inertia, by.inertia),
        )
        if factor != 1.0
    ]

    def change(model: LinearModel, trim: Trim) -> LinearModel:
        for each in changes:
            model = each(model, trim)
        return model

    return change


CASES: dict[str, tuple[Change, int]] = {
    NOMINAL: (_unchanged, 0),
    **{name: (_changed(by), 0) for name, by in PERTURBATIONS.items()},
    "one more period of delay": (_unchanged, 1),
}
"""Each perturbation by name: the change of the linear aircraft, and by how many of its periods the
autopilot is late.
"""
