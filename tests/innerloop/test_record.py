"""What is recorded of a design, and the command that makes one."""

import json

import pytest

from innerloop.law import ControlLaw, linear_controller
from innerloop.margins import Loops


@pytest.fixture(scope="module")
def record(designs):
    return designs("x8").record


def test_the_record_is_json_without_nan_or_infinity(record):
    assert json.loads(json.dumps(record, allow_nan=False)) == record


def test_the_record_has_every_operating_point_and_every_loop(record, x8_schedule):
    assert record["airspeeds_mps"] == [15.0, 17.5, 20.0, 22.5, 25.0]
    # 25 points and 40 between; three controls, three measurements, and at the points all controls
    # at once.
    assert len(record["margins"]) == 75 * 6 + 25
    autopilot = linear_controller(ControlLaw(x8_schedule), x8_schedule.level(2))
    loops = Loops(x8_schedule.models[2][2], autopilot, x8_schedule.delay)
    here = [m for m in record["margins"] if m["airspeed_mps"] == 20.0 and m["bank_rad"] == 0.0]
    assert [m["loop"] for m in here] == [*loops.breaks, "all controls"]
    assert here[0]["gain_db"] == pytest.approx(loops.margins()[0].gain_db, rel=1e-12)
    # Six changed aircraft and one more period of delay at each point, each with its worst loops.
    assert len(record["robustness"]) == 75 * 7
    assert {row["stable"] for row in record["robustness"]} == {True}


def test_poles_are_recorded_in_conjugate_pairs_and_stable_when_closed(record):
    assert len({(poles["airspeed_mps"], poles["bank_rad"]) for poles in record["poles"]}) == 25
    for poles in record["poles"]:
        assert all([re, -im] in poles["closed_loop"] for re, im in poles["closed_loop"])
        assert max(re for re, _ in poles["closed_loop"]) < 0.0
