"""Marks of logarithmic axes, shared abscissas, and lengths in kilometres."""

import numpy as np
import pytest

from reports.document.axes import in_kilometres, log_axis
from reports.document.chart import Line, Panel


@pytest.mark.parametrize(
    ("limits", "marks"),
    [
        ((0.1, 1000.0), [0.1, 1.0, 10.0, 100.0, 1000.0]),
        ((0.7, 130.0), [1.0, 10.0, 100.0]),
        ((2.0, 130.0), [3.0, 10.0, 30.0, 100.0]),
        ((1.5, 6.0), [2.0, 3.0, 4.0, 5.0, 6.0]),
        ((0.0121, 0.0149), [0.013, 0.014]),
    ],
)
def test_a_logarithmic_axis_has_three_marks_at_least_and_powers_of_ten_where_they_are_enough(
    limits, marks
):
    assert log_axis(limits, [])[1] == pytest.approx(marks)


def test_limits_that_are_not_given_hold_the_positive_data_with_room_to_spare():
    (low, high), _ = log_axis(None, [np.array([0.0, 2.0, np.nan]), np.array([50.0, -1.0])])
    assert 1.5 < low < 2.0
    assert 50.0 < high < 65.0
    low, high = log_axis(None, [np.zeros(2)])[0]
    assert 0.0 < low < high


@pytest.mark.parametrize(
    ("reach", "equal", "labels"),
    [
        ((9_999.0, 500.0), True, ("East [m]", "North [m]")),
        # Of two axes that are equally long, both.
        ((500.0, 10_000.0), True, ("East [km]", "North [km]")),
        ((500.0, 10_000.0), False, ("East [m]", "North [km]")),
    ],
)
def test_far_flights_are_shown_in_kilometres(reach, equal, labels):
    line = Line(x=np.array([-reach[0], 0.0]), y=np.array([0.0, -reach[1]]), label="", colour="blue")
    nothing = Line(x=np.array([]), y=np.array([]), label="", colour="blue")
    panel = in_kilometres(
        Panel(x_label="East [m]", y_label="North [m]", lines=[nothing, line], equal=equal)
    )
    assert (panel.x_label, panel.y_label) == labels
    shown = [1000.0 if "[km]" in label else 1.0 for label in labels]
    assert panel.lines[1].x[0] * shown[0] == pytest.approx(-reach[0], rel=1e-12)
    assert panel.lines[1].y[1] * shown[1] == pytest.approx(-reach[1], rel=1e-12)
