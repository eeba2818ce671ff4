"""A convergence study from its file to its run directory, with few trajectories from near by."""

import pandas as pd
import pytest

from scenarios.engine.processes import InProcessExecutor
from scenarios.errors import InputError
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from tests.extensions.convergence.conftest import SETTINGS, TRAJECTORIES
from tests.run_tables import manifest_of

pytestmark = pytest.mark.slow


def test_an_interrupted_study_resumes_to_the_same_rows(directory, tmp_path):
    def run(*overrides, resume, progress=lambda *_: None):
        return run_study(
            load_study("convergence", [*SETTINGS, *overrides]), "convergence", tmp_path / "run",
            executor_factory=InProcessExecutor, resume=resume, progress=progress,
        )  # fmt: skip

    def interrupt(_, done, __):
        if done >= 8:
            raise KeyboardInterrupt

    count = 3 * TRAJECTORIES
    first = run(resume=False, progress=interrupt)
    assert first.verdict.interrupted
    assert 0 < first.verdict.counts.done < count
    assert manifest_of(tmp_path / "run")["state"] == "interrupted"
    again = run(resume=True)
    assert again.verdict.counts.done == again.verdict.counts.planned == count
    tables = [pd.read_csv(path / "summary.csv") for path in (tmp_path / "run", directory)]
    pd.testing.assert_frame_equal(*tables, check_exact=True)
    with pytest.raises(InputError, match="another configuration"):
        run("seed=3", resume=True)


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ('guidance.laws=["cascade", "cascade"]', r"laws is \['cascade', 'cascade'\].*once"),
        ('guidance.laws=["magic"]', "guidance.laws.0.*'magic'.*lyapunov"),
        ("guidance.heading_rate_max_rad_s=0.4", "0.4.*greater than 0.5"),
        ("keepout.radius_m=200", "unknown key 'keepout'"),
    ],
)
def test_bad_values_are_refused(override, words):
    with pytest.raises(InputError, match=words):
        load_study("convergence", [*SETTINGS, override])
