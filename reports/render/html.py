"""The report as one self-contained HTML file."""

import json
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from jinja2.utils import htmlsafe_json_dumps
from plotly.offline import get_plotlyjs

from reports.document.blocks import Content, FlightPicker
from reports.document.chart import Chart
from reports.render.plotly_charts import draw


def write_html(report: Content, path: Path) -> None:
    """Write the report to ``path``; it opens from disk without a network."""
    environment = Environment(
        loader=PackageLoader("reports.render"), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    page = environment.get_template("report.html.j2").render(
        report=report,
        plotly=get_plotlyjs(),
        kind=lambda block: type(block).__name__,
        figure=lambda chart: _for_script(_figure(chart)),
        flights=_flights,
    )
    path.write_text(page, encoding="utf-8")


def _flights(picker: FlightPicker) -> str:
    return _for_script({flight.flight_id: [_figure(chart) for chart in flight.charts] for flight in picker.flights})


def _figure(chart: Chart) -> dict[str, Any]:
    figure: dict[str, Any] = json.loads(draw(chart).to_json())
    # The template would be repeated with every figure; the page sets it once.
    figure["layout"].pop("template", None)
    return figure


def _for_script(value: Any) -> str:
    """Return JSON for a script element: no text in it can end the element, nor begin a comment that hides its end."""
    return htmlsafe_json_dumps(value, separators=(",", ":"))
