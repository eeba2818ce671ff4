"""Monte Carlo and comparisons from their file to their run directory, kinematic and short."""

import json

import numpy as np
import pandas as pd
import pytest
from flight_cases import run_here

from scenarios.engine.runner import ExecutorFactory
from tests.run_tables import manifest_of, rows_of

pytestmark = pytest.mark.slow


SHORT = [
    "fidelity=kinematic", "turbulence.level=none", "turbulence.gusts=0",
    "turbulence.gust_speed_mps=0",
    # Too short to settle.
    "flight.duration_max_s=3.0", "flight.log_rate_hz=5", "guidance.rate_hz=5",
    "criteria.required=keep_out", "histories=5",
    # All within the range, so that every flight is at its point; vessels at 2 m/s and more make an
    # apparent wind.
    "speed_ratio=[0.0, 5.0]", "wind.speed_mps=0.5",
]  # fmt: skip


def run(out, *overrides, **how):
    return run_here("monte_carlo", out, *SHORT, *overrides, **how)


def statistics_of(out):
    return json.loads((out / "statistics.json").read_text(encoding="utf-8"))


def tables(out):
    names = ("summary.csv", "draws.csv")
    found = [pd.read_csv(out / name) for name in names]
    return [table.drop(columns="wall_time_s", errors="ignore") for table in found]


def test_flights_are_at_the_points_of_a_sobol_sequence_for_any_number_of_processes(tmp_path):
    out = tmp_path / "run"
    assert (
        run(out, "flights=40", executor_factory=ExecutorFactory(jobs=2)).verdict.counts.done == 40
    )
    summary, draws = tables(out)
    assert list(draws["flight_id"]) == list(summary["flight_id"])
    # A Sobol sequence has one of 32 points in each 32nd of a range.
    aspect = draws["start.aspect_deg"].to_numpy()
    assert np.histogram(aspect[:32], bins=32, range=(-180.0, 180.0))[0].tolist() == [1] * 32
    assert summary["wind_from_deg"].equals(draws["wind.from_deg"])
    assert summary["start_aspect_deg"].to_numpy() == pytest.approx(aspect, abs=1e-9)
    measured = statistics_of(out)["violation"]["measured"]
    # Clopper and Pearson's one-sided bound of 0 of n: 1 - (1 - confidence)^(1/n).
    bound = pytest.approx(1.0 - 0.05 ** (1.0 / 40.0), rel=1e-9)
    assert (measured["events"], measured["flights"], measured["upper"]) == (0, 40, bound)
    run(tmp_path / "fewer", "flights=16")
    for one, other in zip(tables(out), tables(tmp_path / "fewer"), strict=True):
        pd.testing.assert_frame_equal(one[:16], other, check_exact=True)


def test_a_study_stops_by_itself_where_the_interval_is_as_tight_as_demanded(tmp_path, monkeypatch):
    # Looks after 8, 16, 32 flights and so on: 256 would take too long here.
    monkeypatch.setattr("scenarios.statistics.estimates.FIRST_LOOK", 8)
    # 0 of n at the confidence of look k: 1 - (0.05/(k (k + 1)))^(1/n) is 0.37, 0.26, 0.15 at 8, 16,
    # 32.
    out, keys, reports = tmp_path / "run", ("flights=100", "statistics.violation_upper=0.2"), []
    result = run(out, *keys)
    assert (result.verdict.counts.done, result.all_met) == (32, True)
    assert result.lines[-1].startswith("stopped after 32 of 100 flights")
    assert manifest_of(out)["flights_planned"] == 32
    found = statistics_of(out)
    assert found["look_number"] == 3
    # The bound of the third look: 1 - (0.05/12)^(1/32) = 15.7 %, and not 8.94 %.
    upper = 1.0 - (0.05 / 12.0) ** (1.0 / 32.0)
    assert found["violation"]["pessimistic"]["upper"] == pytest.approx(upper, rel=1e-9)
    # Once it has stopped nothing is left to fly.
    again = run(out, *keys, resume=True, progress=lambda *report: reports.append(report))
    assert again.verdict.counts.done == 32
    assert [report for report in reports if report[0] == "flying"] == [("flying", 32, 100)]


SLOW_STEPS = ("fidelity=kinematic", "guidance.rate_hz=5", "flight.log_rate_hz=5")
BOTH_LAWS = '[{name="line_of_sight", set={"guidance.law"="line_of_sight"}}, {name="lyapunov", set={"guidance.law"="lyapunov"}}]'


def flown(out, name, *overrides, **beside):
    """Fly a study; return its result, its flights and those of its comparison."""
    result = run_here(name, out, *overrides, **beside)
    return result, rows_of(out), rows_of(out, "comparison.csv")


def test_operational_scenarios_are_compared_with_variants_of_the_same_seeds(tmp_path):
    keys = ["flights=2", f"comparison.variants={BOTH_LAWS}", "comparison.flights=1"]
    reports, given = [], ("sea_wind", *SLOW_STEPS, "flight.crossings=1", *keys)
    _, rows, variants = flown(
        tmp_path / "run", *given, progress=lambda *report: reports.append(report)
    )
    assert reports[1:] == [("flying", done, 4) for done in range(5)]
    for row in rows:
        assert (row["outcome"], row["keepout_violations"]) == ("completed", 0), row["message"]
    assert [row["variant"] for row in rows] == ["study"] * 2
    assert [row["variant"] for row in variants] == ["line_of_sight", "lyapunov"]
    same = ["seed", "nu", "wind_speed_mps", "vessel_speed_mps", "start_distance_m"]
    row = rows[0]
    for variant in variants:
        assert [variant[name] for name in same] == [row[name] for name in same]
        assert variant["flight_id"] == variant["variant"]
        assert variant["beside"] == row["flight_id"]
    assert manifest_of(tmp_path / "run")["flights_planned"] == 2
    result, *_ = flown(tmp_path / "run", *given, resume=True)
    lines = [line for line in result.lines if "comparison" in line]
    assert lines[0].startswith("  comparison line_of_sight, not counted above: 1 planned, 1 flown")


def test_monte_carlo_compares_steering_laws_at_the_same_points(tmp_path):
    sampled = ("turbulence={}", "flights=4", "flight.duration_max_s=10", "histories=0")
    draws = 'draws=[{key="wind.speed_mps", uniform=[0, 5]}]'
    keys = (*SLOW_STEPS, *sampled, draws, f"comparison.variants={BOTH_LAWS}")
    _, rows, variants = flown(tmp_path / "run", "monte_carlo", *keys)
    assert len(rows) == 4
    points = [(row["seed"], row["wind_speed_mps"]) for row in rows]
    for name in ("line_of_sight", "lyapunov"):
        of_variant = [row for row in variants if row["variant"] == name]
        assert [(row["seed"], row["wind_speed_mps"]) for row in of_variant] == points
    drawn = {row["variant"] for row in rows_of(tmp_path / "run", "draws.csv")}
    assert drawn == {"study", "line_of_sight", "lyapunov"}
