"""The work of an arena: tasks that tune a law, and flights that are measured to their end."""

import time
from dataclasses import dataclass, replace

from common.run_layout import TUNING_TABLE, WINDOW_TABLE
from scenarios.engine.task import Result, Row, Task
from scenarios.experiment.requests import FlightRequest
from scenarios.flight.record import FlightRecord
from scenarios.flight_runner import FlightRunner
from scenarios.measures.window import measured_figures, window_figures
from scenarios.planning.flight_plan import FlightPlan
from scenarios.scenario.files import with_values
from scenarios.studies.arena.entrants import Entrant
from scenarios.studies.arena.tuning import Tuner

_GUIDANCE = "guidance."


@dataclass(frozen=True, kw_only=True)
class ArenaWork(FlightRunner):
    """Tunes laws, and flies them; other attributes are those of ``FlightRunner``.

    Attributes
    ----------
    entrants : tasks beyond the last flight tune one after the other of these
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
        # Without parameters and cost: nothing was tried.
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
        """Return the law that a task tunes; none for a flight."""
        flights = self._ends[-1]
        return self.entrants[task.number - flights] if task.number >= flights else None
