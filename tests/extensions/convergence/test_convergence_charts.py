"""Figures of made-up convergence studies: what is counted and drawn."""

import numpy as np
import pandas as pd
import pytest
from convergence_runs import LAWS, REFERENCES
from report_parts import assert_axes_read_quantity_and_unit, named_charts

from extensions.convergence.report import (
    CURVE_POINTS,
    DISTANCE_BINS,
    HISTORIES_PER_LAW,
    HISTORY_POINTS,
    cumulative,
)
from reports.document.chart import Chart, Line, Panel
from reports.render import matplotlib_charts, plotly_charts


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
        "settling": CURVE_POINTS + 1,
        "distance": DISTANCE_BINS,
        "samples": HISTORY_POINTS,
        "counterexamples": HISTORY_POINTS,
    }
    # Page 1 has the first one, and only page 1.
    charts = {"settling": failed.picture, **named_charts(failed)}
    assert set(charts) == set(limits)
    for name, limit in limits.items():
        assert max(len(line.x) for panel in charts[name].panels for line in panel.lines) <= limit, (
            name
        )


def test_a_panel_per_law_and_a_curve_per_reference(failed):
    charts = {"settling": failed.picture, **named_charts(failed)}
    lines = [len(panel.lines) for panel in charts["settling"].panels]
    assert lines == [len(REFERENCES)] * len(LAWS)
    assert [panel.title for panel in charts["settling"].panels] == [
        "Law (24)",
        "Law (30)",
        "Law (30), cut at ω_max",
    ]
    # Of 1200 trajectories of the cut law 40 never settled.
    ends = [line.y[-1] for line in charts["settling"].panels[2].lines]
    assert np.mean(ends) == pytest.approx(100.0 * 1160 / 1200)


def test_over_distance_the_slowest_bound_every_settling_time(converged_path, converged):
    slowest, most, few, median, _ = named_charts(converged)["distance"].panels[0].lines
    rows = pd.read_csv(converged_path / "summary.csv").query("law == 'lyapunov'")
    assert slowest.y.max() == rows["settling_time_s"].max()
    assert np.all(few.y <= median.y)
    assert np.all(median.y <= most.y)
    assert np.all(most.y <= slowest.y)


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


def test_a_sample_is_drawn_to_its_very_end(converged_path, converged):
    history = pd.read_parquet(converged_path / "trajectories" / "lyapunov_00000.parquet")
    first = named_charts(converged)["samples"].panels[0].lines[0]
    assert (first.x[-1], first.y[-1]) == (
        history["time_s"].iloc[-1],
        history["distance_m"].iloc[-1],
    )


def test_every_axis_reads_quantity_and_unit_and_holds_something(failed):
    assert_axes_read_quantity_and_unit(named_charts(failed).values())
    for chart in named_charts(failed).values():
        for panel in chart.panels:
            assert all(np.isfinite(line.y).all() and len(line.y) for line in panel.lines), (
                chart.name
            )


def test_every_chart_is_drawn_alike_on_screen_and_in_print(failed):
    for chart in named_charts(failed).values():
        lines = [line for panel in chart.panels for line in panel.lines]
        assert sum(len(of["data"]) for of in plotly_charts.draw(chart)["panels"]) == len(lines)
        assert sum(len(ax.lines) for ax in matplotlib_charts.draw(chart).axes) == len(lines)


def test_a_logarithmic_ordinate_is_one_on_screen_and_in_print():
    line = Line(x=np.array([1.0, 2.0]), y=np.array([0.01, 100.0]), label="curve", colour="blue")
    panel = Panel(
        x_label="Time [s]",
        y_label="Distance [m]",
        lines=[line],
        log_y=True,
        y_range=(0.001, 1000.0),
    )
    chart = Chart(name="chart", caption="", panels=[panel])
    axis = plotly_charts.draw(chart)["panels"][0]["layout"]["yaxis"]
    assert (axis["type"], tuple(axis["range"])) == ("log", (-3.0, 3.0))
    (ax,) = matplotlib_charts.draw(chart).axes
    assert (ax.get_yscale(), ax.get_ylim()) == ("log", (0.001, 1000.0))
