"""Results of flying: runs and flights."""

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

_FLIGHTS_SHOWN = 12
"""Largest number of flights in a notebook's table."""

_UNMEASURED = [
    outcome.value for outcome in (Outcome.INFEASIBLE, Outcome.TRIM_FAILED, Outcome.FAILED)
]
"""Outcomes of flights without any measurement."""


class Run:
    """The results of a study, returned by ``run``.

    Tables are data frames with the columns' units in ``attrs["units"]``, such as
    ``summary.attrs["units"]["min_distance_m"]``, and their meanings in ``attrs["meanings"]``. They
    are copies: changing them changes no flight and no report.

    Parameters
    ----------
    directory : run directory
    lines : the result in lines of text

    Attributes
    ----------
    directory, lines : as given
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
        """Return the verdict, with counts and with the worst flights of each criterion."""
        return self._data.verdict

    @property
    def met(self) -> bool:
        """Return whether every flight met its requirement, which gives exit status 0."""
        return self.verdict.exit_status == MET

    @functools.cached_property
    def summary(self) -> "pd.DataFrame":
        """Return a row per flight, or per trajectory and law of a study of convergence."""
        return self._explained(self._data.summary.copy(), SUMMARY)

    @functools.cached_property
    def comparison(self) -> "pd.DataFrame":
        """Return a row per flight of the comparisons; there may be none."""
        return self._explained(self._data.comparison.copy(), COMPARISON)

    @functools.cached_property
    def crossings(self) -> "pd.DataFrame":
        """Return a row per crossing of the plume."""
        return self._explained(self._data.crossings.copy(), CROSSINGS)

    @functools.cached_property
    def draws(self) -> "pd.DataFrame":
        """Return a row per flight with the keys that were swept or sampled at random."""
        return self._explained(self._data.draws.copy(), DRAWS)

    @property
    def columns(self) -> Mapping[str, Table]:
        """Return the descriptions of columns, of type ``Column``, by file and name."""
        return self._data.columns

    def _explained(self, frame: "pd.DataFrame", table: str) -> "pd.DataFrame":
        """Add units and meanings of the columns to a table's attributes; return the table."""
        columns = {str(name): self._data.column(str(name), table) for name in frame}
        numbers = frame.select_dtypes(include="number").columns
        frame.attrs["units"] = {str(name): columns[str(name)].unit for name in numbers}
        frame.attrs["meanings"] = {name: of.meaning for name, of in columns.items() if of.meaning}
        return frame

    @property
    def flights(self) -> Mapping[str, "Flight"]:
        """Return the flights by name, first those of the study, then those of its comparisons."""
        tables = (self._data.summary, self._data.comparison)
        if "trial" not in self._data.summary:
            return {}
        return {str(name): Flight(self, str(name)) for rows in tables for name in rows["flight_id"]}

    @property
    def statistics(self) -> Statistics | None:
        """Return the statistics of a Monte Carlo study, or None for any other study."""
        return None if self._data.statistics is None else statistics_of(self._data.statistics)

    def report(
        self, path: str | os.PathLike[str] | None = None, *, all_flights: bool = False
    ) -> str:
        """Return the report as the text of an HTML page, or write it to a path and return the path.

        Parameters
        ----------
        path : path of an HTML or PDF file, by its suffix; None to write nothing
        all_flights : whether a printed report has every flight instead of the most informative ones

        Raises
        ------
        InputError : the suffix is unknown, or the file cannot be written
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
        """Return the result as lines of text."""
        return "\n".join((f"Run: {self.manifest['title']}", *self.lines))

    def _repr_html_(self) -> str:
        """Return the result and the first flights as tables, for a notebook."""
        columns = [
            name
            for name in ("flight_id", "outcome", "criteria_met", "min_distance_m", "crossing_count")
            if name in self.summary
        ]
        rows = self.summary[columns].head(_FLIGHTS_SHOWN).itertuples(index=False)
        more = len(self.summary) - _FLIGHTS_SHOWN
        text = "".join(
            f"<p>{html.escape(line)}</p>" for line in (self.manifest["title"], *self.lines)
        )
        return f"{text}{table([columns, *rows])}{f'<p>and {more} more</p>' if more > 0 else ''}"


class Flight:
    """One flight, returned by ``fly`` or from ``Run.flights``.

    Parameters
    ----------
    run : run of the flight
    flight_id : name of the flight

    Attributes
    ----------
    run, flight_id : as given
    """

    def __init__(self, run: Run, flight_id: str) -> None:
        self.run, self.flight_id = run, flight_id

    @functools.cached_property
    def row(self) -> "pd.Series[Any]":
        """Return the flight's row of the summary; units are in ``attrs["units"]``."""
        data = self.run._data
        for rows, name in ((data.summary, SUMMARY), (data.comparison, COMPARISON)):
            found = rows[rows["flight_id"] == self.flight_id]
            if len(found):
                row = found.iloc[0].rename(self.flight_id)
                row.attrs = dict(self.run._explained(found, name).attrs)
                return row
        raise InputError(
            f"the run in '{self.run.directory}' has no flight '{self.flight_id}'; its summary"
            " lists them"
        )

    @functools.cached_property
    def history(self) -> "pd.DataFrame":
        """Return the time history; ``attrs`` has "units" and "meanings" of the columns.

        Raises
        ------
        InputError : the run has no time history of this flight
        """
        history = self.run._data.history(self.flight_id)
        if history is None:
            raise InputError(
                f"flight '{self.flight_id}' has no time history; raise histories, or fly it"
                " alone with fly"
            )
        return self.run._explained(history, FLIGHTS)

    @functools.cached_property
    def crossings(self) -> "pd.DataFrame":
        """Return a row per crossing of the plume after settling."""
        crossings = self.run._data.crossings_of(self.flight_id).reset_index(drop=True)
        return self.run._explained(crossings, CROSSINGS)

    @property
    def met(self) -> bool:
        """Return whether the flight kept out, completed its mission, and met every criterion."""
        return bool(self.row["criteria_met"])

    @property
    def kept_out(self) -> bool:
        """Return whether the flight kept out of the keep-out area and came back."""
        return KeepOut.of(self.row.to_dict()) is KeepOut.KEPT_OUT

    @property
    def reasons(self) -> tuple[str, ...]:
        """Return the reasons why the flight is not met, as sentences; empty if it is met."""
        message = str(self.row["message"])
        # The message of a flight without any measurement is one sentence with a remedy.
        return tuple(
            filter(None, [message] if self.row["outcome"] in _UNMEASURED else message.split("; "))
        )

    def plot(self) -> "Figure":
        """Return track and time histories as a matplotlib figure.

        Raises
        ------
        InputError : the run has no time history of this flight
        """
        from reports.output import flight_figure

        with _one_line():
            return flight_figure(self.run._data, self.flight_id)

    def export(self, path: str | os.PathLike[str]) -> Path:
        """Write the flight in the format that the suffix names; return the path.

        Parameters
        ----------
        path : path of the file: .parquet, .arrow, .csv (the time history), .kmz, .acmi, .czml,
            .mcap, .nc, .tlog, .geojson, .tracks.csv, and suffixes of further exporters

        Raises
        ------
        InputError : the suffix is unknown, a package or the time history is missing, or the file
            cannot be written
        """
        from reports.output import write_flight

        with _one_line():
            write_flight(self.run._data, self.flight_id, Path(path))
        return Path(path)

    def __repr__(self) -> str:
        """Return the flight's name and how it ended."""
        return (
            f"Flight {self.flight_id}:"
            f" {'met' if self.met else '; '.join((str(self.row['outcome']), *self.reasons))}"
        )

    def _repr_html_(self) -> str:
        """Return the flight's main figures as a table, and its track, for a notebook."""
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
    """Return a value for a notebook: numbers have four digits and a unit."""
    return (
        f"{value:.4g}{'' if unit == DIMENSIONLESS else f' {unit}'}"
        if isinstance(value, float)
        else value
    )


@contextmanager
def _one_line() -> Iterator[None]:
    """Raise errors of runs, formats and files as an InputError."""
    from common.errors import PluginError
    from reports.errors import ReportError

    try:
        yield
    except (ReportError, PluginError) as error:
        raise InputError(str(error)) from None
