"""Comparisons of a run: the same flights with parts changed, in a table, and as curves where they
have any.
"""

import math
import re
from dataclasses import replace

import pandas as pd
import pytest
from report_parts import blocks_of

from reports.document.blocks import Table
from reports.document.chart import Chart
from reports.registry import content

pytestmark = pytest.mark.usefixtures("without_single_flights")


def test_many_comparisons_have_a_row_for_each_variant(run):
    rows = pd.concat([run.summary[run.summary["trial"] == "steady"]] * 20, ignore_index=True)
    rows["flight_id"] = [f"steady_{i:05d}" for i in range(len(rows))]
    compared = rows.assign(
        flight_id=rows["flight_id"] + "_no_preview", variant="no_preview", beside=rows["flight_id"]
    )
    report = content(
        replace(
            run,
            summary=pd.concat([rows, run.summary[run.summary["trial"] == "turns"]]),
            comparison=compared,
        )
    )
    (table,) = blocks_of(report, Table, "comparison")
    assert [row[:3] for row in table.rows] == [
        ["as in the study", "40", "0"],
        ["no preview", "40", "0"],
    ]


def test_a_comparison_is_named_as_the_flight_of_the_study_also_where_that_is_not_in_the_summary(
    run,
):
    compared = run.summary.iloc[[0]].assign(variant="no_preview", beside="steady_00007")
    charts = blocks_of(content(replace(run, comparison=compared)), Chart, "comparison")
    assert [panel.title for chart in charts for panel in chart.panels] == ["steady_00007"]


def test_panels_are_as_long_and_as_high_as_their_curves(run):
    compared = run.summary.iloc[[0]].assign(variant="no_preview", beside="steady_00000")
    (chart,) = blocks_of(content(replace(run, comparison=compared)), Chart, "comparison")
    lines = [line for panel in chart.panels for line in panel.lines]
    (end,) = {panel.x_range[1] for panel in chart.panels}
    assert end == max(line.x.max() for line in lines)
    # The words say where a curve ends before its flight does.
    whole = end == pytest.approx(
        float((compared["duration_s"] - compared["settling_time_s"]).iloc[0]), abs=0.2
    )
    assert ("from settling on" if whole else f"the first {end:g} s after settling") in chart.caption
    longer = content(replace(run, comparison=compared.assign(duration_s=1e4)))
    assert re.search(
        r"changed: the first \d+ s after settling\.",
        blocks_of(longer, Chart, "comparison")[0].caption,
    )
    (height,) = {panel.y_range[1] for panel in chart.panels}
    # Up to 1.2 settling bands of 5 m, which would hide the errors of two good trackers, and from a
    # fiftieth of that on.
    largest = max(line.y.max() for line in lines)
    assert height == pytest.approx(min(6.0, max(1.05 * largest, 0.12)))


def test_a_comparison_without_a_curve_is_named_below_the_figure_with_its_reason(run):
    steady = run.summary[run.summary["trial"] == "steady"]
    never = {
        "outcome": "not_settled",
        "settling_time_s": math.nan,
        "criteria_met": False,
        "beside": steady["flight_id"],
    }
    compared = steady.assign(
        variant="no_keepout_guard", **never, flight_id=steady["flight_id"] + "_no_keepout_guard"
    )
    (chart,) = blocks_of(content(replace(run, comparison=compared)), Chart, "comparison")
    assert " Without a curve: no keep-out guard (never settled)." in chart.caption
    flown = run.summary.iloc[[1]].assign(variant="no_keepout_guard", beside="steady_00001")
    (chart,) = blocks_of(
        content(replace(run, comparison=pd.concat([compared.iloc[:1], flown]))), Chart, "comparison"
    )
    assert " Without a curve: no keep-out guard at steady_00000 (never settled)." in chart.caption
