"""NPFG, the fixed-wing path following of PX4.

Its look-ahead depends on the track error. It weights its commands by how feasible a bearing is in
the wind, and it adapts its period.

Source: T. Stastny, R. Siegwart, "On Flying Backwards: Preventing Run-away of Small, Low-speed,
Fixed-wing UAVs in Strong Winds", IROS 2019, and the law as PX4 flies it, release 1.15
(BSD-3-Clause). Written from equations, not from code. Unlike PX4 it does not raise the airspeed to
keep a ground speed or to come back to the track: a steering law does not command the airspeed.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from extensions.arena.laws.path import PathLaw, PathMotion, turn_rate
from gnc.numeric import clip
from gnc.vectors import Vector, course_of, cross, dot, minus, norm, plus, right_of, scaled

_EPSILON = 1e-6
_RADIUS_MIN = 0.5
"""Smallest turn radius that the feed-forward is formed for [m]."""
_AIRSPEED_BUFFER = 1.5
"""Airspeed beyond the least one for a bearing at which the bearing is wholly feasible [m/s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NpfgParameters:
    """Parameters; defaults are those of PX4.

    Attributes
    ----------
    period : T_0 [s]
    damping : zeta [-]
    roll_time_constant : T_phi; 0 for no bounds on the period [s]
    safety_factor : on the lower bound [-]
    airspeed : nominal [m/s]
    """

    period: float = 10.0
    damping: float = 0.7
    roll_time_constant: float = 0.5
    safety_factor: float = 1.5
    airspeed: float = 15.0


PX4_DEFAULTS = NpfgParameters()
"""PX4's defaults."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NpfgCommand:
    """What NPFG commands.

    Attributes
    ----------
    lateral_acceleration : positive to the right [m/s2]
    feed_forward : its part for the path's curvature, before it fades with the track error [m/s2]
    heading : demanded heading [rad]
    bearing : demanded ground course [rad]
    period : adapted period [s]
    error_bound : track error beyond which the bearing points straight at the path [m]
    """

    lateral_acceleration: float
    feed_forward: float
    heading: float
    bearing: float
    period: float
    error_bound: float


def npfg(
    position: Vector,
    velocity: Vector,
    wind: Vector,
    tangent: Vector,
    curvature: float,
    parameters: NpfgParameters = PX4_DEFAULTS,
) -> NpfgCommand:
    """Return NPFG's command.

    Parameters
    ----------
    position, velocity : of the vehicle, from the nearest point of the path [m], and over the ground
        [m/s]
    wind : velocity of the air [m/s]
    tangent : unit vector along the path at that point
    curvature : of the path there, positive to the right [1/m]
    parameters : of the law
    """
    p = parameters
    air_velocity = minus(velocity, wind)
    airspeed = norm(air_velocity)
    ground_speed = norm(velocity)
    wind_speed = norm(wind)
    error = cross(tangent, position)
    track_feasible = bearing_feasibility(tangent, wind, airspeed)
    period = _adapted_period(
        p, abs(error), ground_speed, airspeed, wind_speed, curvature, track_feasible
    )
    gain = 4.0 * math.pi * p.damping / period
    bound = track_error_bound(ground_speed, p.damping * period)
    off = clip(abs(error) / bound, 0.0, 1.0)
    look_ahead = 0.5 * math.pi * (1.0 - off) ** 2
    proximity = math.sin(look_ahead) ** 2
    towards = scaled(right_of(tangent), -math.copysign(1.0, error) if error != 0.0 else -1.0)
    bearing = plus(scaled(towards, math.cos(look_ahead)), tangent, math.sin(look_ahead))
    feasible = bearing_feasibility(bearing, wind, airspeed) * track_feasible
    reference = _air_velocity_reference(bearing, wind, wind_speed, p.airspeed)
    feedback = _feedback(gain, air_velocity, airspeed, reference)
    feed_forward = _feed_forward(tangent, velocity, wind, airspeed, error, curvature)
    acceleration = feedback + feasible * proximity * feed_forward
    return NpfgCommand(
        lateral_acceleration=acceleration,
        feed_forward=feed_forward,
        heading=course_of(reference),
        bearing=course_of(bearing),
        period=period,
        error_bound=bound,
    )


def bearing_feasibility(bearing: Vector, wind: Vector, airspeed: float) -> float:
    """Return how feasible a ground course is in this wind, from 0 to 1.

    Parameters
    ----------
    bearing : unit vector of the course
    wind : [m/s]
    airspeed : [m/s]
    """
    across = norm(wind) if dot(wind, bearing) < 0.0 else abs(cross(wind, bearing))
    return math.sin(0.5 * math.pi * clip((airspeed - across) / _AIRSPEED_BUFFER, 0.0, 1.0)) ** 2


def track_error_bound(ground_speed: float, time_constant: float) -> float:
    """Return the track error beyond which the vehicle heads straight for the path [m]."""
    if ground_speed > 1.0:
        return ground_speed * time_constant
    return 0.5 * time_constant * (ground_speed * ground_speed + 1.0)


def _adapted_period(
    p: NpfgParameters,
    error: float,
    ground_speed: float,
    airspeed: float,
    wind_speed: float,
    curvature: float,
    feasible: float,
) -> float:
    """Return the period [s], within what the roll dynamics and the path's curvature allow."""
    if p.roll_time_constant <= _EPSILON:
        return p.period
    turn_rate = abs(curvature * airspeed)
    if wind_speed > airspeed or airspeed < _EPSILON:
        wind_factor = 2.0
    else:
        wind_factor = 2.0 * (1.0 - math.sqrt(1.0 - min(1.0, wind_speed / airspeed)))
    straight = math.pi * p.roll_time_constant / p.damping
    lowest = straight
    if turn_rate * wind_factor >= _EPSILON and p.damping >= 0.5:
        lowest = (
            4.0 * math.pi * p.roll_time_constant * p.damping * feasible
            + (1.0 - feasible) * straight
        )
    lowest *= p.safety_factor
    straight *= p.safety_factor
    off = clip(error / track_error_bound(ground_speed, straight * p.damping), 0.0, 1.0)
    proximity = math.sin(0.5 * math.pi * (off - 1.0) ** 2) ** 2
    lowest = proximity * lowest + (1.0 - proximity) * straight
    period = max(lowest, p.period)
    demand = turn_rate * wind_factor * feasible
    if turn_rate * wind_factor > _EPSILON and demand > 0.0:
        highest = 4.0 * math.pi * p.damping / demand
        if math.isfinite(highest) and period > highest:
            period = proximity * max(lowest, highest) + (1.0 - proximity) * period
    return period


def _air_velocity_reference(
    bearing: Vector, wind: Vector, wind_speed: float, airspeed: float
) -> Vector:
    """Return the air velocity that comes nearest to the bearing over the ground [m/s]."""
    across = cross(wind, bearing)
    along = dot(wind, bearing)
    if abs(across) < airspeed and (along > 0.0 or wind_speed < airspeed):
        return plus(
            scaled(bearing, math.sqrt(max(airspeed * airspeed - across * across, 0.0))),
            right_of(bearing),
            across,
        )
    # No heading gives that bearing: head against the wind, turned towards the bearing.
    drift = minus(
        scaled(bearing, math.sqrt(max(wind_speed * wind_speed - airspeed * airspeed, 0.0))), wind
    )
    length = norm(drift)
    return scaled(drift, airspeed / length) if length > 0.0 else scaled(bearing, airspeed)


def _feedback(gain: float, air_velocity: Vector, airspeed: float, reference: Vector) -> float:
    """Return the lateral acceleration that turns the air velocity to its reference [m/s2]."""
    turn = cross(air_velocity, reference)
    length = norm(reference)
    if dot(air_velocity, reference) < 0.0:
        return gain * airspeed * (-1.0 if turn < 0.0 else 1.0)
    return gain * turn / length if length > 0.0 else 0.0


def _feed_forward(
    tangent: Vector, velocity: Vector, wind: Vector, airspeed: float, error: float, curvature: float
) -> float:
    """Return the lateral acceleration of a curve at the vehicle's distance from the path [m/s2]."""
    curvature_here = 0.0
    if curvature != 0.0:
        curvature_here = curvature / max(1.0 - curvature * error, abs(curvature) * _RADIUS_MIN)
    path_rate = curvature_here * max(dot(velocity, tangent), 0.0)
    crosswind = cross(wind, tangent)
    along = math.sqrt(max(airspeed * airspeed - crosswind * crosswind, 0.0))
    return airspeed * (1.0 + dot(wind, tangent) / max(along, _EPSILON)) * path_rate


@dataclass(frozen=True, slots=True, kw_only=True)
class NpfgLaw(PathLaw):
    """NPFG on the reference's tangent (M1), or on a circle in the frame of its centre (M2).

    Attributes
    ----------
    npfg_period_s : period T_0 of the loop [s]
    npfg_damping : damping zeta of the loop [-]
    npfg_roll_time_constant_s : time constant T_phi of the roll angle [s]
    """

    inputs: ClassVar[str] = (
        "tangent and curvature over the ground (M1), a circle in its centre's frame (M2); wind"
    )
    npfg_period_s: float = 10.0
    npfg_damping: float = 0.7
    npfg_roll_time_constant_s: float = 0.5

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""
        parameters = NpfgParameters(
            period=self.npfg_period_s,
            damping=self.npfg_damping,
            roll_time_constant=self.npfg_roll_time_constant_s,
            airspeed=motion.airspeed,
        )
        command = npfg(
            motion.position,
            motion.velocity,
            motion.wind,
            motion.tangent,
            motion.curvature,
            parameters,
        )
        return turn_rate(command.lateral_acceleration, motion.airspeed)
