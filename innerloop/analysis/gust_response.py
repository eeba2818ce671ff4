"""The linear aircraft in moving air, alone and under its autopilot.

Air that moves acts through what the body's velocity against it makes: forces and moments of the
air, and what the propeller sees. The linear model was made in still air, where that velocity is the
body's own, so its columns hold more: how velocity components turn with the body (-omega x v), how
they add up to climb, and how angles follow rates. Those are known in closed form and subtracted;
the rest, times minus the air's velocity, is the effect of a gust.
"""

import math

import control
import numpy as np
import numpy.typing as npt

from aircraft.linearise import LinearModel
from aircraft.state import body_velocity, level
from aircraft.trim import Trim
from innerloop.analysis.closed_loop import closed_loop
from innerloop.law.control_law import ControlLaw
from innerloop.law.linear_controller import linear_controller
from innerloop.synthesis.schedule import LEVEL_GAINS, Schedule

GUSTS = ("gust_along", "gust_right", "gust_down", "gust_p", "gust_q", "gust_r")
"""Velocity of the air along the trimmed course, right and down [m/s], and its rotation about these
axes [rad/s].
"""

MOTION = ("speed", "course_rate")
"""Motion against the mean air: horizontal speed [m/s] and rate of the course [rad/s]; ``airspeed``,
``alpha``, ``beta`` and ``heading_rate`` are against the gusty air, as the autopilot measures
them."""

_AIR = ("airspeed", "alpha", "beta", "p", "q", "r")
_RATES = ("p", "q", "r")

Array = npt.NDArray[np.float64]


def gust_loop(schedule: Schedule, index: int, bank_index: int) -> control.StateSpace:
    """Return aircraft and autopilot at airspeed ``index`` and gain bank ``bank_index``, from
    commands and gusts.

    Inputs are ``COMMANDS`` and ``GUSTS``; outputs those of ``aircraft_in_gusts`` and each control's
    command.
    """
    models = schedule.models[index]
    trim = schedule.gain_trim(index, bank_index)
    aircraft = aircraft_in_gusts(models[bank_index], trim, models[LEVEL_GAINS])
    return closed_loop(aircraft, linear_controller(ControlLaw(schedule), trim), schedule.delay)


def aircraft_in_gusts(model: LinearModel, trim: Trim, level_model: LinearModel) -> LinearModel:
    """Return a linear model with inputs for gusts, and outputs for the motion against the mean air.

    Parameters
    ----------
    model, trim : as ``aircraft.linearise.linearise`` returned it, and where
    level_model : at the same airspeed in level flight

    Returns
    -------
    LinearModel
        States as those of ``model``; the body's velocity is that against the mean air. Inputs:
        those of ``model``, then ``GUSTS``. Outputs: those of ``model``, of which ``airspeed``,
        ``alpha``, ``beta`` and ``heading_rate`` are against the gusty air, then ``MOTION``.

    Notes
    -----
    In a turn the rates' columns of moments hold the body's gyroscopic moments, which cannot be
    separated without its inertia. Moments by rates are taken from level flight instead, where
    gyroscopic moments vanish; they hardly depend on the angle of attack.
    """
    states, outputs = model.state_labels, model.output_labels
    air = [states.index(name) for name in _AIR]
    moments = [states.index(name) for name in _RATES]
    at = velocity_by_polar(trim.airspeed, trim.alpha, trim.beta)
    by_air = model.A[:, air].copy()
    by_air[:3] -= np.linalg.solve(at, _turning(trim, at))
    by_air[moments, 3:] = level_model.A[np.ix_(moments, air[3:])]
    by_air[[states.index(name) for name in ("roll", "pitch", "altitude")]] = 0.0

    to_body = _level_to_body(trim)
    against = np.zeros((6, 6))
    against[:3, :3] = -np.linalg.solve(at, to_body)
    against[3:, 3:] = -to_body

    reads = np.zeros((len(outputs), len(GUSTS)))
    for j, name in enumerate(_AIR[:3]):
        reads[outputs.index(name)] = against[j]
    rate = outputs.index("heading_rate")
    reads[rate] = model.C[rate, air] @ against
    speed = np.zeros(len(states))
    speed[states.index("airspeed")] = 1.0
    # The same acceleration turns a faster motion less: against the mean air the aircraft is faster
    # by the gust along its course.
    course_rate = reads[rate] - np.eye(len(GUSTS))[0] * trim.yaw_rate / trim.airspeed
    return LinearModel(
        A=model.A,
        B=np.hstack([model.B, by_air @ against]),
        C=np.vstack([model.C, speed, model.C[rate]]),
        D=np.block(
            [
                [model.D, reads],
                [np.zeros((1, len(model.input_labels) + len(GUSTS)))],
                [model.D[rate], course_rate],
            ]
        ),
        state_labels=states,
        input_labels=(*model.input_labels, *GUSTS),
        output_labels=(*outputs, *MOTION),
    )


def velocity_by_polar(airspeed: float, alpha: float, beta: float) -> Array:
    """Return the rates of body velocity [m/s] by airspeed [m/s], angle of attack and sideslip
    [rad]: (3, 3).
    """
    (ca, sa), (cb, sb) = ((math.cos(x), math.sin(x)) for x in (alpha, beta))
    return np.array([
        [ca * cb, -airspeed * sa * cb, -airspeed * ca * sb],
        [sb, 0.0, airspeed * cb],
        [sa * cb, airspeed * ca * cb, -airspeed * sa * sb],
    ])  # fmt: skip


def _turning(trim: Trim, at: Array) -> Array:
    """Return the rates of -omega x v [m/s^2] by ``_AIR``, shape (3, 6)."""
    velocity = body_velocity(trim.airspeed, trim.alpha, trim.beta)
    return np.hstack([-_cross(trim.rates_body) @ at, _cross(velocity)])


def _cross(vector: tuple[float, float, float]) -> Array:
    """Return the matrix of the cross product with ``vector``."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _level_to_body(trim: Trim) -> Array:
    """Return the matrix that turns a vector along the course, to its right and down into body axes."""
    units = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    from_body = np.column_stack([level(unit, trim.roll, trim.pitch) for unit in units])
    offset = trim.course_offset()
    cos, sin = math.cos(offset), math.sin(offset)
    from_course = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(from_body.T @ from_course)
