"""Points of a sweep: random numbers of their own or common ones, and who says which."""

import pytest

from reports.registry import content
from reports.run.run_data import read_run
from scenarios.engine.processes import InProcessExecutor
from scenarios.experiment.requests import Experiment
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study, study_of
from scenarios.world.noise import PAYLOAD, own_generator
from tests.run_tables import manifest_of, rows_of

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


@pytest.mark.parametrize(
    ("given", "kind", "line", "sentence"),
    [
        ("false", "own", "each has starts, noise and", "Each point of the sweep has starts, noise"),
        ("true", "common", "all have the same starts", "All points of the sweep have the same"),
    ],
)
def test_console_manifest_and_report_say_whose_random_numbers_points_have(
    tmp_path, given, kind, line, sentence
):
    keys = (
        "fidelity=kinematic", "guidance.rate_hz=5", "flight.log_rate_hz=5", "comparison.variants=[]", "flight.crossings=2",
        "sweep.nu=[0.3]", "sweep.keepout.radius_m=[150, 200]", f"common_random_numbers={given}",
    )  # fmt: skip
    result = run_study(
        load_study("sweep_nu", keys),
        "sweep_nu",
        tmp_path / "run",
        overrides=keys,
        executor_factory=InProcessExecutor,
    )
    assert any(told.startswith(f"points of the sweep: {line}") for told in result.lines)
    assert manifest_of(tmp_path / "run")["random_numbers_of_points"] == {"sweep_nu": kind}
    assert sentence in content(read_run(tmp_path / "run")).verdict.detail
    seeds = {row["seed"] for row in rows_of(tmp_path / "run")}
    assert len(seeds) == {"own": 2, "common": 1}[kind]
