"""Charts as data for the library in the page."""

import base64

import numpy as np

from reports.document.chart import Chart, Line, Panel
from reports.render.plotly_charts import draw


def drawn(**kinds):
    """Return a chart of one panel as the page reads it."""
    x = np.array([1.0, 10.0])
    line = Line(x=x, y=x, label="curve", colour="blue")
    panel = Panel(**{"x_label": "Time [s]", "y_label": "Distance [m]", "lines": [line]} | kinds)
    return draw(Chart(name="chart", caption="", panels=[panel]))


def test_numbers_come_back_to_single_precision():
    line = Line(
        x=np.array([0.1, np.nan, 3.0]),
        y=np.array([]),
        label="",
        colour="blue",
        error=np.array([1.0, 2.0, 3.0]),
    )
    (trace,) = drawn(lines=[line])["panels"][0]["data"]
    found = np.frombuffer(base64.b64decode(trace["x"]["bdata"]), dtype=trace["x"]["dtype"])
    np.testing.assert_array_equal(found, np.array([0.1, np.nan, 3.0], dtype=np.float32))
    assert trace["y"] == []
    bars = base64.b64decode(trace["error_y"]["array"]["bdata"])
    assert np.frombuffer(bars, dtype="<f4").tolist() == [1.0, 2.0, 3.0]
