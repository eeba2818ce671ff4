"""The report as a PDF, set by Typst."""

import json
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from itertools import count
from pathlib import Path
from typing import Any

import typst

from reports.document.blocks import (
    Block,
    Card,
    Content,
    FlightContent,
    FlightPicker,
    Fold,
    Section,
    Table,
)
from reports.document.chart import Chart
from reports.document.numbering import figures_in
from reports.render.figure_files import write_figures
from reports.render.words import unbroken

_AFTER_FLIGHTS = 2
"""Sections after the flights: parameters and provenance."""

TEMPLATE = Path(__file__).parent / "templates" / "report.typ"

Data = dict[str, Any]

Figures = dict[str, Chart]
"""Charts by the name of the file that each is drawn into."""


def write_pdf(report: Content, path: Path, *, all_flights: bool = False) -> None:
    """Write the report to ``path``, with ``all_flights`` or with those that are printed."""
    with tempfile.TemporaryDirectory() as folder:
        directory = Path(folder)
        (directory / "report.typ").write_text(
            TEMPLATE.read_text(encoding="utf-8"), encoding="utf-8"
        )
        figures: Figures = {}
        data = _data(report, directory, figures, all_flights=all_flights)
        write_figures(figures, directory)
        (directory / "data.json").write_text(json.dumps(data), encoding="utf-8")
        path.write_bytes(typst.compile(str(directory / "report.typ")))


def _data(report: Content, directory: Path, figures: Figures, *, all_flights: bool) -> Data:
    """Return what is typeset; its charts are added to ``figures``, and its logo is written."""
    pickers = [
        block
        for section in report.sections
        for block in section.blocks
        if isinstance(block, FlightPicker)
    ]
    # Flights have pages of their own before parameters and provenance, and their figures the
    # numbers after all others.
    numbers = count(figures_in(report.picture, report.sections) + 1)
    flights = [
        flight for picker in pickers for flight in picker.flights if all_flights or flight.printed
    ]
    # A report without a flight in print has no section on single flights.
    without = [] if flights else [of for of in report.sections if _is_of_flights(of)]
    sections = [_section(of, figures) for of in _in_print(report.sections) if of not in without]
    head, verdict = report.letterhead, report.verdict
    if head.logo:
        (directory / f"logo{head.logo.suffix}").write_bytes(head.logo.content)
    return {
        "title": report.title,
        "run": head.run,
        "when": head.dated,
        "author": head.author,
        "signature": head.signature,
        "logo": f"logo{head.logo.suffix}" if head.logo else "",
        "description": report.description,
        "changes": report.changes,
        "flown": unbroken(report.flown),
        "verdict": {
            "tone": verdict.tone,
            "sign": verdict.sign,
            "headline": unbroken(verdict.headline),
            "detail": unbroken(verdict.detail),
        },
        "failures": verdict.first_failures,
        "facts": [{"name": name, "value": unbroken(value)} for name, value in report.facts],
        "cards": [_card(card, judges=verdict.judges) for card in verdict.cards],
        "picture": _image(report.picture, figures) if report.picture else None,
        "sections": [section for section in sections if section["blocks"]],
        "flights": [_flight(flight, figures, numbers) for flight in flights],
    }


def _in_print(sections: Sequence[Section]) -> list[Section]:
    """Return the sections with that of single flights right before the flights, which are printed
    before the last two.
    """
    of_flights = list(map(_is_of_flights, sections))
    flights, others = (
        [s for s, of in zip(sections, of_flights, strict=True) if of is which]
        for which in (True, False)
    )
    return [*others[:-_AFTER_FLIGHTS], *flights, *others[-_AFTER_FLIGHTS:]]


def _is_of_flights(section: Section) -> bool:
    return any(isinstance(block, FlightPicker) for block in section.blocks)


def _card(card: Card, *, judges: bool) -> Data:
    return {
        "name": card.name,
        "value": unbroken(card.value),
        "tone": card.tone,
        "small": unbroken(card.small_print) if judges else card.note,
    }


def _section(section: Section, figures: Figures) -> Data:
    """Return a section without its folds, and its picker, whose flights have pages of their own."""
    blocks = [
        _block(block, figures)
        for block in section.blocks
        if not isinstance(block, FlightPicker | Fold)
    ]
    return {"title": section.title, "blocks": blocks}


def _block(block: Block, figures: Figures) -> Data:
    shown = _image(block, figures) if isinstance(block, Chart) else asdict(block)
    if isinstance(block, Table):
        shown["head"] = [unbroken(title) for title in block.head]
    return {"kind": type(block).__name__, **shown}


def _flight(flight: FlightContent, figures: Figures, numbers: Iterator[int]) -> Data:
    charts = [replace(chart, number=f"Figure {next(numbers)}") for chart in flight.charts]
    images = [
        {"kind": "Chart", **_image(chart, figures, f"{flight.flight_id}-")} for chart in charts
    ]
    return {"title": flight.title, "charts": images}


def _image(chart: Chart, figures: Figures, prefix: str = "") -> Data:
    file = f"{prefix}{chart.name}.svg"
    figures[file] = chart
    return {"file": file, "number": chart.number, "caption": chart.caption}
