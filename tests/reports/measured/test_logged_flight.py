"""The report of a logged flight: its verdict, its figures, and what it says of the flight, of the
instrument, of holes in the log and of other gases.
"""

import copy
import hashlib
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pypdfium2
import pytest
from report_parts import (
    assert_axes_read_quantity_and_unit,
    blocks_of,
    built,
    named_charts,
    numbers_on_page_1,
)
from snapshots import assert_reads_as_before

from measurement.log.command import main
from reports.document.blocks import Card, Table
from reports.document.provenance import provenance_section
from reports.errors import ReportError
from reports.measurement.charts import regression_chart
from reports.measurement.content import gas_sections, samples_chart, stage_chart
from reports.measurement.instrument_tables import instrument_table
from reports.measurement.verdict import measurement_verdict
from reports.registry import content
from reports.run.letterhead import letterhead
from reports.run.run_data import read_run

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).parents[3] / "docs" / "examples"

FULL = """instrument = "electrochemical"
missing = [-9999]
[flight]
vessel = "Nordlys"
imo = 9074729
mmsi = 219000000
date = 2026-06-01T23:58:00Z
place = "Kattegat, east of Anholt"
operator = "Agency"
[engine]
keel_laid = 2022-05-01
rated_rpm = 120
control_area = "north_sea"
design_speed_mps = 13.0
speed_mps = 12.0
"""

OWN = """[instrument.channels.so2]
t90_s = 18.0
gain_sd = 0.04
cross = { no = 0.015 }
[instrument.channels.co2]
t90_s = 3.0
t90_sd = 0.1
noise = 1.0
"""


def estimated(folder, table, config):
    """Estimate a log with a configuration; return the directory of the run."""
    table.to_csv(folder / "flight.csv", index=False)
    (folder / "flight.toml").write_text(config, encoding="utf-8")
    given = ["--config", str(folder / "flight.toml"), "--out", str(folder / "out"), "--no-report"]
    assert main([str(folder / "flight.csv"), *given]) == 0
    return folder / "out"


def example():
    return pd.read_csv(EXAMPLES / "example_flight.csv")


def record_of(directory):
    return json.loads((directory / "estimate.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def run_directory(tmp_path_factory):
    config = (EXAMPLES / "example_instrument.toml").read_text(encoding="utf-8")
    return estimated(tmp_path_factory.mktemp("whole"), example(), config)


@pytest.fixture
def record(run_directory):
    return record_of(run_directory)


@pytest.fixture(scope="module")
def report(run_directory):
    return content(read_run(run_directory))


@pytest.fixture(scope="module")
def full_directory(tmp_path_factory):
    """A log with CH4 whose configuration names ship, engine, place and time."""
    table = example()
    excess = table["co2_ppm"] - table["co2_ppm"].quantile(0.05)
    noise = 0.004 * np.random.default_rng(1).standard_normal(len(table))
    table["ch4_ppm"] = (1.95 + 0.07 * excess + noise).round(4)
    return estimated(tmp_path_factory.mktemp("full"), table, FULL)


@pytest.fixture(scope="module")
def full(full_directory):
    return record_of(full_directory)


@pytest.fixture(scope="module")
def holed(tmp_path_factory):
    """A log of SO2 and CO2 without a row, with a gap, and without CO2 at 50 s, for 3 s after 219 s
    and for 4 s after 227 s: none of the 6 readings between the last two, from 222 s on, is used.
    """
    table = example().drop(columns=["no_ppb", "no2_ppb"])
    table.loc[[50, 220, 221, 228, 229, 230], "co2_ppm"] = np.nan
    table = table.drop(index=[100, *range(150, 170)])
    return read_run(estimated(tmp_path_factory.mktemp("holed"), table, OWN))


def changed_run(directory, tmp_path, record=None, samples=True):
    """Return a copy of the directory with another record, or without samples."""
    for name in ("manifest.json", "estimate.json", *(["samples.csv"] if samples else [])):
        (tmp_path / name).write_bytes((directory / name).read_bytes())
    if record is not None:
        (tmp_path / "estimate.json").write_text(json.dumps(record), encoding="utf-8")
    return tmp_path


def test_the_report_of_a_flight_reads_as_before(report):
    assert_reads_as_before("estimate", report)


@pytest.mark.usefixtures("sketched")
def test_both_reports_are_built_and_page_1_of_print_has_every_fact(full_directory, tmp_path):
    directory = shutil.copytree(full_directory, tmp_path / "run")
    text = built(directory)
    document = pypdfium2.PdfDocument(directory / "report.pdf")
    page = "".join(document[0].get_textpage().get_text_range().split())
    document.close()
    for name, value in content(read_run(directory)).facts:
        assert "".join(f"{name}{value}".split()) in page
        assert f"<dt>{name}</dt>" in text


def test_every_number_on_page_1_is_that_of_the_estimate(run_directory, record, tmp_path):
    found, figures = record["estimate"], record["estimate"]["figures"]
    known = {
        *(
            f"{found[name]:.3f}"
            for name in ("fsc_percent", "low_percent", "high_percent", "total_percent")
        ),
        *(f"{of['limit_percent']:.2f}" for of in found["verdicts"]),
        *(f"{100.0 * of['probability_above']:.1f}" for of in found["verdicts"]),
        *(f"{seconds:.0f}" for seconds in record["time_to_verdict_s"].values() if seconds),
        f"{figures['duration_s']:.0f}",
        f"{figures['passes']}",
        f"{figures['co2_snr']:.0f}",
        # Nothing less than 0.1 % or more than 99.9 % is shown; the confidence; class A needs a
        # standard uncertainty of 0.2 times the lowest limit of 0.10 %.
        *("0.1", "99.9", "95", "0.020", "0.027"),
    }
    assert numbers_on_page_1(run_directory, tmp_path) <= known


@pytest.mark.parametrize(
    ("verdict", "chance", "holds", "complete", "words"),
    [
        ("above", 0.97, False, False, "Above the limit of 0.10 %; probability above it: 97.0 %"),
        ("below", 1e-4, True, True, "Below the limit of 0.10 %; probability above it: less than 0.1 %"),
        ("open", 0.4, True, False, "Not shown to be above or below the limit of 0.10 %; probability above it: 40.0 %"),
    ],
)  # fmt: skip
def test_a_verdict_says_probability_and_limit(record, verdict, chance, holds, complete, words):
    record["estimate"]["verdicts"][0] |= {"verdict": verdict, "probability_above": chance}
    found = measurement_verdict(record)
    assert (found.holds, found.complete, found.headline) == (holds, complete, words)


def test_a_result_that_is_less_sure_than_fuels_have_sulphur_is_none(record):
    record["estimate"] |= {"fsc_percent": 81.7, "total_percent": 10936.7, "quality": "C"}
    found = measurement_verdict(record)
    assert found.headline == "Nothing can be said of the limit of 0.10 %: there is no result"
    assert not any("81.7" in text for text in (found.detail, *(card[1] for card in found.figures)))


def test_quality_c_gives_no_verdict_and_says_what_to_do_next(record):
    assert "analyse the parts" not in measurement_verdict(record).detail
    record["estimate"] |= {"quality": "C", "quality_reasons": ["SO2 is saturated"]}
    for verdict in record["estimate"]["verdicts"]:
        verdict |= {"verdict": "open", "probability_above": 1.0}
    record["time_to_verdict_s"] = {"0.1": None, "0.5": None}
    found = measurement_verdict(record)
    assert found.headline == "No verdict on the limit of 0.10 %: quality C gives none"
    assert "No verdict on the limit of 0.50 %: quality C gives none." in found.detail
    assert "analyse the parts of the log that are free of it as separate logs" in found.detail
    assert Card("Probability above the limit of 0.10 %", "no verdict: quality C") in found.figures
    assert {card.value for card in found.figures if card.name.startswith("Time to")} == {
        "none: quality C"
    }
    assert not found.complete


def test_where_the_result_is_by_areas_the_regression_is_still_shown(run_directory, record):
    samples = pd.read_csv(run_directory / "samples.csv")
    swapped = record | {"estimate": record["other"], "other": record["estimate"]}
    assert swapped["estimate"]["method"] == "areas"
    for chart in (regression_chart(samples, of) for of in (record, swapped)):
        points, line = chart.panels[0].lines
        left = points.y - np.interp(points.x, line.x, line.y)
        # Least squares, but for the noise of CO2: the rest does not follow CO2.
        assert abs(np.corrcoef(points.x, left)[0, 1]) < 0.2
        assert chart.panels[1].lines[1].y[0] == record["estimate"]["fsc_percent"]


@pytest.mark.usefixtures("sketched")
def test_a_flight_without_a_result_says_why(run_directory, tmp_path, record):
    figures = ("fsc_percent", "noise_percent", "total_percent", "slope_ppb_per_ppm", "agreement")
    record["estimate"] |= dict.fromkeys((*figures, "misfit")) | {
        "quality": "C",
        "quality_reasons": ["no pass through a plume"],
        "common_percent": {},
    }
    for verdict in record["estimate"]["verdicts"]:
        verdict |= {"verdict": "open", "probability_above": None}
    record |= {"over_time": [], "other": None, "time_to_verdict_s": {"0.1": None}}
    report = content(read_run(changed_run(run_directory, tmp_path, record)))
    assert report.verdict.headline.startswith("Nothing can be said of the limit of 0.10 %")
    assert (report.verdict.holds, report.verdict.complete) == (True, False)
    assert report.verdict.failures == ["quality C: no pass through a plume"]
    assert set(named_charts(report)) == {"channels", "gas-samples", "track"}
    built(tmp_path)


def test_without_samples_the_report_says_so(run_directory, tmp_path):
    report = content(read_run(changed_run(run_directory, tmp_path, samples=False)))
    assert report.sections[0].anchor == "missing"
    assert "samples.csv" in blocks_of(report, Table, "missing")[0].rows[0][0]
    assert set(named_charts(report)) == {"budget", "gas-samples"}


@pytest.mark.parametrize("text", ["", "[]", '{"estimate": 3}', "\x00"])
def test_an_estimate_that_cannot_be_read_is_refused(run_directory, tmp_path, text):
    directory = changed_run(run_directory, tmp_path)
    (directory / "estimate.json").write_text(text, encoding="utf-8")
    with pytest.raises(ReportError, match="measure the flight again"):
        content(read_run(directory))


# When, where, which ship and which log.


def facts(directory, tmp_path, record=None, **changes):
    """Return page 1's facts of a record with other entries of its flight."""
    record = copy.deepcopy(record or record_of(directory))
    details = record["flight"]["details"] | changes.pop("details", {})
    record["flight"] |= changes | {"details": details}
    return dict(content(read_run(changed_run(directory, tmp_path, record))).facts)


def test_page_1_says_when_where_which_ship_by_whom_and_from_which_log(full_directory, tmp_path):
    found = facts(full_directory, tmp_path)
    # The log has 300 s; its file is the one whose hash sha256sum prints.
    assert found["Time (UTC)"] == (
        "2026-06-01 23:58:00 to 2026-06-02 00:03:00 UTC"
        " (start by the configuration; the log counts seconds)"
    )
    assert found["Place"] == (
        "Kattegat, east of Anholt (by the configuration); latitude and longitude are not in the log"
    )
    assert found["Ship"] == "Nordlys, IMO 9074729, MMSI 219000000 (by the configuration)"
    assert found["Operator"] == "Agency (by the configuration)"
    logged, settings = (full_directory.parent / f"flight.{of}" for of in ("csv", "toml"))
    hashes = [hashlib.sha256(path.read_bytes()).hexdigest() for path in (logged, settings)]
    assert found["Log"] == f"flight.csv, 301 rows, SHA-256 {hashes[0]}"
    assert found["Instrument"].startswith("Electrochemical SO2, NO and NO2 cells with NDIR CO2")
    assert {"Missing readings", "Gaps"}.isdisjoint(found)
    run = read_run(full_directory)
    rows = dict(provenance_section(run, letterhead(run, {})).blocks[0].rows)
    assert rows["SHA-256 of the log"] == f"{hashes[0]}, of the file flight.csv"
    assert rows["SHA-256 of the configuration"] == f"{hashes[1]}, of the file flight.toml"
    # The date of the analysis is not taken for that of the flight.
    report = content(run)
    assert report.letterhead.dated == f"analysed {report.letterhead.when}"
    assert rows["Analysed"] == report.letterhead.when


def test_what_neither_log_nor_configuration_says_is_said_to_be_missing(full_directory, tmp_path):
    nothing = dict.fromkeys(("vessel", "place", "operator"), "")
    nothing |= dict.fromkeys(("imo", "mmsi", "day", "start"))
    found = facts(
        full_directory, tmp_path, first_utc=None, last_utc=None, utc_from="", details=nothing
    )
    missing = "not in the log, whose times are seconds, and not in the configuration"
    assert found["Time (UTC)"] == missing
    assert found["Place"] == "latitude and longitude are not in the log"
    assert found["Ship"] == "not named in the configuration"
    assert "Operator" not in found


@pytest.mark.parametrize(
    ("offset", "words"),
    [(True, "by the log"), (False, "by the log, whose times have no offset: taken as UTC")],
)
def test_times_and_positions_of_the_log_are_said_to_be_those(
    full_directory, tmp_path, offset, words
):
    found = facts(
        full_directory,
        tmp_path,
        first_utc="2026-06-01T10:00:00Z",
        last_utc="2026-06-01T10:05:00.500Z",
        utc_from="log",
        offset=offset,
        first_position=[56.7, 11.52],
        last_position=[-56.71, 348.0],
    )
    assert found["Time (UTC)"] == f"2026-06-01 10:00:00 to 10:05:00 UTC ({words})"
    assert found["Place"].endswith(
        "from 56.70000° N, 11.52000° E to 56.71000° S, 12.00000° W (first and last of the log)"
    )


# The instrument.


def rows_of(table):
    return {row[0]: row[1:] for row in table.rows}


def tables_of_the_instrument(directory):
    return [rows_of(of) for of in blocks_of(content(read_run(directory)), Table, "instrument")]


def test_the_instrument_has_a_column_for_each_channel_with_every_property(full_directory):
    rows, assumptions = tables_of_the_instrument(full_directory)
    # As measurement/sniffer/presets/electrochemical.toml: t90 of SO2 20 s known to 5 %, of CO2 4 s
    # known to 5 %.
    assert rows["Response time t90 ± 1σ [s]"][:2] == ["20 ± 1", "4 ± 0.2"]
    assert rows["Noise of a reading, 1σ"][:4] == ["2.5", "1", "7", "7"]
    assert rows["Delay ± 1σ [s]"][:3] == ["1 ± 0.3", "1 ± 0.1", "1 ± 0.3"]
    assert rows["Calibration: gain ± 1σ [-]"][:3] == ["1 ± 0.03", "1 ± 0.02", "1 ± 0.05"]
    assert rows["Response to NO2 ± 1σ [per ppb]"][:2] == ["−0.16 ± 0.032", "none"]
    assert rows["Range"][1] == "0 to 5000"
    assert rows["Column of the log"][:4] == ["so2_ppb", "co2_ppm", "no_ppb", "no2_ppb"]
    # The source of a preset says what is assumed of it.
    assert not any("assumed" in cell for cells in rows.values() for cell in cells[:4])
    assert "Assumptions: " in assumptions["Figures of the instrument"][0]


def test_figures_that_the_record_showed_are_said_to_be_from_it(record):
    stated, used = record["instrument"]["stated"], record["instrument"]["used"]
    stated["so2"] |= {"t90_sd": None, "delay_sd_s": None}
    stated["co2"]["noise"], used["co2"]["noise"] = None, 1.23
    record["estimate"] |= {"so2_t90_s": 21.26, "so2_t90_sd_s": 0.5}
    record["estimate"] |= {"delay_s": -0.123, "delay_sd_s": 0.4}
    del record["flight"]["columns"]["no2"]
    rows = rows_of(instrument_table(record))
    assert rows["Response time t90 ± 1σ [s]"][0] == "21.3 ± 0.5, from the record"
    assert rows["Delay ± 1σ [s]"][0] == "−0.12 ± 0.40 after CO2, from the record"
    assert rows["Noise of a reading, 1σ"][1] == "1.2, from the record"
    assert rows["Column of the log"][3] == "none: not measured"


def test_what_the_configuration_and_the_log_leave_out_is_marked_as_assumed(holed):
    rows, assumptions = tables_of_the_instrument(holed.path)
    # What is assumed is that of measurement/sniffer/presets.py: 10 % of a t90, a gain of CO2 known
    # to 3 %, a fifth of a response.
    assert rows["Response time t90 ± 1σ [s]"] == ["18 ± 1.8, 1σ assumed", "3 ± 0.3"]
    assert rows["Calibration: gain ± 1σ [-]"] == ["1 ± 0.04", "1 ± 0.03, assumed"]
    assert rows["Response to NO ± 1σ [per ppb]"] == ["0.015 ± 0.003, 1σ assumed", "none"]
    assert rows["Noise of a reading, 1σ"][1] == "1"
    assert "marked as assumed" in assumptions["Figures of the instrument"][0]
    record = record_of(holed.path)
    estimate = record["estimate"]
    # 0.015 of the 18 ppb of NO per ppm of CO2 of measurement.gases.EXPECTED_PPB_PER_PPM, less, at
    # 0.2322 % per ppb/ppm.
    assert "NO is not measured: taken as 18 " in assumptions["NO and NO2"][0]
    assert estimate["assumed_percent"] == pytest.approx(-0.015 * 18.0 * 0.2322, rel=0.02)
    assert estimate["fsc_percent"] == pytest.approx(
        0.2322 * estimate["slope_ppb_per_ppm"] + estimate["assumed_percent"], abs=1e-4
    )
    words = f"{estimate['assumed_percent']:+.3f} % "
    caption = regression_chart(pd.read_csv(holed.path / "samples.csv"), record).caption
    assert f"times the slope, and {words}for NO and NO2 that the log does not have" in caption


# Holes of the log.


def test_missing_readings_and_gaps_are_counted_on_page_1_and_in_the_record(holed):
    # 301 rows of the example less 21; the longest gap is from the reading at 149 s to that at
    # 170 s; at 50 s and 100 s one sample each.
    counted = {
        "Missing readings": "6 of CO2 in 280 rows",
        "Gaps": "3 of 28 s in all, the longest 21 s from 149 s on; 2 samples in short ones"
        " interpolated, not shown as readings; 6 rows beside gaps left out, as fewer than 8 in a"
        " row are too few to use",
    }
    report = content(holed)
    assert counted.items() <= dict(report.facts).items()
    (table,) = blocks_of(report, Table, "record")
    assert counted.items() <= dict(table.rows).items()


def test_neither_samples_nor_figures_show_readings_that_the_log_does_not_have(holed):
    samples = pd.read_csv(holed.path / "samples.csv").set_index("time_s")
    readings = samples[["so2_ppb", "co2_ppm"]]
    assert list(readings.index[readings.isna().all(axis=1)]) == [50.0, 100.0]
    assert readings.drop([50.0, 100.0]).notna().all(axis=None)
    charts = named_charts(content(holed))
    (co2,) = [line for line in charts["channels"].panels[0].lines if line.label == "reading"]
    time = co2.x[np.isfinite(co2.y)]
    assert not np.any((time > 149.5) & (time < 169.5))
    assert np.isnan(co2.y[np.searchsorted(np.nan_to_num(co2.x, nan=160.0), 160.0)])
    assert "Lines end where the log has no readings, and where" in charts["channels"].caption
    # As many as samples with a reading.
    assert len(charts["regression"].panels[0].lines[0].x) == readings["co2_ppm"].notna().sum()
    assert len(charts["track"].panels[1].lines[0].x) < len(co2.x) * 2500 / 300
    assert "no track is drawn" in charts["track"].caption


# Other gases.


def test_the_page_has_a_row_and_samples_for_every_gas(full_directory, full):
    sections = content(read_run(full_directory)).sections
    section = next(section for section in sections if section.anchor == "gases")
    table, *charts = section.blocks
    assert [row[0] for row in table.rows] == ["NOx", "CH4"]
    nox = full["gases"][0]
    # A ship of stage III with 12 g/kWh, at 1.5 times 3.4 g/kWh for one load.
    assert table.rows[0][2] == f"{nox['value']:.2f}"
    assert table.rows[0][6:] == ["5.1, stage III", "above", nox["quality"]]
    assert table.rows[1][6:8] == ["none", "none"]
    assert "certifies nothing" in table.caption
    assert "CH4: no limit on this gas" in table.caption
    assert [chart.name for chart in charts] == ["gas-samples", "stages"]
    assert_axes_read_quantity_and_unit(charts)
    for panel, of in zip(samples_chart(full["gases"]).panels, full["gases"], strict=True):
        samples, line = panel.lines
        assert np.diff(line.y)[0] / np.diff(line.x)[0] == pytest.approx(of["slope"])
        assert np.corrcoef(samples.x, samples.y)[0, 1] > 0.9


def test_stages_are_drawn_with_what_was_measured(full):
    panel = stage_chart(full["gases"]).panels[0]
    curves = {line.label: line for line in panel.lines}
    for stage, slow, fast in (("I", 17.0, 9.8), ("II", 14.4, 7.7), ("III", 3.4, 2.0)):
        assert curves[f"stage {stage}"].y[[0, -1]].tolist() == [slow, fast]
    nox = full["gases"][0]
    measured = curves["measured, 95 % interval"]
    assert (measured.x[0], measured.y[0]) == (120.0, nox["value"])
    assert measured.y[0] - measured.error[0, 0] == pytest.approx(nox["low"])
    assert measured.y[0] + measured.error[1, 0] == pytest.approx(nox["high"])
    assert curves["limit at one load"].y[0] == pytest.approx(5.1)
    rejected = [full["gases"][0] | {"quality": "C", "value": None, "stage": None}]
    assert stage_chart(rejected) is None
    assert gas_sections(full | {"gases": []}) == []


def test_a_flight_without_so2_is_judged_by_its_gases(full_directory, tmp_path, full):
    directory = changed_run(full_directory, tmp_path, full | {"estimate": None})
    found = content(read_run(directory))
    assert (found.verdict.holds, found.verdict.complete) == (False, False)
    assert re.match(r"NOx .*limit 5\.1, stage III: above", found.verdict.headline)
    assert "CH4" in found.verdict.detail
    assert [panel.title for panel in found.picture.panels] == ["NOx", "CH4"]
    anchors = {section.anchor for section in found.sections}
    assert "gases" in anchors
    assert not anchors & {"result", "instrument"}
    assert "figures are in" not in dict(found.facts)["Instrument"]
