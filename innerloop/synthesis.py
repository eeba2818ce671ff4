"""From a linear model to feedback gains: reachable bandwidths, weights by Bryson's rule, servo LQR.

Bryson's rule makes each weight one over the square of an acceptable deviation. The acceptable
deviation follows from a frequency: the fastest that the aircraft's control authority, its servos
and its lift can follow. So one set of numbers, none of which contains a length or a time, designs a
3 kg flying wing and an airliner.

A servo LQR suits the plant. It is multivariable (elevator and throttle both move airspeed and
altitude, aileron and rudder both roll and yaw), an autopilot measures every state that is fed back,
integral action comes with the design, and weights that follow from an aircraft's own frequencies
carry over to the next aircraft.

Servo and engine states are left out of the feedback (a hobby servo's position is not measured) and
out of the Riccati equation, where their static gain replaces them. The margins are then computed
with them and with the computing delay. In a bank, longitudinal and lateral motion couple: the gains
of each are computed as if the other were at rest, and the margins with both.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import control
import numpy as np

from aircraft.linearise import BODY_STATES, LinearModel, Matrix
from aircraft.trim import Trim
from common.physics import STANDARD_GRAVITY
from innerloop.schedule import (
    LONGITUDINAL,
    PERIODS,
    DesignWeights,
    Gains,
    LoopBandwidths,
    loop_delay,
)

_STATIC_GAIN_MIN = 1e-9
"""Final value of a unit step below which a state does not follow an input: a rate ends at 0."""

_LAG_PHASE = 0.18
"""Phase that a loop may lose to servo and computing delay, with the shortest period [rad]."""

_AUTHORITY_FRACTION = 0.5
"""Share of the control authority for a step of a command [-]; gusts and feedback take the rest."""

_BANK_STEP_FRACTION = 0.5
"""Step of bank that takes this authority, over the bank limit [-]."""

_PITCH_STEP = 0.15
"""Step of pitch that takes this authority [rad]: half the acceptable deviation."""

_MODEL_DAMPING = 0.9
"""Damping of the heading-rate response [-]: exp(-pi 0.9 / sqrt(1 - 0.9^2)) = 0.15 % overshoot."""

_PEAK_RATE = 0.42
"""Largest rate of a step response over its frequency [-]: 0.39, or 0.42 with a damping of 0.8."""

_LIFT_FRACTION = 0.75
"""Fastest altitude loop, over -Z_alpha, at which lift turns the path towards the nose [-]."""

_ENGINE_FRACTION = 0.3
"""Fastest airspeed loop times the lag of engine and delay [-]: the phase that they take [rad]."""

_AIRSPEED_TO_ALTITUDE = 0.27
"""Fastest airspeed loop, over the altitude loop [-].

Elevator and throttle both move airspeed and altitude, so a factor near 4 separates the frequencies.
"""

# The deviations of Bryson's rule, in an aircraft's own units: one over a loop's bandwidth for time,
# V for climbing, g for changes of airspeed, g/V for turning. They are the weights of the X8's first
# design, divided by its units, and serve every aircraft: the margins and step responses of each
# design are computed, and a design without the required margins is slowed down or refused.
_PITCH = 0.3
_ROLL = 0.1
_SIDESLIP = 0.05
"""Acceptable angles [rad]."""

_PITCH_RATE = 0.5
_ROLL_RATE = 3.3
"""Acceptable rates of pitch and, hardly penalised, of roll, over angle per unit of time [-]."""

_CLIMB_TIME = 0.5
_SLOWDOWN_TIME = 2.0
"""Time in which the acceptable pitch makes acceptable altitude and airspeed [units of time]."""

_AIRSPEED_HELD = 2.4
_ALTITUDE_HELD = 12.0
_HEADING_RATE_HELD = 14.0
_SIDESLIP_HELD = 6.0
"""How long an acceptable deviation may last [units of time]: it gives the acceptable integral.

The deviation of the heading rate is the rate at which the acceptable roll turns.
"""

_ERROR_MAX = 2.0
"""Clipping of altitude and airspeed errors, over acceptable ones [-]: beyond, a steady climb."""

_ANTI_WINDUP = 0.33
"""Rate at which integrators follow a saturated control, over the longitudinal bandwidth [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlWeights:
    """Acceptable deviations of the controls at one airspeed [-]; NaN without a rudder."""

    elevator: float
    aileron: float
    throttle: float
    rudder: float


def quasi_static(model: LinearModel) -> LinearModel:
    """Return the model with the states of servos and engines replaced by their static gain."""
    labels = model.state_labels
    rigid = [i for i, name in enumerate(labels) if name in BODY_STATES]
    driven = [i for i, name in enumerate(labels) if name not in BODY_STATES]
    a, b, c, d = model.A, model.B, model.C, model.D
    inverse = -np.linalg.inv(a[np.ix_(driven, driven)])
    by_rigid = inverse @ a[np.ix_(driven, rigid)]
    by_input = inverse @ b[driven]
    return LinearModel(
        A=a[np.ix_(rigid, rigid)] + a[np.ix_(rigid, driven)] @ by_rigid,
        B=b[rigid] + a[np.ix_(rigid, driven)] @ by_input,
        C=c[:, rigid] + c[:, driven] @ by_rigid,
        D=d + c[:, driven] @ by_input,
        state_labels=tuple(labels[i] for i in rigid),
        input_labels=model.input_labels,
        output_labels=model.output_labels,
    )


def state_lag(model: LinearModel, control_input: str) -> float:
    """Return the lag of a control input [s]: that of the slowest servo or engine state behind it.

    The lag of a state is the area between its step response and its final value, over that value.
    """
    driven = [i for i, name in enumerate(model.state_labels) if name not in BODY_STATES]
    if not driven:
        return 0.0
    follow = model.A[np.ix_(driven, driven)]
    end = -np.linalg.solve(follow, model.B[driven, model.input_labels.index(control_input)])
    area = -np.linalg.solve(follow, end)
    lags = [float(a / e) for a, e in zip(area, end, strict=True) if abs(e) > _STATIC_GAIN_MIN]
    return max(lags, default=0.0)


def reachable_bandwidths(models: Sequence[LinearModel], bank: float) -> LoopBandwidths:
    """Return the bandwidths that an aircraft can follow at every airspeed.

    The models are linear about level flight, one for each airspeed; its turns bank by ``bank``
    [rad] at most.
    """
    each = [_reachable(model, bank) for model in models]
    longitudinal = min(bandwidths.longitudinal for bandwidths in each)
    engine = min(bandwidths.airspeed for bandwidths in each)
    return LoopBandwidths(
        lateral=min(bandwidths.lateral for bandwidths in each),
        longitudinal=longitudinal,
        airspeed=min(engine, _AIRSPEED_TO_ALTITUDE * longitudinal),
    )


def _reachable(model: LinearModel, bank: float) -> LoopBandwidths:
    plant = quasi_static(model)
    delay = loop_delay(PERIODS[0])
    roll_step = _BANK_STEP_FRACTION * bank
    lateral = min(
        _LAG_PHASE / (state_lag(model, "aileron") + delay),
        math.sqrt(_AUTHORITY_FRACTION * _authority(plant, "p", "aileron") / roll_step),
        _AUTHORITY_FRACTION
        * _authority(plant, "p", "aileron")
        / (abs(_derivative(plant, "p", "p")) * _PEAK_RATE * roll_step),
    )
    longitudinal = min(
        _LAG_PHASE / (state_lag(model, "elevator") + delay),
        math.sqrt(_AUTHORITY_FRACTION * _authority(plant, "q", "elevator") / _PITCH_STEP),
        _LIFT_FRACTION * abs(_derivative(plant, "alpha", "alpha")),
    )
    return LoopBandwidths(
        lateral=lateral,
        longitudinal=longitudinal,
        airspeed=_ENGINE_FRACTION / (state_lag(model, "throttle") + delay),
    )


def _derivative(plant: LinearModel, rate_of: str, state: str) -> float:
    return float(plant.A[plant.state_labels.index(rate_of), plant.state_labels.index(state)])


def _authority(plant: LinearModel, rate_of: str, control_input: str) -> float:
    row = plant.state_labels.index(rate_of)
    return abs(float(plant.B[row, plant.input_labels.index(control_input)]))


def design_weights(bandwidths: LoopBandwidths, airspeed: float) -> DesignWeights:
    """Return the weights for loops of these bandwidths near ``airspeed`` [m/s].

    Altitude follows pitch, and airspeed follows gravity along it. So with a time unit of one over
    the frequency, deviations of altitude go with V, of airspeed with g, and integrals with the unit
    itself.
    """
    unit = 1.0 / bandwidths.longitudinal
    turn = 1.0 / bandwidths.lateral
    altitude = _CLIMB_TIME * airspeed * _PITCH * unit
    speed = _SLOWDOWN_TIME * STANDARD_GRAVITY * _PITCH * unit
    return DesignWeights(
        airspeed=speed,
        pitch=_PITCH,
        pitch_rate=_PITCH_RATE * _PITCH * bandwidths.longitudinal,
        altitude=altitude,
        airspeed_integral=_AIRSPEED_HELD * speed / bandwidths.airspeed,
        altitude_integral=_ALTITUDE_HELD * altitude * unit,
        roll=_ROLL,
        roll_rate=_ROLL_RATE * _ROLL * bandwidths.lateral,
        sideslip=_SIDESLIP,
        heading_integral=_HEADING_RATE_HELD * STANDARD_GRAVITY / airspeed * _ROLL * turn,
        sideslip_integral=_SIDESLIP_HELD * _SIDESLIP * turn,
        model_frequency=bandwidths.lateral,
        model_damping=_MODEL_DAMPING,
        altitude_error_max=_ERROR_MAX * altitude,
        airspeed_error_max=_ERROR_MAX * speed,
        anti_windup_rate=_ANTI_WINDUP * bandwidths.longitudinal,
    )


def control_weights(
    model: LinearModel, bandwidths: LoopBandwidths, weights: DesignWeights
) -> ControlWeights:
    """Return the control deflections that move each axis at its bandwidth, against its damping."""
    plant = quasi_static(model)

    def effort(row: str, frequency: float) -> float:
        return frequency * math.hypot(frequency, _derivative(plant, row, row))

    rudder = math.nan
    if _has_rudder(plant):
        stiffness = abs(_derivative(plant, "r", "beta"))
        rudder = (
            weights.sideslip
            * min(effort("r", bandwidths.lateral), stiffness)
            / _authority(plant, "r", "rudder")
        )
    pitching = weights.pitch * effort("q", bandwidths.longitudinal)
    rolling = weights.roll * effort("p", bandwidths.lateral)
    return ControlWeights(
        elevator=pitching / _authority(plant, "q", "elevator"),
        aileron=rolling / _authority(plant, "p", "aileron"),
        throttle=weights.airspeed * bandwidths.airspeed / _authority(plant, "airspeed", "throttle"),
        rudder=rudder,
    )


def design_gains(
    model: LinearModel, trim: Trim, weights: DesignWeights, controls: ControlWeights
) -> Gains:
    """Return the feedback gains for a model from ``aircraft.linearise`` about ``trim``.

    The acceptable deviations of states and controls are those at its airspeed.
    """
    plant = quasi_static(model)
    longitudinal, longitudinal_integral = _longitudinal(plant, weights, controls)
    lateral, heading_integral, sideslip_integral = _lateral(plant, weights, controls)
    by_rate, by_acceleration = _feedforward(plant, trim)
    return Gains(
        longitudinal=longitudinal,
        longitudinal_integral=longitudinal_integral,
        lateral=lateral,
        heading_integral=heading_integral,
        sideslip_integral=sideslip_integral,
        roll_rate_feedforward=by_rate,
        roll_acceleration_feedforward=by_acceleration,
    )


def _has_rudder(plant: LinearModel) -> bool:
    return "rudder" in plant.input_labels


def _bryson(*deviations: float) -> Matrix:
    """Return the weights of Bryson's rule; a deviation of 0 stands for no weight."""
    return np.diag([0.0 if d == 0.0 else 1.0 / d**2 for d in deviations])


def _servo(a: Matrix, b: Matrix, c: Matrix, d: Matrix, q: Matrix, r: Matrix) -> Matrix:
    """Return the LQR gain on the plant with the integral of -y appended."""
    n, m = c.shape[1], c.shape[0]
    a_servo = np.block([[a, np.zeros((n, m))], [-c, np.zeros((m, m))]])
    gain, _, _ = control.lqr(a_servo, np.vstack([b, -d]), q, r)
    return np.asarray(gain)


def _longitudinal(
    plant: LinearModel, w: DesignWeights, controls: ControlWeights
) -> tuple[Matrix, Matrix]:
    """Return the gains from ``LONGITUDINAL``, and from the integrals of airspeed and altitude."""
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
    """Return the gains from ``LATERAL``, and from the integrals of heading rate and sideslip."""
    states = ("beta", "p", "r", "roll")
    if not _has_rudder(plant):
        a, b, c, d = plant.pick(states, ("aileron",), ("heading_rate",))
        q = _bryson(0.0, w.roll_rate, 0.0, w.roll, w.heading_integral)
        gain = _servo(a, b, c, d, q, _bryson(controls.aileron))[0]
        return np.array([[*gain[1:4], 0.0], np.zeros(4)]), -float(gain[4]) / float(gain[3]), 0.0
    a, b, c, d = plant.pick(states, ("aileron", "rudder"), ("heading_rate", "beta"))
    q = _bryson(w.sideslip, w.roll_rate, 0.0, w.roll, w.heading_integral, w.sideslip_integral)
    gain = _servo(a, b, c, d, q, _bryson(controls.aileron, controls.rudder))
    in_lateral_order = gain[:, [1, 2, 3, 0]]
    return in_lateral_order, -float(gain[0, 4]) / float(gain[0, 3]), float(gain[1, 5])


def _feedforward(plant: LinearModel, trim: Trim) -> tuple[Matrix, Matrix]:
    """Return aileron and rudder for a roll rate and for a roll acceleration, shape (2,) each.

    The rudder cancels the yaw that rolling and aileron cause, and turns the nose with the turn: r
    grows by g cos(bank)/V times p.
    """
    axes: tuple[str, ...] = ("p",)
    inputs: tuple[str, ...] = ("aileron",)
    if _has_rudder(plant):
        axes = ("p", "r")
        inputs = ("aileron", "rudder")
    a, b, _, _ = plant.pick(axes, inputs, ("p",))
    turning = np.array([0.0, STANDARD_GRAVITY * math.cos(trim.roll) / trim.airspeed])[: len(axes)]
    inverse = np.linalg.inv(b)
    by_rate = inverse @ (turning - a[:, 0])
    by_acceleration = inverse[:, 0]
    padding = np.zeros(2 - len(axes))
    return np.concatenate([by_rate, padding]), np.concatenate([by_acceleration, padding])
