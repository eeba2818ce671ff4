"""Panels as they are printed: all that is written about them is on the figure."""

import numpy as np
import pytest

from reports.document.chart import Chart, Line, Panel
from reports.document.numbering import PICTURE_HEIGHT
from reports.render.matplotlib_charts import draw

LABELS = (
    "keep-out area, r_min",
    "plume's axis",
    "ship, to scale",
    "flown",
    "reference",
    "crossing",
    "closest approach",
    "start",
    "end",
)


@pytest.mark.parametrize(
    ("across", "along"), [((-8.2, 3.4), (-0.8, 16.8)), ((-370.0, 350.0), (-235.0, 860.0))]
)
def test_labels_and_titles_of_maps_are_not_cut_off_and_touch_no_legend(across, along):
    # Of high maps with short marks, as of a fast aircraft's in kilometres, the label below had been
    # cut in two.
    lines = [
        Line(x=np.array(across), y=np.array(along), label=label, colour="black") for label in LABELS
    ]
    panel = Panel(
        x_label="Right of the plume's axis [km]",
        y_label="Along it [km]",
        title="Closest",
        lines=lines,
        equal=True,
        x_range=across,
        y_range=along,
    )
    figure = draw(
        Chart(
            name="picture",
            caption="",
            panels=[panel, panel],
            columns=2,
            panel_height=PICTURE_HEIGHT,
        )
    )
    figure.draw_without_rendering()
    (legend,) = (each.get_window_extent() for each in figure.legends)
    for ax in figure.axes:
        for label in (ax.xaxis.label, ax.yaxis.label):
            box = label.get_window_extent()
            assert box.y0 >= 0.0
            assert box.x0 >= 0.0
        assert ax.title.get_window_extent().y1 <= legend.y0
