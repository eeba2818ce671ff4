"""What a scenario says of its experiment: whether flights are a random sample, whether there are several points, where they
start."""

import pytest

from scenarios.errors import InputError
from scenarios.schema.load import load_study, with_values
from scenarios.schema.scenario import Scenario

WIND = {"key": "wind.speed_mps", "uniform": [0.0, 5.0]}
START = {"place_m": [-400.0, 0.0], "course_deg": 0.0}


@pytest.mark.parametrize(
    ("keys", "at_random"),
    [
        ({}, True),
        ({"start": START}, False),
        ({"start": START, "draws": [WIND]}, True),
        # One seed for all: a hundred times the same flight.
        ({"flight_seed": 3, "flights": 100}, False),
        ({"flight_seed": 3, "draws": [WIND]}, True),
        ({"study": "monte_carlo", "draws": [WIND]}, True),
        # Each level starts from the nearest flights of the one before.
        ({"study": "monte_carlo", "method": "subset", "draws": [WIND]}, False),
        ({"study": "falsify", "draws": [WIND]}, False),
        ({"cases": [{"name": "one"}]}, False),
    ],
)
def test_flights_are_a_random_sample_where_nothing_but_chance_tells_them_apart(keys, at_random):
    assert Scenario(title="own", **keys).sampled_at_random is at_random


@pytest.mark.parametrize(
    ("keys", "several"),
    [
        ({}, False),
        ({"flights": 5, "draws": [WIND]}, False),
        ({"sweep": {"nu": [0.3]}}, True),
        ({"cases": [{"name": "one"}]}, True),
        ({"comparison": {"variants": [{"name": "one", "set": {}}]}}, True),
        ({"fidelity": "both"}, True),
    ],
)
def test_an_experiment_has_several_points_by_what_varies_otherwise_than_at_random(keys, several):
    assert Scenario(title="own", **keys).several_points is several


def test_a_distance_that_is_sampled_is_checked_by_its_own_value_and_not_by_that_of_starts_without_it():
    study = load_study("starts_anywhere", ["keepout.radius_m=500", "draws.1.uniform=[510,1300]"])
    assert study.draws[1].key == "start.range_m"
    with pytest.raises(InputError, match=r"start\.range_m is 490 m; it must exceed keepout\.radius_m, 500 m"):
        with_values(study, {"start.range_m": 490.0})
