"""What the report of a logged flight says of the flight itself: when, where, which ship, which log,
which instrument.
"""

import hashlib
import json
import shutil
from pathlib import Path

import pandas as pd
import pypdfium2
import pytest
from report_parts import blocks_of, built

from common.text import moment, span_words
from measurement.log.command import main
from reports.document.blocks import Table
from reports.document.provenance import provenance_section
from reports.measurement.data import position_words
from reports.registry import content
from reports.run.letterhead import letterhead
from reports.run.run_data import read_run

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).parents[3] / "docs" / "examples"

CONFIG = """instrument = "electrochemical"
missing = [-9999]
[flight]
vessel = "Nordlys"
imo = 9074729
mmsi = 219000000
date = 2026-06-01T23:58:00Z
place = "Kattegat, east of Anholt"
operator = "Agency"
"""


@pytest.fixture(scope="module")
def run_directory(tmp_path_factory):
    folder = tmp_path_factory.mktemp("evidence")
    (folder / "flight.toml").write_text(CONFIG, encoding="utf-8")
    given = [
        str(EXAMPLES / "example_flight.csv"),
        "--config",
        str(folder / "flight.toml"),
        "--out",
        str(folder / "out"),
    ]
    assert main([*given, "--no-report"]) == 0
    return folder / "out"


@pytest.fixture
def directory(run_directory, tmp_path):
    return shutil.copytree(run_directory, tmp_path / "run")


def facts(directory, **changes):
    """Return page 1's facts of a record of which entries of its flight are others."""
    path = directory / "estimate.json"
    record = json.loads(path.read_text(encoding="utf-8"))
    details = record["flight"]["details"] | changes.pop("details", {})
    record["flight"] |= changes | {"details": details}
    path.write_text(json.dumps(record), encoding="utf-8")
    return dict(content(read_run(directory)).facts)


def test_page_1_says_when_where_which_ship_by_whom_and_from_which_log(directory):
    told = facts(directory)
    # The log has 300 s; its file is the one whose hash sha256sum prints.
    assert (
        told["Time (UTC)"]
        == "2026-06-01 23:58:00 to 2026-06-02 00:03:00 UTC (start by the configuration; the log counts seconds)"
    )
    assert (
        told["Place"]
        == "Kattegat, east of Anholt (by the configuration); latitude and longitude are not in the log"
    )
    assert told["Ship"] == "Nordlys, IMO 9074729, MMSI 219000000 (by the configuration)"
    assert told["Operator"] == "Agency (by the configuration)"
    digest = hashlib.sha256((EXAMPLES / "example_flight.csv").read_bytes()).hexdigest()
    assert told["Log"] == f"example_flight.csv, 301 rows, SHA-256 {digest}"
    assert told["Program"].startswith("plume-flight-study ")
    assert told["Instrument"].startswith("Electrochemical SO2, NO and NO2 cells with NDIR CO2")


def test_what_neither_log_nor_configuration_says_is_told_to_be_missing(directory):
    nothing = {
        "vessel": "",
        "imo": None,
        "mmsi": None,
        "day": None,
        "start": None,
        "place": "",
        "operator": "",
    }
    told = facts(directory, first_utc=None, last_utc=None, utc_from="", details=nothing)
    assert (
        told["Time (UTC)"]
        == "not in the log, whose times are seconds, and not in the configuration"
    )
    assert told["Place"] == "latitude and longitude are not in the log"
    assert told["Ship"] == "not named in the configuration"
    assert "Operator" not in told
    told = facts(directory, details=nothing | {"day": "2026-06-01"})
    assert (
        told["Time (UTC)"]
        == "2026-06-01 (by the configuration); the time of day is not in the log, whose times are seconds"
    )


@pytest.mark.parametrize(
    ("offset", "words"),
    [(True, "by the log"), (False, "by the log, whose times have no offset: taken as UTC")],
)
def test_times_and_positions_of_the_log_are_told_as_those(directory, offset, words):
    times = {
        "first_utc": "2026-06-01T10:00:00Z",
        "last_utc": "2026-06-01T10:05:00.500Z",
        "utc_from": "log",
        "offset": offset,
    }
    told = facts(directory, **times, first_position=[56.7, 11.52], last_position=[-56.71, 348.0])
    assert told["Time (UTC)"] == f"2026-06-01 10:00:00 to 10:05:00 UTC ({words})"
    assert told["Place"].endswith(
        "from 56.70000° N, 11.52000° E to 56.71000° S, 12.00000° W (first and last of the log)"
    )


def test_the_date_of_the_analysis_is_not_taken_for_that_of_the_flight(directory):
    report = content(read_run(directory))
    assert report.letterhead.dated == f"analysed {report.letterhead.when}"
    (rows,) = (table.rows for table in blocks_of(report, Table, "provenance"))
    assert ["Analysed", report.letterhead.when] in rows


@pytest.mark.usefixtures("sketched")
def test_screen_and_page_1_of_print_have_every_fact(directory):
    told = facts(directory)
    text = built(directory)
    document = pypdfium2.PdfDocument(directory / "report.pdf")
    page = "".join(document[0].get_textpage().get_text_range().split())
    document.close()
    for name, value in told.items():
        assert "".join(f"{name}{value}".split()) in page
        assert f"<dt>{name}</dt>" in text


def rows_of(directory, number):
    return {
        row[0]: row[1:]
        for row in blocks_of(content(read_run(directory)), Table, "instrument")[number].rows
    }


def test_the_instrument_has_a_column_for_each_channel_with_every_property(directory):
    table = blocks_of(content(read_run(directory)), Table, "instrument")[0]
    assert table.head == ["Property", "SO2 [ppb]", "CO2 [ppm]", "NO [ppb]", "NO2 [ppb]"]
    rows = rows_of(directory, 0)
    # As measurement/sniffer/presets/electrochemical.toml: t90 of SO2 20 s known to 5 %, of CO2 4 s
    # known to 5 %.
    assert rows["Response time t90 ± 1σ [s]"][:2] == ["20 ± 1", "4 ± 0.2"]
    assert rows["Noise of a reading, 1σ"] == ["2.5", "1", "7", "7"]
    assert rows["Delay ± 1σ [s]"] == ["1 ± 0.3", "1 ± 0.1", "1 ± 0.3", "1 ± 0.3"]
    assert rows["Calibration: gain ± 1σ [-]"] == ["1 ± 0.03", "1 ± 0.02", "1 ± 0.05", "1 ± 0.05"]
    assert rows["Response to NO2 ± 1σ [per ppb]"] == ["−0.16 ± 0.032", "none", "none", "none"]
    assert rows["Range"][1] == "0 to 5000"
    assert rows["Column of the log"] == ["so2_ppb", "co2_ppm", "no_ppb", "no2_ppb"]


def test_what_the_record_showed_of_the_instrument_is_said_to_be_from_it(tmp_path):
    log = tmp_path / "flight.csv"
    pd.read_csv(EXAMPLES / "example_flight.csv").drop(columns=["no2_ppb"]).to_csv(log, index=False)
    assert main([str(log), "--out", str(tmp_path / "out"), "--no-report"]) == 0
    found = json.loads((tmp_path / "out" / "estimate.json").read_text(encoding="utf-8"))["estimate"]
    rows = rows_of(tmp_path / "out", 0)
    assert (
        rows["Response time t90 ± 1σ [s]"][0]
        == f"{found['so2_t90_s']:.1f} ± {found['so2_t90_sd_s']:.1f}, from the record"
    )
    assert rows["Delay ± 1σ [s]"][0].endswith("after CO2, from the record")
    assert rows["Noise of a reading, 1σ"][1].endswith(", from the record")
    assert rows["Column of the log"][3] == "none: not measured"
    told = rows_of(tmp_path / "out", 1)["NO and NO2"][0]
    assert "NO is measured, but SO2 not corrected for it, as its response is not stated" in told
    # Of a ship's NO2 over its CO2: measurement.gases.EXPECTED_PPB_PER_PPM.
    assert "NO2 is not measured: taken as 2 ± 1.2 ppb per ppm of CO2 (1σ)" in told


def test_places_and_times_are_told_the_same_everywhere():
    assert position_words(57.2, 11.3) == "57.20000° N, 11.30000° E"
    assert position_words(-0.00001, -179.99999) == "0.00001° S, 179.99999° W"
    at = moment("2026-06-01T12:00:00+02:00")
    assert span_words(at, at) == "2026-06-01 10:00:00 UTC"
    assert moment("soon") is None
    assert moment(float("nan")) is None


def test_what_the_configuration_leaves_out_of_its_instrument_is_marked_as_assumed(tmp_path):
    channels = "so2]\nt90_s = 18.0\ngain_sd = 0.04\ncross = { no = 0.015 }\n[instrument.channels.co2]\nt90_s = 3.0\nt90_sd = 0.1\n"
    (tmp_path / "own.toml").write_text(
        f"[instrument.channels.{channels}noise = 1.0\n", encoding="utf-8"
    )
    given = [
        str(EXAMPLES / "example_flight.csv"),
        "--config",
        str(tmp_path / "own.toml"),
        "--out",
        str(tmp_path / "out"),
    ]
    assert main([*given, "--no-report"]) == 0
    rows = rows_of(tmp_path / "out", 0)
    # What is assumed is that of measurement/sniffer/presets.py: 10 % of a t90, a gain of CO2 known
    # to 3 %, a fifth of a response.
    assert rows["Response time t90 ± 1σ [s]"] == ["18 ± 1.8, 1σ assumed", "3 ± 0.3"]
    assert rows["Calibration: gain ± 1σ [-]"] == ["1 ± 0.04", "1 ± 0.03, assumed"]
    assert rows["Response to NO ± 1σ [per ppb]"] == ["0.015 ± 0.003, 1σ assumed", "none"]
    assert rows["Noise of a reading, 1σ"][1] == "1"
    assert "marked as assumed" in rows_of(tmp_path / "out", 1)["Figures of the instrument"][0]


def test_a_preset_has_no_marks_as_its_source_says_what_is_assumed(directory):
    assert not any("assumed" in cell for cells in rows_of(directory, 0).values() for cell in cells)
    assert "Assumptions: " in rows_of(directory, 1)["Figures of the instrument"][0]


def test_the_provenance_says_of_which_file_each_hash_is_and_which_hash(directory):
    run = read_run(directory)
    rows = dict(provenance_section(run, letterhead(run, {})).blocks[0].rows)
    for what, path in (
        ("log", EXAMPLES / "example_flight.csv"),
        ("configuration", directory.parent / "flight.toml"),
    ):
        written = CONFIG.encode() if what == "configuration" else path.read_bytes()
        assert (
            rows[f"SHA-256 of the {what}"]
            == f"{hashlib.sha256(written).hexdigest()}, of the file {path.name}"
        )
    assert "Hash of the input" not in rows
