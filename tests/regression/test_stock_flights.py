"""Aircraft that JSBSim brings fly the study: a jet trainer, and a light aircraft with more weight."""

import math

import pytest
from study_runs import AT_THE_SHIP, assert_flown_as_the_issue_asks, flown_once, fly_study

from scenarios.errors import InputError

pytestmark = pytest.mark.slow

# One of the issue's three speed ratios, and a few crossings of 30: one takes up to 65 s. The issue's
# were flown by hand, by the c172x, the c310 and the 737, too.


def test_a_jet_trainer_flies_the_sweep(designs, tmp_path):
    designs("T37")
    (row,) = fly_study(tmp_path / "run", "T37", "flight.crossings=5").rows.values()
    assert_flown_as_the_issue_asks(row)


@pytest.mark.parametrize(
    ("key", "words"),
    [
        # Found by trimming it: from 1.3 times its stall in the steepest turn to 1.6 times that.
        ("airspeed_mps=50.0", r"T37 flies 58\.7 to 93\.9 m/s: choose an airspeed in between"),
        ("bank_deg=45.0", r"45\.0 deg of bank; the autopilot of T37 stops at 35: lower guid"),
    ],
)
def test_what_it_cannot_fly_is_refused_with_its_limits(designs, tmp_path, key, words):
    designs("T37")
    with pytest.raises(InputError, match=words):
        fly_study(tmp_path / "run", "T37", f"guidance.{key}")
    assert list(tmp_path.iterdir()) == []


def test_a_light_aircraft_flies_the_sweep_and_its_rudder_keeps_it_from_slipping(
    heavy_design, tmp_path
):
    folder = heavy_design.design.schedule.spec.folder
    run = fly_study(tmp_path / "run", folder, "flight.crossings=5")
    ((nu, row),) = run.rows.items()
    assert_flown_as_the_issue_asks(row)
    # Turns are coordinated by the rudder. Measured once settled: 0.013 deg; asserted is four times
    # that, and a fortieth of what the Aerosonde slipped without its rudder.
    assert run.settled(nu)["sideslip_rad"].abs().max() < math.radians(0.05)
    # The X8's own 1.5 m of altitude, though it is given more; measured 0.2 m.
    assert row["altitude_error_max_m"] <= 1.5


def test_an_aircraft_that_pushes_over_to_a_glide_in_its_turn_away_keeps_out(designs, tmp_path):
    # A law flies a jet trainer at the ship, and its engines fail. As it pushes over it turns more
    # slowly, and came in by 4.2 m, as long as the guard did not allow for that.
    designs("T37")
    keys = {
        "aircraft": "T37", "vessel.speed_mps": 55, "start.distance_m": [7500, 9500], "start.aspect_deg": 180,
        "start.course_deg": 180, "reference.standoff_radius_m": 90000, "fault.kind": "engine", "fault.at_s": [52, 52],
        "flight.duration_max_s": 90, "flight.crossings": 0, "flight_seed": 1871587661,
    }  # fmt: skip
    row = flown_once(tmp_path / "run", "sea_wind", keys, *AT_THE_SHIP)
    assert row["guard_time_s"] > 1.0
    assert row["min_distance_m"] > row["keepout_radius_m"]
