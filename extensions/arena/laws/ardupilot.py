"""ArduPilot's L1 control, towards a waypoint and on a loiter circle.

Towards a waypoint it is Park's law with period and damping set, a capture angle and an integrator.
On a circle it first captures the circle from outside, and then has proportional and derivative
control.

Written from a description of the laws, not from ArduPilot's code, which has another licence.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from extensions.arena.laws.path import PathLaw, PathMotion, path_motion, turn_rate
from gnc.laws import ONLY_CIRCLES, ONLY_MOVING_POINTS
from gnc.numeric import clip, wrap
from gnc.reference.reference import Reference
from gnc.steering import Air, Motion
from gnc.vectors import Vector, along, course_of, cross, dot, minus, norm, plus, scaled

PERIOD = 17.0
"""ArduPilot's default of NAVL1_PERIOD [s]."""
DAMPING = 0.75
"""ArduPilot's default of NAVL1_DAMPING [-]."""
INTEGRATOR_GAIN = 0.02
"""ArduPilot's default of NAVL1_XTRACK_I [1/s]."""

_ONE_OVER_PI = 0.3183099
"""1/pi, as ArduPilot has it."""
_RIGHT_ANGLE = 1.5708
"""A right angle, as ArduPilot has it [rad]."""
_SPEED_MIN = 0.1
"""Ground speed below which the heading counts as course [m/s]."""
_PAUSE = 1.0
"""Time since the last call after which the integrator starts anew [s]."""
_STEP_MAX = 0.1
"""Longest time that the integrator integrates over in a call [s]."""
_INTEGRATE_WITHIN = math.radians(5.0)
"""Capture angle within which the integrator runs [rad]."""
_INTEGRAL_MAX = 0.1
"""Limit of the integrator [rad]."""
_CAPTURE_MAX = 0.7071
"""Largest sine of the capture angle. The vehicle is behind the start of the line if the cosine of
the angle from the line to it is below the negative of this [-].
"""
_OVERRUN = 3.0
"""Flight time beyond the end of the line after which it turns back to the end [s]."""
_CENTRE = 0.1
"""Distance within which a centre has no bearing [m], and speed below which there is no course
[m/s].
"""


# ---------------------------------------------------------------- Towards a waypoint


@dataclass(frozen=True, slots=True)
class L1State:
    """The memory of the law from one call to the next.

    Attributes
    ----------
    integral : of the capture angle [rad]
    gain : gain of the integrator at the last call; NaN before the first call [1/s]
    last_angle : from the course to the demanded direction, at the last call [rad]
    """

    integral: float = 0.0
    gain: float = math.nan
    last_angle: float = 0.0


FRESH = L1State()
"""The state before the first call."""


def update_waypoint(
    position: Vector,
    velocity: Vector,
    yaw: float,
    start: Vector,
    end: Vector,
    *,
    time_step: float,
    state: L1State = FRESH,
    period: float = PERIOD,
    damping: float = DAMPING,
    integrator_gain: float = INTEGRATOR_GAIN,
) -> tuple[float, L1State]:
    """Return the lateral acceleration, positive to the right [m/s2], and the next state.

    Parameters
    ----------
    position, velocity : of the vehicle over the ground [m, m/s]
    yaw : heading [rad]
    start, end : of the line [m]; if they are the same, the line leads from the vehicle to it
    time_step : since the last call [s]
    state : from the last call
    period, damping : of the loop [s, -]
    integrator_gain : 0 for no integrator [1/s]
    """
    velocity = _course_velocity(velocity, yaw)
    speed = norm(velocity)
    distance = _ONE_OVER_PI * damping * period * speed
    line = minus(end, start)
    direction = _unit(line) or _unit(minus(end, position)) or along(yaw)
    from_start = minus(position, start)
    across = cross(from_start, direction)
    done = dot(from_start, direction)
    range_from_start = norm(from_start)
    integral = 0.0 if time_step > _PAUSE else state.integral
    gain = state.gain
    if range_from_start > distance and done / max(range_from_start, 1.0) < -_CAPTURE_MAX:
        angle = _angle_to(_unit(minus(start, position)) or direction, velocity)
    elif done > norm(line) + _OVERRUN * speed:
        angle = _angle_to(_unit(minus(end, position)) or direction, velocity)
    else:
        capture = math.asin(clip(across / max(distance, 0.1), -_CAPTURE_MAX, _CAPTURE_MAX))
        if integrator_gain <= 0.0 or integrator_gain != gain:
            integral = 0.0
        elif abs(capture) < _INTEGRATE_WITHIN:
            integral += capture * integrator_gain * min(time_step, _STEP_MAX)
            integral = clip(integral, -_INTEGRAL_MAX, _INTEGRAL_MAX)
        gain = integrator_gain
        angle = capture + integral + _angle_to(direction, velocity)
    angle = decided(angle, state.last_angle, bearing=course_of(minus(end, position)), yaw=yaw)
    acceleration = _towards(angle, speed, distance, damping)
    return acceleration, L1State(integral, gain, angle)


def _towards(angle: float, speed: float, distance: float, damping: float) -> float:
    """Return the lateral acceleration to a direction ``angle`` [rad] off the course [m/s2]."""
    sine = math.sin(clip(angle, -_RIGHT_ANGLE, _RIGHT_ANGLE))
    return 4.0 * damping**2 * speed * speed / distance * sine


def _course_velocity(velocity: Vector, yaw: float) -> Vector:
    """Return the velocity [m/s], or a slow one along the heading if the vehicle flies backwards."""
    if norm(velocity) < _SPEED_MIN or abs(wrap(course_of(velocity) - yaw)) >= 0.5 * math.pi:
        return scaled(along(yaw), _SPEED_MIN)
    return velocity


def _unit(vector: Vector) -> Vector | None:
    length = norm(vector)
    return scaled(vector, 1.0 / length) if length > 0.0 else None


def _angle_to(direction: Vector, velocity: Vector) -> float:
    """Return the angle from the velocity to a direction, positive to the right [rad]."""
    return math.atan2(cross(velocity, direction), dot(velocity, direction))


def decided(angle: float, last: float, *, bearing: float, yaw: float) -> float:
    """Return the angle to turn by [rad].

    If the target is behind the vehicle and the angle has changed its sign, this is the last angle.

    Parameters
    ----------
    angle, last : now, and at the last call [rad]
    bearing : of the target [rad]
    yaw : heading [rad]
    """
    behind = (
        abs(angle) > 0.9 * math.pi
        and abs(last) > 0.9 * math.pi
        and abs(wrap(bearing - yaw)) > math.radians(120.0)
    )
    return last if behind and angle * last < 0.0 else angle


@dataclass(frozen=True, slots=True, kw_only=True)
class ArduPilotL1Law(PathLaw):
    """Base of the laws by ArduPilot's L1 towards a waypoint; they differ in the line.

    Attributes
    ----------
    l1_period_s : period of the loop, ArduPilot's NAVL1_PERIOD [s]
    l1_damping : damping of the loop, ArduPilot's NAVL1_DAMPING [-]
    l1_integrator_per_s : gain of the cross-track integrator, ArduPilot's NAVL1_XTRACK_I [1/s]
    """

    l1_period_s: float = PERIOD
    l1_damping: float = DAMPING
    l1_integrator_per_s: float = INTEGRATOR_GAIN

    def line(self, motion: PathMotion) -> tuple[Vector, Vector]:
        """Return start and end of the line to follow, from the path's point [m]."""
        raise NotImplementedError

    def step(self, motion: PathMotion, time_step: float, state: L1State) -> tuple[float, L1State]:
        """Return the demanded heading rate [rad/s], and the next state; time step in s."""
        acceleration, state = update_waypoint(
            motion.position,
            motion.velocity,
            motion.heading,
            *self.line(motion),
            time_step=time_step,
            state=state,
            period=self.l1_period_s,
            damping=self.l1_damping,
            integrator_gain=self.l1_integrator_per_s,
        )
        return turn_rate(acceleration, motion.airspeed), state

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate of a first call [rad/s]."""
        return self.step(motion, 0.0, FRESH)[0]

    def start(self, time_step: float) -> "_L1Flight":
        """Return the law of one flight, with its integrator, called every ``time_step`` [s]."""
        return _L1Flight(self, time_step)


class _L1Flight:
    def __init__(self, law: ArduPilotL1Law, time_step: float) -> None:
        self._law = law
        self._time_step = time_step
        self._state = FRESH

    def heading_rate(self, reference: Reference, own: Motion, air: Air, /) -> float:
        motion = path_motion(reference, own, air)
        rate, self._state = self._law.step(motion, self._time_step, self._state)
        return rate


@dataclass(frozen=True, slots=True, kw_only=True)
class ArduPilotL1TangentLaw(ArduPilotL1Law):
    """ArduPilot's L1 on the reference's tangent (M1); attributes of ``ArduPilotL1Law``."""

    inputs: ClassVar[str] = "tangent of the path over the ground (M1); velocity over the ground"

    def line(self, motion: PathMotion) -> tuple[Vector, Vector]:
        """Return a line from 500 m behind the reference to 5 km ahead of it [m]."""
        return scaled(motion.tangent, -500.0), scaled(motion.tangent, 5000.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ArduPilotL1PointLaw(ArduPilotL1Law):
    """ArduPilot's L1 with the reference itself as waypoint (M3).

    Attributes are those of ``ArduPilotL1Law``.
    """

    inputs: ClassVar[str] = "the reference's place as waypoint (M3); velocity over the ground"
    unsupported_tasks: ClassVar[dict[str, str]] = ONLY_MOVING_POINTS

    def line(self, motion: PathMotion) -> tuple[Vector, Vector]:  # noqa: ARG002 - of the base
        """Return the reference as start and end of the line [m]."""
        return (0.0, 0.0), (0.0, 0.0)


# ---------------------------------------------------------------- On a circle


def update_loiter(
    position: Vector,
    velocity: Vector,
    yaw: float,
    centre: Vector,
    radius: float,
    side: int,
    *,
    period: float = PERIOD,
    damping: float = DAMPING,
) -> float:
    """Return the lateral acceleration of the loiter, positive to the right [m/s2].

    ArduPilot's rule for a centre exactly behind the vehicle is left out, because the law would need
    a memory for this rule alone.

    Parameters
    ----------
    position, velocity : of the vehicle over the ground [m, m/s]
    yaw : heading [rad]
    centre, radius : of the circle [m]
    side : +1 clockwise, -1 anticlockwise
    period, damping : of the loop [s, -]
    """
    frequency = 2.0 * math.pi / period
    speed = max(norm(velocity), 1.0)
    distance = _ONE_OVER_PI * damping * period * speed
    from_centre = minus(position, centre)
    range_ = norm(from_centre)
    if range_ > _CENTRE:
        outward = scaled(from_centre, 1.0 / range_)
    elif norm(velocity) > _CENTRE:
        outward = scaled(velocity, 1.0 / norm(velocity))
    else:
        outward = along(yaw)
    across = cross(outward, velocity)
    inbound = -dot(velocity, outward)
    capture = _towards(math.atan2(across, inbound), speed, distance, damping)
    outside = range_ - radius
    around = across * side
    correction = outside * frequency * frequency - inbound * 2.0 * damping * frequency
    if inbound < 0.0 and around < 0.0:
        correction = max(correction, 0.0)
    circle = side * (correction + around * around / max(0.5 * radius, radius + outside))
    if outside > 0.0 and side * capture < side * circle:
        return capture
    return circle


@dataclass(frozen=True, slots=True, kw_only=True)
class ArduPilotLoiterLaw(PathLaw):
    """ArduPilot's loiter about a moving centre, by the velocity over the ground, as in ArduPilot.

    Attributes
    ----------
    loiter_period_s : period of the loop, ArduPilot's NAVL1_PERIOD [s]
    loiter_damping : damping of the loop, ArduPilot's NAVL1_DAMPING [-]
    """

    inputs: ClassVar[str] = "the circle, with the velocity over the ground, as ArduPilot has it"
    unsupported_tasks: ClassVar[dict[str, str]] = ONLY_CIRCLES
    loiter_period_s: float = PERIOD
    loiter_damping: float = DAMPING

    def velocity(self, motion: PathMotion) -> Vector:
        """Return the velocity over the ground [m/s]."""
        return plus(motion.velocity, motion.frame)

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""
        acceleration = update_loiter(
            motion.position,
            self.velocity(motion),
            motion.heading,
            *motion.circle,
            period=self.loiter_period_s,
            damping=self.loiter_damping,
        )
        return turn_rate(acceleration, motion.airspeed)


@dataclass(frozen=True, slots=True, kw_only=True)
class ArduPilotRelativeLoiterLaw(ArduPilotLoiterLaw):
    """ArduPilot's loiter with the velocity relative to the centre (M2).

    This is an improvement by this project, not ArduPilot's. Attributes are those of
    ``ArduPilotLoiterLaw``.
    """

    inputs: ClassVar[str] = (
        "the circle in the frame of its centre (M2), which ArduPilot does not do"
    )

    def velocity(self, motion: PathMotion) -> Vector:
        """Return the velocity relative to the centre [m/s]."""
        return motion.velocity
