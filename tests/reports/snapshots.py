"""The words of a report, without its numbers, beside those that were read and found good.

``UPDATE_SNAPSHOTS=1 pytest ...`` writes them anew: read the difference before it is committed.
"""

import difflib
import os
import re
from collections.abc import Iterator
from pathlib import Path

from report_parts import assert_axes_read_quantity_and_unit

from reports.document.blocks import FlightPicker, Fold, Table
from reports.document.chart import Chart
from reports.render import matplotlib_charts, plotly_charts

FOLDER = Path(__file__).parent / "snapshots"


def assert_reads_as_before(name, report):
    """Compare a report, or the findings of a study, with ``snapshots/NAME.txt``; and draw each of
    its kinds of figures once, for screen and print.
    """
    charts = {chart.name.rstrip("0123456789"): chart for chart in _charts(report)}
    assert_axes_read_quantity_and_unit(list(charts.values()))
    for chart in charts.values():
        printed, shown = matplotlib_charts.draw(chart), plotly_charts.draw(chart)
        assert len(printed.axes) >= len(shown["panels"]) == len(chart.panels)
    words = "\n".join(map(_without_numbers, _lines(report))) + "\n"
    path = FOLDER / f"{name}.txt"
    if os.environ.get("UPDATE_SNAPSHOTS"):
        FOLDER.mkdir(exist_ok=True)
        path.write_text(words, encoding="utf-8")
    before = path.read_text(encoding="utf-8").splitlines()
    difference = list(difflib.unified_diff(before, words.splitlines(), lineterm="", n=0))
    assert not difference, "\n".join(difference)


def _without_numbers(line):
    return re.sub(r"[-−+]?\d[\d.,]*(e[-+]?\d+)?", "0", line)


def _charts(report):
    blocks = [block for section in report.sections for block in section.blocks]
    inside = [of for block in blocks if isinstance(block, Fold) for of in block.blocks]
    flights = [of for block in blocks if isinstance(block, FlightPicker) for of in block.flights]
    of_flights = [chart for flight in flights for chart in flight.charts]
    every = [report.picture, *blocks, *inside, *of_flights]
    return [block for block in every if isinstance(block, Chart)]


def _lines(report) -> Iterator[str]:
    verdict = report.verdict
    yield report.flown
    yield f"{verdict.tone}: {verdict.headline}"
    yield verdict.detail
    yield from (f"! {failure}" for failure in verdict.failures)
    yield from (f"# {card.name}: {card.small_print}" for card in verdict.figures)
    yield from (f"@ {name}" for name, _ in report.facts)
    if report.picture:
        yield from _block(report.picture)
    for section in report.sections:
        if section.anchor != "provenance":
            yield f"== {section.title}"
            for block in section.blocks:
                yield from _block(block)


def _block(block) -> Iterator[str]:
    if isinstance(block, Chart):
        yield f"Chart: {block.caption}"
        for panel in block.panels:
            names = dict.fromkeys(line.label for line in panel.lines if line.label)
            yield f"  {panel.title} | {panel.x_label} | {panel.y_label}: {', '.join(names)}"
    elif isinstance(block, Table):
        yield f"Table: {block.caption}"
        yield f"  {' | '.join(block.head)}"
        # What every parameter means is that of the schema.
        if "every parameter" not in block.caption.lower() and len(block.rows) < 40:
            yield from (f"  {row[0]}" for row in block.rows)
    elif isinstance(block, Fold):
        yield f"Fold: {block.title}"
        for inner in block.blocks:
            yield from _block(inner)
    elif isinstance(block, FlightPicker):
        flight = next((of for of in block.flights if of.charts), block.flights[0])
        yield f"Flights, as {flight.title}"
        for chart in flight.charts:
            yield from _block(chart)
    else:
        yield block.text
