"""What flying returns: a run, and its flights."""

import functools
import html
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from common.columns import DIMENSIONLESS, Table
from common.run_layout import COMPARISON, CROSSINGS, DRAWS, FLIGHTS, REPORT_HTML, SUMMARY
from common.verdict import MET, KeepOut, RunVerdict
from scenarios.api.html import picture, table
from scenarios.api.statistics import Statistics, statistics_of
from scenarios.errors import InputError
from scenarios.flight.outcome import Outcome

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from reports.run.run_data import RunData

_SHOWN = 12
"""Flights that a notebook shows at most."""

_UNMEASURED = [
    outcome.value for outcome in (Outcome.INFEASIBLE, Outcome.TRIM_FAILED, Outcome.FAILED)
]
"""How flights end of which nothing is measured."""


class Run:
    """The results of a study. Made by ``run``.

    Tables are data frames with the units of their columns in ``attrs["units"]``, as
    ``summary.attrs["units"]["min_distance_m"]``, and what they are in ``attrs["meanings"]``. What is
    changed in them changes no flight and no report.

    Parameters
    ----------
    directory : of the run
    lines : the result in lines of text

    Attributes
    ----------
    directory, lines : the same
    """

    def __init__(self, directory: Path, *, lines: tuple[str, ...]) -> None:
        from reports.run.run_data import read_run

        self.directory, self.lines = directory, lines
        with _one_line():
            self._data: RunData = read_run(directory)

    @property
    def manifest(self) -> dict[str, Any]:
        """Return the manifest: configuration, software, outcomes."""
        return self._data.manifest

    @property
    def verdict(self) -> RunVerdict:
        """Return what the run has shown: its counts, each criterion with its worst flights, and
        whether everything is as required.
        """
        return self._data.verdict

    @property
    def met(self) -> bool:
        """Return whether every flight did what the scenario requires of it, as exit status 0 of the
        command line.
        """
        return self.verdict.exit_status == MET

    @functools.cached_property
    def summary(self) -> "pd.DataFrame":
        """Return a row per flight of the study, or per trajectory and law of a study of
        convergence.
        """
        return self._explained(self._data.summary.copy(), SUMMARY)

    @functools.cached_property
    def comparison(self) -> "pd.DataFrame":
        """Return a row per flight of the comparisons, possibly none."""
        return self._explained(self._data.comparison.copy(), COMPARISON)

    @functools.cached_property
    def crossings(self) -> "pd.DataFrame":
        """Return a row per crossing of the plume."""
        return self._explained(self._data.crossings.copy(), CROSSINGS)

    @functools.cached_property
    def draws(self) -> "pd.DataFrame":
        """Return a row per flight: the keys that were swept or sampled at random."""
        return self._explained(self._data.draws.copy(), DRAWS)

    @property
    def columns(self) -> Mapping[str, Table]:
        """Return what the columns are, by file and name: ``common.columns.Column`` has the title,
        symbol, unit, digits, meaning, and which side is worse.
        """
        return self._data.columns

    def _explained(self, frame: "pd.DataFrame", table: str) -> "pd.DataFrame":
        """Return a table with units and meanings of its columns in its attributes."""
        columns = {str(name): self._data.column(str(name), table) for name in frame}
        numbers = frame.select_dtypes(include="number").columns
        frame.attrs["units"] = {str(name): columns[str(name)].unit for name in numbers}
        frame.attrs["meanings"] = {name: of.meaning for name, of in columns.items() if of.meaning}
        return frame

    @property
    def flights(self) -> Mapping[str, "Flight"]:
        """Return the flights by their names, those of the study before those of its comparisons."""
        tables = (self._data.summary, self._data.comparison)
        if "trial" not in self._data.summary:
            return {}
        return {str(name): Flight(self, str(name)) for rows in tables for name in rows["flight_id"]}

    @property
    def statistics(self) -> Statistics | None:
        """Return what a Monte Carlo study shows and how sure that is, or None of any other study."""
        return None if self._data.statistics is None else statistics_of(self._data.statistics)

    def report(
        self, path: str | os.PathLike[str] | None = None, *, all_flights: bool = False
    ) -> str:
        """Return the report as the text of an HTML page; with a path write it, as HTML or PDF by
        the suffix, and return the path.

        Parameters
        ----------
        path : of the file; nothing is written without one
        all_flights : print every flight that can be picked on the screen, not only the most
            informative ones

        Raises
        ------
        InputError : a suffix of no report, or the file cannot be written
        """
        from reports.output import write_report

        with _one_line():
            if path is not None:
                write_report(self._data, Path(path), all_flights=all_flights)
                return str(path)
            with tempfile.TemporaryDirectory() as folder:
                page = Path(folder) / REPORT_HTML
                write_report(self._data, page)
                return page.read_text(encoding="utf-8")

    def __repr__(self) -> str:
        """Return the result in lines."""
        return "\n".join((f"Run: {self.manifest['title']}", *self.lines))

    def _repr_html_(self) -> str:
        """Return the result and the first flights as tables, for a notebook."""
        columns = [
            name
            for name in ("flight_id", "outcome", "criteria_met", "min_distance_m", "crossing_count")
            if name in self.summary
        ]
        rows = self.summary[columns].head(_SHOWN).itertuples(index=False)
        more = len(self.summary) - _SHOWN
        text = "".join(
            f"<p>{html.escape(line)}</p>" for line in (self.manifest["title"], *self.lines)
        )
        return f"{text}{table([columns, *rows])}{f'<p>and {more} more</p>' if more > 0 else ''}"


class Flight:
    """One flight. Made by ``fly``, or one of ``Run.flights``.

    Parameters
    ----------
    run : that it belongs to
    flight_id : its name

    Attributes
    ----------
    run, flight_id : the same
    """

    def __init__(self, run: Run, flight_id: str) -> None:
        self.run, self.flight_id = run, flight_id

    @functools.cached_property
    def row(self) -> "pd.Series[Any]":
        """Return its row of the summary; units are in ``attrs["units"]``."""
        data = self.run._data
        for rows, name in ((data.summary, SUMMARY), (data.comparison, COMPARISON)):
            found = rows[rows["flight_id"] == self.flight_id]
            if len(found):
                row = found.iloc[0].rename(self.flight_id)
                row.attrs = dict(self.run._explained(found, name).attrs)
                return row
        raise InputError(
            f"the run in '{self.run.directory}' has no flight '{self.flight_id}'; its summary lists them"
        )

    @functools.cached_property
    def history(self) -> "pd.DataFrame":
        """Return its time history; units are in ``attrs["units"]``, what columns are in
        ``attrs["meanings"]``.

        Raises
        ------
        InputError : the run kept none of this flight
        """
        history = self.run._data.history(self.flight_id)
        if history is None:
            raise InputError(
                f"flight '{self.flight_id}' has no time history; raise histories, or fly it alone, with fly"
            )
        return self.run._explained(history, FLIGHTS)

    @functools.cached_property
    def crossings(self) -> "pd.DataFrame":
        """Return a row per crossing of the plume after settling."""
        crossings = self.run._data.crossings_of(self.flight_id).reset_index(drop=True)
        return self.run._explained(crossings, CROSSINGS)

    @property
    def met(self) -> bool:
        """Return whether it kept out, completed its mission, and met every criterion."""
        return bool(self.row["criteria_met"])

    @property
    def kept_out(self) -> bool:
        """Return whether it is known to have kept out of the keep-out area, and came back."""
        return KeepOut.of(self.row.to_dict()) is KeepOut.KEPT_OUT

    @property
    def reasons(self) -> tuple[str, ...]:
        """Return why it is not met, a sentence each; none if it is."""
        message = str(self.row["message"])
        # That of a flight that ended before anything was measured is one sentence, with its remedy.
        return tuple(
            filter(None, [message] if self.row["outcome"] in _UNMEASURED else message.split("; "))
        )

    def plot(self) -> "Figure":
        """Return its track and its time histories as a figure of matplotlib.

        Raises
        ------
        InputError : the run kept no time history of this flight
        """
        from reports.output import flight_figure

        with _one_line():
            return flight_figure(self.run._data, self.flight_id)

    def export(self, path: str | os.PathLike[str]) -> Path:
        """Write it in the format that the suffix names, and return the path.

        Parameters
        ----------
        path : of the file: .parquet, .arrow, .csv (its time history), .kmz, .acmi, .czml, .mcap,
            .nc, .tlog, .geojson, .tracks.csv, and the suffixes of exporters that others add

        Raises
        ------
        InputError : another suffix, a package that is missing, no time history, or the file cannot
            be written
        """
        from reports.output import write_flight

        with _one_line():
            write_flight(self.run._data, self.flight_id, Path(path))
        return Path(path)

    def __repr__(self) -> str:
        """Return its name and how it ended."""
        return f"Flight {self.flight_id}: {'met' if self.met else '; '.join((str(self.row['outcome']), *self.reasons))}"

    def _repr_html_(self) -> str:
        """Return its main figures as a table, and its track, for a notebook."""
        from reports.output import flight_figure

        units = self.row.attrs["units"]
        shown = (
            "outcome",
            "message",
            "nu",
            "min_distance_m",
            "settling_time_s",
            "crossing_count",
            "tracking_error_rms_m",
        )
        rows = [
            (name, _cell(self.row[name], units.get(name, DIMENSIONLESS)))
            for name in shown
            if name in self.row
        ]
        text = f"<p>{html.escape(repr(self))}</p>{table(rows)}"
        data = self.run._data
        if not data.has_history(self.flight_id):
            return text
        return text + picture(
            flight_figure(data, self.flight_id, tracks_alone=True),
            f"Track of flight {self.flight_id}",
        )


def _cell(value: object, unit: str) -> object:
    """Return a value as a notebook shows it: four digits, and the unit if there is one."""
    return (
        f"{value:.4g}{'' if unit == DIMENSIONLESS else f' {unit}'}"
        if isinstance(value, float)
        else value
    )


@contextmanager
def _one_line() -> Iterator[None]:
    """Raise what is wrong with a run, a format, or a file to be written, as an InputError."""
    from common.errors import PluginError
    from reports.errors import ReportError

    try:
        yield
    except (ReportError, PluginError) as error:
        raise InputError(str(error)) from None
