"""The report of a measured flight: its verdict, its figures, and what it says of a flight without a
result.
"""

import json
import math
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from report_parts import (
    blocks_of,
    built,
    named_charts,
    numbers_on_page_1,
)
from snapshots import assert_reads_as_before

from measurement.log.command import main
from reports.document.blocks import Card, Table
from reports.document.chart import Chart, Line, Panel
from reports.errors import ReportError
from reports.measurement.charts import over_time_chart, regression_chart
from reports.measurement.data import errors
from reports.measurement.verdict import measurement_verdict, probability
from reports.registry import content
from reports.render import matplotlib_charts, plotly_charts
from reports.run.run_data import read_run

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[3]
EXAMPLE = ("docs/examples/example_flight.csv", "docs/examples/example_instrument.toml")


@pytest.fixture(scope="module")
def run_directory(tmp_path_factory):
    out = tmp_path_factory.mktemp("measured")
    flight, config = (str(ROOT / name) for name in EXAMPLE)
    assert main([flight, "--config", config, "--out", str(out), "--no-report"]) == 0
    return out


@pytest.fixture
def record(run_directory):
    return json.loads((run_directory / "estimate.json").read_text(encoding="utf-8"))


def changed_run(run_directory, tmp_path, record=None, samples=True):
    """Return a copy of the directory with another record, or without samples."""
    for name in ("manifest.json", "estimate.json", *(["samples.csv"] if samples else [])):
        (tmp_path / name).write_bytes((run_directory / name).read_bytes())
    if record is not None:
        (tmp_path / "estimate.json").write_text(json.dumps(record), encoding="utf-8")
    return tmp_path


def test_the_report_of_a_flight_reads_as_before(run_directory):
    assert_reads_as_before("estimate", content(read_run(run_directory)))


def test_both_reports_are_built_and_print_takes_four_pages(run_directory, tmp_path):
    text = built(changed_run(run_directory, tmp_path))
    assert "Fuel sulphur content of example_flight" in text
    pages = re.findall(rb"/Type\s*/Page\b", (tmp_path / "report.pdf").read_bytes())
    assert len(pages) == 4


def test_every_number_on_page_1_is_that_of_the_estimate(run_directory, tmp_path):
    record = json.loads((run_directory / "estimate.json").read_text(encoding="utf-8"))
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
        # What is less than 0.1 % or more than 99.9 % is not told; the confidence; class A asks for a
        # standard uncertainty of 0.2 times the lowest limit of 0.10 %.
        *("0.1", "99.9", "95", "0.020", "0.027"),
    }
    assert numbers_on_page_1(run_directory, tmp_path) <= known


def test_parts_of_the_uncertainty_add_to_the_whole(record):
    # The parts are independent: they add in squares.
    assert math.hypot(*(part for _, part in errors(record))) == pytest.approx(
        record["estimate"]["total_percent"], rel=1e-9
    )


def test_an_estimate_below_0_is_not_told_outside_of_its_own_interval_without_a_word(record):
    record["estimate"] |= {"fsc_percent": -0.058, "low_percent": 0.0, "high_percent": 0.072}
    detail = measurement_verdict(record).detail
    words = "-0.058 % m/m, which is below 0; 95 % interval 0.000 to 0.072 %, given that no fuel has less than 0, from"
    assert detail.startswith(f"Fuel sulphur content {words}")


@pytest.mark.parametrize(
    ("verdict", "chance", "holds", "complete", "words"),
    [
        ("above", 0.97, False, False, "Above the limit of 0.10 %; probability above it: 97.0 %"),
        (
            "below",
            0.0001,
            True,
            True,
            "Below the limit of 0.10 %; probability above it: less than 0.1 %",
        ),
        (
            "open",
            0.4,
            True,
            False,
            "Not shown to be above or below the limit of 0.10 %; probability above it: 40.0 %",
        ),
    ],
)
def test_a_verdict_says_probability_and_limit(record, verdict, chance, holds, complete, words):
    record["estimate"]["verdicts"][0] |= {"verdict": verdict, "probability_above": chance}
    told = measurement_verdict(record)
    assert (told.holds, told.complete, told.headline) == (holds, complete, words)


def test_a_result_that_is_less_sure_than_fuels_have_sulphur_is_none(record):
    record["estimate"] |= {
        "fsc_percent": 81.7,
        "total_percent": 10936.7,
        "quality": "C",
        "quality_reasons": ["SO2 is not of it"],
    }
    told = measurement_verdict(record)
    assert told.headline == "Nothing can be said of the limit of 0.10 %: there is no result"
    assert not any("81.7" in text for text in (told.detail, *(card[1] for card in told.figures)))


def test_quality_c_gives_no_verdict_in_words_either(record):
    record["estimate"] |= {"quality": "C", "quality_reasons": ["SO2 is saturated"]}
    for verdict in record["estimate"]["verdicts"]:
        verdict |= {"verdict": "open", "probability_above": 1.0}
    told = measurement_verdict(record)
    assert told.headline == "No verdict on the limit of 0.10 %: quality C gives none"
    assert "No verdict on the limit of 0.50 %: quality C gives none." in told.detail
    assert Card("Probability above the limit of 0.10 %", "no verdict: quality C") in told.figures
    assert not told.complete


def test_limits_are_told_with_all_their_decimals(record):
    record["estimate"]["verdicts"][0]["limit_percent"] = 0.125
    record["time_to_verdict_s"] = {"0.125": 40.0}
    told = measurement_verdict(record)
    assert "the limit of 0.125 %" in told.headline
    assert {"Probability above the limit of 0.125 %", "Time to a verdict on 0.125 %"} <= {
        card[0] for card in told.figures
    }
    for row in record["over_time"]:
        row["verdict_0.125"] = "above"
    assert "limit 0.125 %" in {
        note.text.strip() for note in over_time_chart(record).panels[0].notes
    }


def test_what_is_assumed_of_gases_that_a_log_does_not_have_is_told(tmp_path, capsys):
    log = pd.read_csv(ROOT / EXAMPLE[0]).drop(columns=["no_ppb", "no2_ppb"])
    log.to_csv(tmp_path / "log.csv", index=False)
    out = tmp_path / "run"
    assert (
        main(
            [
                str(tmp_path / "log.csv"),
                "--config",
                str(ROOT / EXAMPLE[1]),
                "--out",
                str(out),
                "--no-report",
            ]
        )
        == 0
    )
    found = json.loads((out / "estimate.json").read_text(encoding="utf-8"))
    estimate, samples = found["estimate"], pd.read_csv(out / "samples.csv")
    # 0.015 of 18 ppb/ppm of NO and -0.16 of 2 ppb/ppm of NO2, to 0.2322 %: less 0.063 %, and more
    # 0.074 %.
    assert estimate["assumed_percent"] == pytest.approx(0.012, abs=0.0015)
    assert estimate["fsc_percent"] == pytest.approx(
        0.2322 * estimate["slope_ppb_per_ppm"] + estimate["assumed_percent"], abs=1e-4
    )
    words = f"{estimate['assumed_percent']:+.3f} % "
    assert (
        f"of it {words}correct SO2 for NO and NO2 that the log does not have"
        in capsys.readouterr().out
    )
    assert (
        f"times the slope, and {words}for NO and NO2 that the log does not have"
        in regression_chart(samples, found).caption
    )


def test_where_the_result_is_by_areas_the_regression_is_still_shown_with_its_own_line(tmp_path):
    config = tmp_path / "config.toml"
    config.write_text(
        'method = "areas"\n' + (ROOT / EXAMPLE[1]).read_text(encoding="utf-8"), encoding="utf-8"
    )
    assert (
        main(
            [
                str(ROOT / EXAMPLE[0]),
                "--config",
                str(config),
                "--out",
                str(tmp_path / "run"),
                "--no-report",
            ]
        )
        == 0
    )
    found = json.loads((tmp_path / "run" / "estimate.json").read_text(encoding="utf-8"))
    assert found["estimate"]["method"] == "areas"
    scatter, groups = regression_chart(pd.read_csv(tmp_path / "run" / "samples.csv"), found).panels
    points, line = scatter.lines
    expected = np.interp(points.x, line.x, line.y)
    # Least squares, but for the noise of CO2: the rest does not follow CO2.
    assert abs(np.corrcoef(points.x, points.y - expected)[0, 1]) < 0.2
    assert groups.lines[1].y[0] == found["other"]["fsc_percent"]


@pytest.mark.usefixtures("sketched")
def test_a_flight_without_a_result_says_why(run_directory, tmp_path, record):
    nothing = dict.fromkeys(
        (
            "fsc_percent",
            "noise_percent",
            "total_percent",
            "slope_ppb_per_ppm",
            "agreement",
            "misfit",
        )
    )
    record["estimate"] |= nothing | {
        "quality": "C",
        "quality_reasons": ["no pass through a plume"],
        "common_percent": {},
    }
    for verdict in record["estimate"]["verdicts"]:
        verdict |= {"verdict": "open", "probability_above": None}
    record |= {"over_time": [], "other": None, "time_to_verdict_s": {"0.1": None}}
    report = content(read_run(changed_run(run_directory, tmp_path, record)))
    assert (
        report.verdict.headline == "Nothing can be said of the limit of 0.10 %: there is no result"
    )
    assert report.verdict.holds
    assert not report.verdict.complete
    assert report.verdict.failures == ["quality C: no pass through a plume"]
    assert set(named_charts(report)) == {"channels", "gas-samples", "track"}
    built(tmp_path)


def test_a_perfect_instrument_is_shown_where_it_is_known(run_directory, tmp_path, record):
    report = content(
        read_run(changed_run(run_directory, tmp_path, record | {"true_percent": 0.25}))
    )
    labels = [line.label for line in report.picture.panels[0].lines]
    assert "a perfect instrument" in labels
    assert Card("A perfect instrument reads", "0.250 % m/m") in report.verdict.figures


def test_without_samples_the_report_says_so(run_directory, tmp_path):
    report = content(read_run(changed_run(run_directory, tmp_path, samples=False)))
    assert report.sections[0].anchor == "missing"
    assert "samples.csv" in blocks_of(report, Table, "missing")[0].rows[0][0]
    assert set(named_charts(report)) == {"budget", "gas-samples"}


def test_samples_without_a_place_have_no_track(run_directory, tmp_path):
    directory = changed_run(run_directory, tmp_path)
    table = pd.read_csv(directory / "samples.csv").drop(
        columns=["north_m", "east_m", "height_m", "so2_true_ppb", "co2_true_ppm"]
    )
    table.to_csv(directory / "samples.csv", index=False)
    charts = named_charts(content(read_run(directory)))
    assert "track" not in charts
    assert "truth" not in {
        line.label for panel in charts["channels"].panels for line in panel.lines
    }


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"estimate": 3}', "\x00"])
def test_an_estimate_that_cannot_be_read_is_refused(run_directory, tmp_path, text):
    directory = changed_run(run_directory, tmp_path)
    (directory / "estimate.json").write_text(text, encoding="utf-8")
    with pytest.raises(ReportError, match="measure the flight again"):
        content(read_run(directory))


def test_probabilities_are_never_certain():
    assert probability(1.0) == "more than 99.9 %"
    assert probability(0.0) == "less than 0.1 %"
    assert probability(math.nan) == "not known"


def test_points_have_the_colour_of_their_value_on_one_scale():
    x = np.arange(4.0)
    lines = [
        Line(x=x, y=x, label="", colour="blue", style="points", values=values)
        for values in (x, 2.0 * x, x * np.nan)
    ]
    panels = [Panel(x_label="A [m]", y_label="B [m]", lines=[line]) for line in lines]
    chart = Chart(name="coloured", caption="", panels=panels, columns=3, scale_label="CO2 [ppm]")
    assert chart.scale == (0.0, 6.0)
    traces = [panel["data"][0] for panel in plotly_charts.draw(chart)["panels"]]
    assert [(trace["marker"]["cmin"], trace["marker"]["cmax"]) for trace in traces] == [
        (0.0, 6.0)
    ] * 3
    assert ["showscale" in trace["marker"] for trace in traces] == [False, False, True]
    figure = matplotlib_charts.draw(chart)
    # Three panels and one colour scale; values that are no numbers are not drawn.
    assert len(figure.axes) == 4
    assert [len(ax.collections[0].get_offsets()) for ax in figure.axes[:3]] == [4, 4, 0]
    assert figure.axes[3].get_ylabel() == "CO2 [ppm]"
    assert Chart(name="plain", caption="", panels=[]).scale is None
