"""The results of flights over what a perfect instrument reads."""

import base64

import numpy as np
import pandas as pd
import pytest

from reports.measurement import method
from reports.render import plotly_charts


def test_error_bars_are_the_intervals_and_not_symmetric_where_these_are_cut():
    rows = pd.DataFrame(
        {
            "sensor": ["fast"],
            "fsc_expected_percent": [0.01],
            "fsc_percent": [0.01],
            "areas_fsc_percent": [-0.01],
        }
    )
    for of, low, high in (("fsc", 0.0, 0.03), ("areas_fsc", 0.0, 0.02)):
        rows = rows.assign(**{f"{of}_low_percent": low, f"{of}_high_percent": high})
    chart = method.error_chart(rows)
    bars = [panel.lines[0].error.ravel() for panel in chart.panels]
    np.testing.assert_allclose(bars, [[0.01, 0.02], [0.0, 0.03]], atol=1e-12)
    drawn = plotly_charts.draw(chart)["panels"][0]["data"][0]["error_y"]
    assert [
        np.frombuffer(base64.b64decode(drawn[end]["bdata"]), dtype="<f4")[0]
        for end in ("arrayminus", "array")
    ] == (pytest.approx([0.01, 0.02]))


def _results(expected, found):
    columns = {"fsc_expected_percent": expected, "sensor": "fast"}
    for of in ("fsc", "areas_fsc"):
        columns |= {
            f"{of}_percent": found,
            f"{of}_low_percent": 0.0,
            f"{of}_high_percent": np.abs(found) + 0.02,
        }
    return pd.DataFrame(columns)


def test_results_below_a_logarithmic_scale_stand_at_its_edge_and_are_counted():
    chart = method.error_chart(_results([0.05, 0.1, 1.0], [-0.02, 0.001, 1.0]))
    assert "results below the scale, 2 by regression, 2 by areas" in chart.caption
    for panel in chart.panels:
        inside, below, _ = panel.lines
        assert (list(inside.x), list(below.x)) == ([1.0], [0.05, 0.1])
        assert all(panel.y_range[0] < y < 1.2 * panel.y_range[0] for y in below.y)
        # What reaches from the edge up is the interval that the flight states.
        np.testing.assert_allclose((below.y + below.error[1]), [0.04, 0.021])


def test_only_flights_of_one_fuel_are_drawn_beside_each_other():
    once, often = (
        method.error_chart(_results(fuels, fuels))
        for fuels in ([0.05, 0.1, 1.0], [0.05, 0.1, 0.1, 1.0])
    )
    assert list(once.panels[0].lines[0].x) == [0.05, 0.1, 1.0]
    assert "side by side" not in once.caption
    np.testing.assert_allclose(often.panels[0].lines[0].x, [0.05, 0.095, 0.105, 1.0])
    assert "of one sensor and fuel are drawn side by side" in often.caption


@pytest.mark.parametrize("found", [[-0.02, -0.01, -0.3], [np.nan, np.nan, np.nan]])
def test_where_no_result_is_above_0_the_scale_is_that_of_the_fuels(found):
    (panel, _) = method.error_chart(_results([0.05, 0.1, 1.0], found)).panels
    assert panel.y_range == pytest.approx((0.01, 1.5))
