"""From a scenario to one flight: everything it needs, resolved to SI, and the reason where it
cannot be flown.
"""

from scenarios.planning.flight_plan import FlightPlan
from scenarios.planning.following_flight import Spreads, following_flight
from scenarios.planning.limits import check_recorded
from scenarios.planning.tracking_flight import circling_flight, tracking_flight
from scenarios.scenario.scenario import Scenario
from scenarios.vehicles.vehicle_setup import VehicleSetup
from scenarios.world.noise import Noise
from scenarios.world.vessel import check_manoeuvres


def plan_flight(
    scenario: Scenario,
    *,
    flight_id: str,
    seed: int | Noise,
    setup: VehicleSetup,
    spreads: Spreads = lambda _: None,
) -> FlightPlan:
    """Resolve one flight.

    Parameters
    ----------
    scenario, flight_id : the flight
    seed : of its start, air and noise, or these as a blend
    setup : of its vehicle
    spreads : of the tracking error

    Raises
    ------
    InfeasibleError : the flight has no solution, or starts where no command keeps it out of the
        keep-out area, or manoeuvres of its vessel overlap, or it turns too fast for the rate at
        which it is recorded
    """
    check_recorded(scenario)
    check_manoeuvres(scenario.vessel, scenario.vessel_speed)
    noise = seed if isinstance(seed, Noise) else Noise(seed)
    if scenario.circles:
        return circling_flight(scenario, flight_id, noise, setup)
    if scenario.follows:
        return following_flight(scenario, flight_id, noise, setup, spreads(scenario))
    return tracking_flight(scenario, flight_id, noise, setup)
