"""The space of an experiment's random variables: points spread evenly over it, the space for a
search, and whether flights are a random sample of it, so that a bound follows from them.
"""

import functools
import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from gnc.errors import InfeasibleError
from scenarios.errors import InputError
from scenarios.experiment.draws import speed_ratios, values_at
from scenarios.experiment.points import without_repetitions
from scenarios.scenario.files import with_values
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.equipment import SensorsConfig
from scenarios.scenario.sections.experiment import DrawConfig
from scenarios.search.method import Coordinate, Space
from scenarios.world.vessel import SteadyVessel, check_manoeuvres, largest_acceleration
from scenarios.world.world import vessel_of

_BLOCK = 256
"""Points that are made together: a Sobol sequence is balanced over powers of two."""

_READ = ("payload.", "emission.")
"""Sections that change what is read in a flight, and its path only where that follows the readings.
"""

_DIRECTIONS = ("course_deg", "from_deg", "aspect_deg", "heading_deg")
"""Ends of the keys of directions, which are the same after a full circle [deg]; a turn is none: it
has a side.
"""


@dataclass(frozen=True, slots=True)
class SamplingDesign:
    """Points spread evenly over the unit cube of the random variables, one for each flight's
    number.

    Attributes
    ----------
    sampling : ``sobol``, scrambled; ``latin_hypercube`` of as many strata as there are flights;
        ``random`` for no points at all
    dimension : number of keys that are sampled
    flights, seed : of the study
    """

    sampling: str
    dimension: int
    flights: int
    seed: int

    def at(self, number: int) -> tuple[float, ...]:
        """Return the point of a flight, which depends only on its number and the attributes; empty
        if it has none.
        """
        if self.sampling == "random" or not self.dimension:
            return ()
        if self.sampling == "latin_hypercube":
            return tuple(_block(self, 0)[number])
        block, i = divmod(number, _BLOCK)
        return tuple(_block(self, block)[i])


@functools.lru_cache(maxsize=4)
def _block(design: SamplingDesign, block: int) -> list[list[float]]:
    """Return points that are made together: all of a Latin hypercube, ``_BLOCK`` of a sequence."""
    from scipy.stats import qmc

    points: np.ndarray
    if design.sampling == "latin_hypercube":
        points = qmc.LatinHypercube(design.dimension, rng=design.seed).random(design.flights)
    else:
        sequence = qmc.Sobol(design.dimension, scramble=True, rng=design.seed)
        if block:
            sequence.fast_forward(block * _BLOCK)
        points = sequence.random(_BLOCK)
    rows: list[list[float]] = points.tolist()
    return rows


def is_random_sample(scenario: Scenario) -> bool:
    """Return whether flights are a random sample, of the random variables or of noise from
    different seeds.

    Flights of a search and of subset simulation are not: each depends on earlier flights. Copies of
    a flight are not either. There are copies if flights differ in nothing random: swept values, and
    values chosen in turn, repeat.
    """
    if scenario.study == "falsify" or scenario.method == "subset" or scenario.cases:
        return False
    read = not scenario.finds and any(key.startswith(_READ) for key in scenario.sweep.root)
    if read and flights_per_sample(scenario) > 1:
        # Some are the same flight with other readings.
        return False
    # Draws of these keys do not make flights different either.
    draws = [draw for draw in scenario.draws if scenario.finds or not draw.key.startswith(_READ)]
    in_turn = {
        draw.key: without_repetitions(draw.choice)
        for draw in draws
        if draw.choice is not None and draw.weights is None
    }
    if any(draw.key not in in_turn and _varies(draw) for draw in draws):
        return True
    listed = {*scenario.sweep.root, *in_turn}
    if "flight_seed" in listed:
        # The first key that is chosen in turn changes from flight to flight; a seed in a later
        # place repeats, with other values of the first key.
        first = next(iter(in_turn), "")
        different = len(in_turn[first]) if first == "flight_seed" else 1
        return scenario.flights <= different and _depends_on_seed(scenario, listed)
    return scenario.flight_seed is None and _depends_on_seed(scenario, listed)


def flights_per_sample(scenario: Scenario) -> int:
    """Return how many flights have the same seed and random variables: a bound on a probability
    counts them as one.

    The flights of two vehicles share them, and so do those of all points of a sweep, unless each
    point has its own random numbers. Without random variables, swept seeds make flights different,
    and so do speed ratios with one flight each, unless the scenario sets common random numbers.
    """
    sweep, drawn = scenario.sweep.root, bool(scenario.draws)
    seeded = "flight_seed" in sweep or scenario.flight_seed is not None
    apart: set[str] = set()
    if scenario.own_random_numbers and (drawn or not seeded):
        apart = {*sweep}
    elif "flight_seed" in sweep and not drawn:
        apart = {"flight_seed"}
    elif scenario.common_random_numbers is None and scenario.flights == 1 and not (drawn or seeded):
        apart = {"nu"}
    points = math.prod(
        len(without_repetitions(values)) for key, values in sweep.items() if key not in apart
    )
    return points * (2 if scenario.fidelity == "both" else 1)


def random_numbers_of_points(scenario: Scenario) -> str:
    """Return whether the points of a sweep have ``own`` or ``common`` random numbers; an empty text
    without a sweep.
    """
    if not any(len(without_repetitions(values)) > 1 for values in scenario.sweep.root.values()):
        return ""
    vehicles = 2 if scenario.fidelity == "both" else 1
    common = scenario.flight_seed is not None or flights_per_sample(scenario) > vehicles
    return "common" if common else "own"


def _varies(draw: DrawConfig) -> bool:
    """Return whether a random variable has several values; a range without width has one value, and
    so has a choice with a single value of positive weight.
    """
    if draw.uniform is not None:
        return draw.uniform[0] < draw.uniform[1]
    return draw.weights is None or sum(weight > 0.0 for weight in draw.weights) > 1


def _depends_on_seed(scenario: Scenario, listed: Collection[str]) -> bool:
    """Return whether every flight depends on its seed, by its start or by noise; the values of the
    listed keys do not count.
    """

    def given(key: str) -> bool:
        return f"start.{key}" in listed or getattr(scenario.start, key) is not None

    def varies(section: str) -> bool:
        return any(key.startswith(section) for key in listed)

    placed = given("place_m") or (given("range_m") and given("aspect_deg"))
    if not (placed and given("course_deg")):
        return True
    shaken = (
        scenario.fidelity == "six_dof"
        and not scenario.turbulence.calm
        and not varies("turbulence.")
    )
    errs = scenario.sensors != SensorsConfig() and not varies("sensors.")
    return shaken or errs or not (scenario.reports.exact or varies("reports."))


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


def search_space(scenario: Scenario) -> Space:
    """Return the space of a scenario's random variables, a coordinate for each in their order."""
    return Space(
        coordinates=tuple(map(_coordinate, scenario.draws)),
        beyond=lambda point: beyond_declared(scenario, tuple(map(float, point))),
    )


def _coordinate(draw: DrawConfig) -> Coordinate:
    if draw.choice is not None:
        weights = np.cumsum([0.0, *(draw.weights or [1.0] * len(draw.choice))])
        return Coordinate(
            choices=tuple((weights / weights[-1]).tolist()), noise=draw.key == "flight_seed"
        )
    low, high = draw.uniform or (0.0, 0.0)
    return Coordinate(
        time_range=draw.uniform if draw.key.endswith("at_s") and low < high else None,
        circle=draw.key.endswith(_DIRECTIONS) and high - low == 360.0,
    )
