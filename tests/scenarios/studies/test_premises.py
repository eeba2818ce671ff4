"""The study of the premises, and how a run ends that contradicts what is proved."""

import json
from dataclasses import replace

import pandas as pd

from common.premises import TERMS
from common.run_layout import COLUMNS, FLIGHTS
from scenarios.engine.processes import InProcessExecutor
from scenarios.flight.guard_belief import GuardBelief
from scenarios.measures import figures
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study

QUICK = [
    "fidelity='kinematic'", "flights=1", "flight.duration_max_s=40",
    'cases=[{name="calm",set={"wind.speed_mps"=0.0}},{name="wind"}]',
]  # fmt: skip


def flown(out, **keys):
    scenario = load_study("premises", QUICK)
    return run_study(scenario, "premises", out, executor_factory=InProcessExecutor, **keys)


def test_the_study_has_a_row_for_each_case_and_term(tmp_path):
    result = flown(tmp_path / "run")
    table = pd.read_csv(tmp_path / "run" / "premises.csv")
    assert list(dict.fromkeys(table["case"])) == ["calm_kinematic", "wind_kinematic"]
    assert set(table["term"]) <= set(TERMS)
    assert (table["ratio_max"] >= table["ratio_median"]).all()
    assert any("median / largest" in line for line in result.lines)
    assert result.verdict.counts.unexplained == 0
    told = json.loads((tmp_path / "run" / COLUMNS).read_text())
    assert list(told["premises.csv"]) == list(table)
    assert set(GuardBelief.COLUMNS) <= set(told[FLIGHTS])


def test_a_violation_with_every_premise_held_has_an_exit_status_of_its_own(tmp_path, monkeypatch):
    measured = figures.keepout_figures
    monkeypatch.setattr(
        figures,
        "keepout_figures",
        lambda *path: replace(measured(*path), violations=1, depth=1.0),
    )
    monkeypatch.setattr(figures, "premise_figures", lambda *_: {"premises_exceeded": "none"})
    result = flown(tmp_path / "run")
    assert result.verdict.counts.unexplained == 2
    assert "THE KEEP-OUT GUARD IS WRONG" in result.lines[0]
    assert not result.all_met
    assert result.verdict.exit_status == 3
    row = pd.read_csv(tmp_path / "run" / "summary.csv").iloc[0]
    assert row["outcome"] == "unexplained_violation"
    assert not row["kept_out"]
