"""The report as one self-contained HTML file."""

import json
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from plotly.offline import get_plotlyjs

from reports.chart import Chart
from reports.content import Content
from reports.plotly_charts import draw


def write_html(report: Content, path: Path) -> None:
    """Write the report to ``path``; it opens from disk without a network."""
    environment = Environment(
        loader=PackageLoader("reports"), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    flights = {flight.flight_id: [_figure(chart) for chart in flight.charts] for flight in report.flights}
    page = environment.get_template("report.html.j2").render(
        report=report,
        plotly=get_plotlyjs(),
        figure=lambda chart: _for_script(_figure(chart)),
        flights=_for_script(flights),
    )
    path.write_text(page, encoding="utf-8")


def _figure(chart: Chart) -> dict[str, Any]:
    figure: dict[str, Any] = json.loads(draw(chart).to_json())
    # The template would be repeated with every figure; the page sets it once.
    figure["layout"].pop("template", None)
    return figure


def _for_script(value: Any) -> str:
    """Return JSON that cannot end the script element it stands in."""
    return json.dumps(value, separators=(",", ":")).replace("</", "<\\/")
