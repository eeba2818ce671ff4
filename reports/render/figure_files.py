"""Figures of a printed report as files, drawn in as many processes as there are cores and figures
for.
"""

import multiprocessing
import os
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.backends.backend_svg import FigureCanvasSVG

from common.interrupt import follow_parent
from reports.document.chart import Chart
from reports.render.matplotlib_charts import draw

_FIGURES_PER_PROCESS = 2
"""Figures below which a process takes longer to start than it saves [-]."""

_RESOLUTION = 200
"""Resolution of what is drawn as pixels [1/inch]."""

_SVG: dict[Any, Any] = {"svg.fonttype": "path", "svg.hashsalt": "report"}
"""Letters are drawn as curves, and names within a file do not differ from time to time."""

_to_draw: list[tuple[Chart, Path]] = []
"""What all processes draw. A forked process inherits it, which is faster than to send it."""


def write_figures(charts: Mapping[str, Chart], directory: Path) -> None:
    """Draw charts into files of the given names in a directory, as SVG, alike by any number of
    processes.
    """
    figures = [(chart, directory / name) for name, chart in charts.items()]
    processes = min(os.cpu_count() or 1, len(figures) // _FIGURES_PER_PROCESS)
    # A process that is not forked would have to import first all that draws.
    if processes < 2 or multiprocessing.get_start_method() != "fork":
        for chart, path in figures:
            write_figure(chart, path)
        return
    with ProcessPoolExecutor(processes, initializer=_begin, initargs=(figures,)) as pool:
        for _ in pool.map(_write, range(len(figures))):
            pass


def write_figure(chart: Chart, path: Path) -> None:
    """Draw one chart into a file."""
    figure = draw(chart)
    # `savefig` would draw all twice, the first time to lay it out alone.
    figure.set_dpi(_RESOLUTION)
    canvas: Any = FigureCanvasSVG(figure)
    with rc_context(_SVG):
        canvas.print_svg(path, metadata={"Date": None})


def _begin(figures: list[tuple[Chart, Path]]) -> None:
    follow_parent()
    _to_draw[:] = figures


def _write(index: int) -> None:
    write_figure(*_to_draw[index])
