"""The report as a PDF, set by Typst."""

import json
import tempfile
from dataclasses import asdict
from pathlib import Path
from typing import Any

import typst

from reports.chart import Chart
from reports.content import Content
from reports.matplotlib_charts import draw
from reports.tables import Table

TEMPLATE = Path(__file__).parent / "templates" / "report.typ"


def write_pdf(report: Content, path: Path) -> None:
    """Write the report to ``path``."""
    with tempfile.TemporaryDirectory() as folder:
        directory = Path(folder)
        (directory / "report.typ").write_text(TEMPLATE.read_text(encoding="utf-8"), encoding="utf-8")
        data = _data(report, directory)
        (directory / "data.json").write_text(json.dumps(data), encoding="utf-8")
        path.write_bytes(typst.compile(str(directory / "report.typ")))


def _data(report: Content, directory: Path) -> dict[str, Any]:
    def image(chart: Chart | None, name: str = "") -> dict[str, str] | None:
        if chart is None:
            return None
        file = f"{name or chart.name}.svg"
        draw(chart).savefig(directory / file, dpi=200)
        return {"file": file, "caption": chart.caption}

    def table(t: Table | None) -> dict[str, Any] | None:
        return None if t is None else asdict(t)

    return {
        "title": report.title,
        "description": report.description,
        "changes": report.changes,
        "safe": report.verdict.safe,
        "complete": report.verdict.complete,
        "failures": report.verdict.failures,
        "headline": report.verdict.headline,
        "detail": report.verdict.detail,
        "figures": [list(figure) for figure in report.verdict.figures],
        "sweep": [image(chart) for chart in report.sweep],
        "flights_table": table(report.flights_table),
        "comparison": image(report.comparison),
        "comparison_table": table(report.comparison_table),
        "flights": [
            {
                "name": f"ν = {flight.nu:.2f}: {flight.outcome}",
                "charts": [image(chart, f"{flight.flight_id}-{chart.name}") for chart in flight.charts],
            }
            for flight in report.flights
        ],
        "innerloop": [image(chart) for chart in report.innerloop],
        "margins": table(report.margins),
        "steps": table(report.steps),
        "trims": table(report.trims),
        "oscillation": table(report.oscillation),
        "parameters": table(report.parameters),
        "provenance": table(report.provenance),
    }
