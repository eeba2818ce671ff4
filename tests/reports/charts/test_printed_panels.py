"""Panels as they are printed: all that is written about them is on the figure."""

import numpy as np

from reports.document.chart import Chart, Line, Panel
from reports.render.matplotlib_charts import draw


def test_panels_with_their_marks_and_labels_lie_apart_and_within_the_figure():
    x = np.array([0.0, 1000.0])
    panels = [
        Panel(
            x_label="Time since the orbit was reached [s]",
            y_label="Airspeed error, rms after settling [m/s]",
            title=title,
            lines=[Line(x=x, y=high * x, label="flown", colour="blue", values=shaded)],
        )
        for title, high, shaded in (("", 1.0, None), ("Titled", 2e-5, x), ("", 30.0, None))
    ]
    for share_x, last_height in ((False, 0.0), (True, 0.0), (False, 0.2)):
        chart = Chart(
            name="panels",
            caption="",
            panels=[*panels, *panels[: 1 if last_height else 2]],
            columns=3,
            panel_height=0.25,
            last_height=last_height,
            share_x=share_x,
            scale_label="CO2 [ppm]",
        )
        figure = draw(chart)
        figure.draw_without_rendering()
        boxes = [ax.get_tightbbox() for ax in figure.axes]
        for i, box in enumerate(boxes):
            assert figure.bbox.x0 <= box.x0 < box.x1 <= figure.bbox.x1
            assert figure.bbox.y0 <= box.y0 < box.y1 <= figure.bbox.y1
            # A pixel is what a line is wide.
            assert not any(box.padded(-1.0).overlaps(other.padded(-1.0)) for other in boxes[:i])
