"""A patrol of two ships on the kinematic vehicle: served, recorded, repeated, and what is refused."""

import math

import numpy as np
import pandas as pd
import pytest

from extensions.patrol.ships import sampled_patrol
from extensions.patrol.study import PatrolWork
from extensions.patrol.tables import ship_row, wind_row
from scenarios.engine.processes import InProcessExecutor
from scenarios.engine.task import Task
from scenarios.experiment.requests import Experiment
from scenarios.planning.spreads import PredictedSpreads
from scenarios.scenario.files import load_study, with_values
from scenarios.studies.base import run_study
from scenarios.world.world import mean_wind, vessel_of
from tests.in_process import assert_refused, run_command
from tests.run_tables import rows_of

pytestmark = pytest.mark.slow

QUICK = (
    "fidelity=kinematic", "guidance.rate_hz=5", "flight.log_rate_hz=5", "flights=1", "patrol.ships=2",
    "patrol.area_m=8000", "patrol.endurance_s=1500", "patrol.separation_m=2000",
)  # fmt: skip


def patrol(*overrides):
    return load_study("patrol", [*QUICK, *overrides])


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    out = tmp_path_factory.mktemp("patrol") / "run"
    return run_study(patrol(), "patrol", out, executor_factory=InProcessExecutor), out


def test_both_ships_are_served_with_the_right_verdict_and_the_run_is_met(run):
    result, out = run
    (row,) = rows_of(out)
    counts = {"ships": 2, "served": 2, "correct": 2, "wrong": 0, "oracle_verdicts": 2}
    assert counts.items() <= row.items()
    assert row["kept_out"]
    assert row["keepout_violations"] == 0
    assert result.all_met
    ships = rows_of(out, "ships.csv")
    assert sorted(ship["position"] for ship in ships) == [0, 1]
    for ship in ships:
        # The catalog's limit between compliant fuel and the others.
        truth = "above" if ship["fsc_fuel_percent"] > 0.15 else "below"
        assert ship["verdict"] == ship["truth"] == truth
        # r_min of the keep-out sphere, by default.
        assert min(ship["min_distance_m"], ship["others_distance_min_m"]) > 200.0


def test_stretches_follow_each_other_in_time_and_place_and_fit_into_the_endurance(run):
    _, out = run
    phases = pd.read_csv(out / "phases.csv")
    assert phases["begins_s"].iloc[0] == 0.0
    for end, begin in (
        ("ends_s", "begins_s"),
        ("to_north_m", "from_north_m"),
        ("to_east_m", "from_east_m"),
    ):
        # Each stretch begins with the very sample that the one before it ends with; a flight at the
        # place that its start is turned into and back: rounding.
        assert np.allclose(phases[end].iloc[:-1], phases[begin].iloc[1:], rtol=0.0, atol=1e-6), end
    assert phases["ends_s"].iloc[-1] <= 1500.0
    assert set(phases["phase"]) == {"transit", "approach", "searching", "measuring", "leaving"}


def test_a_flight_begins_where_the_way_to_the_ship_ends(run):
    _, out = run
    phases = pd.read_csv(out / "phases.csv")
    for ship in rows_of(out, "ships.csv"):
        own = phases[phases["ship"] == ship["ship"]]
        leg = own[own["phase"] == "transit"].iloc[-1]
        course = math.radians(ship["vessel_course_deg"])
        way = ship["vessel_speed_mps"] * ship["reached_s"]
        north = ship["north_m"] + way * math.cos(course)
        east = ship["east_m"] + way * math.sin(course)
        # start.distance_m ends at 800 m; tables have all digits.
        distance = math.hypot(leg["to_north_m"] - north, leg["to_east_m"] - east)
        assert distance == pytest.approx(800.0, abs=1e-6)


def test_the_same_patrol_is_flown_again_to_the_last_bit_in_this_process_or_another(tmp_path):
    # Beside each ship until its patience is over, long before there is a verdict.
    short = patrol("patrol.patience_s=30")
    run_study(short, "patrol", tmp_path / "one")
    run_study(short, "patrol", tmp_path / "again", executor_factory=InProcessExecutor)
    assert all(ship["ended_s"] > 0.0 for ship in rows_of(tmp_path / "one", "ships.csv"))
    for name in ("ships.csv", "phases.csv"):
        assert (tmp_path / "again" / name).read_bytes() == (tmp_path / "one" / name).read_bytes()


def test_ships_stay_apart_in_one_wind_and_every_patrol_has_others():
    keys = "patrol.ships=6 patrol.area_m=40000 patrol.endurance_s=5400 patrol.separation_m=3000"
    scenario = patrol(*keys.split())
    first, second = (sampled_patrol("patrol", scenario, number) for number in (0, 1))
    assert first.movers != second.movers
    assert first == sampled_patrol("patrol", scenario, 0)
    winds = [ship.scenario.wind for ship in first.ships]
    assert len({(wind.speed_mps, wind.from_deg) for wind in winds}) == 1
    assert len({ship.scenario.flight_seed for ship in first.ships}) == 6
    for i, ship in enumerate(first.movers):
        # The range of the catalog's speed_ratio.
        assert 0.25 <= abs(ship.velocity - first.air.wind) / first.air.speed <= 0.9
        for other in first.movers[:i]:
            for time in range(0, 5401, 60):
                assert abs(ship.at(time) - other.at(time)) >= 3000.0


def test_ways_are_flown_in_the_wind_at_their_height_and_ships_have_the_speed_ratio_of_their_flights():
    scenario = patrol("wind.roughness_m=0.0002")
    found = sampled_patrol("patrol", scenario, 0)
    given = found.ships[0].scenario.wind
    # V(z) = V(10 m) ln(z/z0)/ln(10 m/z0), at the 60 m of the catalog's flights.
    expected = given.speed_mps * math.log(60.0 / 2e-4) / math.log(10.0 / 2e-4)
    assert abs(found.air.wind) == pytest.approx(expected, rel=1e-12)
    assert wind_row(found) == {"wind_speed_mps": given.speed_mps, "wind_from_deg": given.from_deg}
    for i, ship in enumerate(found.ships):
        # By the wind at the funnel's mouth, as of any flight.
        flown = mean_wind(ship.scenario, vessel_of(ship.scenario)).now(
            0.0, ship.scenario.source_height
        )
        nu = abs(ship.mover.velocity - complex(*flown)) / found.air.speed
        assert ship_row(found, i, 0.15)["nu"] == pytest.approx(nu, rel=1e-12)


def test_a_patrol_that_fails_is_a_row_with_its_reason():
    # Two ships that are to stay farther apart than the square is wide, found when the patrol is
    # flown.
    scenario = with_values(patrol(), {"patrol.separation_m": 20_000.0})
    work = PatrolWork(
        experiments=(Experiment("patrol", scenario),),
        histories=1,
        setup=None,
        spreads=PredictedSpreads(),
    )
    (row,) = work.run(Task(number=0)).tables["summary.csv"]
    assert (row["outcome"], row["criteria_met"]) == ("failed", False)
    assert row["message"].startswith("patrol.separation_m is 20000 m")


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("patrol.separation_m=9000", ("patrol.separation_m is 9000 m", "patrol.area_m")),
        ("flight.until=flown", ("flight.until is 'flown'", "'verdict'")),
        ("vessel.manoeuvres=[{at_s=20.0,turn_deg=30.0}]", ("vessel.manoeuvres",)),
        (
            "patrol.clearance_m=700",
            ("are 900 m together, more than start.distance_m, whose end is 800 m",),
        ),
        (
            "criteria.required=keep_out",
            ("'criteria.required' has no effect here", "judged by patrol.oracle_share_min and"),
        ),
        (
            "histories=4",
            ("'histories' has no effect here", "a patrol keeps no time histories: leave it out"),
        ),
    ],
)
def test_what_is_no_patrol_is_refused_in_one_line(override, words, tmp_path):
    overrides = [part for given in (*QUICK, override) for part in ("--set", given)]
    assert_refused(
        run_command(
            "scenarios.run", "patrol", *overrides, "--out", tmp_path / "run", "--no-report"
        ),
        *words,
    )


def test_flights_of_a_patrol_know_the_plume_as_the_scenario_says_and_those_of_the_oracle_are_told(
    monkeypatch, tmp_path
):
    known = []

    def recorded(scenario, values):
        flown = with_values(scenario, values)
        known.append(flown.following.plume)
        return flown

    monkeypatch.setattr("extensions.patrol.study.with_values", recorded)
    one = patrol("patrol.ships=1", "following.plume=predicted")
    run_study(one, "patrol", tmp_path / "run", executor_factory=InProcessExecutor)
    assert known == ["predicted", "told"]
