"""How far the flight at a point leaves what its scenario declares."""

from collections.abc import Sequence

from gnc.errors import InfeasibleError
from scenarios.errors import InputError
from scenarios.experiment.draws import speed_ratios, values_at
from scenarios.scenario.files import with_values
from scenarios.scenario.scenario import Scenario
from scenarios.world.vessel import SteadyVessel, check_manoeuvres, largest_acceleration
from scenarios.world.world import vessel_of


def beyond_declared(scenario: Scenario, point: Sequence[float]) -> float:
    """Return how far a flight leaves the declared speed ratios and the declared acceleration of the
    vessel [-].

    The acceleration counts relative to ``following.vessel_acceleration_mps2``, changes of speed and
    of course together, where that is not 0. A flight whose values contradict each other, such as
    manoeuvres that overlap, counts as 1.

    Parameters
    ----------
    scenario : a trial
    point : position of each random variable in its distribution, from 0 to 1
    """
    try:
        flight = with_values(scenario, values_at(scenario.draws, point))
        check_manoeuvres(flight.vessel, flight.vessel_speed)
    except (InputError, InfeasibleError):
        return 1.0
    (low, high), (least, most) = flight.speed_ratio, speed_ratios(flight)
    return max(0.0, low - least, most - high, _acceleration_excess(flight))


def _acceleration_excess(flight: Scenario) -> float:
    declared = flight.following.vessel_acceleration_mps2
    vessel = vessel_of(flight)
    if declared == 0.0 or isinstance(vessel, SteadyVessel):
        return 0.0
    return max(0.0, largest_acceleration(vessel, flight.flight.duration_max_s) / declared - 1.0)
