"""Whole flights of the X8 in JSBSim: the numbers that the study stands on."""

import math

import numpy as np
import pandas as pd
import pytest

from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.task import Task
from scenarios.scenario.files import load_study
from scenarios.studies.base import FlightStudy
from tests.run_tables import history_in

pytestmark = pytest.mark.slow

SPEED = 19.42


@pytest.fixture
def fly(tmp_path):
    def run(*overrides, nu=0.5, scenario="sweep_nu"):
        settings = load_study(scenario, [f"sweep.nu=[{nu}]", "comparison.variants=[]", *overrides])
        study = FlightStudy(settings, scenario, {scenario: settings})
        result = study.work(RunDirectory(tmp_path)).run(Task(number=0))
        (row,) = result.tables["summary.csv"]
        return row, history_in(result)

    return run


@pytest.mark.parametrize(
    ("nu", "crossings"), [(0.0, 6), (0.1, 6), (0.3, 6), (0.5, 30), (0.7, 6), (0.95, 16)]
)
def test_crossings_stay_outside_r_min_and_nothing_ever_enters_it(fly, nu, crossings):
    # One flight has the study's 30 crossings; those of the others are as good from the first to the
    # sixth, but for the fastest vessel's, whose first crossings have the rest of the way onto the
    # orbit in their error.
    row, _ = fly(f"flight.crossings={crossings}", nu=nu)
    assert row["outcome"] == "completed"
    assert row["crossing_count"] >= crossings
    # Issue: crossing distance >= r_min at every crossing, no keep-out violation over the whole
    # flight.
    assert row["crossing_distance_min_m"] >= 200.0
    assert row["keepout_violations"] == 0
    assert row["min_distance_m"] >= 200.0
    # Issue: interval within 1 % of pi/omega_0, tracking rms <= 1.5 m, airspeed rms <= 0.3 m/s,
    # altitude <= 1.5 m, and no command above omega_max.
    assert row["crossing_interval_mean_s"] == pytest.approx(
        row["crossing_interval_predicted_s"], rel=0.01
    )
    assert row["tracking_error_rms_m"] <= 1.5
    assert row["airspeed_error_rms_mps"] <= 0.3
    assert row["altitude_error_max_m"] <= 1.5
    assert row["heading_rate_command_max_rad_s"] <= 9.80665 / SPEED
    assert row["criteria_met"]
    if nu == 0.5:
        assert_the_papers_two_numbers(row)


def assert_the_papers_two_numbers(row):
    # Paper, Simulation 3: a crossing every 9.5 s at 214 m, r_min = 200 m. Issue: each within 2 %.
    assert row["crossing_interval_mean_s"] == pytest.approx(9.5, rel=0.02)
    assert row["crossing_distance_mean_m"] == pytest.approx(214.0, rel=0.02)


def test_the_law_alone_flies_into_the_keep_out_area_where_the_guard_does_not(fly):
    # The sweep's own start at nu = 0.15, tracked from the first step on as the paper does: 10 m
    # inside without the guard.
    without, _ = fly(
        "guidance.approach=false", "guidance.keepout_guard=false", "flight.crossings=3", nu=0.15
    )
    assert without["keepout_violations"] > 0
    assert "guard_interventions" not in without
    guarded, history = fly("guidance.approach=false", "flight.crossings=3", nu=0.15)
    assert guarded["keepout_violations"] == 0
    assert guarded["guard_interventions"] > 0
    # Recorded at half the rate of the guidance.
    shown = history["guard"] > 0.0
    assert guarded["guard_time_s"] == pytest.approx(
        0.1 * shown.sum(), abs=0.1 * guarded["guard_interventions"]
    )
    # On the way to the orbit, never on it.
    assert history["time_s"][shown].max() < guarded["settling_time_s"]


@pytest.mark.parametrize("nu", [0.0, 0.8])
def test_a_flight_that_needs_no_guard_flies_the_same_without_one_to_the_last_bit(fly, nu):
    # Beside a faster ship the orbit lies farther out for a guard.
    row, guarded = fly("flight.duration_max_s=90", nu=nu)
    assert row["guard_interventions"] == 0
    _, alone = fly("flight.duration_max_s=90", "guidance.keepout_guard=false", nu=nu)
    # A guard's record has what it believes beside what both fly.
    assert set(alone.columns) < set(guarded.columns)
    pd.testing.assert_frame_equal(guarded[alone.columns], alone, check_exact=True)


@pytest.mark.parametrize(
    ("seed", "nu", "approach", "duration"),
    [
        (1, 0.0, "true", 60),
        (1, 0.0, "false", 250),
        (10, 0.9, "false", 250),
        (7, 0.75, "false", 250),
    ],
)
def test_from_anywhere_about_the_ship_nothing_enters(fly, seed, nu, approach, duration):
    # Starts from which the law alone, or a guard that takes the lag of slow commands for that of a
    # reversal, got 3 to 7 m in.
    words = [
        "start.spread_deg=180",
        f"seed={seed}",
        f"flight.duration_max_s={duration}",
        f"guidance.approach={approach}",
    ]
    row, _ = fly(*words, nu=nu)
    assert row["keepout_violations"] == 0
    # The paper's tracking needs the guard from each of them, the way round the vessel from none.
    assert (row["guard_interventions"] > 0) == (approach == "false")


def test_law_and_guard_do_not_hold_each_other_beside_a_fast_ship(fly):
    # The law turned parallel to the ship 3 m outside, and the way to the orbit led through the
    # course to the ship: for 58.5 s.
    row, _ = fly("start.spread_deg=180", "seed=5", "flight.crossings=2", nu=0.9)
    assert row["keepout_violations"] == 0
    assert 0.0 < row["guard_time_s"] < 5.0
    assert row["settling_time_s"] < 90.0


def test_starting_ahead_of_the_vessel_without_an_approach_the_guard_keeps_out_and_it_gets_round(
    fly,
):
    # With an approach it goes round by itself, and the guard has nothing to do.
    words = [
        "start.course_deg=30",
        "start.spread_deg=180",
        "start.distance_m=[300, 500]",
        "guidance.approach=false",
    ]
    row, _ = fly(*words, "seed=4", "flight.crossings=1", nu=0.3)
    assert abs(row["start_aspect_deg"]) > 90.0
    assert row["outcome"] == "completed"
    assert row["keepout_violations"] == 0
    assert row["guard_interventions"] > 0


def test_preview_and_airspeed_trim_each_take_away_error(fly):
    def steady_error(*overrides):
        _, history = fly("flight.crossings=9", *overrides)
        late = history[history["time_s"] > history["time_s"].iloc[-1] - 60.0]
        off = np.hypot(
            late["reference_north_m"] - late["north_m"], late["reference_east_m"] - late["east_m"]
        )
        return math.sqrt(float(np.mean(off**2)))

    both = steady_error()
    no_trim = steady_error("guidance.airspeed_trim=false")
    no_preview = steady_error("guidance.preview=false")
    neither = steady_error("guidance.preview=false", "guidance.airspeed_trim=false")
    # Measured 0.15, 0.24, 1.7 and 2.3 m; asserted is the order with room for another machine's
    # rounding.
    assert both < no_trim < no_preview < neither
    assert both < 0.5
