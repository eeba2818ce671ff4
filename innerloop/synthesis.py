"""Feedback gains from a linear model: reachable bandwidths, Bryson's rule, servo LQR.

In Bryson's rule each weight is one over the square of an acceptable deviation. The acceptable
deviations follow from the bandwidth that the aircraft's control authority, servos and lift allow.
One set of dimensionless numbers thus designs a 3 kg flying wing and an airliner.

A servo LQR suits the plant for four reasons. The plant is multivariable: elevator and throttle both
move airspeed and altitude, aileron and rudder both roll and yaw. Every state that is fed back is
measured. The design includes integral action. Weights in units of the aircraft's own frequencies
carry over to other aircraft.

Servo and engine states are not fed back, because a hobby servo's position is not measured. In the
Riccati equation their static gain replaces them. The margins are computed with these states and
with the computing delay.

In a bank, longitudinal and lateral motion couple. The gains of each are computed as if the other
were at rest, and the margins with both.
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
"""Least final value of the step response of a state that follows an input [-]: rates end at 0."""

_LAG_PHASE = 0.18
"""Phase that a loop may lose to servo and computing delay at the shortest period [rad]."""

_AUTHORITY_FRACTION = 0.5
"""Fraction of the control authority for a command step [-]; gusts and feedback get the rest."""

_BANK_STEP_FRACTION = 0.5
"""Step of bank that uses this authority, over the bank limit [-]."""

_PITCH_STEP = 0.15
"""Step of pitch that uses this authority [rad]: half the acceptable deviation."""

_MODEL_DAMPING = 0.9
"""Damping of the heading-rate response [-]: exp(-pi 0.9 / sqrt(1 - 0.9^2)) = 0.15 % overshoot."""

_PEAK_RATE = 0.42
"""Largest rate of a step response over its frequency [-]: 0.39, or 0.42 at a damping of 0.8."""

_LIFT_FRACTION = 0.75
"""Fastest altitude loop over -Z_alpha, the rate at which lift aligns the path with the nose [-]."""

_ENGINE_FRACTION = 0.3
"""Fastest airspeed loop times the lag of engine and delay: the phase lost to them [rad]."""

_AIRSPEED_TO_ALTITUDE = 0.27
"""Fastest airspeed loop over the altitude loop [-].

Elevator and throttle both move airspeed and altitude, so a factor near 4 separates the loops.
"""

# Deviations of Bryson's rule in the aircraft's own units: one over a loop's bandwidth for time, V
# for climb rate, g for acceleration, g/V for turn rate. The numbers were found for the X8 and serve
# every aircraft, because a design without the required margins is slowed down or refused.
_PITCH = 0.3
_ROLL = 0.1
_SIDESLIP = 0.05
"""Acceptable angles [rad]."""

_PITCH_RATE = 0.5
_ROLL_RATE = 3.3
"""Acceptable rates of pitch and of roll, over acceptable angle per unit of time [-]."""

_CLIMB_TIME = 0.5
_SLOWDOWN_TIME = 2.0
"""Time for acceptable pitch to cause acceptable altitude and airspeed errors [units of time]."""

_AIRSPEED_HELD = 2.4
_ALTITUDE_HELD = 12.0
_HEADING_RATE_HELD = 14.0
_SIDESLIP_HELD = 6.0
"""Durations of acceptable deviations, which give the acceptable integrals [units of time].

The acceptable heading-rate error is the heading rate of the acceptable roll.
"""

_ERROR_MAX = 2.0
"""Clipping of altitude and airspeed errors over acceptable errors [-]: it limits the climb."""

_ANTI_WINDUP = 0.33
"""Rate at which integrators follow a saturated control over the longitudinal bandwidth [-]."""


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
    """Return the lag of the slowest servo or engine state that follows a control input [s].

    The lag of a state is the area between its step response and its final value, over the final
    value.
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

    ``models`` are linear models about level flight, one per airspeed; ``bank`` is the largest bank
    [rad].
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
    """Return the weights for loops of given bandwidths near ``airspeed`` [m/s].

    Pitch changes altitude at a rate proportional to V, and airspeed at a rate proportional to g.
    With one over the bandwidth as the unit of time, acceptable deviations of altitude scale with V,
    of airspeed with g, and of integrals with the unit of time.
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
    """Return the control deflections that move each axis at its bandwidth, including damping."""
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
    """Return the feedback gains for a linear model about ``trim``.

    ``weights`` and ``controls`` are the acceptable deviations at the model's airspeed.
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
    """Return the weight matrix of Bryson's rule; a deviation of 0 means no weight."""
    return np.diag([0.0 if d == 0.0 else 1.0 / d**2 for d in deviations])


def _servo(a: Matrix, b: Matrix, c: Matrix, d: Matrix, q: Matrix, r: Matrix) -> Matrix:
    """Return the LQR gain of the plant extended by the integral of -y."""
    n, m = c.shape[1], c.shape[0]
    a_servo = np.block([[a, np.zeros((n, m))], [-c, np.zeros((m, m))]])
    gain, _, _ = control.lqr(a_servo, np.vstack([b, -d]), q, r)
    return np.asarray(gain)


def _longitudinal(
    plant: LinearModel, w: DesignWeights, controls: ControlWeights
) -> tuple[Matrix, Matrix]:
    """Return the longitudinal gains: on ``LONGITUDINAL``, and on the integrals of the errors."""
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
    """Return lateral gains: on ``LATERAL``, and on the integrals of heading rate and sideslip."""
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

    The rudder cancels the yaw caused by rolling and by the aileron, and yaws the nose with the
    turn: r grows by g cos(bank)/V times p.
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
