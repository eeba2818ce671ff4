"""What a scenario says of its experiment: whether flights are a random sample, whether there are
several points, where they start."""

import pytest

from scenarios.experiment.requests import Experiment
from scenarios.experiment.sampling import flights_per_sample, is_random_sample
from scenarios.scenario.files import load_study
from scenarios.scenario.scenario import Scenario

WIND = {"key": "wind.speed_mps", "uniform": [0.0, 5.0]}
FROM = {"key": "wind.from_deg", "choice": [0.0, 90.0, 180.0, 270.0]}
LOAD = {"key": "emission.load", "uniform": [0.2, 0.9]}
SEEDS = {"key": "flight_seed", "choice": [1, 2]}
SNIFFERS = {"payload.sensor": ["fast", "electrochemical"]}
COMMON = {"common_random_numbers": True}
OWN = {"common_random_numbers": False}
ABOARD = {"payload": ["sniffer"], "emission": {"ship": "container"}}
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
        # One seed, and four winds in turn: fifty times the same four flights. At random by their
        # weights they are a sample.
        ({"flight_seed": 5, "flights": 200, "draws": [FROM]}, False),
        (
            {"flight_seed": 5, "flights": 200, "draws": [FROM | {"weights": [1.0, 1.0, 2.0, 1.0]}]},
            True,
        ),
        ({"flight_seed": 5, "flights": 200, "draws": [FROM, WIND]}, True),
        ({"flights": 200, "draws": [FROM]}, True),
        # Seeds in turn, and each once; or each ten times.
        ({"flights": 2, "draws": [SEEDS]}, True),
        ({"flights": 20, "draws": [SEEDS]}, False),
        ({"flights": 4, "draws": [{"key": "flight_seed", "choice": [7, 7, 7, 7]}]}, False),
        # Two seeds with two winds each, or one seed with both: no flight twice, and no sample more
        # than there are seeds.
        ({"flights": 4, "draws": [SEEDS, FROM]}, False),
        ({"flights": 2, "draws": [SEEDS, FROM]}, True),
        ({"flights": 2, "draws": [FROM, SEEDS]}, False),
        ({"flights": 4, "sweep": {"flight_seed": [1, 2]}, "draws": [FROM]}, False),
        # Random variables of one value.
        ({"flight_seed": 3, "flights": 8, "draws": [WIND | {"uniform": [5.0, 5.0]}]}, False),
        (
            {"flight_seed": 3, "flights": 8, "draws": [FROM | {"weights": [0.0, 1.0, 0.0, 0.0]}]},
            False,
        ),
        ({"flights": 1, "sweep": {"flight_seed": [1, 2]}}, True),
        ({"flights": 10, "sweep": {"flight_seed": [1, 2]}}, False),
        # In calm air nothing but the start depends on the seed.
        ({"start": START, "flights": 8, "draws": [FROM]}, False),
        ({"start": START, "flights": 8, "draws": [FROM], "turbulence": {"level": "light"}}, True),
        (
            {"start": START, "flights": 8, "draws": [FROM], "sensors": {"position_sigma_m": 1.0}},
            True,
        ),
        (
            {
                "start": {"range_m": 500.0, "aspect_deg": 180.0},
                "flights": 8,
                "sweep": {"start.course_deg": [0.0, 90.0]},
            },
            False,
        ),
        # Sniffers that read the same flight, and those on flights of their own.
        ({"flights": 8, "sweep": SNIFFERS}, False),
        (ABOARD | {"flights": 8, "sweep": SNIFFERS} | COMMON, False),
        (ABOARD | {"flights": 8, "sweep": SNIFFERS, "flight_seed": 3}, False),
        (ABOARD | {"flights": 8, "sweep": SNIFFERS}, True),
        # And sniffers that are drawn, without and with a path that depends on what is read.
        ({"flight_seed": 3, "flights": 8, "draws": [LOAD]}, False),
        ({"flight_seed": 3, "flights": 8, "draws": [LOAD, WIND]}, True),
        (
            {"flight_seed": 3, "flights": 8, "draws": [LOAD], "following": {"plume": "estimated"}},
            True,
        ),
        ({"flights": 8, "draws": [LOAD]}, True),
        (
            {"flights": 4, "draws": [SEEDS, {"key": "payload.exact", "choice": [True, False]}]},
            False,
        ),
        # Each level starts from the nearest flights of the one before.
        ({"study": "monte_carlo", "method": "subset", "draws": [WIND]}, False),
        ({"study": "falsify", "draws": [WIND]}, False),
        ({"cases": [{"name": "one"}]}, False),
    ],
)
def test_flights_are_a_random_sample_where_they_differ_by_chance_alone(keys, at_random):
    assert is_random_sample(Scenario(title="own", **keys)) is at_random


@pytest.mark.parametrize(
    ("keys", "shared"),
    [
        ({"flights": 8}, 1),
        ({"sweep": {"nu": [0.3, 0.5]}}, 1),
        ({"sweep": {"nu": [0.3, 0.5]}, "flights": 8}, 2),
        ({"sweep": {"nu": [0.3, 0.5], "keepout.radius_m": [200.0, 250.0, 300.0]}}, 3),
        ({"sweep": {"keepout.radius_m": [200.0, 250.0, 300.0]}, "flights": 8}, 3),
        ({"sweep": {"keepout.radius_m": [200.0, 250.0, 200.0]}, "flights": 8}, 2),
        ({"sweep": {"flight_seed": [1, 2, 3]}}, 1),
        ({"fidelity": "both", "flights": 8}, 2),
        # Speed ratios of one flight each have seeds of their own, but all points of a sweep the
        # same sample of random variables.
        ({"sweep": {"nu": [0.3, 0.5]}, "draws": [FROM | {"weights": [1.0] * 4}]}, 2),
        # Numbers of their own, asked for or because of an instrument; the vehicles share them.
        (OWN | {"sweep": {"nu": [0.3, 0.5]}, "flights": 8}, 1),
        (OWN | {"sweep": {"vessel.speed_ratio": [0.3, 0.5]}}, 1),
        (ABOARD | {"sweep": {"nu": [0.3, 0.5], "keepout.radius_m": [200.0, 250.0, 300.0]}}, 1),
        (ABOARD | {"sweep": {"nu": [0.3, 0.5]}, "draws": [FROM | {"weights": [1.0] * 4}]}, 1),
        (
            OWN | {"fidelity": "both", "sweep": {"keepout.radius_m": [200.0, 250.0]}, "flights": 8},
            2,
        ),
        # Seeds that are given come again.
        (OWN | {"sweep": {"flight_seed": [1, 2, 3], "keepout.radius_m": [200.0, 250.0]}}, 2),
        (OWN | {"sweep": {"keepout.radius_m": [200.0, 250.0]}, "flight_seed": 3}, 2),
        # Common numbers.
        (COMMON | {"sweep": {"nu": [0.3, 0.5]}}, 2),
        (ABOARD | COMMON | {"sweep": {"wind.from_deg": [0.0, 90.0]}, "flights": 8}, 2),
    ],
)
def test_flights_of_several_points_share_what_is_random(keys, shared):
    scenario = Scenario(title="own", **keys)
    assert flights_per_sample(scenario) == shared
    experiment = Experiment("own", scenario)
    assert (
        len({experiment.request(i).seed for i in range(experiment.flights)})
        == experiment.flights / shared
    )


@pytest.mark.parametrize(("common", "samples"), [(None, 1), (True, 1), (False, 3)])
def test_flights_with_swept_seeds_share_their_random_variables_where_these_are_common(
    common, samples
):
    swept = {"flight_seed": [1, 2, 3]}
    scenario = Scenario(title="own", sweep=swept, draws=[WIND], common_random_numbers=common)
    experiment = Experiment("own", scenario)
    winds = {experiment.request(i).scenario.wind.speed_mps for i in range(3)}
    assert len(winds) == samples == 3 // flights_per_sample(scenario)


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


@pytest.mark.parametrize(
    ("name", "overrides", "funnel", "start"),
    [
        # measurement/ships.toml: 35 m of the container, 16 of the coaster, 55 of the
        # cruise ship.
        ("sulphur", (), 35.0, 35.0),
        ("sulphur", ("emission.ship=cruise",), 55.0, 55.0),
        # The UAV keeps 3 m, in light turbulence 6, within flight.altitude_min_m and altitude_max_m:
        # 20 and 120 m above the sea.
        ("sulphur", ("emission.ship=coaster", "vessel.speed_mps=6"), 16.0, 23.0),
        (
            "sulphur",
            ("emission.ship=coaster", "vessel.speed_mps=6", "following.plume=estimated"),
            16.0,
            23.0,
        ),
        ("sulphur", ("plume.source_height_m=150", "turbulence.level=light"), 150.0, 114.0),
        ("sulphur", ("flight.altitude_min_m=36", "flight.altitude_max_m=40"), 35.0, 38.0),
        (
            "sulphur",
            ("emission.ship=coaster", "vessel.speed_mps=6", "plume.source_height_m=25"),
            25.0,
            25.0,
        ),
        (
            "sulphur",
            ("emission.ship=coaster", "vessel.speed_mps=6", "flight.altitude_m=40"),
            16.0,
            40.0,
        ),
        ("sweep_nu", (), 60.0, 60.0),
    ],
)
def test_a_plume_begins_at_the_funnel_of_its_ship_unless_its_height_is_given(
    name, overrides, funnel, start
):
    scenario = load_study(name, overrides)
    assert (scenario.source_height, scenario.altitude) == (funnel, start)
