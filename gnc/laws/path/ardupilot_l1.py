"""ArduPilot's L1 control towards a waypoint: Park's law with period and damping set, a capture
angle and an integrator.

Written from a description of the law, not from ArduPilot's code, whose licence is another.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from gnc.laws.path.adapter import PathLaw, PathMotion, path_motion, turn_rate
from gnc.laws.steering_law import NO_CIRCLE, ON_CIRCLE, Surroundings, steering_law
from gnc.numeric import clip, wrap
from gnc.reference.reference import Reference
from gnc.vectors import Vector, along, course_of, cross, dot, minus, norm, scaled

ONE_OVER_PI = 0.3183099
"""As ArduPilot has it."""
_QUARTER = 1.5708
"""As ArduPilot has it [rad]."""
_SPEED_MIN = 0.1
"""Ground speed below which the heading counts as course [m/s]."""
_PAUSE, _STEP_MAX = 1.0, 0.1
"""Time since the last call after which the integrator begins anew, and the most that it integrates
over [s].
"""
_INTEGRATE_WITHIN, _INTEGRAL_MAX = math.radians(5.0), 0.1
"""Capture angle within which the integrator runs, and its limit [rad]."""
_CAPTURE_MAX = 0.7071
"""Largest sine of the capture angle, and of the angle that counts as behind the start [-]."""
_OVERRUN = 3.0
"""Time of flight beyond the end of the line after which it turns back to the end [s]."""


@dataclass(frozen=True, slots=True)
class L1Parameters:
    """Parameters of ArduPilot's L1, with its defaults.

    Attributes
    ----------
    period : NAVL1_PERIOD [s]
    damping : NAVL1_DAMPING [-]
    integrator_gain : NAVL1_XTRACK_I; 0 for no integrator [1/s]
    """

    period: float = 17.0
    damping: float = 0.75
    integrator_gain: float = 0.02


@dataclass(frozen=True, slots=True)
class L1State:
    """What the law remembers from one call to the next.

    Attributes
    ----------
    integral : of the capture angle [rad]
    gain : the integrator's at the last call, by which a change is noticed; not a number before the
        first call [1/s]
    last_angle : between course and demanded direction at the last call [rad]
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
    parameters: L1Parameters | None = None,
) -> tuple[float, L1State]:
    """Return the lateral acceleration, positive to the right [m/s2], and the state for the next
    call. A pure function.

    Parameters
    ----------
    position, velocity : of the vehicle over the ground, north and east [m, m/s]
    yaw : heading [rad]
    start, end : of the line [m]; with one place for both the line leads from the vehicle to it
    time_step : since the last call [s]
    state : from the last call
    parameters : of the law, ArduPilot's defaults if not given
    """
    p = parameters or L1Parameters()
    velocity = course_velocity(velocity, yaw)
    speed = norm(velocity)
    distance = ONE_OVER_PI * p.damping * p.period * speed
    line = minus(end, start)
    direction = unit(line) or unit(minus(end, position)) or along(yaw)
    from_start = minus(position, start)
    across, done = cross(from_start, direction), dot(from_start, direction)
    integral = 0.0 if time_step > _PAUSE else state.integral
    range_from_start = norm(from_start)
    if range_from_start > distance and done / max(range_from_start, 1.0) < -_CAPTURE_MAX:
        angle = _angle_to(unit(minus(start, position)) or direction, velocity)
    elif done > norm(line) + _OVERRUN * speed:
        angle = _angle_to(unit(minus(end, position)) or direction, velocity)
    else:
        capture = math.asin(clip(across / max(distance, 0.1), -_CAPTURE_MAX, _CAPTURE_MAX))
        if p.integrator_gain <= 0.0 or p.integrator_gain != state.gain:
            integral = 0.0
        elif abs(capture) < _INTEGRATE_WITHIN:
            integral += capture * p.integrator_gain * min(time_step, _STEP_MAX)
            integral = clip(integral, -_INTEGRAL_MAX, _INTEGRAL_MAX)
        state = L1State(integral, p.integrator_gain, state.last_angle)
        angle = capture + integral + _angle_to(direction, velocity)
    angle = decided(angle, state.last_angle, bearing=course_of(minus(end, position)), yaw=yaw)
    acceleration = (
        4.0 * p.damping**2 * speed * speed / distance * math.sin(clip(angle, -_QUARTER, _QUARTER))
    )
    return acceleration, L1State(integral, state.gain, angle)


def course_velocity(velocity: Vector, yaw: float) -> Vector:
    """Return the velocity over the ground; a slow one along the heading where the vehicle flies
    backwards or stands [m/s].
    """
    if norm(velocity) < _SPEED_MIN or abs(wrap(course_of(velocity) - yaw)) >= 0.5 * math.pi:
        return scaled(along(yaw), _SPEED_MIN)
    return velocity


def unit(vector: Vector) -> Vector | None:
    """Return the direction of a vector, or none of a vector without length."""
    length = norm(vector)
    return scaled(vector, 1.0 / length) if length > 0.0 else None


def decided(angle: float, last: float, *, bearing: float, yaw: float) -> float:
    """Return the angle to turn by, to the last side where the target is behind and both sides are
    as near [rad].

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


def _angle_to(direction: Vector, velocity: Vector) -> float:
    """Return by how much to turn to the right from ``velocity`` to ``direction`` [rad]."""
    return math.atan2(cross(velocity, direction), dot(velocity, direction))


_BEHIND, _AHEAD = -500.0, 5000.0
"""Where the line that stands for the reference's tangent begins and ends, from the reference [m].
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArduPilotL1Law(PathLaw):
    """Base of the laws by ArduPilot's L1 towards a waypoint.

    Attributes
    ----------
    l1_period_s : period of the loop, ArduPilot's NAVL1_PERIOD [s]
    l1_damping : damping of the loop, ArduPilot's NAVL1_DAMPING [-]
    l1_integrator_per_s : gain of the cross-track integrator, ArduPilot's NAVL1_XTRACK_I [1/s]
    """

    l1_period_s: float = 17.0
    l1_damping: float = 0.75
    l1_integrator_per_s: float = 0.02

    def line(self, motion: PathMotion) -> tuple[Vector, Vector]:
        """Return the ends of the line to follow, from the path's point [m]."""
        raise NotImplementedError

    def step(self, motion: PathMotion, time_step: float, state: L1State) -> tuple[float, L1State]:
        """Return the demanded heading rate [rad/s], and the state for the next step; the time step
        in s.
        """
        acceleration, state = update_waypoint(
            motion.position,
            motion.velocity,
            motion.heading,
            *self.line(motion),
            time_step=time_step,
            state=state,
            parameters=L1Parameters(self.l1_period_s, self.l1_damping, self.l1_integrator_per_s),
        )
        return turn_rate(acceleration, motion.airspeed), state

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s], from a fresh state."""
        return self.step(motion, 0.0, FRESH)[0]

    def begin(self, surroundings: Surroundings, time_step: float) -> "_Flight":
        """Return the law of one flight, in these surroundings, called every ``time_step`` [s]."""
        return _Flight(self, surroundings, time_step)


class _Flight:
    """The law of one flight, with its integrator."""

    __slots__ = ("_law", "_state", "_surroundings", "_time_step")

    def __init__(self, law: ArduPilotL1Law, surroundings: Surroundings, time_step: float) -> None:
        self._law, self._surroundings, self._time_step, self._state = (
            law,
            surroundings,
            time_step,
            FRESH,
        )

    def heading_rate(
        self, reference: Reference, to_north: float, to_east: float, course: float, speed: float
    ) -> float:
        motion = path_motion(reference, to_north, to_east, course, speed, self._surroundings)
        rate, self._state = self._law.step(motion, self._time_step, self._state)
        return rate


@steering_law("ardupilot_l1")
@dataclass(frozen=True, slots=True, kw_only=True)
class ArduPilotL1TangentLaw(ArduPilotL1Law):
    """ArduPilot's L1 along the reference's tangent (M1); attributes as of ``ArduPilotL1Law``."""

    given: ClassVar[str] = "tangent of the path over the ground (M1); velocity over the ground"

    def line(self, motion: PathMotion) -> tuple[Vector, Vector]:
        """Return the ends of the line to follow, from the path's point [m]."""
        return scaled(motion.tangent, _BEHIND), scaled(motion.tangent, _AHEAD)


@steering_law("ardupilot_l1_point")
@dataclass(frozen=True, slots=True, kw_only=True)
class ArduPilotL1PointLaw(ArduPilotL1Law):
    """ArduPilot's L1 with the reference itself as waypoint (M3); attributes as of
    ``ArduPilotL1Law``.
    """

    given: ClassVar[str] = "the reference's place as waypoint (M3); velocity over the ground"
    cannot: ClassVar[dict[str, str]] = {ON_CIRCLE: NO_CIRCLE}

    def line(self, motion: PathMotion) -> tuple[Vector, Vector]:  # noqa: ARG002
        """Return the ends of the line to follow, from the path's point [m]."""
        return (0.0, 0.0), (0.0, 0.0)
