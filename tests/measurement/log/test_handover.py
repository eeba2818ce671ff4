"""The record to hand over: it fits its schema, loses nothing, and a changed figure is noticed."""

import copy
import hashlib
import json

import pandas as pd
import pytest
from logged_flights import run

from measurement.errors import MeasurementError
from measurement.log.handover import read_record, schema

pytestmark = pytest.mark.slow


def problems(record):
    # Here, as the tests of measurement are collected without the developers' tools.
    from jsonschema import Draft202012Validator

    Draft202012Validator.check_schema(schema())
    return [error.message for error in Draft202012Validator(schema()).iter_errors(record)]


def test_a_record_fits_its_schema_and_goes_round_without_loss(golden):
    record, estimate = golden.json("record.json"), golden.json("out/estimate.json")
    assert read_record(golden.log.parent / "record.json") == record
    assert problems(record) == []
    sulphur, nox = record["figures"][:2]
    # To the last bit.
    assert sulphur["value"] == estimate["estimate"]["fsc_percent"]
    assert sulphur["parts"]["noise"] == estimate["estimate"]["noise_percent"]
    assert nox["value"] == estimate["gases"][0]["value"]
    assert nox["verdicts"][0]["limit"] == 14.4
    total = sum(part**2 for part in nox["parts"].values()) ** 0.5
    assert total == pytest.approx(nox["standard_uncertainty"])
    assert record["ship"] == {"name": "Nordlys", "imo": 9074729, "mmsi": 219000000}
    assert record["time"]["first_utc"] == "2026-06-01T10:00:00Z"
    assert record["decision"]["rule"] == "eca_0.13"
    assert "screens, and certifies nothing" in record["scope"]


def test_a_record_has_the_hash_of_every_input(golden):
    record, folder = golden.json("record.json"), golden.log.parent
    files = {item["name"]: item["sha256"] for item in record["inputs"]}
    assert list(files) == [golden.log.name, "instrument.toml", "before.json"]
    files |= {item["path"]: item["sha256"] for item in record["pictures"]}
    for name, shown in files.items():
        assert shown == hashlib.sha256((folder / name).read_bytes()).hexdigest()
    [calibration] = record["calibrations"]
    assert calibration["sha256"] == golden.json("before.json")["sha256"]
    log = (folder / "zero.csv").read_bytes()
    assert calibration["log_sha256"] == hashlib.sha256(log).hexdigest()


def test_a_change_is_noticed_by_the_hash_that_is_documented(golden, tmp_path):
    record = golden.json("record.json")
    bare = {key: value for key, value in record.items() if key != "sha256"}
    text = json.dumps(bare, sort_keys=True, separators=(",", ":"))
    assert hashlib.sha256(text.encode()).hexdigest() == record["sha256"]
    path = tmp_path / "changed.json"
    # Another layout is no change.
    path.write_text(json.dumps(record, indent=7), encoding="utf-8")
    assert read_record(path) == record
    for change in (
        lambda of: of["figures"][0].update(value=0.09),
        lambda of: of["figures"][1]["verdicts"][0].update(verdict="below"),
        lambda of: of["inputs"].pop(),
    ):
        changed = copy.deepcopy(record)
        change(changed)
        path.write_text(json.dumps(changed), encoding="utf-8")
        with pytest.raises(MeasurementError, match="was changed after it was written"):
            read_record(path)


def test_the_schema_refuses_what_no_record_has(golden):
    for change in (
        lambda of: of["figures"][0].pop("standard_uncertainty"),
        lambda of: of["figures"][0].update(quality="D"),
        lambda of: of["figures"][0].update(quality="C", reasons=["a leak"]),  # with a verdict
        lambda of: of.update(version=2),
        lambda of: of["ship"].update(imo=1),
        lambda of: of["inputs"].clear(),
        lambda of: of["instrument"].update(sha256="0"),
        lambda of: of.update(more=1),
    ):
        changed = golden.json("record.json")
        changed["figures"][0]["verdicts"][0]["verdict"] = "above"
        change(changed)
        assert problems(changed)


def test_a_record_of_a_log_that_says_nothing_fits_the_schema_too(logged, capsys):
    table = pd.read_csv(logged)
    table["co2_ppm"] = 420.0  # no plume: nothing is known
    table[["time_s", "so2_ppb", "co2_ppm"]].to_csv(logged, index=False)
    path = logged.parent / "record.json"
    assert run(logged, "--record", str(path), config=False) == 0
    assert "CO2 reads the same throughout" in capsys.readouterr().out
    record = read_record(path)
    assert problems(record) == []
    assert record["figures"][0]["value"] is None
    assert record["figures"][0]["quality"] == "C"
    for words, message in (
        (["--record", "r.json", "--picture", "none.png"], "'none.png' cannot be read"),
        (["--picture", "none.png"], "give that, too"),
        (["--record", f"{path}/r.json"], "cannot be written"),
    ):
        assert run(logged, *words, config=False) == 2
        printed = capsys.readouterr().err
        assert message in printed
        assert printed.count("\n") == 1


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("[", "cannot be read"),
        ("{}", "is no record"),
        ('{"format": "plume-flight record", "version": 9}', "has version 9"),
        ('{"format": "plume-flight record", "version": 1}', "was changed"),
    ],
)
def test_a_file_that_is_no_record_is_refused_in_a_line(tmp_path, content, message):
    path = tmp_path / "record.json"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(MeasurementError, match=message) as caught:
        read_record(path)
    assert "\n" not in str(caught.value)
