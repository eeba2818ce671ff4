"""Reports of made-up convergence studies: what is counted, drawn, listed and said."""

import json
import re

import numpy as np
import pandas as pd
import pytest
from convergence_runs import LAWS, REFERENCES, write_convergence_run

from reports.build import build_reports
from reports.convergence.charts import CURVE_POINTS, DISTANCE_BINS, HISTORIES_PER_LAW, HISTORY_POINTS, cumulative
from reports.convergence.tables import FAILED_ROWS
from reports.convergence.verdict import FAILURES_NAMED, percentage
from reports.document.blocks import Table, Text
from reports.document.chart import Chart, Line, Panel
from reports.errors import ReportError
from reports.registry import content
from reports.render import matplotlib_charts, plotly_charts
from reports.run.run_data import read_run

TRAJECTORIES = 1200
FAILURES = [("lyapunov", 3, "time_up"), ("cascade", 7, "steps_up"), ("cascade", 200, "not_finite")]


@pytest.fixture(scope="module")
def converged_path(tmp_path_factory):
    return write_convergence_run(tmp_path_factory.mktemp("converged") / "run", TRAJECTORIES)


@pytest.fixture(scope="module")
def failed_path(tmp_path_factory):
    return write_convergence_run(tmp_path_factory.mktemp("failed") / "run", TRAJECTORIES, failures=FAILURES, cut_failures=40)


@pytest.fixture(scope="module")
def converged(converged_path):
    return content(read_run(converged_path))


@pytest.fixture(scope="module")
def failed(failed_path):
    return content(read_run(failed_path))


def small(path, **options):
    return content(read_run(write_convergence_run(path / "run", 30, **options)))


def blocks_of(report, kind, anchor=None):
    sections = [section for section in report.sections if anchor in (None, section.anchor)]
    return [block for section in sections for block in section.blocks if isinstance(block, kind)]


def charts_of(report):
    return {chart.name: chart for chart in blocks_of(report, Chart)}


def test_a_study_in_which_all_converged_says_so(converged):
    assert converged.verdict.holds
    assert converged.verdict.complete
    # Two laws that the theory is about.
    assert converged.verdict.headline == f"All {2 * TRAJECTORIES:,} trajectories converged"
    assert converged.verdict.failures == []
    assert [figure[1:] for figure in converged.verdict.figures[:3]] == [("100 %", "100 %"), ("100 %", "100 %"), ("100 %", "")]
    anchors = [section.anchor for section in converged.sections]
    assert anchors == ["question", "settling", "samples", "parameters", "provenance"]


def test_counter_examples_are_named_with_their_reasons(failed):
    assert not failed.verdict.holds
    assert failed.verdict.headline == f"3 of {2 * TRAJECTORIES:,} trajectories did not converge"
    assert [line.split(": ")[:2] for line in failed.verdict.failures] == [
        ["Law (24), trajectory 3", "time up"],
        ["Law (30), trajectory 7", "steps up"],
        ["Law (30), trajectory 200", "not finite"],
    ]
    lyapunov, cascade, cut = blocks_of(failed, Table, "counterexamples")
    assert [row[0] for row in lyapunov.rows] == ["3"]
    assert [row[0] for row in cascade.rows] == ["7", "200"]
    assert len(cut.rows) == FAILED_ROWS < 40


def test_cut_commands_have_no_part_in_the_verdict_but_are_shown(tmp_path):
    report = small(tmp_path, cut_failures=4)
    assert report.verdict.holds
    assert report.verdict.complete
    assert "26 of 30 converged" in report.verdict.detail
    # 26 of 30, rounded down.
    assert report.verdict.figures[2] == ("Law (30), cut at ω_max: converged", "86.66 %", "")
    (table,) = blocks_of(report, Table, "counterexamples")
    assert len(table.rows) == 4


def test_the_verdict_names_the_first_counter_examples_and_counts_the_others(tmp_path):
    report = small(tmp_path, failures=[("cascade", i, "time_up") for i in range(FAILURES_NAMED + 5)])
    assert len(report.verdict.failures) == FAILURES_NAMED + 1
    assert report.verdict.failures[-1].startswith("and 5 more")


def test_an_unfinished_study_is_not_called_complete(tmp_path):
    report = small(tmp_path, state="interrupted", planned=100)
    assert report.verdict.holds
    assert not report.verdict.complete
    assert report.verdict.headline == "All 60 trajectories so far converged; 200 are planned"
    assert "continue it with --resume" in report.verdict.detail


def test_a_study_of_which_rows_are_missing_is_not_called_complete(tmp_path):
    assert not small(tmp_path, planned=31).verdict.complete


@pytest.mark.parametrize(
    ("part", "whole", "text"), [(3, 3, "100 %"), (99_999, 100_000, "99.99 %"), (999_999, 1_000_000, "99.99 %"), (0, 5, "0 %")]
)
def test_only_all_are_a_hundred_percent(part, whole, text):
    assert percentage(part, whole) == text


def test_the_table_counts_and_orders_as_the_run_did(failed_path, failed):
    (table,) = blocks_of(failed, Table, "settling")
    summary = pd.read_csv(failed_path / "summary.csv")
    assert len(table.rows) == len(LAWS) * (len(REFERENCES) + 1)
    for i, (law, cells) in enumerate(zip(LAWS, table.rows[3::4], strict=True)):
        rows = summary[summary["law"] == law]
        assert cells[2:4] == [f"{len(rows):,}", f"{(rows['outcome'] == 'converged').sum():,}"]
        ordered = np.sort(rows["settling_time_s"].fillna(np.inf))
        # The 600th or 601st of 1200 is their median: either may be printed, to the second.
        assert float(cells[4].replace(",", "")) == pytest.approx(ordered[600], abs=0.5 + ordered[600] - ordered[599])
        # Under every law some never settled, so that the time by which all had is none.
        assert cells[7] == "–"
        assert [row[2] for row in table.rows[4 * i : 4 * i + 3]] == ["400", "400", "400"]


def test_a_cumulative_curve_counts_what_never_came_to_pass():
    x, y = cumulative(np.array([3.0, np.nan, 1.0, 2.0]))
    assert x.tolist() == [1.0, 1.0, 2.0, 3.0]
    assert y.tolist() == [0.0, 0.25, 0.5, 0.75]
    none, shares = cumulative(np.array([np.nan]))
    assert len(none) == len(shares) == 0


def test_a_cumulative_curve_is_thinned_and_keeps_its_ends():
    values = np.random.default_rng(4).uniform(size=5000)
    x, y = cumulative(values)
    assert len(x) == CURVE_POINTS + 1
    assert (x[0], x[-1]) == (values.min(), values.max())
    assert (y[0], y[-1]) == (0.0, 1.0)
    assert np.all(np.diff(y) > 0.0)
    # Of 5000 values no larger than x, the share is exact at every point kept.
    assert y[100] == np.mean(values <= x[100])


def test_no_chart_draws_more_points_than_a_screen_shows(failed):
    limits = {
        "settling": CURVE_POINTS + 1, "predicted": CURVE_POINTS + 1, "distance": DISTANCE_BINS, "samples": HISTORY_POINTS,
        "counterexamples": HISTORY_POINTS,
    }  # fmt: skip
    charts = charts_of(failed)
    assert set(charts) == set(limits)
    for name, limit in limits.items():
        assert max(len(line.x) for panel in charts[name].panels for line in panel.lines) <= limit, name


def test_a_panel_per_law_and_a_curve_per_reference(failed):
    charts = charts_of(failed)
    for name in ("settling", "predicted"):
        assert [len(panel.lines) for panel in charts[name].panels] == [len(REFERENCES)] * len(LAWS)
    assert [panel.title for panel in charts["settling"].panels] == ["Law (24)", "Law (30)", "Law (30), cut at ω_max"]
    # Of 1200 trajectories of the cut law 40 never settled.
    ends = [line.y[-1] for line in charts["settling"].panels[2].lines]
    assert np.mean(ends) == pytest.approx(100.0 * 1160 / 1200)


def test_where_no_settling_time_is_predicted_none_is_compared(tmp_path):
    path = write_convergence_run(tmp_path / "run", 30)
    rows = pd.read_csv(path / "summary.csv")
    rows.loc[rows["trajectory"] < 6, "settling_time_predicted_s"] = [0.0, np.inf, np.nan] * 6
    rows.to_csv(path / "summary.csv", index=False)
    known = rows[rows["trajectory"] >= 6].query("law != 'cascade_cut'")
    ratio = (known["settling_time_s"] / known["settling_time_predicted_s"]).median()
    report = content(read_run(path))
    assert report.verdict.figures[-1] == ("Settling over predicted, median", f"{ratio:.2f}", "")
    # Of 10 trajectories of a law about a kind of reference 8 are left, and the first point comes twice.
    panels = charts_of(report)["predicted"].panels
    assert {len(line.x) for panel in panels for line in panel.lines} == {9}
    assert min(line.x[0] for panel in panels for line in panel.lines) > 0.0


def test_over_distance_the_slowest_bound_every_settling_time(converged_path, converged):
    slowest, most, few, median, _ = charts_of(converged)["distance"].panels[0].lines
    rows = pd.read_csv(converged_path / "summary.csv").query("law == 'lyapunov'")
    assert slowest.y.max() == rows["settling_time_s"].max()
    assert np.all(few.y <= median.y)
    assert np.all(median.y <= most.y)
    assert np.all(most.y <= slowest.y)


def test_samples_show_what_converged_and_counter_examples_what_did_not(failed):
    charts = charts_of(failed)
    for name in ("samples", "counterexamples"):
        for panel in charts[name].panels:
            assert panel.log_y
            assert 1 <= len(panel.lines) <= HISTORIES_PER_LAW
    assert all(line.y[-1] < 1.0 for panel in charts["samples"].panels for line in panel.lines)
    assert all(line.y[-1] > 1.0 for panel in charts["counterexamples"].panels for line in panel.lines)


def test_a_sample_is_drawn_to_its_very_end(converged_path, converged):
    history = pd.read_parquet(converged_path / "trajectories" / "lyapunov_00000.parquet")
    first = charts_of(converged)["samples"].panels[0].lines[0]
    assert (first.x[-1], first.y[-1]) == (history["time_s"].iloc[-1], history["distance_m"].iloc[-1])


def test_every_axis_reads_quantity_and_unit_and_holds_something(failed):
    for chart in charts_of(failed).values():
        for panel in chart.panels:
            for label in (panel.x_label, panel.y_label):
                assert re.fullmatch(r".+ \[[^\]]+\]", label), (chart.name, label)
            assert all(np.isfinite(line.y).all() and len(line.y) for line in panel.lines), chart.name


def test_every_chart_is_drawn_alike_on_screen_and_in_print(failed):
    for chart in charts_of(failed).values():
        lines = [line for panel in chart.panels for line in panel.lines]
        assert len(plotly_charts.draw(chart).data) == len(lines)
        assert sum(len(ax.lines) for ax in matplotlib_charts.draw(chart).axes) == len(lines)


def test_a_logarithmic_ordinate_is_one_on_screen_and_in_print():
    line = Line(x=np.array([1.0, 2.0]), y=np.array([0.01, 100.0]), label="curve", colour="blue")
    panel = Panel(x_label="Time [s]", y_label="Distance [m]", lines=[line], log_y=True, y_range=(0.001, 1000.0))
    chart = Chart(name="chart", caption="", panels=[panel])
    axis = plotly_charts.draw(chart).layout.yaxis
    assert (axis.type, tuple(axis.range)) == ("log", (-3.0, 3.0))
    (ax,) = matplotlib_charts.draw(chart).axes
    assert (ax.get_yscale(), ax.get_ylim()) == ("log", (0.001, 1000.0))


def test_the_text_says_what_was_drawn_and_what_converged_means(converged):
    text = " ".join(block.text for block in blocks_of(converged, Text))
    assert f"{TRAJECTORIES:,} initial states" in text
    assert "400 are circling, 400 are oscillating, 400 are randomly turning" in text
    # The manifest's limits.
    assert "within 0.02 m of its reference" in text
    assert "within 0.0002 rad" in text
    assert "stays below 5 m" in text
    assert "φ = π" in text


def test_both_reports_are_built_and_self_contained(failed_path):
    html, pdf = build_reports(failed_path)
    text = html.read_text(encoding="utf-8")
    assert pdf.read_bytes().startswith(b"%PDF")
    assert not re.search(r"<(script|link|img)[^>]+(src|href)=", text)
    for anchor in re.findall(r'href="#([a-z]+)"', text):
        assert f'id="{anchor}"' in text
    assert "<option" not in text


@pytest.mark.parametrize("kept", [0, 1])
def test_a_study_without_rows_or_with_next_to_none_can_be_reported_on(kept, tmp_path):
    path = write_convergence_run(tmp_path / "run", 3, state="interrupted")
    rows = pd.read_csv(path / "summary.csv")
    rows.head(kept).to_csv(path / "summary.csv", index=False)
    html, _ = build_reports(path)
    text = html.read_text(encoding="utf-8")
    assert ("Nothing was flown" in text) == (kept == 0)
    shown = re.sub(r"<script.*?</script>", "", text[text.index("<h1>") :], flags=re.DOTALL)
    assert not re.search(r"\bnan\b", shown)


def test_a_study_in_which_nothing_ever_settles_can_be_reported_on(tmp_path):
    path = write_convergence_run(tmp_path / "run", 4, failures=[(law, i, "time_up") for law in LAWS for i in range(4)])
    html, _ = build_reports(path)
    assert "8 of 8 trajectories did not converge" in html.read_text(encoding="utf-8")


def change(path, how):
    how(pd.read_csv(path / "summary.csv")).to_csv(path / "summary.csv", index=False)


def without_ensemble(path):
    manifest = json.loads((path / "manifest.json").read_text(encoding="utf-8"))
    del manifest["config"]["ensemble"]
    (path / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda path: (path / "summary.csv").unlink(), "no summary.csv"),
        (lambda path: (path / "summary.csv").write_text("x,y\n1,2\n", encoding="utf-8"), "is damaged"),
        (lambda path: change(path, lambda rows: rows.assign(law="pursuit")), "law is pursuit; known are lyapunov"),
        (lambda path: change(path, lambda rows: rows.assign(reference="square")), "reference is square; known are circle"),
        (lambda path: change(path, lambda rows: rows.drop(columns="settling_time_s")), "is damaged"),
        (without_ensemble, "is damaged"),
    ],
)
def test_a_damaged_study_is_refused_in_one_line(damage, words, tmp_path):
    path = write_convergence_run(tmp_path / "run", 6)
    damage(path)
    with pytest.raises(ReportError, match=words) as refusal:
        build_reports(path)
    assert "\n" not in str(refusal.value)
