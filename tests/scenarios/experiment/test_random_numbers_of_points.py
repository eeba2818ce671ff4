"""Points of a sweep: random numbers of their own or common ones, and who says which."""

import pytest

from scenarios.experiment.requests import Experiment
from scenarios.scenario.files import load_study
from scenarios.studies.base import study_of
from scenarios.world.noise import PAYLOAD, own_generator

pytestmark = pytest.mark.slow

WINDS = "sweep.wind.from_deg=[0, 120, 240]"


@pytest.mark.parametrize(("common", "different"), [((), 3), (("common_random_numbers=true",), 1)])
def test_each_wind_direction_has_an_instrument_of_its_own_unless_they_are_to_share_one(
    common, different
):
    experiment = Experiment("sulphur", load_study("sulphur", [WINDS, *common]))
    requests = [experiment.request(number) for number in range(experiment.flights)]
    assert [of.scenario.wind.from_deg for of in requests] == [0.0, 120.0, 240.0]
    assert len({of.seed for of in requests}) == different
    # What the sampled instrument is made of.
    assert len({own_generator(of.noise, PAYLOAD).random() for of in requests}) == different


@pytest.mark.parametrize(
    ("common", "different"), [("common_random_numbers=false", 8), ("flights=4", 4)]
)
def test_samples_that_are_spread_evenly_are_spread_at_each_point_anew(common, different):
    keys = ["flights=4", common, "sweep.keepout.radius_m=[200, 250]"]
    study = study_of(load_study("monte_carlo", keys), "monte_carlo")
    tasks = [study.task(number) for number in range(8)]
    assert len({task.point for task in tasks}) == different
