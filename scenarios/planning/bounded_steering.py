"""The look-ahead and the steering of a flight: given, or searched so that no state asks for more
than omega_max.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

from gnc.analysis.bounds import BoundedSteering, fastest_within, heading_rate_bound
from gnc.errors import InfeasibleError
from gnc.laws import STEERING_LAWS
from gnc.paper import LookAhead, look_ahead
from gnc.steering import SteeringLaw
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.guidance import GuidanceConfig


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


def steering_law(guidance: GuidanceConfig, **searched: float) -> SteeringLaw:
    """Return the steering law of a scenario, its parameters as given or, where they were searched,
    as found.
    """
    given = guidance.model_extra or {}
    law: Any = STEERING_LAWS.get(guidance.law)
    values = {
        name: searched.get(name, getattr(guidance, name, given.get(name, default)))
        for name, default in guidance.law_keys.items()
    }
    try:
        made: SteeringLaw = law(**values)
    except ValueError as error:
        raise InfeasibleError(f"guidance of law '{guidance.law}': {error}") from None
    return made


def given_steering(guidance: GuidanceConfig) -> Steering:
    """Return the steering that a scenario gives, without a bound."""
    parameters = look_ahead(guidance.epsilon_per_m, guidance.look_ahead_m)
    return Steering(look_ahead=parameters, steering_max=guidance.steering_max_rad_s, bound=math.inf)


def plan_steering(
    scenario: Scenario, heading_rate_max: float, reference_heading_rate: float
) -> Steering:
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
        found = search_steering(scenario, heading_rate_max, reference_heading_rate)
        return Steering(
            look_ahead=found.look_ahead, steering_max=found.steering_max, bound=found.bound
        )
    given = given_steering(g)
    if g.law != "cascade":
        return given
    bound = heading_rate_bound(
        given.look_ahead,
        speed=speed,
        reference_heading_rate_max=reference_heading_rate,
        steering_max=g.steering_max_rad_s,
    )
    return replace(given, bound=bound)


def search_steering(
    scenario: Scenario, heading_rate_max: float, reference_heading_rate: float
) -> BoundedSteering:
    """Return the steering that converges fastest from the farthest start, while no state asks for
    more than omega_max.

    Parameters and errors are those of ``plan_steering``.
    """
    try:
        return fastest_within(
            speed=largest_speed(scenario),
            heading_rate_max=heading_rate_max,
            reference_heading_rate_max=reference_heading_rate,
            distance_from=farthest_start(scenario),
            distance_to=scenario.flight.settling_band_m,
            gain=scenario.guidance.gain_per_s,
        )
    except InfeasibleError as error:
        raise InfeasibleError(
            f"guidance.tuning is 'bounded' with guidance.reserve {scenario.guidance.reserve:g}: {error} (guidance.reserve)"
        ) from None


def largest_speed(scenario: Scenario) -> float:
    """Return the largest speed of vehicle and reference [m/s] for which the bound holds.

    It is the largest that is commanded, and a margin where an aircraft has to follow the command.
    """
    g = scenario.guidance
    margin = g.bound_speed_margin_mps if scenario.fidelity == "six_dof" else 0.0
    return g.airspeed_mps + (g.airspeed_trim_max_mps if g.airspeed_trim else 0.0) + margin


def farthest_start(scenario: Scenario) -> float:
    """Return about how far from the reference a flight may start [m]: as far as from the vessel."""
    start = scenario.start
    if start.place_m is not None:
        distance = math.hypot(*start.place_m)
    elif start.range_m is not None:
        distance = start.range_m
    else:
        distance = start.distance_m[1]
    return max(distance, 10.0 * scenario.flight.settling_band_m)
