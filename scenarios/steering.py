"""The look-ahead and the steering of a flight: given, or searched so that no state asks for more than omega_max."""

import math
from dataclasses import dataclass

from gnc.bounds import fastest_within, heading_rate_bound
from gnc.delta import LookAhead, look_ahead
from scenarios.config import Scenario


@dataclass(frozen=True, slots=True, kw_only=True)
class Steering:
    """Parameters of the cascade law, eq. (30).

    Attributes
    ----------
    look_ahead : epsilon [1/m] and R [m]
    steering_max : largest |h(phi)| [rad/s]
    bound : on what the law asks for in any state [rad/s]; infinite for a law that has none
    """

    look_ahead: LookAhead
    steering_max: float
    bound: float


def plan_steering(scenario: Scenario, heading_rate_max: float, reference_heading_rate: float) -> Steering:
    """Return the steering of a flight.

    Parameters
    ----------
    scenario : its parameters
    heading_rate_max : omega_max [rad/s]
    reference_heading_rate : largest |omega_r| of the reference [rad/s]

    Raises
    ------
    InfeasibleError : parameters that cannot work, or none that respect omega_max
    """
    g, speed = scenario.guidance, largest_speed(scenario)
    if g.tuning == "bounded":
        found = fastest_within(
            speed=speed,
            heading_rate_max=heading_rate_max,
            reference_heading_rate_max=reference_heading_rate,
            distance_from=math.hypot(*scenario.start.place_m) if scenario.start.place_m else scenario.start.distance_m[1],
            distance_to=scenario.flight.settling_band_m,
            gain=g.gain_per_s,
        )
        return Steering(look_ahead=found.look_ahead, steering_max=found.steering_max, bound=_bound(g.law, found.bound))
    parameters = look_ahead(g.epsilon_per_m, g.look_ahead_m)
    bound = heading_rate_bound(
        parameters,
        speed=speed,
        reference_heading_rate_max=reference_heading_rate,
        steering_max=g.steering_max_rad_s,
    )
    return Steering(look_ahead=parameters, steering_max=g.steering_max_rad_s, bound=_bound(g.law, bound))


def largest_speed(scenario: Scenario) -> float:
    """Return the largest speed commanded of vehicle and reference [m/s], for which the bound holds."""
    g = scenario.guidance
    return g.airspeed_mps + (g.airspeed_trim_max_mps if g.airspeed_trim else 0.0)


def _bound(law: str, bound: float) -> float:
    return bound if law == "cascade" else math.inf
