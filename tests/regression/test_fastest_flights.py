"""Flights whose reference is the fastest oscillation (docs/fastest_oscillation.md)."""

import pytest

from tests.regression.study_runs import assert_flown_as_the_issue_asks, fly_study

pytestmark = pytest.mark.slow

FASTEST = "reference.shape=fastest"


def test_the_sweep_keeps_to_its_criteria_and_crosses_more_often_than_the_sinusoid(tmp_path):
    rows = fly_study(tmp_path / "fastest", "x8", FASTEST, "flight.crossings=5", nus=(0.1, 0.5)).rows
    for row in rows.values():
        # The issue: rms <= 1.5 m, interval within 1 % of its own prediction, no keep-out violation.
        assert_flown_as_the_issue_asks(row)
        # Measured: within 0.03 % of it.
        assert row["crossing_interval_mean_s"] == pytest.approx(
            row["crossing_interval_predicted_s"], rel=2e-3
        )
    # The issue: <= 7.95 s at nu = 0.5, where the sinusoid takes 9.61 s; 11.57 s at 0.1, rounded,
    # where it takes 14.01 s.
    assert rows[0.5]["crossing_interval_mean_s"] <= 7.95
    assert rows[0.1]["crossing_interval_mean_s"] == pytest.approx(11.57, abs=0.03)


def test_in_wind_a_slow_orbit_that_spends_all_of_the_heading_rate_is_joined_and_kept(tmp_path):
    run = fly_study(
        tmp_path / "run",
        "x8",
        FASTEST,
        "wind.speed_mps=2",
        "wind.from_deg=40",
        "flight.crossings=6",
        nus=(0.2,),
    )
    ((nu, row),) = run.rows.items()
    assert row["outcome"] == "completed", row["message"]
    assert row["keepout_violations"] == 0
    # The criterion of sea_wind is 2 %; steering takes 0.5 % of the frequency.
    assert row["crossing_interval_mean_s"] == pytest.approx(
        row["crossing_interval_predicted_s"], rel=0.01
    )
    history = run.history(nu)
    rate = history["reference_heading_rate_rad_s"].abs()
    before = history["time_s"] < row["settling_time_s"]
    # 0.8 of 0.985 omega_max until it is tracked, then all of it.
    assert rate[before].quantile(0.5) < 0.82 * row["heading_rate_limit_rad_s"]
    assert rate[~before].max() == pytest.approx(0.985 * row["heading_rate_limit_rad_s"], rel=1e-3)


def test_a_start_abeam_of_a_slow_ship_joins_an_orbit_that_spends_all_of_the_heading_rate(tmp_path):
    # One of 7 of 48 flights that never settled where the reference takes all of it from the first
    # (docs/fastest_oscillation.md).
    words = ["start.place_m=[260.07,495.12]", "start.course_deg=-59.87", "flight.crossings=6"]
    (row,) = fly_study(tmp_path / "run", "x8", FASTEST, *words, nus=(0.1016,)).rows.values()
    assert_flown_as_the_issue_asks(row)


def test_beside_a_slow_vessel_the_loiter_crosses_more_often_than_any_oscillation(tmp_path):
    row = fly_study(
        tmp_path / "run", "x8", "reference.shape=loiter", "flight.crossings=8", nus=(0.1,)
    ).rows[0.1]
    assert_flown_as_the_issue_asks(row)
    # pi/(omega_max (1 - nu)) = 6.913 s, and 1.5 % of reserve; the fastest oscillation takes 11.58
    # s.
    assert row["crossing_interval_mean_s"] == pytest.approx(7.02, abs=0.03)
