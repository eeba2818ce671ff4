"""Every kind of block, on the screen and in print."""

import re

from reports.document.blocks import (
    Card,
    Content,
    FlightContent,
    FlightPicker,
    Section,
    Text,
    Verdict,
)
from reports.render.pdf import write_pdf
from reports.run.letterhead import Letterhead


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
