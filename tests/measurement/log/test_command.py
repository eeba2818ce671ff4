"""The command from a CSV file to its directory, and what it prints and refuses."""

import hashlib
import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from logged_flights import run
from scipy.stats import norm

from measurement.log.command import main

pytestmark = pytest.mark.slow

BRIEFLY = pytest.mark.usefixtures("briefly")


def recorded(logged, name="estimate.json"):
    return json.loads((logged.parent / "out" / name).read_text(encoding="utf-8"))


def configured(logged, text):
    (logged.parent / "instrument.toml").write_text(text, encoding="utf-8")


def test_a_flight_is_estimated_printed_and_written(logged, capsys):
    assert run(logged) == 0
    printed = capsys.readouterr().out
    content = r"fuel sulphur content 0\.\d{3} % m/m, 95 % interval 0\.\d{3} to 0\.\d{3} %\n"
    assert re.search(content, printed)
    assert "standard uncertainty (1 sigma) 0." in printed
    assert "above the limit of 0.10 %; probability above it: more than 99.9 %" in printed
    assert "below the limit of 0.50 %" in printed
    assert recorded(logged, "manifest.json")["study"] == "measurement"
    record = recorded(logged)
    found = record["estimate"]
    assert found["low_percent"] < 0.3 < found["high_percent"]
    assert record["over_time"][-1]["elapsed_s"] == 300.0
    assert record["time_to_verdict_s"]["0.1"] <= 120.0
    assert record["other"]["method"] == "areas"
    samples = pd.read_csv(logged.parent / "out" / "samples.csv")
    assert len(samples) == 301
    columns = {"co2_excess_ppm", "so2_excess_ppb", "fit_ppb", "residual_ppb"}
    assert columns | {"north_m", "height_m", "so2_true_ppb"} <= set(samples)
    assert sorted(path.name for path in (logged.parent / "out").iterdir()) == [
        "estimate.json",
        "manifest.json",
        "samples.csv",
    ]


@BRIEFLY
def test_an_instrument_from_a_table_has_its_response_found(logged, capsys):
    configured(
        logged,
        "limits_percent = [0.2]\n[instrument]\ntitle = 'Mine'\n[instrument.channels.so2]\n"
        "cross = { no = 0.015, no2 = -0.16 }\n[instrument.channels.co2]\nt90_s = 4.0\nnoise = 1.0\n"
        "[instrument.channels.no]\n[instrument.channels.no2]\n",
    )
    assert run(logged) == 0
    assert "Mine" in capsys.readouterr().out
    record = recorded(logged)
    found = record["estimate"]
    assert [verdict["limit_percent"] for verdict in found["verdicts"]] == [0.2]
    assert record["other"] is None
    assert found["so2_t90_s"] == pytest.approx(20.0, abs=4.0)
    stated, used = (record["instrument"][kind]["so2"] for kind in ("stated", "used"))
    # What is not stated is None, and what the record showed in its place is used.
    assert (stated["noise"], stated["t90_sd"]) == (None, None)
    assert used["noise"] > 0.0
    assert used["t90_s"] == found["so2_t90_s"] != stated["t90_s"]


@BRIEFLY
def test_a_rule_decides_and_says_how_often_it_is_wrong(logged, capsys):
    configured(logged, 'instrument = "electrochemical"\nrule = "eca_0.15"\n')
    assert run(logged) == 0
    record = recorded(logged)
    decision, found = record["decision"], record["estimate"]
    z = (0.15 - 0.10) / found["total_percent"]
    assert decision["false_alarm"] == pytest.approx(norm.sf(z), rel=1e-6)
    assert decision["suspect"] == (found["fsc_percent"] >= 0.15)
    assert "rule eca_0.15 (" in capsys.readouterr().out
    configured(logged, 'instrument = "electrochemical"\n')
    assert run(logged) == 0
    assert recorded(logged)["decision"] is None


@BRIEFLY
def test_the_record_has_the_instrument_and_the_hashes_of_its_files(logged):
    assert run(logged) == 0
    instrument = recorded(logged)["instrument"]
    # Figures of measurement/sniffer/presets/electrochemical.toml.
    figures = {"t90_s": 20.0, "t90_sd": 0.05, "noise": 2.5}
    assert figures.items() <= instrument["stated"]["so2"].items()
    assert instrument["used"] == instrument["stated"]
    manifest = recorded(logged, "manifest.json")
    for name, path in (("source", logged), ("settings", logged.parent / "instrument.toml")):
        assert manifest[name] == path.name
        assert manifest[f"{name}_hash"] == hashlib.sha256(path.read_bytes()).hexdigest()
    assert run(logged, config=False) == 0
    manifest = recorded(logged, "manifest.json")
    assert (manifest["settings"], manifest["settings_hash"]) == (None, None)


@BRIEFLY
def test_a_missing_reading_leaves_a_verdict_and_saturation_does_not(logged, capsys):
    table = pd.read_csv(logged)
    table.loc[100, "so2_ppb"] = np.nan
    table.to_csv(logged, index=False)
    assert run(logged) == 0
    assert recorded(logged)["estimate"]["quality"] != "C"
    table.loc[20, "so2_ppb"] = 20000.0
    table.to_csv(logged, index=False)
    assert run(logged) == 0
    assert "SO2 is saturated at 20000 ppb" in capsys.readouterr().out
    assert recorded(logged)["estimate"]["quality"] == "C"


@BRIEFLY
def test_a_record_without_a_verdict_prints_no_nan(logged, capsys):
    table = pd.read_csv(logged)
    table["co2_ppm"] = 420.0
    table.to_csv(logged, index=False)
    assert run(logged, config=False) == 0
    printed = capsys.readouterr().out
    assert "fuel sulphur content: none can be given\n" in printed
    assert "no verdict on the limit of 0.10 %: quality C gives none" in printed
    assert not re.search(r"\bnan\b", printed)
    assert "CO2 reads the same throughout" in printed


@pytest.mark.parametrize(
    ("content", "config", "quoted"),
    [
        (None, "", "flight.csv': cannot be read"),
        ("time_s,so2_ppb,co2_ppm\n", None, "out.toml' cannot be read"),
        ("time_s,so2_ppb,co2_ppm\n", "[", "out.toml' is not TOML"),
        ("time_s,so2_ppb,co2_ppm\n", "", "flight.csv': "),
        ("time_s,so2_ppb,co2_ppm\n1,2,420\n", "", "flight.csv': the record has 1 samples"),
        (
            "time_s,so2_ppb,co2_ppm\n" + "".join(f"{t},2,4\n" for t in range(99)),
            "",
            "flight.csv': CO2 has a median of 4 ppm",
        ),
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


def test_a_directory_that_cannot_be_written_is_refused(logged, capsys):
    (logged.parent / "out").write_text("in the way", encoding="utf-8")
    assert run(logged) == 2
    assert "give another --out" in capsys.readouterr().err


@BRIEFLY
@pytest.mark.parametrize("manifest", ['{"study": "flights", "state": "complete"}', "{"])
def test_the_command_does_not_write_over_a_run_of_another_kind(logged, capsys, manifest):
    out = logged.parent / "out"
    out.mkdir()
    (out / "manifest.json").write_text(manifest, encoding="utf-8")
    assert run(logged) == 2
    assert f"'{out}' holds another run" in capsys.readouterr().err
    assert [path.name for path in out.iterdir()] == ["manifest.json"]
    assert (out / "manifest.json").read_text(encoding="utf-8") == manifest


@BRIEFLY
def test_two_logs_of_one_name_do_not_share_the_default_directory(
    logged, capsys, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "other").mkdir()
    other = tmp_path / "other" / logged.name
    pd.read_csv(logged).iloc[:200].to_csv(other, index=False)
    assert main([str(logged), "--no-report"]) == 0
    out = Path("runs") / f"measurement_{logged.stem}"
    before = (out / "manifest.json").read_bytes()
    assert main([str(other), "--no-report"]) == 2
    assert f"'{out}' holds the estimate of another log" in capsys.readouterr().err
    assert (out / "manifest.json").read_bytes() == before
    # The same log is estimated anew, and a directory that is given is replaced.
    assert main([str(logged), "--no-report"]) == 0
    assert main([str(other), "--out", str(out), "--no-report"]) == 0


@BRIEFLY
def test_a_new_estimate_leaves_no_report_of_the_older_one(logged):
    assert run(logged) == 0
    out = logged.parent / "out"
    for name in ("report.html", "report.pdf"):
        (out / name).write_text("of the older estimate", encoding="utf-8")
    (out / "export").mkdir()
    (out / "export" / "flight.kml").write_text("of the older estimate", encoding="utf-8")
    assert run(logged) == 0
    assert sorted(path.name for path in out.iterdir()) == [
        "estimate.json",
        "manifest.json",
        "samples.csv",
    ]
