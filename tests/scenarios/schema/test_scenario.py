"""What a scenario says of its experiment: whether flights are a random sample, whether there are several points, where they
start."""

import pytest

from scenarios.errors import InputError
from scenarios.schema.load import load_study, with_values
from scenarios.schema.scenario import Scenario

WIND = {"key": "wind.speed_mps", "uniform": [0.0, 5.0]}
FROM = {"key": "wind.from_deg", "choice": [0.0, 90.0, 180.0, 270.0]}
SEEDS = {"key": "flight_seed", "choice": [1, 2]}
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
        # One seed, and four winds in turn: fifty times the same four flights. At random by their weights they are a sample.
        ({"flight_seed": 5, "flights": 200, "draws": [FROM]}, False),
        ({"flight_seed": 5, "flights": 200, "draws": [FROM | {"weights": [1.0, 1.0, 2.0, 1.0]}]}, True),
        ({"flight_seed": 5, "flights": 200, "draws": [FROM, WIND]}, True),
        ({"flights": 200, "draws": [FROM]}, True),
        # Seeds in turn, and each once; or each ten times.
        ({"flights": 2, "draws": [SEEDS]}, True),
        ({"flights": 20, "draws": [SEEDS]}, False),
        ({"flights": 1, "sweep": {"flight_seed": [1, 2]}}, True),
        ({"flights": 10, "sweep": {"flight_seed": [1, 2]}}, False),
        # In calm air nothing but the start depends on the seed.
        ({"start": START, "flights": 8, "draws": [FROM]}, False),
        ({"start": START, "flights": 8, "draws": [FROM], "turbulence": {"level": "light"}}, True),
        ({"start": START, "flights": 8, "draws": [FROM], "sensors": {"position_sigma_m": 1.0}}, True),
        ({"start": {"range_m": 500.0, "aspect_deg": 180.0}, "flights": 8, "sweep": {"start.course_deg": [0.0, 90.0]}}, False),
        # Sniffers that read the same flight.
        ({"flights": 8, "sweep": {"payload.sensor": ["fast", "electrochemical"]}}, False),
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
