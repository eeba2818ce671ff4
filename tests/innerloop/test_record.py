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
    level = x8_schedule.level(2)
    expected = Loops(
        x8_schedule.models[2][2],
        linear_controller(ControlLaw(x8_schedule), level),
        x8_schedule.delay,
    ).margins()[0]
    here = [m for m in record["margins"] if m["airspeed_mps"] == 20.0 and m["bank_rad"] == 0.0]
    loops = [
        "elevator",
        "aileron",
        "throttle",
        "airspeed",
        "altitude",
        "heading_rate",
        "all controls",
    ]
    assert [m["loop"] for m in here] == loops
    assert here[0]["gain_db"] == pytest.approx(expected.gain_db, rel=1e-12)
    # Six changed aircraft and one more period of delay at each point, each with its worst loops.
    assert len(record["robustness"]) == 75 * 7
    assert {row["stable"] for row in record["robustness"]} == {True}
    assert {row["case"] for row in record["robustness"] if row["periods_late"]} == {
        "one more period of delay"
    }
    assert record["required"] == {
        "gain_db": 6.0,
        "phase_deg": 45.0,
        "perturbed_gain_db": 4.0,
        "perturbed_phase_deg": 30.0,
    }


def test_the_record_has_each_step_predicted_and_flown_alike(record):
    pairs = {}
    for response in record["responses"]:
        if response["kind"] == "model":
            continue  # what the heading rate is made to follow
        pairs.setdefault(response["command"], {})[response["kind"]] = response
    assert set(pairs) == {"heading_rate", "airspeed", "altitude"}
    for command, pair in pairs.items():
        # At full size: tables and kinks add to what test_responses allows small steps, a tenth of
        # the step in all.
        final = [response["channels"][command][-1] for response in pair.values()]
        assert final[0] == pytest.approx(final[1], abs=0.1 * abs(pair["flown"]["size"]))
        # Of what a step should not move, that is of all but what it commands.
        assert (
            f"{command}_largest_mps" in pair["flown"],
            f"{command}_largest_m" in pair["flown"],
        ) == (False, False)
        assert "throttle" in pair["flown"]["channels"]
        assert pair["flown"]["rise_time_s"] == pytest.approx(
            pair["predicted"]["rise_time_s"], rel=0.25
        )


def test_poles_are_recorded_in_conjugate_pairs_and_stable_when_closed(record):
    # Of each of the 25 operating points.
    assert (
        len({(poles["airspeed_mps"], poles["bank_rad"]) for poles in record["poles"]})
        == len(record["poles"])
        == 25
    )
    for poles in record["poles"]:
        assert all([re, -im] in poles["closed_loop"] for re, im in poles["closed_loop"])
        assert max(re for re, _ in poles["closed_loop"]) < 0.0
