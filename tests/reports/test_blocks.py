"""Every kind of block, on the screen and in print."""

import json
import re
from dataclasses import replace

import numpy as np
import pypdfium2
import pytest

from reports.document.blocks import (
    Card,
    Content,
    FlightContent,
    FlightPicker,
    Heading,
    Section,
    Table,
    Text,
    Verdict,
)
from reports.document.chart import Chart, Line, Panel
from reports.registry import _figures
from reports.render.html import write_html
from reports.render.pdf import write_pdf
from reports.run.letterhead import Letterhead


def a_chart(name):
    x = np.array([1.0, 2.0])
    line = Line(x=x, y=x, label="curve", colour="blue")
    return Chart(
        name=name,
        caption=f"Caption of {name}.",
        panels=[Panel(x_label="Time [s]", y_label="Distance [m]", lines=[line])],
    )


def a_report(blocks):
    return Content(
        title="Title",
        letterhead=Letterhead(run="run", when="2026-11-22 08:35 UTC"),
        description="Description.",
        changes="",
        flown="One flight.",
        picture=None,
        verdict=Verdict(
            holds=True,
            complete=True,
            headline="Good",
            detail="",
            failures=[],
            figures=[Card("Card", "1")],
        ),
        sections=[
            Section(anchor="first", title="The first section", nav_title="First", blocks=blocks),
            Section(anchor="second", title="Second section", blocks=[Text("Second text.")]),
        ],
    )


def html_of(blocks, tmp_path):
    write_html(a_report(blocks), tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    # Page 1 and the contents are what page 1's own tests are about.
    return text[text.index("<nav>") :]


def test_the_navigation_names_every_section_once(tmp_path):
    text = html_of([Text("First text.")], tmp_path)
    nav = re.search(r"<nav>(.*?)</nav>", text)[1]
    assert re.findall(r'<a href="#(\w+)">(.*?)</a>', nav) == [
        ("summary", "Summary"), ("first", "First"), ("second", "Second section"),
    ]  # fmt: skip
    assert re.findall(r'<section id="(\w+)">', text) == ["contents", "first", "second"]


def test_blocks_appear_in_their_order_with_their_text_escaped(tmp_path):
    table = Table(head=["Head"], rows=[["cell"]], widths=[1.0])
    text = html_of([Text("a < b"), table, Heading("Middle"), a_chart("last")], tmp_path)
    places = [
        text.index(part)
        for part in ("<p>a &lt; b</p>", "<td", "<h3>Middle</h3>", 'data-figure="fig-last"')
    ]
    assert places == sorted(places)


@pytest.mark.parametrize(("left_columns", "lefts"), [(0, 0), (1, 2), (2, 4)])
def test_so_many_columns_are_left_aligned_as_a_table_says(left_columns, lefts, tmp_path):
    table = Table(head=["a", "b"], rows=[["1", "2"]], widths=[1.0, 1.0], left_columns=left_columns)
    assert html_of([table], tmp_path).count('class="left') == lefts


def test_prose_and_a_missing_head_are_a_tables_own_matter(tmp_path):
    text = html_of(
        [Table(head=["", ""], rows=[["1", "2"]], widths=[1.0, 1.0], prose=True)], tmp_path
    )
    assert '<div class="prose">' in text
    assert "<thead>" not in text
    text = html_of([Table(head=["", "", "b"], rows=[["1", "2", "3"]], widths=[1.0] * 3)], tmp_path)
    assert '<div class="prose">' not in text
    assert "<thead>" in text


def test_a_picker_offers_flights_by_their_labels_and_a_report_without_one_has_no_picker(tmp_path):
    flights = [
        FlightContent(flight_id=i, label=f"label {i}", title=f"Page {i}", charts=[])
        for i in ("a", "b")
    ]
    text = html_of([FlightPicker(flights=flights)], tmp_path)
    assert re.findall(r'<option value="(\w)" data-telling>(.*?)</option>', text) == [
        ("a", "label a"),
        ("b", "label b"),
    ]
    assert "<option" not in html_of([Text("none")], tmp_path)


def test_figures_of_a_flight_have_their_captions_on_the_screen_too(tmp_path):
    flight = FlightContent(flight_id="a", label="a", title="Page a", charts=[a_chart("same")])
    text = html_of([FlightPicker(flights=[flight])], tmp_path)
    figures = json.loads(re.search(r'id="flight-figures">(.*?)</script>', text)[1])
    assert [figure["caption"] for figure in figures["a"]] == [a_chart("same").caption]
    assert "words.textContent = figure.caption" in text


def test_every_block_is_printed_and_each_flight_has_a_heading(tmp_path):
    flights = [
        FlightContent(
            flight_id=i, label=i, title=f"Page {i}", charts=[a_chart("same")] * (i == "a")
        )
        for i in ("a", "b")
    ]
    table = Table(head=["Head"], rows=[["cell"]] * 200, widths=[1.0], breakable=True)
    write_pdf(
        a_report(
            [Text("Text."), Heading("Heading"), a_chart("one"), FlightPicker(flights=flights)]
        ),
        tmp_path / "flights.pdf",
    )
    write_pdf(a_report([Text("Text.")]), tmp_path / "text.pdf")
    write_pdf(a_report([table]), tmp_path / "table.pdf")
    # Without a picture the sections begin on page 1.
    assert pages(tmp_path / "text.pdf") == 1
    assert headings(tmp_path / "flights.pdf") == {
        "About this run", "The first section", "Heading", "Second section", "Page a", "Page b",
    }  # fmt: skip
    assert pages(tmp_path / "table.pdf") > 3


def pages(path):
    """Return the number of a PDF's pages."""
    return int(re.search(rb"/Type/Pages/Count (\d+)", path.read_bytes())[1])


def headings(path):
    """Return the titles of a PDF's outline, in any order."""
    return {title.decode() for title in re.findall(rb"/Title\((.*?)\)/Dest", path.read_bytes())}


def test_flights_that_are_not_printed_have_a_page_only_where_all_are_asked_for(tmp_path):
    flights = [
        FlightContent(flight_id=i, label=i, title=f"Page {i}", charts=[], printed=i == "b")
        for i in "abc"
    ]
    report = a_report([FlightPicker(flights=flights)])
    write_pdf(report, tmp_path / "some.pdf")
    write_pdf(report, tmp_path / "all.pdf", all_flights=True)
    assert headings(tmp_path / "some.pdf") & {"Page a", "Page b", "Page c"} == {"Page b"}
    assert headings(tmp_path / "all.pdf") >= {"Page a", "Page b", "Page c"}


def test_a_long_key_goes_on_over_the_next_line_and_is_copied_whole(tmp_path):
    key = "criteria.law_beyond_heading_rate_max_rad_s"
    write_pdf(
        a_report([Table(head=["Key", "Value"], rows=[[key, "no"]], widths=[1.0, 8.0])]),
        tmp_path / "keys.pdf",
    )
    document = pypdfium2.PdfDocument(tmp_path / "keys.pdf")
    text = "".join(page.get_textpage().get_text_range() for page in document)
    document.close()
    lines = text[text.index("criteria.") :].split("no\r\n")[0]
    # Line ends are where the page has them; nothing else stands between the letters.
    assert re.sub(r"\s", "", lines).startswith(key)
    assert key not in text


def test_a_second_line_of_negative_figures_stands_below_the_first_in_print(tmp_path):
    cell = "\N{MINUS SIGN}0.03\n(\N{MINUS SIGN}0.04 to \N{MINUS SIGN}0.02)"
    write_pdf(
        a_report([Table(head=["Key", "Value"], rows=[["key", cell]], widths=[1.0, 1.0])]),
        tmp_path / "figures.pdf",
    )
    document = pypdfium2.PdfDocument(tmp_path / "figures.pdf")
    heights = {}
    for text in (page.get_textpage() for page in document):
        for figure in ("0.03", "0.04", "0.02"):
            if found := text.search(figure).get_next():
                heights[figure] = text.get_charbox(found[0])[1]
    document.close()
    # Points up the page: the interval is on one line, below its quantile.
    assert heights["0.04"] == pytest.approx(heights["0.02"], abs=0.5)
    assert heights["0.03"] > heights["0.04"] + 3.0


def test_long_keys_may_go_on_over_the_next_line_on_the_screen_and_short_ones_may_not(tmp_path):
    rows = [["guidance.heading_rate_max_rad_s", "ω_max & <b>, r_min"]]
    text = html_of([Table(head=["Key", "Value"], rows=rows, widths=[1.0, 1.0])], tmp_path)
    assert "guidance.<wbr>heading_<wbr>rate_<wbr>max_<wbr>rad_<wbr>s" in text
    assert "ω_max &amp; &lt;b&gt;, r_min" in text


def test_a_narrow_window_leaves_a_long_text_its_width_and_a_hash_may_go_on_over_the_next_line(
    tmp_path,
):
    digest = "0123456789abcdef" * 4
    table = Table(
        head=["Sulphur [% m/m]", "Words"],
        rows=[["short words here", f"{digest}, of the file"]],
        widths=[1.0, 1.0],
    )
    text = html_of([table], tmp_path)
    assert f">{'<wbr>'.join([digest[:16]] * 4)}, of the file</td>" in text
    # A long text has a column of 14rem at least, and the table scrolls; a unit is not divided.
    assert text.count('words long">') == 1
    assert ">Sulphur [%\N{NO-BREAK SPACE}m/m]</th>" in text


def test_a_unit_in_the_head_of_a_printed_table_is_not_divided(tmp_path):
    write_pdf(
        a_report(
            [Table(head=["Sulphur content [% m/m]", "b"], rows=[["1", "2"]], widths=[1.0, 7.0])]
        ),
        tmp_path / "unit.pdf",
    )
    document = pypdfium2.PdfDocument(tmp_path / "unit.pdf")
    text = "".join(page.get_textpage().get_text_range() for page in document)
    document.close()
    assert re.search(r"\[%\sm/m\]", text)
    assert not re.search(r"\[%\s*[\r\n]+m/m", text)


@pytest.mark.parametrize(
    ("rows", "classes"), [(14, 'class="scroll whole"'), (15, 'class="scroll"')]
)
def test_a_short_table_stays_on_one_printed_page_and_a_long_one_may_go_on_over_the_next(
    rows, classes, tmp_path
):
    assert classes in html_of([Table(head=["a"], rows=[["1"]] * rows, widths=[1.0])], tmp_path)


def test_what_page_1_has_no_room_for_stands_below_further_figures_and_nothing_twice():
    verdict = Verdict(
        headline="",
        detail="",
        failures=[f"flight {i}" for i in range(7)],
        figures=[],
    )
    heading, *more = _figures(verdict)
    assert heading == Heading("More failures and remarks")
    assert [*verdict.first_failures[:4], *(text.text for text in more)] == verdict.failures
    assert verdict.first_failures[4] == "and 3 more, under “Further figures”"
    assert len(_figures(replace(verdict, failures=verdict.failures[:4]))) == 0
