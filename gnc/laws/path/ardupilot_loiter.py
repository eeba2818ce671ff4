"""ArduPilot's L1 control on a loiter circle: a capture angle from outside, proportional and
derivative control on the circle.

Written from a description of the law, not from ArduPilot's code, whose licence is another.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from gnc.laws.path.adapter import PathLaw, PathMotion, turn_rate
from gnc.laws.path.ardupilot_l1 import ONE_OVER_PI
from gnc.laws.steering_law import CIRCLES_ALONE, ON_OSCILLATION, steering_law
from gnc.numeric import clip
from gnc.vectors import Vector, along, cross, dot, minus, norm, plus, scaled

_QUARTER = 1.5708
_CENTRE = 0.1
"""Distance from the centre within which it has no bearing [m]."""


@dataclass(frozen=True, slots=True)
class LoiterParameters:
    """Parameters of the loiter, with ArduPilot's defaults; the integrator is not used here.

    Attributes
    ----------
    period : NAVL1_PERIOD [s]
    damping : NAVL1_DAMPING [-]
    """

    period: float = 17.0
    damping: float = 0.75


@dataclass(frozen=True, slots=True)
class Loiter:
    """What the loiter asks for.

    Attributes
    ----------
    lateral_acceleration : positive to the right [m/s2]
    circling : whether it is on the circle, not capturing it
    """

    lateral_acceleration: float
    circling: bool


def update_loiter(
    position: Vector,
    velocity: Vector,
    yaw: float,
    centre: Vector,
    radius: float,
    side: int,
    *,
    parameters: LoiterParameters | None = None,
) -> Loiter:
    """Return what the loiter asks for. A pure function.

    Parameters
    ----------
    position, velocity : of the vehicle over the ground, north and east [m, m/s]
    yaw : heading [rad]
    centre, radius : of the circle [m]
    side : +1 clockwise, -1 anticlockwise
    parameters : of the law, ArduPilot's defaults if not given
    """
    p = parameters or LoiterParameters()
    rate = 2.0 * math.pi / p.period
    speed = max(norm(velocity), 1.0)
    distance = ONE_OVER_PI * p.damping * p.period * speed
    from_centre = minus(position, centre)
    range_ = norm(from_centre)
    if range_ > _CENTRE:
        outward = scaled(from_centre, 1.0 / range_)
    elif norm(velocity) > _CENTRE:
        outward = scaled(velocity, 1.0 / norm(velocity))
    else:
        outward = along(yaw)
    across, inbound = cross(outward, velocity), -dot(velocity, outward)
    angle = math.atan2(across, inbound)
    capture = (
        4.0 * p.damping**2 * speed * speed / distance * math.sin(clip(angle, -_QUARTER, _QUARTER))
    )
    outside, around = range_ - radius, across * side
    correction = outside * rate * rate - inbound * 2.0 * p.damping * rate
    if inbound < 0.0 and around < 0.0:
        correction = max(correction, 0.0)
    circle = side * (correction + around * around / max(0.5 * radius, radius + outside))
    if outside > 0.0 and side * capture < side * circle:
        return Loiter(capture, circling=False)
    return Loiter(circle, circling=True)


@steering_law("ardupilot_loiter")
@dataclass(frozen=True, slots=True, kw_only=True)
class ArduPilotLoiterLaw(PathLaw):
    """ArduPilot's loiter about a moving centre as ArduPilot flies it: with the velocity over the
    ground.

    The indecision of the law is left out: it matters where the centre lies exactly behind, and a
    memory of it would be all the state that the law has.

    Attributes
    ----------
    loiter_period_s : period of the loop, ArduPilot's NAVL1_PERIOD [s]
    loiter_damping : damping of the loop, ArduPilot's NAVL1_DAMPING [-]
    """

    given: ClassVar[str] = "the circle, with the velocity over the ground, as ArduPilot has it"
    cannot: ClassVar[dict[str, str]] = {ON_OSCILLATION: CIRCLES_ALONE}
    loiter_period_s: float = 17.0
    loiter_damping: float = 0.75

    def velocity(self, motion: PathMotion) -> Vector:
        """Return the velocity that the law is given [m/s]."""
        return plus(motion.velocity, motion.frame)

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""
        parameters = LoiterParameters(self.loiter_period_s, self.loiter_damping)
        asked = update_loiter(
            motion.position,
            self.velocity(motion),
            motion.heading,
            *motion.circle,
            parameters=parameters,
        )
        return turn_rate(asked.lateral_acceleration, motion.airspeed)


@steering_law("ardupilot_loiter_relative")
@dataclass(frozen=True, slots=True, kw_only=True)
class ArduPilotRelativeLoiterLaw(ArduPilotLoiterLaw):
    """ArduPilot's loiter with the velocity relative to the centre (M2): an improvement of this
    project, not ArduPilot's.

    Attributes are those of ``ArduPilotLoiterLaw``.
    """

    given: ClassVar[str] = "the circle in the frame of its centre (M2), which ArduPilot does not do"

    def velocity(self, motion: PathMotion) -> Vector:
        """Return the velocity that the law is given [m/s]."""
        return motion.velocity
