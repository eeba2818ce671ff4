"""An equilibrium of an aircraft in flight, and how the search for it ended."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from aircraft.simulation.state import RigidBodyState, body_velocity, level


class TrimOutcome(Enum):
    """How a search for equilibrium ended."""

    CONVERGED = "converged"
    LIMITED = "held by a limit"
    NOT_CONVERGED = "not converged"


@dataclass(frozen=True, slots=True, kw_only=True)
class Trim:
    """An equilibrium.

    Attributes
    ----------
    airspeed : true airspeed [m/s]
    altitude : [m]
    climb_angle : [rad]
    alpha, beta : angle of attack and sideslip [rad]
    roll, pitch : [rad]
    rates_body : p, q, r [rad/s]
    yaw_rate : rate of yaw, which in a steady turn is the heading rate [rad/s]
    inputs : control inputs by name [-]
    driven : driven states by name [SI]
    outcome : whether it is an equilibrium
    residuals : remaining accelerations, forward, right, down, p, q, r [m/s^2, rad/s^2]
    limits : control inputs and angles that are at their limit, each in words
    """

    airspeed: float
    altitude: float
    climb_angle: float
    alpha: float
    beta: float
    roll: float
    pitch: float
    rates_body: tuple[float, float, float]
    yaw_rate: float
    inputs: Mapping[str, float]
    driven: Mapping[str, float]
    outcome: TrimOutcome
    residuals: tuple[float, ...]
    limits: tuple[str, ...]

    @property
    def residual(self) -> float:
        """Return the largest remaining acceleration [m/s^2, rad/s^2]."""
        return max(abs(value) for value in self.residuals)

    def state(
        self, latitude: float = 0.0, longitude: float = 0.0, yaw: float = 0.0
    ) -> RigidBodyState:
        """Return the rigid-body state of this equilibrium at a place [rad] and yaw [rad]."""
        return RigidBodyState(
            latitude=latitude,
            longitude=longitude,
            altitude=self.altitude,
            roll=self.roll,
            pitch=self.pitch,
            yaw=yaw,
            velocity_body=body_velocity(self.airspeed, self.alpha, self.beta),
            rates_body=self.rates_body,
        )

    def course_offset(self) -> float:
        """Return course minus yaw [rad]."""
        ahead, right, _ = level(
            body_velocity(self.airspeed, self.alpha, self.beta), self.roll, self.pitch
        )
        return math.atan2(right, ahead)
