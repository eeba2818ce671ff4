"""The report as one self-contained HTML file."""

import re
from itertools import product
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from reports.document.blocks import Content, FlightPicker
from reports.render import replay
from reports.render.plotly_charts import draw
from reports.render.script_data import for_script
from reports.render.words import unbroken

PLOTLY = Path(__file__).parent / "bundle" / "plotly-cartesian.min.js"
"""Library that draws the charts of every page; ``bundle/README.md`` says where it comes from."""


_PAPER = 1040
"""Width of figures of a page that is printed [px]; the page is drawn as wide as that of a large
screen.
"""

_LONG = 16
"""Letters of a word from which it may go on over the next line, and of a cell beyond which it may.
"""


def write_html(report: Content, path: Path) -> None:
    """Write the report to ``path``; it opens from disk without a network."""
    environment = Environment(
        loader=PackageLoader("reports.render"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
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
        breakable=_breakable,
        is_figures=_is_figures,
        paper_width=_PAPER,
        unbroken=unbroken,
    )
    path.write_text(page, encoding="utf-8")


def _breakable(words: str) -> Markup:
    """Return words whose long keys may be broken after a point or a stroke, and whose hashes after
    any 16 digits.
    """
    keys = re.compile(rf"\S{{{_LONG},}}")
    text = keys.sub(
        lambda key: re.sub(r"([_.])(?=[a-z])|([0-9a-f]{16})(?=[0-9a-f])", r"\1\2<wbr>", key[0]),
        str(escape(words)),
    )
    return Markup(text)


def _is_figures(cell: str) -> bool:
    """Return whether a cell of a table stays on one line: it is short, or figures alone with units
    of one letter.
    """
    return len(cell) <= _LONG or not re.search(r"[^\W\d_]{2}", cell.replace(" to ", " "))


def _flights(picker: FlightPicker) -> tuple[str, str]:
    """Return the figures of all flights, with their captions, and, once each, the curves in them.

    Time is that of every history of a flight.
    """
    curves: dict[str, int] = {}
    figures = {
        flight.flight_id: [draw(chart) | {"caption": chart.caption} for chart in flight.charts]
        for flight in picker.flights
    }
    for trace, axis in product(
        (
            trace
            for drawn in figures.values()
            for figure in drawn
            for panel in figure["panels"]
            for trace in panel["data"]
        ),
        ("x", "y"),
    ):
        if trace[axis]:
            trace[axis] = curves.setdefault(trace[axis]["bdata"], len(curves))
    return for_script(figures), for_script(list(curves))
