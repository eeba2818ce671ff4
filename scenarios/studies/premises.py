"""A study of the keep-out guard's premises in the corners of the declared ranges."""

from collections.abc import Mapping
from dataclasses import replace

import pandas as pd

from common.columns import Table
from common.premises import PREMISE_COLUMNS
from common.run_layout import PREMISES, SUMMARY
from gnc.estimation.error_budget import EXCEEDED_PER_HOUR
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import StudySummary
from scenarios.statistics.estimates import TABLE_COLUMNS, premise_lines, premise_table
from scenarios.studies.base import FlightStudy, frame, study

_COLUMNS = ("flight_id", "turbulence", "duration_s", *PREMISE_COLUMNS)
"""Columns of the summary that the table is made of."""


@study("premises")
class PremisesStudy(FlightStudy):
    """Flights of cases. A table has the largest ratio of error to budget for each case and term of
    the error budget, and the number of flights in which the error was larger.
    """

    def export(self, run: RunDirectory, journal: Journal) -> None:
        """Write its tables."""
        super().export(run, journal)
        run.write_frame(PREMISES, self._table(journal))

    def columns(self) -> Mapping[str, Table]:
        """Return the descriptions of its tables' columns, by file."""
        return {**super().columns(), PREMISES: TABLE_COLUMNS}

    def summary(self, journal: Journal) -> StudySummary:
        """Return the result so far, with the table."""
        found = super().summary(journal)
        return replace(found, lines=[*found.lines, *premise_lines(self._table(journal))])

    def _table(self, journal: Journal) -> pd.DataFrame:
        numbered = list(journal.numbered(SUMMARY))
        (experiment,) = self.experiments.values()
        cases = [experiment.point_of(number)[0].label for number, _ in numbered]
        rows = frame((row for _, row in numbered), _COLUMNS)
        return premise_table(rows, cases, EXCEEDED_PER_HOUR)
