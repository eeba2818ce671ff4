"""Reports of a small run, built once for this file."""

import json
import re
import shutil

import numpy as np
import pandas as pd
import pytest
from judged_runs import changed
from report_parts import blocks_of, built, flown
from snapshots import assert_reads_as_before

from reports.build import build_reports
from reports.document.blocks import FlightPicker, Table
from reports.document.chart import Chart
from reports.errors import ReportError
from reports.output import flight_figure
from reports.registry import content
from reports.run.run_data import read_run
from tests.run_tables import change_manifest, manifest_of, write_manifest

pytestmark = pytest.mark.slow

# Three crossings are too few for the study's own criteria.
CRITERIA = ["criteria.tracking_error_rms_m=5.0", "criteria.crossing_interval_error=0.1"]
OVERRIDES = ["sweep.nu=[0.5, 0.9, 1.0]", "flight.crossings=3", "comparison.nu=[0.5]", *CRITERIA]


@pytest.fixture(scope="module")
def run_path(tmp_path_factory):
    return flown(tmp_path_factory, "sweep_nu", OVERRIDES)


@pytest.fixture(scope="module")
def report(run_path):
    return content(read_run(run_path))


@pytest.fixture
def copy(run_path, tmp_path):
    return shutil.copytree(run_path, tmp_path / "copy")


def flights_of(report):
    (picker,) = blocks_of(report, FlightPicker)
    return picker.flights


@pytest.mark.usefixtures("sketched")
def test_both_reports_are_built_from_disk_alone(copy):
    text = built(copy)
    assert "Sweep of the speed ratio" in text
    figures = json.loads(re.search(r'id="flight-figures">(.*?)</script>', text, re.DOTALL)[1])
    assert set(figures) == {"nu_0.50", "nu_0.90", "nu_1.00"}
    assert figures["nu_1.00"] == []


def test_names_that_become_anchors_and_files_are_unique(report):
    anchors = ["summary", *(section.anchor for section in report.sections)]
    names = [chart.name for chart in blocks_of(report, Chart)]
    assert len(set(anchors)) == len(anchors)
    assert len(set(names)) == len(names)


def test_a_flight_of_a_comparison_is_drawn(run_path):
    # It is not in the summary, which has what was swept; that was a KeyError, and the run was
    # called damaged.
    run = read_run(run_path)
    assert len(flight_figure(run, str(run.comparison["flight_id"].iloc[0])).axes) > 1


def test_an_infeasible_flight_is_in_the_report_with_its_reason(report):
    (table,) = blocks_of(report, Table, "trial1")
    assert "must be below 1" in table.rows[2][1]
    assert report.verdict.tone == "bad"
    assert "must be below 1" in report.verdict.failures[0]
    assert flights_of(report)[2].title.endswith("not flown, infeasible: speed ratio ν is 1")
    assert flights_of(report)[2].charts == []


def test_of_a_sweep_the_closest_flight_is_printed(report, copy):
    flights = {flight.flight_id: flight for flight in flights_of(report)}
    # Of the three one cannot be flown; of the two others one is the closest, one the median, whose
    # track page 1 shows.
    printed = [flight_id for flight_id, flight in flights.items() if flight.printed]
    assert printed == ["nu_0.90"]
    assert "closest approach" in flights["nu_0.90"].label
    (section,) = (section for section in report.sections if section.anchor == "flights")
    assert "report.pdf shows 1 of them: closest approach." in section.blocks[0].text
    summary = pd.read_csv(copy / "summary.csv")
    more = summary[summary["flight_id"] == "nu_0.50"].assign(
        flight_id="nu_0.51", min_distance_m=215.0
    )
    pd.concat([summary, more]).to_csv(copy / "summary.csv", index=False)
    longer = flights_of(content(read_run(copy)))
    assert not {flight.flight_id: flight.printed for flight in longer}["nu_0.51"]


def without(path, entry):
    manifest = manifest_of(path)
    del manifest[entry]
    write_manifest(path, manifest)


def written(name, text):
    return lambda path: (path / name).write_text(text, encoding="utf-8")


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda path: (path / "manifest.json").unlink(), "no manifest.json"),
        (written("manifest.json", "{"), "cannot be read"),
        (written("manifest.json", "[1]"), "not that of a run"),
        (lambda path: change_manifest(path, study="opera"), "study is 'opera', which has no report; those"),
        (lambda path: without(path, "format"), "is a run of format None, and this version reads 1"),
        (lambda path: without(path, "trials"), "another version: its manifest.json has no 'trials'"),
        (lambda path: change_manifest(path, trials={}), "manifest.json names no trials, whose flights"),
        (lambda path: (path / "summary.csv").unlink(), "no summary.csv"),
        (written("summary.csv", "x,y\n" + 9 * "1,2\n"), "is damaged"),
        (written("crossings.csv", "x,y\n1,2\n"), "is damaged"),
    ],
)  # fmt: skip
def test_a_damaged_run_is_refused_in_one_line(copy, damage, words):
    damage(copy)
    with pytest.raises(ReportError, match=words) as refusal:
        build_reports(copy)
    assert "\n" not in str(refusal.value)


@pytest.mark.usefixtures("without_single_flights")
@pytest.mark.parametrize("flights", [1, 3])
def test_theory_is_a_curve_over_the_speed_ratio_however_few_flights_there_are(run_path, flights):
    run = read_run(run_path)
    report = content(changed(run, summary=run.summary.iloc[:flights]))
    charts = {chart.name: chart for chart in blocks_of(report, Chart, "trial1")}
    interval = charts["trial1-nu1-crossings"].panels[0]
    fastest, limit, theory, flown = interval.lines
    assert (fastest.label, limit.label) == ("fastest oscillation", "limit, two crossings a period")
    # At every nu the limit is below what is flown: docs/fastest_oscillation.md.
    assert (np.interp(limit.x, theory.x, theory.y) > limit.y).all()
    assert (theory.label, theory.style) == ("theory, π/ω₀", "solid")
    assert len(theory.x) > 50
    assert (theory.x[0], theory.x[-1]) == (0.0, pytest.approx(0.99))
    # The flights lie on it: their own predictions come from the plan of each.
    rows = run.summary.iloc[:flights].dropna(subset="crossing_interval_predicted_s")
    predicted = np.interp(rows["nu"], theory.x, theory.y)
    assert predicted == pytest.approx(rows["crossing_interval_predicted_s"].to_numpy(), rel=1e-3)
    # From 0 to 1, also about a single flight.
    for chart in charts.values():
        for panel in chart.panels:
            assert panel.x_range == pytest.approx((-0.02, 1.02))
    assert len(flown.x) == len(rows)


def test_a_sweep_reads_as_before(report):
    assert_reads_as_before("sweep", report)
