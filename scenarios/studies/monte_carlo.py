"""Monte Carlo over the real sea: how often, how much, what it depends on, and how sure that is."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import pandas as pd

from common.run_layout import DRAWS, SUMMARY
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, Progress, StudySummary
from scenarios.engine.task import Row, Task
from scenarios.experiment.sampling import Points
from scenarios.schema.monte_carlo_config import MonteCarloScenario
from scenarios.statistics.estimates import COLUMNS, study_statistics
from scenarios.statistics.stopping import looks, tight_enough
from scenarios.studies.sea_study import SeaStudy


class MonteCarloStudy(SeaStudy):
    """Flights that are drawn from declared distributions, until they are all flown or an interval is as tight as was asked for.

    Parameters
    ----------
    scenario, name : what to fly, and what it is called
    overrides : how the scenario differs from the one of that name, for the record

    Raises
    ------
    InputError : an unknown aircraft or fault, or a key that cannot be drawn
    """

    def __init__(self, scenario: MonteCarloScenario, name: str, *, overrides: Sequence[str] = ()) -> None:
        super().__init__(scenario, name, overrides=overrides)
        self._scenario = scenario
        self._points = Points(scenario.sampling, dimension=len(scenario.draws), flights=scenario.flights, seed=scenario.seed)
        self._looks, self._stopped = 0, False

    def task(self, number: int) -> Task:
        """Return the task of a flight, at its point."""
        return Task(number=number, point=self._points.at(number))

    def run(self, fly: Fly, run: RunDirectory, journal: Journal) -> None:
        """Have flights flown up to one look after the other, until one shows what was asked for."""
        first = 0
        stops = self._scenario.statistics.stops
        for flights in looks(self.planned) if stops else [self.planned]:
            self._looks += 1
            fly(self.task(number) for number in range(first, flights))
            first = flights
            if stops and self._tight(journal, flights):
                self._stopped = flights < self.planned
                self.flights = dict.fromkeys(self.flights, flights)
                break
        fly(self.representative_flights(run, journal))

    def _tight(self, journal: Journal, flights: int) -> bool:
        s = self._scenario.statistics
        rows = _frame(journal.rows(SUMMARY, below=flights), COLUMNS)
        return tight_enough(
            rows,
            look_number=self._looks,
            confidence=s.confidence,
            violation_upper=s.violation_upper,
            distance_quantile_width_m=s.distance_quantile_width_m,
            distance_quantile=s.distance_quantile,
        )

    def postprocess(self, run: RunDirectory, journal: Journal, progress: Progress) -> None:
        """Write ``statistics.json``."""
        progress("estimating", self.planned, self.planned)
        statistics = study_statistics(
            _frame(journal.rows(SUMMARY), COLUMNS),
            _frame(journal.rows(DRAWS), self.tables[DRAWS]),
            confidence=self._scenario.statistics.confidence,
            seed=self._scenario.seed,
            look_number=self._looks if self._scenario.statistics.stops else None,
        )
        run.write_json(run.statistics, statistics)

    def summary(self, journal: Journal) -> StudySummary:
        """Return what the flights have come to, and whether the study stopped by itself."""
        found = super().summary(journal)
        if not self._stopped:
            return found
        asked = self._scenario.flights
        line = f"stopped after {self.planned} of {asked} flights: what was asked for is as tight as that"
        return replace(found, lines=[*found.lines, line])


def _frame(rows: Iterable[Row], columns: Sequence[str]) -> pd.DataFrame:
    return pd.DataFrame([[row.get(name) for name in columns] for row in rows], columns=list(columns))
