"""The circle about the vessel that a standoff mission flies."""

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import numpy.typing as npt
from scipy.special import ellipe

from gnc.errors import InfeasibleError
from gnc.mission.axis import AxisHeight, Climb
from gnc.mission.standoff import StandoffParameters
from innerloop.flight.part_failure import glide_airspeed
from scenarios.planning.limits import omega_max, plan_interval
from scenarios.planning.plume.axis import PREDICTED_TIME
from scenarios.planning.reference import RATIO_STEPS
from scenarios.scenario.scenario import Scenario
from scenarios.vehicles.vehicle_setup import VehicleSetup

Array = npt.NDArray[np.float64]

_POINTS = 720


@dataclass(frozen=True, slots=True, kw_only=True)
class VesselCircle:
    """A circle about a vessel, flown clockwise at constant airspeed: an orbit whose centre is the
    vessel.

    Attributes
    ----------
    nu : speed of the vessel through the air over that of the vehicle [-]
    speed : V_r [m/s]
    radius : [m]
    """

    nu: float
    speed: float
    radius: float
    eta: float = math.nan
    limit: str = "standoff circle"
    symmetric: ClassVar[bool] = False

    @property
    def period(self) -> float:
        """Time of one turn about the vessel [s].

        The speed relative to the vessel is V (sqrt(1 - nu^2 sin^2) - nu cos) of the angle between
        tangent and vessel's course; the mean of its inverse over a turn is the complete elliptic
        integral E(nu^2) over pi/2 V (1 - nu^2).
        """
        return float(4.0 * self.radius * ellipe(self.nu**2) / (self.speed * (1.0 - self.nu**2)))

    def periods(self, speed_ratio_max: float) -> tuple[float, ...]:
        """Return the periods at equal steps of nu from 0 to ``speed_ratio_max`` [s]."""
        return tuple(
            replace(self, nu=nu).period
            for nu in np.linspace(0.0, speed_ratio_max, RATIO_STEPS + 1).tolist()
        )

    @property
    def crossing_interval(self) -> float:
        """Time between crossings of the plume: one a turn [s]."""
        return self.period

    @property
    def omega_0(self) -> float:
        """Mean rate of the bearing from the vessel [rad/s]."""
        return 2.0 * math.pi / self.period

    @property
    def amplitude(self) -> float:
        """Largest heading rate through the air, flown against the vessel: (1 + nu)^2 times that in
        still air [rad/s].
        """
        return (1.0 + self.nu) ** 2 * self.speed / self.radius

    def offset(self, time: npt.ArrayLike) -> tuple[Array, Array]:
        """Return where the reference is from the vessel, along its course and to its right [m],
        from right ahead on.
        """
        bearing = np.linspace(0.0, 2.0 * np.pi, _POINTS + 1)
        tangent = bearing + 0.5 * np.pi
        slowness = (
            self.radius
            / self.speed
            / (np.sqrt(1.0 - (self.nu * np.sin(tangent)) ** 2) - self.nu * np.cos(tangent))
        )
        moment = np.concatenate(
            [[0.0], np.cumsum(0.5 * (slowness[1:] + slowness[:-1]) * np.diff(bearing))]
        )
        at = np.interp(np.mod(np.asarray(time), moment[-1]), moment, bearing)
        return self.radius * np.cos(at), self.radius * np.sin(at)

    def half_widths(self) -> tuple[float, float]:
        """Return the radius, both ways [m]."""
        return self.radius, self.radius


def vessel_circle(scenario: Scenario, nu: float, least: float) -> VesselCircle:
    """Return the circle of a scenario: of the radius that it gives, or of the ``least`` that keeps
    out [m].

    Raises
    ------
    InfeasibleError : the circle is tighter than omega_max allows
    """
    circle = VesselCircle(
        nu=nu,
        speed=scenario.guidance.airspeed_mps,
        radius=scenario.reference.standoff_radius_m or least,
    )
    fastest = omega_max(scenario.guidance)
    if circle.amplitude > fastest:
        smallest = max(least, circle.radius * circle.amplitude / fastest)
        raise InfeasibleError(
            f"a circle of {circle.radius:.0f} m about a vessel at nu = {nu:.2f} takes {circle.amplitude:.3f} rad/s, above"
            f" omega_max = {fastest:.3f} rad/s: widen it to {smallest:.0f} m (reference.standoff_radius_m), or raise omega_max"
        )
    return circle


def standoff_parameters(
    scenario: Scenario, setup: VehicleSetup, radius: float, height: AxisHeight
) -> StandoffParameters:
    """Return how a vessel is circled at a radius [m], at the height of the plume's axis there."""
    g = scenario.guidance
    return StandoffParameters(
        radius=radius,
        tracked=scenario.following.tracked_m,
        speed=g.airspeed_mps,
        speed_ratio_max=scenario.following.speed_ratio_max,
        glide_airspeed=glide_airspeed(g.airspeed_mps, setup.airspeed_min),
        plan_interval=plan_interval(scenario.guidance),
        altitude=scenario.altitude,
        height=height,
        climb=Climb(time=PREDICTED_TIME, gradient=scenario.following.climb_gradient),
    )
