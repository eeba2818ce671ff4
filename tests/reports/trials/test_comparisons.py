"""Comparisons of a run: the same flights with parts changed, in a table, and as curves where they
have any.
"""

from dataclasses import replace

import pytest
from report_parts import blocks_of

from reports.document.chart import Chart
from reports.registry import content

pytestmark = pytest.mark.usefixtures("without_single_flights")


def test_a_comparison_is_named_as_the_flight_of_the_study_also_where_that_is_not_in_the_summary(
    run,
):
    compared = run.summary.iloc[[0]].assign(variant="no_preview", beside="steady_00007")
    charts = blocks_of(content(replace(run, comparison=compared)), Chart, "comparison")
    assert [panel.title for chart in charts for panel in chart.panels] == ["steady_00007"]
