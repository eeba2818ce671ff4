"""Pages, figures and rounded figures of a printed report."""

import math
import re

import numpy as np
import pytest

from reports.document.blocks import (
    Card,
    Content,
    FlightContent,
    FlightPicker,
    Section,
    Text,
    Verdict,
)
from reports.document.chart import Chart, Line, Panel
from reports.document.tables import approach, beside_limit
from reports.render import figure_files
from reports.render.figure_files import write_figures
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


def test_flights_that_are_not_printed_have_a_page_only_where_all_are_printed(tmp_path):
    flights = [
        FlightContent(flight_id=i, label=i, title=f"Page {i}", charts=[], printed=i == "b")
        for i in "abc"
    ]
    report = a_report([FlightPicker(flights=flights)])
    write_pdf(report, tmp_path / "some.pdf")
    write_pdf(report, tmp_path / "all.pdf", all_flights=True)
    assert headings(tmp_path / "some.pdf") & {"Page a", "Page b", "Page c"} == {"Page b"}
    assert headings(tmp_path / "all.pdf") >= {"Page a", "Page b", "Page c"}


COUNT = 4
"""Charts that are drawn."""


def a_chart(name):
    x = np.array([1.0, 2.0])
    line = Line(x=x, y=x, label="curve", colour="blue")
    panel = Panel(x_label="Time [s]", y_label="Distance [m]", lines=[line])
    return Chart(name=name, caption=f"Caption of {name}.", panels=[panel])


def drawn_by(folder, processes, monkeypatch):
    """Draw charts by so many processes; return each file's content."""
    monkeypatch.setattr(figure_files.os, "cpu_count", lambda: processes)
    # Enough for two processes, where a report would need twelve.
    monkeypatch.setattr(figure_files, "_FIGURES_PER_PROCESS", COUNT // 2)
    folder.mkdir()
    write_figures({f"{i}.svg": a_chart(f"chart{i}") for i in range(COUNT)}, folder)
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_they_do_not_depend_on_the_number_of_processes(tmp_path, monkeypatch):
    alone = drawn_by(tmp_path / "alone", 1, monkeypatch)
    assert len(alone) == COUNT
    assert drawn_by(tmp_path / "together", 2, monkeypatch) == alone


@pytest.mark.parametrize(
    ("distance", "radius", "words"),
    [
        (212.345, 200.0, "212.3"), (199.96, 200.0, "199.9"), (199.9996, 200.0, "199.9"), (200.0, 200.0, "200.0"),
        (-0.04, 0.0, "−0.1"), (math.nan, 200.0, "–"),
    ],
)  # fmt: skip
def test_a_distance_is_written_on_the_side_of_the_radius_on_which_it_lies(distance, radius, words):
    assert approach(distance, radius) == words


@pytest.mark.parametrize(
    ("value", "bound", "words"),
    [
        (1.504, 1.5, "1.504"),
        (1.5, 1.5, "1.5"),
        (1.61, 1.5, "1.61"),
        (7.99996, 8.0, "7.99996"),
        (1234.0, 100.0, "1230"),
    ],
)
def test_a_figure_is_written_on_the_side_of_its_limit_on_which_it_lies(value, bound, words):
    assert beside_limit(value, bound) == words
