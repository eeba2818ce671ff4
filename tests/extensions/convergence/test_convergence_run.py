"""A convergence study from its file to its run directory, with few trajectories from near by."""

import pandas as pd
import pytest

from extensions.convergence.scenario import ConvergenceScenario
from scenarios.engine.processes import InProcessExecutor
from scenarios.errors import InputError
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from tests.run_tables import manifest_of

pytestmark = pytest.mark.slow

FEW = ["ensemble.trajectories=12", "ensemble.distance_max_m=100", "ensemble.samples=2"]


def study(*overrides):
    loaded = load_study("convergence", [*FEW, *overrides])
    assert isinstance(loaded, ConvergenceScenario)
    return loaded


def run(scenario, path, *, resume=False, progress=lambda *_: None, factory=InProcessExecutor):
    return run_study(
        scenario, "convergence", path, executor_factory=factory, resume=resume, progress=progress
    )


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    path = tmp_path_factory.mktemp("convergence") / "run"
    result = run(study(), path)
    assert result.all_met
    return path


def test_an_interrupted_study_resumes_to_the_same_rows(directory, tmp_path):
    told = []

    def interrupt(doing, done, total):
        told.append((doing, done, total))
        if done >= 8:
            raise KeyboardInterrupt

    path = tmp_path / "run"
    first = run(study(), path, progress=interrupt)
    assert first.verdict.interrupted
    assert 0 < first.verdict.counts.done < 24
    assert manifest_of(path)["state"] == "interrupted"
    again = run(study(), path, resume=True)
    assert again.verdict.counts.done == again.verdict.counts.planned == 24
    pd.testing.assert_frame_equal(
        pd.read_csv(path / "summary.csv"), pd.read_csv(directory / "summary.csv"), check_exact=True
    )
    with pytest.raises(InputError, match="another configuration"):
        run(study("seed=3"), path, resume=True)


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ('guidance.laws=["cascade", "cascade"]', ["laws is ['cascade', 'cascade']", "once"]),
        ('guidance.laws=["magic"]', ["guidance.laws.0", "'magic'", "lyapunov"]),
        (
            "guidance.heading_rate_max_rad_s=0.4",
            ["heading_rate_max_rad_s", "0.4", "greater than 0.5 [rad/s]"],
        ),
        ("keepout.radius_m=200", ["unknown key 'keepout'"]),
    ],
)
def test_bad_values_are_refused_in_one_line(override, words):
    with pytest.raises(InputError) as refusal:
        study(override)
    for word in words:
        assert word in str(refusal.value)
