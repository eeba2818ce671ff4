"""What is recorded of a design, and the command that makes one."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from innerloop.margins import loop_margins
from innerloop.record import design_record

PROJECT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def record(x8_schedule, x8_root):
    return design_record(x8_schedule, x8_root)


def test_the_record_is_json_without_nan_or_infinity(record):
    assert json.loads(json.dumps(record, allow_nan=False)) == record


def test_the_record_has_every_airspeed_and_every_loop(record, x8_schedule):
    assert record["airspeeds_mps"] == [14.0, 17.0, 20.0, 23.0, 26.0]
    assert len(record["margins"]) == 5 * 7  # three controls, three measurements, all controls at once
    expected = loop_margins(x8_schedule, 2)[0]
    found = next(m for m in record["margins"] if m["airspeed_mps"] == 20.0 and m["loop"] == expected.loop)
    assert found["gain_db"] == expected.gain_db
    assert next(m for m in record["margins"] if m["loop"] == "all controls")["gain_db"] is None


def test_the_record_has_each_step_predicted_and_flown_alike(record):
    pairs = {}
    for response in record["responses"]:
        pairs.setdefault(response["command"], {})[response["kind"]] = response
    assert set(pairs) == {"heading_rate", "airspeed", "altitude"}
    for command, pair in pairs.items():
        # At full size: tables and kinks add to what test_responses allows small steps, a tenth of the step in all.
        final = [response["channels"][command][-1] for response in pair.values()]
        assert final[0] == pytest.approx(final[1], abs=0.1 * abs(pair["flown"]["size"]))
        assert pair["flown"]["rise_time_s"] == pytest.approx(pair["predicted"]["rise_time_s"], rel=0.25)


def test_poles_are_recorded_in_conjugate_pairs_and_stable_when_closed(record):
    for poles in record["poles"]:
        assert all([re, -im] in poles["closed_loop"] for re, im in poles["closed_loop"])
        assert max(re for re, _ in poles["closed_loop"]) < 0.0


def test_designing_for_an_unknown_aircraft_ends_in_one_line_and_status_2():
    done = subprocess.run(
        [sys.executable, "-m", "innerloop.design", "x9"], cwd=PROJECT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == "error: unknown aircraft 'x9'; known: aerosonde, x8\n"
