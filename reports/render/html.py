"""The report as one self-contained HTML file."""

from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from reports.document.blocks import Content, FlightPicker
from reports.render import replay
from reports.render.plotly_charts import draw
from reports.render.script_data import for_script

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
        figure=lambda chart: for_script(draw(chart)),
        flights=_flights,
        replay=replay,
        cards=report.verdict.cards,
        failures=report.verdict.first_failures,
    )
    path.write_text(page, encoding="utf-8")


def _flights(picker: FlightPicker) -> str:
    return for_script({flight.flight_id: [draw(chart) for chart in flight.charts] for flight in picker.flights})
