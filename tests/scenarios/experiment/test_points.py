"""Points of an experiment: where they are sampled, what they share, and what is set at each."""

import numpy as np
import pytest
from scipy.stats import qmc

from scenarios.experiment.requests import Experiment
from scenarios.experiment.sampling import SamplingDesign
from scenarios.scenario.files import load_study
from scenarios.scenario.scenario import Scenario
from scenarios.studies.base import study_of

DRAWS = [
    {"key": "wind.speed_mps", "uniform": [3.0, 8.0]},
    {"key": "wind.from_deg", "choice": [0.0, 90.0, 180.0]},
    {"key": "vessel.manoeuvres.0.turn_deg", "uniform": [-90.0, 90.0]},
    {"key": "vessel.speed_mps", "uniform": [2.0, 8.0]},
]
BASE = {
    "title": "t", "fidelity": "kinematic", "flights": 6, "guidance": {"mission": "follow"},
    "draws": DRAWS, "vessel": {"manoeuvres": [{"at_s": 50.0}]},
}  # fmt: skip


def requests_of(**keys):
    experiment = Experiment("t", Scenario.model_validate(BASE | keys))
    return [experiment.request(number) for number in range(experiment.flights)]


TURN, SPEED, FROM = "vessel.manoeuvres.0.turn_deg", "wind.speed_mps", "wind.from_deg"


@pytest.mark.parametrize(
    ("values", "gone", "is_set"),
    [
        ({SPEED: 0.0}, {SPEED}, lambda s: s.wind.speed_mps == 0.0),
        ({"vessel.manoeuvres": []}, {TURN}, lambda s: s.vessel.manoeuvres == ()),
        ({"vessel.speed_ratio": 0.5}, {"vessel.speed_mps"}, lambda s: s.vessel_speed == 9.71),
        ({"wind": {"speed_mps": 2.0}}, {SPEED, FROM}, lambda s: s.wind.speed_mps == 2.0),
    ],
)
def test_what_a_comparison_or_a_case_sets_wins_over_a_sample_and_others_keep_theirs(
    values, gone, is_set
):
    plain = requests_of()
    compared = requests_of(comparison={"variants": [{"name": "own", "set": values}]})
    cases = requests_of(cases=[{"name": "own", "set": values}])
    for study, flight, of_case in zip(plain, compared[len(plain) :], cases, strict=True):
        kept = {key: value for key, value in study.inputs.items() if key not in gone}
        assert flight.inputs == of_case.inputs == kept
        assert flight.seed == of_case.seed == study.seed
        assert flight.scenario.vessel == of_case.scenario.vessel
        assert is_set(flight.scenario)


def test_a_flight_of_a_comparison_is_sampled_again_where_the_flight_beside_it_is():
    # In calm air other samples than the study's would have a speed ratio within these.
    calm_air = {"variants": [{"name": "calm", "set": {SPEED: 0.0}}]}
    flights = requests_of(speed_ratio=[0.2, 0.7], comparison=calm_air)
    for study, calm in zip(flights[:6], flights[6:], strict=True):
        kept = {key: value for key, value in study.inputs.items() if key != SPEED}
        assert calm.inputs == kept
        assert calm.scenario.wind.speed_mps == 0.0


@pytest.mark.parametrize(
    ("key", "choices"),
    [
        ("reference.shape", ["sinusoid", "fastest"]),
        ("following.margin_law", ["cascade", "line_of_sight"]),
        ("turbulence.level", ["none", "light"]),
    ],
)
def test_each_choice_that_the_tracking_in_turbulence_depends_on_is_a_setting(key, choices):
    air = {"guidance": {"mission": "follow"}, "turbulence": {"level": "light"}, "flights": 2}
    document = {"title": "t", **air, "draws": [{"key": key, "choice": choices}]}
    experiment = Experiment("t", Scenario.model_validate(document))
    flown = [experiment.request(number).scenario for number in range(2)]
    section, name = key.split(".")
    for of in (experiment.settings(), flown):
        assert [getattr(getattr(one, section), name) for one in of] == choices


def points(sampling, count, **changes):
    values = {"dimension": 5, "flights": 1024, "seed": 3} | changes
    made = SamplingDesign(sampling, **values)
    return np.array([made.at(number) for number in range(count)])


@pytest.mark.parametrize("sampling", ["sobol", "latin_hypercube"])
def test_a_point_depends_on_its_number_and_the_studys_seed_alone(sampling):
    whole = points(sampling, 600)
    # Asked for one by one and backwards, as tasks come from processes in any order.
    other = SamplingDesign(sampling, dimension=5, flights=1024, seed=3)
    for number in (599, 3, 256, 255):
        assert other.at(number) == tuple(whole[number])
    assert not np.array_equal(whole, points(sampling, 600, seed=4))


def test_a_sobol_sequence_is_that_of_scipy_whatever_blocks_it_is_made_in():
    assert np.array_equal(points("sobol", 1024), qmc.Sobol(5, scramble=True, rng=3).random(1024))


def test_a_latin_hypercube_has_one_flight_in_each_stratum_of_each_input():
    strata = np.floor(1024 * points("latin_hypercube", 1024)).astype(int)
    for column in strata.T:
        assert sorted(column) == list(range(1024))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("common", "different"), [("common_random_numbers=false", 8), ("flights=4", 4)]
)
def test_samples_that_are_spread_evenly_are_spread_at_each_point_anew(common, different):
    keys = ["flights=4", common, "sweep.keepout.radius_m=[200, 250]"]
    study = study_of(load_study("monte_carlo", keys), "monte_carlo")
    tasks = [study.task(number) for number in range(8)]
    assert len({task.point for task in tasks}) == different
