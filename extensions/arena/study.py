"""Steering laws side by side: each is tuned with the same budget, then all fly from the same starts
in the same air.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

from common.columns import Column, Table, described
from common.run_layout import DRAWS
from extensions.arena import ARENA, TUNING_TABLE, WINDOW_TABLE
from extensions.arena.entrants import Entrant, cases_of, conditions_of, entrants_of
from extensions.arena.keys import ArenaKeys
from extensions.arena.results import estimates, limits, tuned_record
from extensions.arena.tuning import Tuner
from extensions.arena.window import (
    MEASURED_COLUMNS,
    WINDOW_COLUMNS,
    measured_figures,
    window_figures,
)
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, Progress, StudySummary
from scenarios.engine.task import Result, Row, Task
from scenarios.errors import InputError
from scenarios.experiment.requests import FlightRequest
from scenarios.flight.record import FlightRecord
from scenarios.flight_runner import FlightRunner
from scenarios.measures.columns import ANY_KEY, FLIGHT_COLUMNS
from scenarios.planning.flight_plan import FlightPlan
from scenarios.scenario.files import with_values
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.experiment import CaseConfig
from scenarios.studies.base import FlightStudy

TUNING_COLUMNS = described(
    {
        "entrant": Column("steering law and task", kind="text"),
        "evaluation": "number of the setting that was tried, from 0",
        "cost_m": "cost of the setting: its error, and its excess times a weight",
        "error_m": "mean over its flights of the rms distance to the reference",
        "excess_rad_s": "mean over its flights of the rms of the commanded heading rate less that"
        " of the reference",
        "parameters": Column("parameters of the law, as JSON", kind="text"),
        "message": Column("why the setting could not be flown", kind="text"),
        "wall_time_s": Column("computing time", title="Computing time", adds_up=True),
    }
)
"""Columns of ``tuning.csv``: a row per setting that the tuner of an arena tried."""


TABLES: Mapping[str, Table] = {
    WINDOW_TABLE: {name: FLIGHT_COLUMNS[name] for name in ("flight_id", "trial")}
    | WINDOW_COLUMNS
    | MEASURED_COLUMNS,
    TUNING_TABLE: TUNING_COLUMNS,
}

_GUIDANCE = "guidance."


@dataclass(frozen=True, kw_only=True)
class ArenaWork(FlightRunner):
    """Tunes laws, and flies them; other attributes are those of ``FlightRunner``.

    Attributes
    ----------
    entrants : tasks with numbers beyond the last flight tune these in order
    tuner : tunes them
    """

    entrants: tuple[Entrant, ...]
    tuner: Tuner

    def run(self, task: Task) -> Result:
        """Tune a law, or fly a flight."""
        entrant = self._tuned(task)
        if entrant is None:
            return super().run(task)
        began = time.perf_counter()
        rows = list(self.tuner.rows(entrant))
        for row in rows:
            row["wall_time_s"] = (time.perf_counter() - began) / len(rows)
        return Result(task=task, tables={TUNING_TABLE: rows}, items=0)

    def lost(self, task: Task, reason: str) -> Result:
        """Return the result of a task whose process was lost."""
        if (entrant := self._tuned(task)) is None:
            return super().lost(task, reason)
        # Without parameters and cost, because no setting was tried.
        row = {"entrant": entrant.name, "evaluation": 0, "message": reason}
        return replace(Result(task=task, tables={TUNING_TABLE: [row]}, items=0), lost=True)

    def request(self, task: Task) -> FlightRequest:
        """Return the flight of a task, with the parameters in its labels."""
        request = super().request(task)
        chosen = {key: float(value) for key, value in task.labels if key.startswith(_GUIDANCE)}
        return replace(request, scenario=with_values(request.scenario, chosen))

    def more_tables(
        self, request: FlightRequest, plan: FlightPlan, record: FlightRecord, row: Row
    ) -> dict[str, list[Row]]:
        """Return the figures of the end of a flight."""
        window = self.tuner.arena.window_s
        figures = window_figures(plan, record, window=window) | measured_figures(row, window=window)
        named = {"flight_id": request.flight_id, "trial": request.trial}
        return {WINDOW_TABLE: [named | figures]}

    def _tuned(self, task: Task) -> Entrant | None:
        """Return the law that a task tunes; None for a flight."""
        flights = self._ends[-1]
        return self.entrants[task.number - flights] if task.number >= flights else None


class ArenaStudy(FlightStudy):
    """Laws in the tasks that they can do, each condition a trial and each law in a task a case of
    it.

    Parameters
    ----------
    scenario, name : the arena, and its name
    trials : the same by its name
    overrides : overrides that were applied, recorded in the manifest

    Raises
    ------
    InputError : same as ``FlightStudy``; a law or a condition that does not exist
    """

    chooses_flights = True

    def __init__(
        self,
        scenario: Scenario,
        name: str,
        trials: Mapping[str, Scenario],
        *,
        overrides: Sequence[str] = (),
    ) -> None:
        self._arena, self._seed = ArenaKeys.of(scenario).arena, scenario.seed
        super().__init__(scenario, name, trials, overrides=overrides)
        keys = dict.fromkeys(
            f"guidance.{key}" for entrant in self.entrants for key in entrant.defaults
        )
        self.tables |= {name: dict(table) for name, table in TABLES.items()}
        self.tables[DRAWS] |= described(dict.fromkeys(keys, ANY_KEY))
        self._chosen: dict[str, Mapping[str, float]] = {}

    def expanded(self, trials: Mapping[str, Scenario]) -> dict[str, Scenario]:
        """Return a trial for each condition, with a case for each law."""
        ((name, self._scenario),) = trials.items()
        if self._scenario.flight.measured_s is not None:
            raise InputError(
                "flight.measured_s is given; an arena measures the last arena.window_s of each"
                " flight: set that"
            )
        for key, duration in (
            ("flight.duration_max_s", self._scenario.flight.duration_max_s),
            ("arena.tuning_duration_s", self._arena.tuning_duration_s),
        ):
            if self._arena.window_s > duration:
                raise InputError(
                    f"arena.window_s is {self._arena.window_s:g} s, and {key} {duration:g} s; a"
                    " flight is measured on its end: make the window shorter, or fly longer"
                )
        self.entrants, self._refused = entrants_of(self._scenario)
        return conditions_of(self._scenario, name, self.entrants)

    def work(self, run: RunDirectory) -> FlightRunner:
        """Return the work on its flights and on the tuning, after writing the aircraft's autopilot
        into the run directory.
        """
        work = super().work(run)
        lag = work.setup.lag if work.setup else self._scenario.kinematic.heading_rate_lag_s
        tuner = Tuner(scenario=self._scenario, arena=self._arena, lag=lag)
        shared = {field.name: getattr(work, field.name) for field in fields(work)}
        return ArenaWork(**shared, entrants=tuple(self.entrants), tuner=tuner)

    def run(self, fly: Fly, run: RunDirectory, journal: Journal) -> None:
        """Tune every law; then fly all of them, and some of each again for their tracks."""
        if self._arena.evaluations:
            fly(Task(number=self._numbers + i) for i in range(len(self.entrants)))
            self._refuse_untuned(journal)
            self._take_tuned(journal)
        fly(self.task(number) for number in range(self._numbers))
        # The report draws the first flight of each law in the first condition.
        first = range(0, len(self.entrants) * self._scenario.flights, self._scenario.flights)
        shown = {
            task.number: task
            for task in (
                *self.unrecorded(first, run, journal),
                *self.representative_flights(run, journal),
            )
        }
        fly(shown.values())

    def task(self, number: int) -> Task:
        """Return the task of a flight, with the chosen parameters of its law."""
        entrant = self.entrants[number // self._scenario.flights % len(self.entrants)]
        chosen = self._chosen.get(entrant.name, {})
        return Task(
            number=number,
            labels=tuple((f"guidance.{key}", repr(value)) for key, value in chosen.items()),
        )

    @staticmethod
    def _refuse_untuned(journal: Journal) -> None:
        """Raise an InputError if the process that tuned a law was lost: with its defaults it would
        not be compared fairly.
        """
        lost = {
            row["entrant"]: row["message"]
            for row in journal.rows(TUNING_TABLE)
            if "cost_m" not in row
        }
        if lost:
            name, reason = next(iter(lost.items()))
            more = f" and {len(lost) - 1} more" if len(lost) > 1 else ""
            raise InputError(
                f"the tuning of '{name}'{more} was lost ({reason}), and a law that is not tuned is"
                " not compared: continue with --resume, with a larger --time-limit or"
                " --memory-limit if that ended it"
            )

    def _take_tuned(self, journal: Journal) -> None:
        """Take the parameters that the tuner chose: cases of the trials have them, so that a replay
        of a flight has them too.
        """
        record = tuned_record(self.entrants, journal.rows(TUNING_TABLE))
        self._chosen = {entry["name"]: entry["tuned"] for entry in record}
        cases = tuple(CaseConfig(**case) for case in cases_of(self.entrants, self._chosen))
        self.trials = {
            name: trial.model_copy(update={"cases": cases}) for name, trial in self.trials.items()
        }

    def postprocess(self, run: RunDirectory, journal: Journal, progress: Progress) -> None:
        """Write ``arena.json``."""
        progress("comparing", self.planned, self.planned)
        run.write_json(run.path / ARENA, self._record(journal))

    def _record(self, journal: Journal) -> dict[str, Any]:
        windows: dict[int, Row] = dict(journal.numbered(WINDOW_TABLE))
        flights, first = self.flights, 0
        rows: dict[str, list[Row]] = {}
        for trial in self.trials:
            # A flight that could not be flown has no figures.
            rows[trial] = [
                windows.get(number, {}) for number in range(first, first + flights[trial])
            ]
            first += flights[trial]
        return {
            "conditions": [
                {"name": name, "title": trial.title} for name, trial in self.trials.items()
            ],
            "flights": self._scenario.flights,
            "entrants": tuned_record(self.entrants, journal.rows(TUNING_TABLE)),
            "refused": [asdict(law) for law in self._refused],
            "estimates": estimates(self.entrants, rows, self._arena, self._seed),
            "limits": limits(rows, self._arena, next(iter(self.trials.values())).guidance),
        }

    def summary(self, journal: Journal) -> StudySummary:
        """Return the result so far, with the chosen parameters."""
        if self._arena.evaluations and len(journal.done()) > 0 and not self._chosen:
            self._take_tuned(journal)
        found = super().summary(journal)
        record = tuned_record(self.entrants, journal.rows(TUNING_TABLE))
        return replace(
            found,
            manifest=found.manifest
            | {"tuned": {entry["name"]: entry["tuned"] for entry in record}},
        )
