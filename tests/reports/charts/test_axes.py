"""Marks of logarithmic axes, lengths in kilometres, and what a caption says of curves that leave
their panels.
"""

import io
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.text import Text

from reports.document.axes import (
    about_values,
    cut_words,
    in_kilometres,
    log_axis,
    mark_text,
    with_one_abscissa,
    wrapped,
)
from reports.document.chart import Chart, Line, Note, Panel
from reports.render import matplotlib_charts, plotly_charts


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


def test_an_axis_of_many_decades_leaves_marks_out():
    assert len(log_axis((1e-20, 1.0), [])[1]) <= 8


def test_limits_that_are_not_given_hold_the_positive_data_with_room_to_spare():
    (low, high), _ = log_axis(None, [np.array([0.0, 2.0, np.nan]), np.array([50.0, -1.0])])
    assert 1.5 < low < 2.0
    assert 50.0 < high < 65.0
    low, high = log_axis(None, [np.zeros(2)])[0]
    assert 0.0 < low < high


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.001, "0.001"),
        (30.0, "30"),
        (1e5, "10⁵"),
        (3e-7, "3·10⁻⁷"),
        (1e-12, "10⁻¹²"),
        (2e4, "20000"),
    ],
)
def test_marks_are_plain_figures_or_powers_of_ten(value, text):
    assert mark_text(value) == text


def test_both_renderers_have_the_same_marks():
    x = np.array([2.0, 130.0])
    panel = Panel(
        x_label="a [m]",
        y_label="b [m]",
        lines=[Line(x=x, y=x, label="", colour="blue")],
        log_x=True,
        log_y=True,
    )
    chart = Chart(name="c", caption="", panels=[panel])
    printed, screen = matplotlib_charts.draw(chart).axes[0], plotly_charts.draw(chart)["layout"]
    assert (
        [text.get_text() for text in printed.get_yticklabels()]
        == screen["yaxis"]["ticktext"]
        == ["3", "10", "30", "100"]
    )
    assert list(printed.get_xticks()) == pytest.approx(screen["xaxis"]["tickvals"])


@pytest.mark.parametrize(("most", "dtick"), [(1.0, 1), (7.0, 1), (24.0, None)])
def test_counts_are_marked_at_whole_numbers(most, dtick):
    x = np.array([0.0, 1.0])
    line = Line(x=x, y=most * x, label="", colour="blue")
    panel = Panel(
        x_label="a [m]", y_label="Flights", lines=[line], y_range=(0.0, most), y_whole=True
    )
    chart = Chart(name="c", caption="", panels=[panel])
    # From eight on Plotly marks whole numbers by itself: it makes about six marks.
    assert plotly_charts.draw(chart)["layout"]["yaxis"].get("dtick") == dtick
    ticks = matplotlib_charts.draw(chart).axes[0].get_yticks()
    assert ticks == pytest.approx(np.round(ticks))


def test_a_caption_says_which_curves_leave_their_panels_and_on_which_side():
    def panel(values, y_range):
        y = np.array(values)
        return Panel(
            x_label="a [m]",
            y_label="Gain [dB]",
            lines=[Line(x=y, y=y, label="", colour="blue")],
            y_range=y_range,
        )

    assert cut_words([panel([0.0, 39.0], (0.0, 40.0))]) == ""
    assert (
        cut_words([panel([0.0, 41.0, np.nan], (0.0, 40.0))])
        == " Beyond the scale: gain above 40 dB."
    )
    assert (
        cut_words([panel([-61.0, 61.0], (-60.0, 60.0))] * 2)
        == " Beyond the scale: gain above 60 dB, gain below −60 dB."
    )
    assert cut_words([panel([1e9], None)]) == ""


def test_words_among_the_curves_go_along_to_kilometres():
    x = np.array([0.0, 2e4])
    panel = Panel(
        x_label="a [m]",
        y_label="b [s]",
        lines=[Line(x=x, y=x, label="", colour="blue")],
        notes=[Note(x=1e4, y=5.0, text="here")],
    )
    (note,) = in_kilometres(panel).notes
    assert (note.x, note.y) == (10.0, 5.0)


def test_a_logarithmic_axis_stays_in_metres_where_another_is_in_kilometres():
    line = Line(x=np.array([0.0, 9.0]), y=np.array([0.1, 2e4]), label="", colour="blue")
    panel = Panel(x_label="a [s]", y_label="b [m]", lines=[line])
    assert in_kilometres(panel).y_label == "b [km]"
    assert in_kilometres(replace(panel, log_y=True)).y_label == "b [m]"


@pytest.mark.parametrize(
    ("label", "room", "lines"),
    [
        ("Distance [m]", 12, ["Distance [m]"]),
        ("Crossings [1/min]", 12, ["Crossings", "[1/min]"]),
        ("Error of the wind estimate, rms [m/s]", 30, ["Error of the wind", "estimate, rms [m/s]"]),
        ("Error of a minute [% m/m]", 20, ["Error of a", "minute [% m/m]"]),
        ("Airspeed", 2, ["Airspeed"]),
    ],
)
def test_a_label_without_room_has_two_lines_and_its_unit_is_whole(label, room, lines):
    assert wrapped(label, room) == lines


def test_both_renderers_write_a_long_label_on_two_lines():
    x = np.array([0.0, 1.0])
    line = Line(x=x, y=x, label="", colour="blue")
    panel = Panel(x_label="A quantity with a long name [m]", y_label="b [m]", lines=[line])
    chart = Chart(name="c", caption="", panels=[panel] * 5, columns=5, panel_height=0.2)
    assert matplotlib_charts.draw(chart).axes[0].get_xlabel() == "A quantity with\na long name [m]"
    assert (
        plotly_charts.draw(chart)["layout"]["xaxis"]["title"]["text"]
        == "A quantity with<br>a long name [m]"
    )


@pytest.mark.parametrize("words", [r"a $\foo$", "100 $ and 200 $"])
def test_a_dollar_sign_is_one(words):
    line = Line(x=np.arange(2.0), y=np.arange(2.0), label=words, colour="black")
    named = Panel(
        x_label=words,
        y_label="y [m]",
        title=words,
        lines=[line],
        y_names=[(0.0, words)],
        notes=[Note(x=0.5, y=0.5, text=words)],
    )
    figure = matplotlib_charts.draw(Chart(name="a", caption="", panels=[named]))
    texts = [text for text in figure.findobj(Text) if text.get_text() == words]
    # Label of the axis, title, name on the ordinate, note, legend.
    assert len(texts) == 5
    assert not any(text.get_parse_math() for text in texts)
    figure.savefig(io.BytesIO(), format="svg")


NEARLY_THE_SAME = np.array([0.50493, 0.50497])
"""Largest heading rates of two flights in a side wind, both at ω_max [rad/s]."""


def test_an_axis_of_values_that_are_nearly_the_same_has_marks_of_few_digits_and_no_offset():
    line = Line(
        x=np.array([0.3, 0.6]), y=NEARLY_THE_SAME, label="flight", colour="blue", style="points"
    )
    chart = Chart(
        name="a", caption="", panels=[Panel(x_label="x [-]", y_label="y [rad/s]", lines=[line])]
    )
    figure = matplotlib_charts.draw(chart)
    figure.canvas.draw()
    (ax,) = figure.axes
    assert ax.yaxis.get_offset_text().get_text() == ""
    marks = [label.get_text() for label in ax.get_yticklabels()]
    assert all(len(mark) <= 5 for mark in marks)
    low, high = plotly_charts.draw(chart)["layout"]["yaxis"]["range"]
    assert (low, high) == pytest.approx(ax.get_ylim())
    assert low < NEARLY_THE_SAME.min() < NEARLY_THE_SAME.max() < high


def test_an_axis_of_values_that_are_all_the_same_is_as_long_on_the_screen_as_in_print():
    # Largest heading rates, each at ω_max: Plotly by itself would draw 1 to both sides, and rates
    # below 0.
    line = Line(
        x=np.array([0.3, 0.6]),
        y=np.array([0.505, 0.505]),
        label="flight",
        colour="blue",
        style="points",
    )
    chart = Chart(
        name="a", caption="", panels=[Panel(x_label="x [-]", y_label="y [rad/s]", lines=[line])]
    )
    limits = plotly_charts.draw(chart)["layout"]["yaxis"]["range"]
    assert limits == pytest.approx(matplotlib_charts.draw(chart).axes[0].get_ylim())
    assert limits[0] > 0.4


def test_no_axis_has_an_offset_where_its_limits_are_given_and_near_to_each_other():
    line = Line(
        x=np.array([0.3, 0.6]), y=NEARLY_THE_SAME, label="flight", colour="blue", style="points"
    )
    panel = Panel(x_label="x [-]", y_label="y [rad/s]", lines=[line], y_range=(0.50492, 0.50498))
    figure = matplotlib_charts.draw(Chart(name="a", caption="", panels=[panel]))
    figure.canvas.draw()
    assert figure.axes[0].yaxis.get_offset_text().get_text() == ""


def test_panels_that_share_their_abscissa_have_the_same_limits_of_it_in_every_column():
    def panel(end, label="Time [s]"):
        return Panel(
            x_label=label,
            y_label="",
            lines=[Line(x=np.array([0.0, end]), y=np.zeros(2), label="", colour="blue")],
        )

    # In the first column marks, whose room an axis adds to by itself, and a shorter curve.
    panels = [panel(3600.0), panel(3599.0), panel(9.0, "Distance [m]"), panel(3000.0)]
    chart = Chart(name="", caption="", panels=panels, columns=2, share_x=True)
    limits = [of.x_range for of in with_one_abscissa(chart).panels]
    assert limits == [(0.0, 3600.0), (0.0, 3600.0), (0.0, 9.0), (0.0, 3600.0)]
    assert [of.x_range for of in with_one_abscissa(replace(chart, share_x=False)).panels] == [
        None
    ] * 4
    chart = replace(chart, panels=[panels[0], panels[1], panels[3]])
    drawn = plotly_charts.draw(chart)["layout"]
    assert {tuple(drawn[f"xaxis{number}"]["range"]) for number in ("", "2", "3")} == {(0.0, 3600.0)}
    assert {axes.get_xlim() for axes in matplotlib_charts.draw(chart).axes[:3]} == {(0.0, 3600.0)}


def test_limits_of_values_that_differ_are_left_to_the_axis():
    # 0.5 and 0.501 differ by 2 in a thousand.
    assert about_values([np.array([0.5, 0.501])]) is None
    assert about_values([np.zeros(3)]) is None
    assert about_values([]) is None


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


def test_what_has_another_unit_than_metres_stays_as_it_is():
    time = Line(x=np.array([0.0, 20_000.0]), y=np.array([0.0, 1.0]), label="", colour="blue")
    panel = Panel(x_label="Time [s]", y_label="Distance [m]", lines=[time])
    assert in_kilometres(panel) is panel
