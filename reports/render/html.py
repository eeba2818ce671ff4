"""The report as one self-contained HTML file."""

from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from jinja2.utils import htmlsafe_json_dumps

from reports.document.blocks import Content, FlightPicker
from reports.render.plotly_charts import draw

PLOTLY = Path(__file__).parent / "bundle" / "plotly-cartesian.min.js"
"""Library that draws the charts of every page; ``bundle/README.md`` says where it comes from."""


def write_html(report: Content, path: Path) -> None:
    """Write the report to ``path``; it opens from disk without a network."""
    environment = Environment(
        loader=PackageLoader("reports.render"), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    page = environment.get_template("report.html.j2").render(
        report=report,
        plotly=PLOTLY.read_text(encoding="utf-8"),
        kind=lambda block: type(block).__name__,
        figure=lambda chart: _for_script(draw(chart)),
        flights=_flights,
        cards=report.verdict.cards,
        failures=report.verdict.first_failures,
    )
    path.write_text(page, encoding="utf-8")


def _flights(picker: FlightPicker) -> str:
    return _for_script({flight.flight_id: [draw(chart) for chart in flight.charts] for flight in picker.flights})


def _for_script(value: Any) -> str:
    """Return JSON for a script element: no text in it can end the element, nor begin a comment that hides its end."""
    return htmlsafe_json_dumps(value, separators=(",", ":"))
