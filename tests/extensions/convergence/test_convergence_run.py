"""A convergence study from its file to its run directory, with few trajectories from near by."""

import pandas as pd
import pytest

from extensions.convergence.ensemble import DISTANCE_CONVERGED, PHI_CONVERGED
from extensions.convergence.scenario import ConvergenceScenario
from reports.output import write_report
from reports.run.run_data import read_run
from scenarios.engine.processes import InProcessExecutor
from scenarios.engine.runner import ExecutorFactory
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


def test_every_trajectory_is_a_row_and_those_that_did_not_converge_are_in_a_file(directory):
    summary = pd.read_csv(directory / "summary.csv")
    # 12 initial states with each of the two laws.
    assert len(summary) == 24
    assert set(summary["law"]) == {"lyapunov", "cascade"}
    assert (summary["outcome"] == "converged").all()
    assert (summary["distance_final_m"] <= DISTANCE_CONVERGED).all()
    assert (summary["phi_final_rad"].abs() <= PHI_CONVERGED).all()
    assert len(pd.read_csv(directory / "counterexamples.csv")) == 0
    # The first two trajectories' time histories, with each law.
    assert len(list((directory / "trajectories").glob("*.parquet"))) == 4


def test_its_report_says_what_happened(directory, tmp_path):
    write_report(read_run(directory), tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "All 24 trajectories converged" in page


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


def test_a_study_goes_on_with_the_blocks_that_are_left(tmp_path):
    few = study("ensemble.trajectories=6", "ensemble.distance_max_m=60")
    told = []

    def tell(doing, done, total):
        told.append((doing, done, total))

    def interrupt(doing, done, total):
        if done == 6:
            raise KeyboardInterrupt

    run(few, tmp_path / "whole", progress=tell, factory=ExecutorFactory(jobs=2))
    # Two laws, three kinds of reference: six blocks of two trajectories.
    assert [done for doing, done, _ in told if doing == "flying"] == [0, 2, 4, 6, 8, 10, 12]
    assert run(few, tmp_path / "broken", progress=interrupt).verdict.counts.done == 6
    told.clear()
    assert run(few, tmp_path / "broken", resume=True, progress=tell).all_met
    assert [report for report in told if report[0] == "flying"] == [
        ("flying", done, 12) for done in (6, 8, 10, 12)
    ]
    assert (tmp_path / "broken" / "summary.csv").read_bytes() == (
        tmp_path / "whole" / "summary.csv"
    ).read_bytes()
    told.clear()
    assert run(few, tmp_path / "whole", resume=True, progress=tell).all_met
    assert [report for report in told if report[0] == "flying"] == [("flying", 12, 12)]


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
