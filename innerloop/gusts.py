"""Turbulence as filtered white noise, and the linear aircraft in moving air.

Low-altitude turbulence follows MIL-F-8785C (``aircraft.weather``). The filters are the factors of
the Dryden spectra, section 3.7.1.2, with rotations as in JSBSim (Yeager, NASA CR-1998-206937): p is
independent, and q and r are the slopes of w and v along the path, averaged over the span. JSBSim's
``atmosphere/turb-type`` 4 has the same filters in Tustin's discretisation.

A gust acts through the velocity of the body relative to the air, on aerodynamic forces and moments
and on the propeller. The columns of a linear model for still air also contain kinematic terms: the
rotation of the velocity components with the body (-omega x v), the climb rate, and the rates of
angles. These terms are known in closed form and subtracted. The remainder, times minus the air's
velocity, is the effect of a gust.

python-control is imported only where it is used.
"""

import math
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from aircraft.linearise import LinearModel
from aircraft.state import body_velocity, level
from aircraft.trim import Trim
from aircraft.weather import GustStatistics
from innerloop.law import ControlLaw, linear_controller
from innerloop.margins import closed_loop
from innerloop.schedule import LEVEL_GAINS, Schedule

if TYPE_CHECKING:
    import control

GUSTS = ("gust_along", "gust_right", "gust_down", "gust_p", "gust_q", "gust_r")
"""Velocity of the air along the trimmed course, right and down [m/s], and its rotation [rad/s]."""

MOTION = ("speed", "course_rate")
"""Motion relative to the mean air: horizontal speed [m/s] and rate of the course [rad/s].

``airspeed``, ``alpha``, ``beta`` and ``heading_rate`` are relative to the gusty air, as the
autopilot measures them.
"""

_AIR = ("airspeed", "alpha", "beta", "p", "q", "r")
_RATES = ("p", "q", "r")

Array = npt.NDArray[np.float64]


def dryden_filters(
    turbulence: GustStatistics, *, airspeed: float, span: float
) -> "control.StateSpace":
    """Return the filters from four white noises of intensity 1 (of u, v, w and p) to ``GUSTS``.

    The solution of the Lyapunov equation is the covariance of the gusts.

    Parameters
    ----------
    turbulence : standard deviations and scale lengths
    airspeed : airspeed of the aircraft [m/s]
    span : wing span, over which rotations are averaged [m]
    """
    import control

    def lag(gain: float, time: float) -> control.TransferFunction:
        return control.tf([gain], [time, 1.0])

    def across_path(deviation: float, time: float) -> control.TransferFunction:
        """Return sigma sqrt(T) (1 + sqrt(3) T s) / (1 + T s)^2."""
        gain = deviation * math.sqrt(time)
        denominator = np.polymul([time, 1.0], [time, 1.0])
        return control.tf([gain * math.sqrt(3.0) * time, gain], denominator)

    def slope(share: float) -> control.TransferFunction:
        """Return the slope of a velocity along the path, averaged over a fraction of the span."""
        return control.tf([1.0 / airspeed, 0.0], [share * span / (math.pi * airspeed), 1.0])

    def block(system: control.TransferFunction, source: str, name: str) -> control.StateSpace:
        return control.ss(
            control.tf2ss(system), inputs=[source], outputs=[name], name=f"{name}_filter"
        )

    along = turbulence.horizontal_length / airspeed
    down = turbulence.vertical_length / airspeed
    reach = math.sqrt(turbulence.vertical_length * span)
    rolling = reach / 2.6 / airspeed
    u = lag(turbulence.horizontal * math.sqrt(2.0 * along), along)
    p = lag(1.9 * turbulence.vertical / reach * math.sqrt(2.0 * rolling), rolling)
    blocks = [
        block(u, "noise_u", "u"),
        block(across_path(turbulence.horizontal, along), "noise_v", "v"),
        block(across_path(turbulence.vertical, down), "noise_w", "w"),
        block(p, "noise_p", "p"),
        block(slope(4.0), "w", "q"),
        block(slope(3.0), "v", "r"),
    ]
    together = control.interconnect(
        blocks,
        inputs=[f"noise_{name}" for name in "uvwp"],
        outputs=list("uvwpqr"),
        name="turbulence",
    )
    together.update_names(outputs=list(GUSTS))
    return together


def gust_loop(schedule: Schedule, index: int, bank_index: int) -> "control.StateSpace":
    """Return the closed loop of aircraft and autopilot, with commands and gusts as inputs.

    Inputs are ``COMMANDS`` and ``GUSTS``. Outputs are the outputs of ``aircraft_in_gusts`` and the
    command of each control. Indices of airspeed and bank are as in ``Schedule.gain_trim``.
    """
    models = schedule.models[index]
    trim = schedule.gain_trim(index, bank_index)
    aircraft = aircraft_in_gusts(models[bank_index], trim, models[LEVEL_GAINS])
    return closed_loop(aircraft, linear_controller(ControlLaw(schedule), trim), schedule.delay)


def aircraft_in_gusts(model: LinearModel, trim: Trim, level_model: LinearModel) -> LinearModel:
    """Return a linear model with gusts as inputs and motion relative to the mean air as outputs.

    Parameters
    ----------
    model, trim : linear model from ``aircraft.linearise``, and its equilibrium
    level_model : linear model of level flight at the same airspeed

    Returns
    -------
    LinearModel
        The states are those of ``model``, with the velocity relative to the mean air. ``GUSTS``
        follow the inputs of ``model``, and ``MOTION`` follows its outputs. The outputs
        ``airspeed``, ``alpha``, ``beta`` and ``heading_rate`` are relative to the gusty air.

    Notes
    -----
    In a turn, the derivatives of moments by angular rates contain gyroscopic moments, which cannot
    be separated without the body's inertia. The derivatives are taken from level flight, where
    gyroscopic moments vanish; they hardly depend on the angle of attack.
    """
    states, outputs = model.state_labels, model.output_labels
    air = [states.index(name) for name in _AIR]
    moments = [states.index(name) for name in _RATES]
    at = velocity_by_polar(trim.airspeed, trim.alpha, trim.beta)
    by_air = model.A[:, air].copy()
    # Derivatives of -omega x v with respect to the components of ``_AIR``.
    velocity = body_velocity(trim.airspeed, trim.alpha, trim.beta)
    turning = np.hstack([-_cross(trim.rates_body) @ at, _cross(velocity)])
    by_air[:3] -= np.linalg.solve(at, turning)
    by_air[moments, 3:] = level_model.A[np.ix_(moments, air[3:])]
    by_air[[states.index(name) for name in ("roll", "pitch", "altitude")]] = 0.0

    to_body = _course_to_body(trim)
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
    # Relative to the mean air the aircraft is faster by the gust along its course, so the same
    # acceleration turns its course less.
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
    """Return the derivatives of body velocity by airspeed, alpha and beta, shape (3, 3)."""
    ca, sa = math.cos(alpha), math.sin(alpha)
    cb, sb = math.cos(beta), math.sin(beta)
    return np.array(
        [
            [ca * cb, -airspeed * sa * cb, -airspeed * ca * sb],
            [sb, 0.0, airspeed * cb],
            [sa * cb, airspeed * ca * cb, -airspeed * sa * sb],
        ]
    )


def _cross(vector: tuple[float, float, float]) -> Array:
    """Return the matrix of the cross product with ``vector``."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _course_to_body(trim: Trim) -> Array:
    """Return the matrix that turns a vector along the course, right and down into body axes."""
    units = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    from_body = np.column_stack([level(unit, trim.roll, trim.pitch) for unit in units])
    offset = trim.course_offset()
    cos, sin = math.cos(offset), math.sin(offset)
    from_course = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(from_body.T @ from_course)
