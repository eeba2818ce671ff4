"""Charts as data for the library in the page, and that library itself."""

import base64
import itertools
import re

import numpy as np
import pytest

from reports.document.chart import Band, Chart, Line, Note, Panel
from reports.render import matplotlib_charts
from reports.render.html import PLOTLY
from reports.render.plotly_charts import draw


def a_panel(**kinds):
    x = np.array([1.0, 10.0])
    return Panel(
        x_label="Time [s]",
        y_label="Distance [m]",
        lines=[Line(x=x, y=x, label="curve", colour="blue")],
        **kinds,
    )


def a_chart(count, **kinds):
    return Chart(name="chart", caption="", panels=[a_panel() for _ in range(count)], **kinds)


def test_the_bundled_library_is_the_version_that_its_page_names_under_its_licence():
    head = PLOTLY.read_text(encoding="utf-8")[:400]
    version = re.search(r"plotly\.js \(cartesian - minified\) v([\d.]+)", head)[1]
    page = (PLOTLY.parent / "README.md").read_text(encoding="utf-8")
    assert f"plotly.js {version}" in page
    assert f"npm pack plotly.js-cartesian-dist-min@{version}" in page
    assert "MIT" in (PLOTLY.parent / "plotly-LICENSE").read_text(encoding="utf-8")


def test_numbers_come_back_to_single_precision():
    line = Line(
        x=np.array([0.1, np.nan, 3.0]),
        y=np.array([]),
        label="",
        colour="blue",
        error=np.array([1.0, 2.0, 3.0]),
    )
    trace = draw(
        Chart(
            name="chart", caption="", panels=[Panel(x_label="a [m]", y_label="b [m]", lines=[line])]
        )
    )["data"][0]
    found = np.frombuffer(base64.b64decode(trace["x"]["bdata"]), dtype=trace["x"]["dtype"])
    np.testing.assert_array_equal(found, np.array([0.1, np.nan, 3.0], dtype=np.float32))
    assert trace["y"] == []
    assert np.frombuffer(
        base64.b64decode(trace["error_y"]["array"]["bdata"]), dtype="<f4"
    ).tolist() == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(("count", "columns"), [(1, 1), (3, 1), (4, 2), (7, 2), (5, 3)])
@pytest.mark.parametrize("share_x", [False, True])
def test_panels_fill_the_room_row_by_row_and_do_not_overlap(count, columns, share_x):
    layout = draw(a_chart(count, columns=columns, share_x=share_x))["layout"]
    numbers = ["", *(str(i) for i in range(2, count + 1))]
    # As many axes as panels: none for a place that stays empty.
    assert {key for key in layout if "axis" in key} == {
        f"{axis}axis{number}" for axis in "xy" for number in numbers
    }
    boxes = [(*layout[f"xaxis{n}"]["domain"], *layout[f"yaxis{n}"]["domain"]) for n in numbers]
    assert min(left for left, *_ in boxes) == 0.0
    assert max(right for _, right, *_ in boxes) == pytest.approx(
        1.0 if count >= columns else boxes[-1][1]
    )
    assert max(top for *_, top in boxes) == pytest.approx(1.0)
    for i, (left, right, bottom, top) in enumerate(boxes):
        assert 0.0 <= left < right <= 1.0
        assert 0.0 <= bottom < top <= 1.0
        for other in boxes[i + 1 :]:
            assert other[0] > right or other[3] < bottom or other[1] < left


def test_panels_of_a_column_share_the_abscissa_of_the_lowest_which_alone_has_figures():
    layout = draw(a_chart(7, columns=2, share_x=True))["layout"]
    # Seven panels in two columns: the last of the left one is the seventh, of the right one the
    # sixth.
    assert [layout[f"xaxis{n}"].get("matches") for n in ("", 2, 3, 4, 5)] == [
        "x7",
        "x6",
        "x7",
        "x6",
        "x7",
    ]
    assert [n for n in ("", 2, 3, 4, 5, 6, 7) if layout[f"xaxis{n}"]["showticklabels"]] == [6, 7]
    assert "title" not in layout["xaxis5"]
    free = draw(a_chart(7, columns=2))["layout"]
    assert not any("matches" in free[f"xaxis{n}"] for n in ("", 2, 3, 4, 5, 6, 7))


def test_a_label_is_one_entry_of_the_legend_however_many_panels_have_it():
    figure = draw(a_chart(3))
    assert [trace["showlegend"] for trace in figure["data"]] == [True, False, False]
    assert {trace["legendgroup"] for trace in figure["data"]} == {"curve"}
    assert figure["layout"]["showlegend"] is False  # a single entry says nothing


def test_titles_stand_above_their_panels_and_notes_among_the_curves_of_theirs():
    panels = [
        a_panel(title="first"),
        a_panel(title="second", notes=[Note(x=2.0, y=3.0, text="here", align="left")]),
    ]
    layout = draw(Chart(name="chart", caption="", panels=panels, columns=2))["layout"]
    first, second, note = layout["annotations"]
    assert (first["text"], first["y"], first["yref"]) == ("first", 1.0, "paper")
    assert second["x"] == pytest.approx(sum(layout["xaxis2"]["domain"]) / 2.0)
    assert (note["text"], note["x"], note["y"], note["xref"], note["yref"], note["xanchor"]) == (
        "here",
        2.0,
        3.0,
        "x2",
        "y2",
        "left",
    )


def test_axes_are_logarithmic_and_equally_long_where_a_panel_asks_for_it():
    layout = draw(
        Chart(
            name="chart",
            caption="",
            panels=[a_panel(log_x=True, x_range=(1.0, 100.0)), a_panel(equal=True)],
        )
    )["layout"]
    assert (layout["xaxis"]["type"], layout["xaxis"]["range"]) == ("log", [0.0, 2.0])
    assert (layout["yaxis2"]["scaleanchor"], layout["yaxis2"]["scaleratio"]) == ("x2", 1)
    low, high = layout["xaxis2"]["range"]
    assert (low < 1.0, high > 10.0) == (True, True)  # every curve, with a little to spare


@pytest.mark.parametrize(("columns", "narrow"), [(1, 1), (2, 1), (3, 1), (4, 2), (5, 2)])
@pytest.mark.parametrize("share_x", [False, True])
def test_on_a_narrow_screen_panels_stand_below_each_other_with_room_for_labels(
    columns, narrow, share_x
):
    figure = draw(a_chart(5, columns=columns, share_x=share_x))
    numbers = ["", *(str(i) for i in range(2, 6))]
    boxes = [
        (*figure["narrow"][f"xaxis{n}"]["domain"], *figure["narrow"][f"yaxis{n}"]["domain"])
        for n in numbers
    ]
    assert len({left for left, *_ in boxes}) == narrow
    assert all(figure["narrow"][f"xaxis{n}"]["showticklabels"] for n in numbers)
    inner = (
        figure["narrow"]["height"] - figure["narrow"]["margin"]["t"] - 55
    )  # what is below them: the renderer's _BOTTOM
    column = sorted((bottom, top) for left, _, bottom, top in boxes if left == 0.0)
    for (_, top), (bottom, _) in itertools.pairwise(column):
        # Figures and a title of 13 px letters take some 45 px.
        assert (bottom - top) * inner > 45.0


def test_the_last_panel_may_be_as_wide_as_the_page():
    layout = draw(a_chart(3, columns=2, panel_height=0.4, last_height=0.2))["layout"]
    assert layout["xaxis3"]["domain"] == [0.0, 1.0]
    heights = [
        layout[f"yaxis{n}"]["domain"][1] - layout[f"yaxis{n}"]["domain"][0] for n in ("", 2, 3)
    ]
    assert heights[0] == pytest.approx(heights[1])
    assert heights[0] == pytest.approx(2.0 * heights[2])
    assert layout["yaxis"]["domain"][0] > layout["yaxis3"]["domain"][1]
    printed = matplotlib_charts.draw(a_chart(3, columns=2, panel_height=0.4, last_height=0.2)).axes
    assert len(printed) == 3


def test_a_band_is_tinted_over_the_whole_height_and_is_one_entry_of_the_legend():
    bands = [
        Band(start=1.0, end=2.0, label="guard", colour="purple"),
        Band(start=3.0, end=4.0, label="guard", colour="purple"),
    ]
    chart = Chart(
        name="chart", caption="", panels=[a_panel(bands=bands), a_panel(bands=bands)], share_x=True
    )
    layout = draw(chart)["layout"]
    assert [shape.get("showlegend", False) for shape in layout["shapes"]] == [
        True,
        False,
        False,
        False,
    ]
    assert {(shape["x0"], shape["x1"], shape["y0"], shape["y1"]) for shape in layout["shapes"]} == {
        (1.0, 2.0, 0, 1),
        (3.0, 4.0, 0, 1),
    }
    assert [shape["yref"] for shape in layout["shapes"]] == [
        "y domain",
        "y domain",
        "y2 domain",
        "y2 domain",
    ]
    assert layout["showlegend"]
    (legend,) = matplotlib_charts.draw(chart).legends
    assert [text.get_text() for text in legend.get_texts()] == ["curve", "guard"]


def test_the_legend_has_room_above_the_panels_and_more_of_it_on_a_narrow_screen():
    x = np.array([0.0, 1.0])
    lines = [
        Line(x=x, y=x, label=f"a curve with a long name, number {i}", colour="blue")
        for i in range(6)
    ]
    figure = draw(
        Chart(name="c", caption="", panels=[Panel(x_label="a [m]", y_label="b [m]", lines=lines)])
    )
    few = draw(a_chart(1))
    assert (
        few["layout"]["margin"]["t"]
        < figure["layout"]["margin"]["t"]
        < figure["narrow"]["margin"]["t"]
    )


def test_a_legend_of_several_rows_stays_clear_of_the_bar_of_buttons():
    labels = [
        "common errors: do not fall",
        "noise: falls with further passes",
        "all together, of every part",
    ]
    lines = [
        Line(x=np.array([0.0, 1.0]), y=np.array([0.0, 1.0]), label=label, colour="blue")
        for label in labels
    ]
    figure = draw(
        Chart(name="c", caption="", panels=[Panel(x_label="a [m]", y_label="b [m]", lines=lines)])
    )
    # As measured in Chromium: the bar ends 28 px below the top of a figure, and a row of the
    # legend, one for each entry here, is 30 px high; the last is 6 px above the panel.
    assert figure["narrow"]["margin"]["t"] - 6 - 30 * len(labels) >= 28


def test_names_of_an_ordinate_leave_the_legend_fewer_entries_in_a_row():
    lines = [
        Line(x=np.array([0.0, 1.0]), y=np.array([0.0, 1.0]), label=label, colour="blue")
        for label in ("above the noise floor", "not above it", "noise floor")
    ]
    names = [(0.0, "Vessel manoeuvre 1 acceleration")]
    plain, named = (
        draw(
            Chart(
                name="c",
                caption="",
                panels=[Panel(x_label="a [m]", y_label="b", lines=lines, y_names=of)],
            )
        )["narrow"]
        for of in ((), names)
    )
    # As measured in Chromium at 520 px: two rows beside numbers, and one for each entry beside
    # these names.
    assert named["margin"]["t"] - plain["margin"]["t"] == 30


def test_an_entry_of_the_legend_with_broad_letters_takes_more_of_its_row():
    # As measured in Chromium: 178, 124, 175 and 217 px; the last two share no row of 390 px, nor do
    # they with the first two.
    labels = [
        "keep-out area, r_min",
        "plume's axis",
        "ship, size not known",
        "guard changed commands",
    ]
    lines = [
        Line(x=np.array([0.0, 1.0]), y=np.array([0.0, 1.0]), label=label, colour="blue")
        for label in labels
    ]
    three, four = (
        draw(Chart(name="c", caption="", panels=[Panel(x_label="a [m]", y_label="b", lines=of)]))[
            "narrow"
        ]
        for of in (lines[:3], lines)
    )
    assert four["margin"]["t"] - three["margin"]["t"] == 30


def test_names_of_an_ordinate_have_room_beside_the_panel_to_their_left():
    names = [(0.0, "holding off"), (1.0, "tracking")]
    plain = draw(a_chart(2, columns=2))["layout"]
    named = draw(
        Chart(name="c", caption="", panels=[a_panel(), a_panel(y_names=names)], columns=2)
    )["layout"]
    gaps = [
        layout["xaxis2"]["domain"][0] - layout["xaxis"]["domain"][1] for layout in (plain, named)
    ]
    # Eleven letters of 13 px take some 70 px of a chart that is 890 px wide without its margins.
    assert gaps[1] > gaps[0]
    assert gaps[1] * 890.0 > 70.0 + 35.0
    assert named["xaxis2"]["domain"][1] == pytest.approx(1.0)


def test_a_panel_that_shares_its_names_with_its_neighbour_has_them_where_it_stands_below_it():
    first, second = (
        a_panel(y_names=[(1.0, "engine"), (2.0, "throttle")]),
        a_panel(y_names=[(1.0, ""), (2.0, "")]),
    )
    figure = draw(Chart(name="chart", caption="", panels=[first, second], columns=2))
    assert figure["layout"]["yaxis2"]["ticktext"] == ["", ""]
    assert figure["narrow"]["yaxis2"]["ticktext"] == ["engine", "throttle"]
    assert figure["narrow"]["yaxis2"]["title"]["text"] == "Distance [m]"
