"""One flight of a study, alone."""

import sys
from dataclasses import replace
from typing import Any

from common.run_layout import OVERRIDES, SUMMARY
from common.verdict import RunVerdict
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, Progress, StudySummary
from scenarios.engine.task import Task, Work
from scenarios.experiment.requests import table_of
from scenarios.flight_runner import FlightWork
from scenarios.measures.verdict import Judge
from scenarios.studies.flight_study import FlightStudy
from scenarios.studies.summary import FlightNotes, trial_line


class SingleFlight:
    """One flight of a study, as a study. Its row is in the summary, even if it is one of a
    comparison.

    Parameters
    ----------
    study : that it is a flight of
    task : the flight
    flight_id, trial : its name, and that of its trial
    table : the file that its row would be in
    """

    what = "flights"
    planned, beside = 1, 0

    def __init__(
        self, study: FlightStudy, task: Task, *, flight_id: str, trial: str, table: str
    ) -> None:
        self._study, self._task, self._flight_id, self._trial, self._table = (
            study,
            task,
            flight_id,
            trial,
            table,
        )
        self.config_hash = f"{study.config_hash} {flight_id}"

    @classmethod
    def of(cls, study: FlightStudy, flight_id: str) -> "SingleFlight | None":
        """Return the flight of this name, or None if the study has none."""
        first = 0
        for name, experiment in study.experiments.items():
            for number in range(experiment.flights):
                found, variant = experiment.named(number)
                if found == flight_id:
                    task = study.task(first + number)
                    return cls(study, task, flight_id=found, trial=name, table=table_of(variant))
            first += experiment.flights
        return None

    def initial_manifest(self) -> dict[str, Any]:
        """Return the manifest as written before the flight."""
        # A flight that was chosen is no random sample.
        one = {
            "trial_flights": {self._trial: 1},
            "flights_planned": 1,
            "sampled_at_random": {self._trial: False},
        }
        return self._study.initial_manifest() | one | {"config_hash": self.config_hash}

    def work(self, run: RunDirectory) -> Work:
        """Return the work of the study, which keeps every time history."""
        work = self._study.work(run)
        return replace(work, histories=sys.maxsize) if isinstance(work, FlightWork) else work

    def run(self, fly: Fly, _run: RunDirectory, _journal: Journal) -> None:
        """Fly the flight; its time history is written."""
        fly([self._task])

    def postprocess(self, _run: RunDirectory, _journal: Journal, _progress: Progress) -> None:
        """Do nothing: one flight has only tables and its time history."""

    def export(self, run: RunDirectory, journal: Journal) -> None:
        """Write the tables; the row is in ``summary.csv`` even if the flight is one of a
        comparison.
        """
        self._study.export(run, journal)
        if self._table != SUMMARY:
            (run.path / self._table).replace(run.path / SUMMARY)

    def judged(self, journal: Journal) -> RunVerdict:
        """Return what the flight has shown, beside a comparison's other flights or without."""
        judge = Judge({self._trial: 1})
        overrides = dict(journal.numbered(OVERRIDES))
        for number, row in journal.numbered(self._table):
            judge.add(row, self._study.criteria_of(row["trial"], overrides.get(number, {})))
        return judge.verdict()

    def summary(self, journal: Journal) -> StudySummary:
        """Return how the flight ended."""
        verdict, notes = self.judged(journal), FlightNotes.of(journal.rows(self._table))
        line = f"{self._flight_id}: {trial_line(verdict.whole)}"
        lines = [line, *notes.not_met_lines("  ")]
        return StudySummary(verdict=verdict, lines=lines, manifest={})
