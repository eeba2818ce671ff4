"""The space that a search over a scenario's random variables has."""

import numpy as np

from scenarios.experiment.declared import beyond_declared
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.experiment import DrawConfig
from scenarios.search.method import Coordinate, Space

_DIRECTIONS = ("course_deg", "from_deg", "aspect_deg", "heading_deg")
"""Ends of the keys of directions, which are the same after a full circle [deg]; a turn is none: it
has a side.
"""


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
