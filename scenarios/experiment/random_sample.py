"""Whether flights of an experiment are a random sample, from which a bound on a probability
follows.
"""

import math
from collections.abc import Collection

from scenarios.experiment.points import without_repetitions
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.equipment import SensorsConfig
from scenarios.scenario.sections.experiment import DrawConfig

_READ = ("payload.", "emission.")
"""Sections that change what is read in a flight, and its path only where that follows the readings.
"""


def is_random_sample(scenario: Scenario) -> bool:
    """Return whether flights are a random sample: of the random variables, or of what follows from
    seeds of their own.

    Those of a search and of subset simulation are not: each depends on what was flown before. Nor
    are copies of a flight, which come where nothing random tells flights apart: values that are
    swept, or chosen in turn, come again and again.
    """
    if scenario.study == "falsify" or scenario.method == "subset" or scenario.cases:
        return False
    read = not scenario.finds and any(key.startswith(_READ) for key in scenario.sweep.root)
    if read and flights_per_sample(scenario) > 1:
        # Some are the same flight, read otherwise.
        return False
    # What is drawn of these tells no two flights apart either.
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
        # Of what is chosen in turn the first is another one in each flight; a seed behind it comes
        # again, beside other values.
        first = next(iter(in_turn), "")
        different = len(in_turn[first]) if first == "flight_seed" else 1
        return scenario.flights <= different and _depends_on_seed(scenario, listed)
    return scenario.flight_seed is None and _depends_on_seed(scenario, listed)


def flights_per_sample(scenario: Scenario) -> int:
    """Return how many flights have the same seed and random variables: a bound on a probability
    counts them as one.

    Those of two vehicles have, and those of all points of a sweep, unless each has random numbers
    of its own. Without random variables seeds that are swept tell flights apart, and so do speed
    ratios of one flight each, if the scenario does not ask for common numbers.
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
    """Return whether the points of a sweep have ``own`` or ``common`` random numbers; no word of a
    scenario that sweeps nothing.
    """
    if not any(len(without_repetitions(values)) > 1 for values in scenario.sweep.root.values()):
        return ""
    vehicles = 2 if scenario.fidelity == "both" else 1
    common = scenario.flight_seed is not None or flights_per_sample(scenario) > vehicles
    return "common" if common else "own"


def _varies(draw: DrawConfig) -> bool:
    """Return whether a random variable has several values: a range of no width, or one choice of
    some weight, has one.
    """
    if draw.uniform is not None:
        return draw.uniform[0] < draw.uniform[1]
    return draw.weights is None or sum(weight > 0.0 for weight in draw.weights) > 1


def _depends_on_seed(scenario: Scenario, listed: Collection[str]) -> bool:
    """Return whether every flight depends on its seed, by its start or by noise, beside the keys
    whose values are listed.
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
