"""The report as a PDF, set by Typst."""

import json
import tempfile
from dataclasses import asdict
from pathlib import Path
from typing import Any

import typst

from reports.document.blocks import Block, Content, FlightContent, FlightPicker, Section
from reports.document.chart import Chart
from reports.render.matplotlib_charts import draw

TEMPLATE = Path(__file__).parent / "templates" / "report.typ"

Data = dict[str, Any]


def write_pdf(report: Content, path: Path, *, all_flights: bool = False) -> None:
    """Write the report to ``path``, with ``all_flights`` or with those that are printed."""
    with tempfile.TemporaryDirectory() as folder:
        directory = Path(folder)
        (directory / "report.typ").write_text(TEMPLATE.read_text(encoding="utf-8"), encoding="utf-8")
        data = _data(report, directory, all_flights=all_flights)
        (directory / "data.json").write_text(json.dumps(data), encoding="utf-8")
        path.write_bytes(typst.compile(str(directory / "report.typ")))


def _data(report: Content, directory: Path, *, all_flights: bool) -> Data:
    pickers = [block for section in report.sections for block in section.blocks if isinstance(block, FlightPicker)]
    sections = [_section(section, directory) for section in report.sections]
    return {
        "title": report.title,
        "description": report.description,
        "changes": report.changes,
        "verdict": asdict(report.verdict),
        "sections": [section for section in sections if section["blocks"]],
        "flights": [_flight(flight, directory) for picker in pickers for flight in picker.flights if all_flights or flight.printed],
    }


def _section(section: Section, directory: Path) -> Data:
    """Return a section without its picker, whose flights have pages of their own."""
    blocks = [_block(block, directory) for block in section.blocks if not isinstance(block, FlightPicker)]
    return {"title": section.title, "blocks": blocks}


def _block(block: Block, directory: Path) -> Data:
    return {"kind": type(block).__name__, **(_image(block, directory) if isinstance(block, Chart) else asdict(block))}


def _flight(flight: FlightContent, directory: Path) -> Data:
    return {"title": flight.title, "charts": [_image(chart, directory, f"{flight.flight_id}-") for chart in flight.charts]}


def _image(chart: Chart, directory: Path, prefix: str = "") -> Data:
    file = f"{prefix}{chart.name}.svg"
    draw(chart).savefig(directory / file, dpi=200)
    return {"file": file, "caption": chart.caption}
