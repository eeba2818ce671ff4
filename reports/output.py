"""What a program asks of a run in memory: the figure of a flight, the report as a file, a flight in
another format.
"""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from common.run_layout import time_history_path
from common.text import did_you_mean
from reports.errors import ReportError
from reports.run.files import damage_named, failure_named, written
from reports.run.run_data import RunData

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from reports.document.chart import Chart
    from reports.export import Exporter

TRACKS = "tracks"
"""Name of the figure of where a flight went."""


def flight_figure(run: RunData, flight_id: str, *, tracks_alone: bool = False) -> "Figure":
    """Return the track of a flight and its time histories as one figure: those of the report.

    Parameters
    ----------
    run : that has its time history
    flight_id : its name
    tracks_alone : without the time histories

    Raises
    ------
    ReportError : it has no time history, its run is damaged, or it cannot be drawn
    """
    from reports.render.matplotlib_charts import draw

    with damage_named(run.path):
        charts = _charts(run, flight_id)
    with failure_named(f"flight '{flight_id}' could not be drawn"):
        return draw(*(chart for chart in charts if chart.name == TRACKS or not tracks_alone))


def _charts(run: RunData, flight_id: str) -> "list[Chart]":
    import pandas as pd

    from reports.flights.single_flight import flight_charts
    from reports.flights.tracks import flight_view
    from reports.run.trials import read_trials

    rows = pd.concat([table for table in (run.summary, run.comparison) if len(table)])
    row = rows[rows["flight_id"] == flight_id].iloc[0]
    trial = next(trial for trial in read_trials(run) if trial.key == row["trial"])
    if not (charts := flight_charts(flight_view(trial, row))):
        raise _without_history(flight_id)
    return charts


def write_report(run: RunData, path: Path, *, all_flights: bool = False) -> None:
    """Write the report of a run, as HTML or PDF by the suffix of ``path``.

    Parameters
    ----------
    run, path : the run, and the file
    all_flights : print every flight that can be picked on the screen, and not only a selection

    Raises
    ------
    ReportError : another suffix, or a run that has no report, is damaged, or cannot be drawn
    """
    from functools import partial

    from reports.registry import content
    from reports.render.html import write_html
    from reports.render.pdf import write_pdf

    writers: dict[str, Callable[..., None]] = {
        ".html": write_html,
        ".pdf": partial(write_pdf, all_flights=all_flights),
    }
    if path.suffix not in writers:
        raise ReportError(
            f"'{path.name}' ends in {path.suffix!r}; a report is written as {' or '.join(writers)}"
        )
    with damage_named(run.path):
        report = content(run)
    with failure_named(f"the report of '{run.path}' could not be drawn"):
        written(path, partial(writers[path.suffix], report))


def write_flight(run: RunData, flight_id: str, path: Path) -> None:
    """Write a flight in the format that the suffix of ``path`` names: its time history, or an
    export.

    Parameters
    ----------
    run, flight_id : the run, and the name of the flight
    path : the file; .parquet, .arrow and .csv hold the time history, other suffixes are those of
        the exporters

    Raises
    ------
    ReportError : no format has this suffix, or its packages are missing, or the flight has no time
        history or cannot be written
    PluginError : an exporter does not load
    """
    if not run.has_history(flight_id):
        raise _without_history(flight_id)
    exporters = _exporters()
    if (
        suffix := next((suffix for suffix in exporters if path.name.endswith(suffix)), None)
    ) is not None:
        write = exporters[suffix]().write
        with failure_named(f"flight '{flight_id}' could not be written as '{path.name}'"):
            written(path, lambda part: write(run.of_flight(flight_id), part))
        return
    writers = {".parquet": _as_parquet, ".arrow": _as_arrow, ".csv": _as_csv}
    if path.suffix not in writers:
        known = [*writers, *exporters]
        guess = did_you_mean(path.suffix, known) or ";"
        raise ReportError(
            f"'{path.name}' ends in {path.suffix!r}{guess} formats of a flight are"
            f" {', '.join(known)}"
        )
    source = run.path / time_history_path(flight_id)
    with failure_named(f"flight '{flight_id}' could not be written as '{path.name}'"):
        written(path, lambda part: writers[path.suffix](source, part))


def _exporters() -> "dict[str, type[Exporter]]":
    """Return the exporters by their suffixes, the longest first; none is made yet, as packages of
    another may be missing.
    """
    from reports.export import EXPORTERS

    found = [EXPORTERS.get(name) for name in EXPORTERS.names()]
    suffixes = {part.suffix if hasattr(part, "suffix") else part().suffix: part for part in found}
    return dict(sorted(suffixes.items(), key=lambda item: -len(item[0])))


def _as_parquet(source: Path, path: Path) -> None:
    """Copy a time history as it is."""
    path.write_bytes(source.read_bytes())


def _as_arrow(source: Path, path: Path) -> None:
    """Write a time history as an Arrow file, with the units of its columns; uncompressed, so that
    it can be mapped into memory.
    """
    import pyarrow.feather
    import pyarrow.parquet

    pyarrow.feather.write_feather(
        pyarrow.parquet.read_table(source), path, compression="uncompressed"
    )


def _as_csv(source: Path, path: Path) -> None:
    """Write a time history as text; every number reads back as the same."""
    import pandas as pd

    pd.read_parquet(source).to_csv(path, index=False, lineterminator="\n")


def _without_history(flight_id: str) -> ReportError:
    return ReportError(
        f"flight '{flight_id}' has no time history: it was not flown, or its run kept fewer"
        " (histories); fly it alone to have it"
    )
