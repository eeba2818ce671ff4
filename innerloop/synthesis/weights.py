"""What the design asks for: how fast an aircraft's loops can be, from its own linear model, and the weights that make them so.

Bryson's rule makes each weight one over the square of an acceptable deviation. What is acceptable follows from a frequency: the
fastest that an aircraft's control authority, its servos and its lift can follow. So one set of numbers, none of them with a length
or a time in it, designs a 3 kg flying wing and an airliner.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import control

from aircraft.simulation.fdm import TIME_STEP
from aircraft.units import STANDARD_GRAVITY
from innerloop.synthesis.quasi_static import quasi_static, state_lag

DELAY = 1.5 * TIME_STEP
"""One step of computing and half a step of hold between measurement and servo [s]."""

_PITCH = 0.3
_ROLL = 0.1
_SIDESLIP = 0.05
"""Acceptable deviations of angles [rad]; only their ratios to what follows matter."""

_LAG_SHARE = 0.18
"""A loop's frequency times the lag in it: 0.18 rad, 10 degrees of phase, go to servo and delay."""

_AUTHORITY_SHARE = 0.5
_STEP_OF_BANK = 0.5
_STEP_OF_PITCH = 0.15
"""Half the authority turns half the bank limit, or 0.15 rad of pitch, at the design's frequency."""

_PEAK_RATE = 0.42
"""Largest rate of a second-order answer with damping 0.9 to a unit step, over its frequency [-]."""

_LIFT_SHARE = 0.75
"""Altitude can be no faster than lift follows angle of attack: share of -Z_alpha [-]."""

_ENGINE_SHARE = 0.3
_THROTTLE_SHARE = 0.27
"""Airspeed's frequency over one over the engine's lag, and over that of altitude."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Speeds:
    """How fast the loops are to be.

    Attributes
    ----------
    lateral : frequency of the heading-rate answer [rad/s]
    longitudinal : of pitch and altitude [rad/s]
    airspeed : of airspeed by throttle [rad/s]
    """

    lateral: float
    longitudinal: float
    airspeed: float

    def slower(self, *, lateral: float = 1.0, longitudinal: float = 1.0, airspeed: float = 1.0) -> "Speeds":
        """Return the speeds times factors."""
        return Speeds(
            lateral=self.lateral * lateral,
            longitudinal=self.longitudinal * longitudinal,
            airspeed=self.airspeed * airspeed,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignWeights:
    """Acceptable deviations and the answer to a heading-rate command, at every airspeed of a design.

    Attributes
    ----------
    airspeed, pitch, pitch_rate, altitude : longitudinal deviations [m/s, rad, rad/s, m]
    airspeed_integral, altitude_integral : of their time integrals [m, m s]
    roll, roll_rate, sideslip : lateral deviations [rad, rad/s, rad]
    heading_integral, sideslip_integral : of the time integrals of heading-rate error and sideslip [rad, rad s]
    model_frequency, model_damping : the second-order response to a heading-rate command that the lateral loop follows [rad/s, -]
    altitude_error_max : altitude error that still makes the elevator work harder [m]
    airspeed_error_max : airspeed error that still makes the throttle work harder [m/s]
    anti_windup_rate : how fast an integrator follows its saturated command [1/s]
    """

    airspeed: float
    pitch: float
    pitch_rate: float
    altitude: float
    airspeed_integral: float
    altitude_integral: float
    roll: float
    roll_rate: float
    sideslip: float
    heading_integral: float
    sideslip_integral: float
    model_frequency: float
    model_damping: float
    altitude_error_max: float
    airspeed_error_max: float
    anti_windup_rate: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlWeights:
    """Acceptable deviations of the controls at one airspeed [-]; the rudder's is not a number where there is none."""

    elevator: float
    aileron: float
    throttle: float
    rudder: float


def reachable_speeds(models: Sequence[control.StateSpace], bank: float) -> Speeds:
    """Return the speeds that an aircraft's level linear models can follow at every one of them, in turns up to ``bank`` [rad]."""
    each = [_reachable(model, bank) for model in models]
    longitudinal = min(speeds.longitudinal for speeds in each)
    engine = min(speeds.airspeed for speeds in each)
    return Speeds(
        lateral=min(speeds.lateral for speeds in each),
        longitudinal=longitudinal,
        airspeed=min(engine, _THROTTLE_SHARE * longitudinal),
    )


def _reachable(model: control.StateSpace, bank: float) -> Speeds:
    plant = quasi_static(model)

    def a(row: str, column: str) -> float:
        return float(plant.A[plant.state_labels.index(row), plant.state_labels.index(column)])

    def b(row: str, column: str) -> float:
        return abs(float(plant.B[plant.state_labels.index(row), plant.input_labels.index(column)]))

    roll_step = _STEP_OF_BANK * bank
    lateral = min(
        _LAG_SHARE / (state_lag(model, "aileron") + DELAY),
        math.sqrt(_AUTHORITY_SHARE * b("p", "aileron") / roll_step),
        _AUTHORITY_SHARE * b("p", "aileron") / (abs(a("p", "p")) * _PEAK_RATE * roll_step),
    )
    longitudinal = min(
        _LAG_SHARE / (state_lag(model, "elevator") + DELAY),
        math.sqrt(_AUTHORITY_SHARE * b("q", "elevator") / _STEP_OF_PITCH),
        _LIFT_SHARE * abs(a("alpha", "alpha")),
    )
    return Speeds(lateral=lateral, longitudinal=longitudinal, airspeed=_ENGINE_SHARE / (state_lag(model, "throttle") + DELAY))


def design_weights(speeds: Speeds, airspeed: float) -> DesignWeights:
    """Return the weights for loops of these speeds at about ``airspeed`` [m/s].

    Altitude follows pitch, and airspeed follows gravity along it; so with a time unit of one over the frequency, deviations of
    altitude go with V, of airspeed with g, and integrals with the unit itself.
    """
    unit, turn = 1.0 / speeds.longitudinal, 1.0 / speeds.lateral
    altitude = 0.5 * airspeed * _PITCH * unit
    speed = 2.0 * STANDARD_GRAVITY * _PITCH * unit
    return DesignWeights(
        airspeed=speed,
        pitch=_PITCH,
        pitch_rate=0.5 * _PITCH * speeds.longitudinal,
        altitude=altitude,
        airspeed_integral=2.4 * speed / speeds.airspeed,
        altitude_integral=12.0 * altitude * unit,
        roll=_ROLL,
        roll_rate=3.3 * _ROLL * speeds.lateral,
        sideslip=_SIDESLIP,
        heading_integral=14.0 * STANDARD_GRAVITY / airspeed * _ROLL * turn,
        sideslip_integral=6.0 * _SIDESLIP * turn,
        model_frequency=speeds.lateral,
        model_damping=0.9,
        altitude_error_max=2.0 * altitude,
        airspeed_error_max=2.0 * speed,
        anti_windup_rate=0.33 * speeds.longitudinal,
    )


def control_weights(model: control.StateSpace, speeds: Speeds, weights: DesignWeights) -> ControlWeights:
    """Return what the controls may do at one airspeed: what moves their axis at its frequency, against its own damping."""
    plant = quasi_static(model)

    def authority(row: str, column: str) -> float:
        return abs(float(plant.B[plant.state_labels.index(row), plant.input_labels.index(column)]))

    def effort(row: str, frequency: float) -> float:
        i = plant.state_labels.index(row)
        return frequency * math.hypot(frequency, float(plant.A[i, i]))

    rudder = math.nan
    if "rudder" in plant.input_labels:
        stiffness = abs(float(plant.A[plant.state_labels.index("r"), plant.state_labels.index("beta")]))
        rudder = weights.sideslip * min(effort("r", speeds.lateral), stiffness) / authority("r", "rudder")
    return ControlWeights(
        elevator=weights.pitch * effort("q", speeds.longitudinal) / authority("q", "elevator"),
        aileron=weights.roll * effort("p", speeds.lateral) / authority("p", "aileron"),
        throttle=weights.airspeed * speeds.airspeed / authority("airspeed", "throttle"),
        rudder=rudder,
    )
