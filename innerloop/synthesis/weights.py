"""Requirements of a design: the bandwidths that an aircraft's loops can have, by its linear model,
and LQR weights for them.

Bryson's rule makes each weight one over the square of an acceptable deviation. What is acceptable
follows from a frequency: the fastest that an aircraft's control authority, its servos and its lift
can follow. So one set of numbers, none of them with a length or a time in it, designs a 3 kg flying
wing and an airliner.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from aircraft.linearise import LinearModel
from common.physics.units import STANDARD_GRAVITY
from innerloop.synthesis.quasi_static import quasi_static, state_lag
from innerloop.synthesis.rate import PERIODS, loop_delay

_LAG_PHASE = 0.18
"""Phase that a loop may lose to its servo and the computing delay at its frequency, if the
autopilot computes at every time step [rad]: 10 degrees."""

_AUTHORITY_FRACTION = 0.5
"""Fraction of the control authority that a step of a command may take [-]: the rest is for gusts
and feedback.
"""

_BANK_STEP_FRACTION = 0.5
"""The step of bank that takes this authority, over the bank limit [-]: half-way into the steepest
turn.
"""

_PITCH_STEP = 0.15
"""The step of pitch that takes this authority [rad]: half the acceptable deviation."""

_MODEL_DAMPING = 0.9
"""Damping of the heading-rate response [-]: it overshoots by 0.15 %, exp(-pi 0.9 / sqrt(1 -
0.9^2)).
"""

_PEAK_RATE = 0.42
"""Largest rate of a second-order response to a unit step, over its frequency [-]: 0.39 with a
damping of 0.9, and 0.42 with one of 0.8, so there is a little to spare."""

_LIFT_FRACTION = 0.75
"""Fastest altitude loop, over the rate -Z_alpha at which lift turns the flight path towards the
nose [-].
"""

_ENGINE_FRACTION = 0.3
"""Fastest airspeed loop, over one over the lag of engine and delay [-]: there the engine
takes 0.3 rad, 17 degrees, of phase."""

_AIRSPEED_TO_ALTITUDE = 0.27
"""Fastest airspeed loop, over the altitude loop [-]: elevator and throttle both move both, so the
frequencies are kept apart by a factor near 4."""

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
"""Acceptable rates of pitch and roll, over their angle a unit of time [-]; roll rate is hardly
penalised.
"""

_CLIMB_TIME = 0.5
_SLOWDOWN_TIME = 2.0
"""Time in which the acceptable pitch makes the acceptable deviation of altitude, by climbing, and
of airspeed, by gravity [units of time]."""

_AIRSPEED_HELD = 2.4
_ALTITUDE_HELD = 12.0
_HEADING_RATE_HELD = 14.0
_SIDESLIP_HELD = 6.0
"""How long an acceptable deviation may last, which gives the acceptable integral of it
[units of time]. For the heading rate, the deviation is the rate at which the acceptable roll
turns."""

_ERROR_MAX = 2.0
"""Number of acceptable deviations beyond which an error of altitude or airspeed is clipped [-]: it
then asks for a steady climb or acceleration."""

_ANTI_WINDUP = 0.33
"""Rate at which integrators follow a saturated control, over the longitudinal bandwidth [-]: three
units of time.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopBandwidths:
    """Bandwidths of the loops of a design.

    Attributes
    ----------
    lateral : frequency of the heading-rate response [rad/s]
    longitudinal : of pitch and altitude [rad/s]
    airspeed : of airspeed by throttle [rad/s]
    """

    lateral: float
    longitudinal: float
    airspeed: float

    def scaled(
        self, *, lateral: float = 1.0, longitudinal: float = 1.0, airspeed: float = 1.0
    ) -> "LoopBandwidths":
        """Return the bandwidths times factors."""
        return LoopBandwidths(
            lateral=self.lateral * lateral,
            longitudinal=self.longitudinal * longitudinal,
            airspeed=self.airspeed * airspeed,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignWeights:
    """Acceptable deviations and the response to a heading-rate command, at every airspeed of a
    design.

    Attributes
    ----------
    airspeed, pitch, pitch_rate, altitude : longitudinal deviations [m/s, rad, rad/s, m]
    airspeed_integral, altitude_integral : of their time integrals [m, m s]
    roll, roll_rate, sideslip : lateral deviations [rad, rad/s, rad]
    heading_integral, sideslip_integral : of the time integrals of heading-rate error and sideslip
        [rad, rad s]
    model_frequency, model_damping : the second-order response to a heading-rate command that the
        lateral loop follows [rad/s, -]
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
    """Acceptable deviations of the controls at one airspeed [-]; the rudder's is NaN without a
    rudder.
    """

    elevator: float
    aileron: float
    throttle: float
    rudder: float


def reachable_bandwidths(models: Sequence[LinearModel], bank: float) -> LoopBandwidths:
    """Return the bandwidths that every level linear model of an aircraft can follow, in turns up to
    ``bank`` [rad].
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

    def a(row: str, column: str) -> float:
        return float(plant.A[plant.state_labels.index(row), plant.state_labels.index(column)])

    def b(row: str, column: str) -> float:
        return abs(float(plant.B[plant.state_labels.index(row), plant.input_labels.index(column)]))

    delay, roll_step = loop_delay(PERIODS[0]), _BANK_STEP_FRACTION * bank
    lateral = min(
        _LAG_PHASE / (state_lag(model, "aileron") + delay),
        math.sqrt(_AUTHORITY_FRACTION * b("p", "aileron") / roll_step),
        _AUTHORITY_FRACTION * b("p", "aileron") / (abs(a("p", "p")) * _PEAK_RATE * roll_step),
    )
    longitudinal = min(
        _LAG_PHASE / (state_lag(model, "elevator") + delay),
        math.sqrt(_AUTHORITY_FRACTION * b("q", "elevator") / _PITCH_STEP),
        _LIFT_FRACTION * abs(a("alpha", "alpha")),
    )
    return LoopBandwidths(
        lateral=lateral,
        longitudinal=longitudinal,
        airspeed=_ENGINE_FRACTION / (state_lag(model, "throttle") + delay),
    )


def design_weights(bandwidths: LoopBandwidths, airspeed: float) -> DesignWeights:
    """Return the weights for loops of these bandwidths at about ``airspeed`` [m/s].

    Altitude follows pitch, and airspeed follows gravity along it; so with a time unit of one over
    the frequency, deviations of altitude go with V, of airspeed with g, and integrals with the unit
    itself.
    """
    unit, turn = 1.0 / bandwidths.longitudinal, 1.0 / bandwidths.lateral
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
    """Return the controls at one airspeed that move their axis at its frequency, against its own
    damping.
    """
    plant = quasi_static(model)

    def authority(row: str, column: str) -> float:
        return abs(float(plant.B[plant.state_labels.index(row), plant.input_labels.index(column)]))

    def effort(row: str, frequency: float) -> float:
        i = plant.state_labels.index(row)
        return frequency * math.hypot(frequency, float(plant.A[i, i]))

    rudder = math.nan
    if "rudder" in plant.input_labels:
        stiffness = abs(
            float(plant.A[plant.state_labels.index("r"), plant.state_labels.index("beta")])
        )
        rudder = (
            weights.sideslip
            * min(effort("r", bandwidths.lateral), stiffness)
            / authority("r", "rudder")
        )
    return ControlWeights(
        elevator=weights.pitch * effort("q", bandwidths.longitudinal) / authority("q", "elevator"),
        aileron=weights.roll * effort("p", bandwidths.lateral) / authority("p", "aileron"),
        throttle=weights.airspeed * bandwidths.airspeed / authority("airspeed", "throttle"),
        rudder=rudder,
    )
