"""The command from a CSV file to its directory, and what it prints and refuses."""

import hashlib
import json
import re
from pathlib import Path

import pandas as pd
import pytest
from logged_flights import flight_table, run
from scipy.stats import norm

from measurement.log.command import main

pytestmark = pytest.mark.slow


def recorded(logged, name="estimate.json"):
    return json.loads((logged.parent / "out" / name).read_text(encoding="utf-8"))


def test_a_flight_is_estimated_and_written(golden):
    record, manifest = golden.json("out/estimate.json"), golden.json("out/manifest.json")
    found = record["estimate"]
    assert found["low_percent"] < 0.3 < found["high_percent"]
    assert [row["elapsed_s"] for row in record["over_time"]] == [60.0]
    assert record["other"]["method"] == "areas"
    # The rule's suspect is from 0.13 % on.
    z = (0.13 - 0.10) / found["total_percent"]
    assert record["decision"]["false_alarm"] == pytest.approx(norm.sf(z), rel=1e-6)
    assert record["decision"]["suspect"] is True
    # Figures of measurement/sniffer/presets/electrochemical.toml, and of the calibration.
    stated, used = (record["instrument"][kind]["so2"] for kind in ("stated", "used"))
    assert (stated["noise"], used["noise"]) == (2.5, 2.5)
    assert stated["t90_s"] == used["t90_s"] == pytest.approx(20.0, abs=0.5)
    out = golden.log.parent / "out"
    assert sorted(path.name for path in out.iterdir()) == [
        "estimate.json",
        "manifest.json",
        "samples.csv",
    ]
    samples = pd.read_csv(out / "samples.csv")
    assert len(samples) == 121
    columns = {"co2_excess_ppm", "so2_excess_ppb", "fit_ppb", "residual_ppb"}
    assert columns | {"north_m", "height_m", "so2_true_ppb"} <= set(samples)
    assert manifest["study"] == "measurement"
    for name, path in (("source", golden.log), ("settings", out.parent / "instrument.toml")):
        assert manifest[name] == path.name
        assert manifest[f"{name}_hash"] == hashlib.sha256(path.read_bytes()).hexdigest()


def test_a_flight_is_printed(golden):
    for pattern in (
        r"fuel sulphur content 0\.\d{3} % m/m, 95 % interval 0\.\d{3} to 0\.\d{3} %\n",
        r"standard uncertainty \(1 sigma\) 0\.",
        r"above the limit of 0\.10 %; probability above it: more than 99\.9 %",
        r"below the limit of 0\.50 %",
        r"rule eca_0\.13 \(",
        r"calibration: SO2 of 2026-06-01",
        # 6 m/s north for two minutes, and 50 m to either side.
        r"ship: .* m to 0\.7 km from flight\.latitude_deg",
        r"stage II",
        r"a verdict screens, and certifies nothing",
        r"no limit on this gas",
    ):
        assert re.search(pattern, golden.printed), pattern
    assert not re.search(r"\bnan\b", golden.printed)


def test_a_record_without_a_verdict_prints_no_nan(logged, capsys):
    table = flight_table(rows=61)
    table["co2_ppm"] = 420.0
    table.to_csv(logged, index=False)
    assert run(logged) == 0
    printed = capsys.readouterr().out
    assert "fuel sulphur content: none can be given\n" in printed
    assert "no verdict on the limit of 0.10 %: quality C gives none" in printed
    assert not re.search(r"\bnan\b", printed)


def test_without_a_configuration_the_record_shows_the_instrument(logged):
    assert run(logged, config=False) == 0
    manifest, record = recorded(logged, "manifest.json"), recorded(logged)
    assert (manifest["settings"], manifest["settings_hash"]) == (None, None)
    assert record["decision"] is record["other"] is None
    # What is not stated is None, and what the record showed in its place is used.
    stated, used = (record["instrument"][kind]["so2"] for kind in ("stated", "used"))
    assert (stated["noise"], stated["t90_sd"]) == (None, None)
    assert used["noise"] > 0.0
    assert used["t90_s"] == record["estimate"]["so2_t90_s"] != stated["t90_s"]


@pytest.mark.parametrize(
    ("content", "config", "quoted"),
    [
        (None, "", "flight.csv': cannot be read"),
        ("time_s,so2_ppb,co2_ppm\n", None, "out.toml' cannot be read"),
        ("time_s,so2_ppb,co2_ppm\n", "[", "out.toml' is not TOML"),
        ("time_s,so2_ppb,co2_ppm\n1,2,420\n", "", "flight.csv': the record has 1 samples"),
    ],
)
def test_bad_input_is_refused_in_one_line_and_leaves_no_directory(
    tmp_path, capsys, content, config, quoted
):
    for name, text in (("flight.csv", content), ("out.toml", config)):
        if text is not None:
            (tmp_path / name).write_text(text, encoding="utf-8")
    files = ["flight.csv", "--config", "out.toml", "--out", "out"]
    arguments = [name if name.startswith("--") else str(tmp_path / name) for name in files]
    assert main([*arguments, "--no-report"]) == 2
    line = capsys.readouterr().err
    assert quoted in line
    assert line.count("\n") == 1
    assert line.count(str(tmp_path)) == 1
    assert not (tmp_path / "out").exists()


# The directory


@pytest.mark.parametrize("manifest", ['{"study": "flights", "state": "complete"}', "{", None])
def test_the_command_does_not_write_over_what_it_did_not_make(logged, capsys, manifest):
    flight_table(rows=61).to_csv(logged, index=False)
    out = logged.parent / "out"
    if manifest is None:
        out.write_text("in the way", encoding="utf-8")
    else:
        out.mkdir()
        (out / "manifest.json").write_text(manifest, encoding="utf-8")
    assert run(logged) == 2
    said = capsys.readouterr().err
    assert ("give another --out" if manifest is None else f"'{out}' holds another run") in said
    assert manifest is None or (out / "manifest.json").read_text(encoding="utf-8") == manifest


def test_two_logs_of_one_name_do_not_share_the_default_directory(
    logged, capsys, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    flight_table(rows=61).to_csv(logged, index=False)
    (tmp_path / "other").mkdir()
    other = tmp_path / "other" / logged.name
    flight_table(rows=71).to_csv(other, index=False)
    out = Path("runs") / f"measurement_{logged.stem}"
    assert run(logged, config=False, out=False) == 0
    before = (out / "manifest.json").read_bytes()
    assert run(other, config=False, out=False) == 2
    assert f"'{out}' holds the estimate of another log" in capsys.readouterr().err
    assert (out / "manifest.json").read_bytes() == before
    # The same log is estimated anew, without the reports of the older estimate.
    (out / "report.html").write_text("of the older estimate", encoding="utf-8")
    (out / "export").mkdir()
    assert run(logged, config=False, out=False) == 0
    assert not (out / "report.html").exists()
    assert not (out / "export").exists()
