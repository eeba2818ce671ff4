"""The report as one self-contained HTML file."""

from itertools import product
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from jinja2.utils import htmlsafe_json_dumps

from reports.document.blocks import Content, FlightPicker
from reports.render import replay
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
        replay=replay,
        replay_data=lambda picker: _for_script(replay.data(picker)),
    )
    path.write_text(page, encoding="utf-8")


def _flights(picker: FlightPicker) -> tuple[str, str]:
    """Return the figures of all flights and, once each, the curves in them: time is that of every history of a flight."""
    curves: dict[str, int] = {}
    figures = {flight.flight_id: [draw(chart) for chart in flight.charts] for flight in picker.flights}
    for trace, axis in product((trace for drawn in figures.values() for figure in drawn for trace in figure["data"]), ("x", "y")):
        if trace[axis]:
            trace[axis] = curves.setdefault(trace[axis]["bdata"], len(curves))
    return _for_script(figures), _for_script(list(curves))


def _for_script(value: Any) -> str:
    """Return JSON for a script element: no text in it can end the element, nor begin a comment that hides its end."""
    return htmlsafe_json_dumps(value, separators=(",", ":"))
