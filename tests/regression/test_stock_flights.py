"""Aircraft that JSBSim brings fly the study: a jet trainer, and a light aircraft with more weight."""

import math

import pytest
from study_runs import AT_THE_SHIP, assert_flown_as_the_issue_asks, flown_once, fly_study

from scenarios.errors import InputError

pytestmark = pytest.mark.slow

# One of the issue's three speed ratios, for the suite's three minutes. All three were flown by all,
# the c172x and the c310, too; a flight of the 737 took up to 13 s and is left to the command line;
# its design is checked in tests/verification.
NU = 0.5
# Nine crossings of 30, as a crossing takes up to 65 s: what a panel of a comparison shows.
SHORT = ("flight.crossings=9",)
WITH_A_COMPARISON = 'comparison={ nu = [0.5], variants = [{ name = "no_preview", set = { "guidance.preview" = false } }] }'


@pytest.fixture(scope="module")
def t37(designs, tmp_path_factory):
    designs("T37")
    return fly_study(
        tmp_path_factory.mktemp("T37") / "run", "T37", *SHORT, WITH_A_COMPARISON, nus=(NU,)
    )


def test_a_jet_trainer_flies_the_sweep(t37):
    assert_flown_as_the_issue_asks(t37.rows[NU])


def test_a_light_aircraft_flies_the_sweep_and_its_rudder_keeps_it_from_slipping(
    heavy_design, tmp_path
):
    run = fly_study(
        tmp_path / "run", heavy_design.design.schedule.spec.folder, "flight.crossings=5"
    )
    ((nu, row),) = run.rows.items()
    assert_flown_as_the_issue_asks(row)
    # Turns are coordinated by the rudder. Measured once settled: 0.013 deg; asserted is four times
    # that, and a fortieth of what the Aerosonde slipped without its rudder.
    assert run.settled(nu)["sideslip_rad"].abs().max() < math.radians(0.05)
    # The X8's own 1.5 m of altitude, though it is given more; measured 0.2 m.
    assert row["altitude_error_max_m"] <= 1.5


def test_its_airspeeds_are_named_where_the_scenario_leaves_them(t37, tmp_path):
    # Found by trimming it: from 1.3 times its stall in the steepest turn, 58.7 m/s, to 1.6 times
    # that.
    with pytest.raises(
        InputError,
        match=r"airspeed_mps is 50; T37 flies 58\.7 to 93\.9 m/s: choose an airspeed in between",
    ):
        fly_study(tmp_path / "slow", "T37", *SHORT, "guidance.airspeed_mps=50.0")
    with pytest.raises(
        InputError,
        match=r"demands 45\.0 deg of bank; the autopilot of T37 stops at 35: lower guidance\.bank_deg",
    ):
        fly_study(tmp_path / "steep", "T37", *SHORT, "guidance.bank_deg=45.0")
    assert list(tmp_path.iterdir()) == []


def test_an_aircraft_that_pushes_over_to_a_glide_in_its_turn_away_keeps_out(designs, tmp_path):
    # A law flies a jet trainer at the ship, and its engines fail. As it pushes over it turns more
    # slowly, and came in by 4.2 m, as long as the guard did not allow for that.
    designs("T37")
    keys = {
        "aircraft": "T37", "vessel.speed_mps": 55, "start.distance_m": [7500, 9500], "start.aspect_deg": 180,
        "start.course_deg": 180, "reference.standoff_radius_m": 90000, "fault.kind": "engine", "fault.at_s": [52, 52],
        "flight.duration_max_s": 120, "flight.crossings": 0, "flight_seed": 1871587661,
    }  # fmt: skip
    row = flown_once(tmp_path / "run", "sea_wind", keys, *AT_THE_SHIP)
    assert row["guard_time_s"] > 1.0
    assert row["min_distance_m"] > row["keepout_radius_m"]
