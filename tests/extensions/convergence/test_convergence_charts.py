"""Figures of made-up convergence studies: what is counted and drawn."""

from report_parts import named_charts

from extensions.convergence.report import (
    HISTORIES_PER_LAW,
)
from reports.render import matplotlib_charts, plotly_charts


def test_samples_show_what_converged_and_counter_examples_what_did_not(failed):
    charts = {"settling": failed.picture, **named_charts(failed)}
    for name in ("samples", "counterexamples"):
        for panel in charts[name].panels:
            assert panel.log_y
            assert 1 <= len(panel.lines) <= HISTORIES_PER_LAW
    assert all(line.y[-1] < 1.0 for panel in charts["samples"].panels for line in panel.lines)
    assert all(
        line.y[-1] > 1.0 for panel in charts["counterexamples"].panels for line in panel.lines
    )


def test_every_chart_is_drawn_alike_on_screen_and_in_print(failed):
    for chart in named_charts(failed).values():
        lines = [line for panel in chart.panels for line in panel.lines]
        assert len(plotly_charts.draw(chart)["data"]) == len(lines)
        assert sum(len(ax.lines) for ax in matplotlib_charts.draw(chart).axes) == len(lines)
