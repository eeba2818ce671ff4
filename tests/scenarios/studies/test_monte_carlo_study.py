"""Monte Carlo from its file to its run directory, kinematic and short."""

import json

import numpy as np
import pandas as pd
import pytest

from scenarios.engine.journal import Journal
from scenarios.engine.processes import InProcessExecutor
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import ExecutorFactory
from scenarios.scenario.files import load_study
from scenarios.statistics.sensitivity import sensitivity_indices
from scenarios.studies.base import run_study, study_of
from tests.run_tables import manifest_of

pytestmark = pytest.mark.slow

SHORT = [
    "fidelity=kinematic",
    "turbulence.level=none",
    "turbulence.gusts=0",
    "turbulence.gust_speed_mps=0",
    # Too short to settle.
    "flight.duration_max_s=3.0",
    "flight.log_rate_hz=5",
    "guidance.rate_hz=5",
    "criteria.required=keep_out",
    "histories=5",
    # All of them within the range, so that every flight is at its point; vessels at 2 m/s and more
    # make an apparent wind.
    "speed_ratio=[0.0, 5.0]",
    "wind.speed_mps=0.5",
]


def run(out, *overrides, factory=InProcessExecutor, resume=False, progress=lambda *_: None):
    scenario = load_study("monte_carlo", [*SHORT, *overrides])
    return run_study(
        scenario, "monte_carlo", out, executor_factory=factory, resume=resume, progress=progress
    )


def bound_of(out):
    return json.loads((out / "statistics.json").read_text(encoding="utf-8"))["violation"][
        "pessimistic"
    ]["upper"]


def tables(out):
    return [
        pd.read_csv(out / name).drop(columns="wall_time_s", errors="ignore")
        for name in ("summary.csv", "draws.csv")
    ]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    out = tmp_path_factory.mktemp("monte_carlo") / "run"
    assert run(out, "flights=40", factory=ExecutorFactory(jobs=2)).verdict.counts.done == 40
    return out


def test_what_is_drawn_follows_the_declared_distributions_at_the_points_of_a_sobol_sequence(whole):
    summary, draws = tables(whole)
    assert list(draws["flight_id"]) == list(summary["flight_id"])
    # A Sobol sequence has one of 32 points in each 32nd of a range, so also in each quarter as
    # many.
    aspect = draws["start.aspect_deg"].to_numpy()[:32]
    assert np.histogram(aspect, bins=32, range=(-180.0, 180.0))[0].tolist() == [1] * 32
    assert summary["wind_from_deg"].equals(draws["wind.from_deg"])
    assert summary["start_aspect_deg"].to_numpy() == pytest.approx(
        draws["start.aspect_deg"].to_numpy(), abs=1e-9
    )
    assert summary["start_distance_m"].to_numpy() == pytest.approx(
        draws["start.range_m"].to_numpy(), rel=1e-12
    )


def test_the_same_seed_gives_the_same_rows_whatever_the_number_of_processes_and_of_flights(
    whole, tmp_path
):
    # Of the whole study two processes flew 40.
    run(tmp_path / "fewer", "flights=16")
    for one, other in zip(tables(whole), tables(tmp_path / "fewer"), strict=True):
        pd.testing.assert_frame_equal(one[:16], other, check_exact=True)


def test_statistics_are_written_and_bound_the_probability_of_an_entry(whole):
    statistics = json.loads((whole / "statistics.json").read_text(encoding="utf-8"))
    measured = statistics["violation"]["measured"]
    assert (measured["events"], measured["flights"]) == (0, 40)
    # Clopper and Pearson's one-sided bound of 0 of n: 1 - (1 - confidence)^(1/n).
    assert measured["upper"] == pytest.approx(1.0 - 0.05 ** (1.0 / 40.0), rel=1e-9)


def test_what_drives_a_figure_is_asked_of_the_random_variables_alone(whole, monkeypatch):
    asked = []

    def indices(inputs, *given, **named):
        asked.append(list(inputs))
        return sensitivity_indices(inputs, *given, **named)

    monkeypatch.setattr("scenarios.statistics.estimates.sensitivity_indices", indices)
    scenario = load_study("monte_carlo", [*SHORT, "flights=40"])
    study, directory = study_of(scenario, "monte_carlo"), RunDirectory(whole)
    journal = Journal(directory.journal, reading=True)
    study.postprocess(directory, journal, lambda *_: None)
    journal.close()
    # Neither the trial nor the variant, which are those of all flights, nor nu, which follows from
    # wind and vessel.
    assert asked
    assert all(keys == [draw.key for draw in scenario.draws] for keys in asked)


@pytest.fixture
def frequent_looks(monkeypatch):
    """Look after 8, 16, 32 flights and so on: 256 would take too long here."""
    monkeypatch.setattr("scenarios.statistics.estimates.FIRST_LOOK", 8)


def test_a_study_stops_by_itself_where_the_interval_it_was_asked_for_is_tight_enough(
    frequent_looks, tmp_path
):
    # 0 of n at the confidence of look k: 1 - (0.05/(k (k + 1)))^(1/n) is 0.37, 0.26, 0.15 at 8, 16,
    # 32.
    result = run(tmp_path / "run", "flights=100", "statistics.violation_upper=0.2")
    assert result.verdict.counts.done == 32
    assert result.all_met
    assert (
        result.lines[-1]
        == "stopped after 32 of 100 flights: the intervals are as narrow as demanded"
    )
    manifest = manifest_of(tmp_path / "run")
    assert manifest["flights_planned"] == 32
    assert (
        json.loads((tmp_path / "run" / "statistics.json").read_text(encoding="utf-8"))[
            "look_number"
        ]
        == 3
    )
    # The bound of the third look: 1 - (0.05/12)^(1/32) = 15.7 %, and not 8.94 %.
    assert bound_of(tmp_path / "run") == pytest.approx(
        1.0 - (0.05 / 12.0) ** (1.0 / 32.0), rel=1e-9
    )
    assert any(
        "; at most 15.7 % of flights sampled as these were, at 95 % confidence" in line
        for line in result.lines
    )
    # Once it has stopped there is nothing to go on with.
    flown = []
    again = run(
        tmp_path / "run",
        "flights=100",
        "statistics.violation_upper=0.2",
        resume=True,
        progress=lambda *p: flown.append(p),
    )
    assert again.verdict.counts.done == 32
    assert [p for p in flown if p[0] == "flying"] == [("flying", 32, 100)]
