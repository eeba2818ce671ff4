"""Flying one flight in a process of its own: plan, fly, measure, record. Every way that one can end
is a row.
"""

import bisect
import itertools
import json
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from datetime import datetime
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from common.columns import Column, Table
from common.run_layout import CROSSINGS, DRAWS, INTERVENTIONS, OVERRIDES
from common.text import as_json_cell
from common.verdict import KeepOut
from scenarios.engine.task import Result, Row, Task
from scenarios.experiment.requests import Experiment, FlightRequest, table_of
from scenarios.flight.closed_loop import fly
from scenarios.flight.failure import failure, unflown
from scenarios.flight.guard_belief import GuardBelief
from scenarios.flight.outcome import Outcome
from scenarios.flight.plume_readings import BELIEF_COLUMNS
from scenarios.flight.record import HISTORY_COLUMNS, FlightRecord
from scenarios.flight.release import release
from scenarios.flight.time_history import history_files
from scenarios.instruments.fuel_estimate import repeated_figures, with_verdict
from scenarios.instruments.instrument import (
    EvaluatedInstrument,
    GasReader,
    Instrument,
    declarations,
)
from scenarios.measures.criteria import failed_criteria
from scenarios.measures.crossings import crossing_rows
from scenarios.measures.figures import flight_figures, plan_row
from scenarios.measures.finding import finding_figures
from scenarios.measures.own_instruments import check_instruments, evaluated
from scenarios.measures.relative_state import flight_history
from scenarios.planning.flight_plan import FlightPlan
from scenarios.planning.planner import plan_flight
from scenarios.planning.spreads import PredictedSpreads
from scenarios.scenario.extension_points import PAYLOADS
from scenarios.scenario.sections.experiment import STUDY
from scenarios.vehicles.vehicle_setup import VehicleSetup, kinematic_setup
from scenarios.world.noise import PAYLOAD, own_generator
from scenarios.world.own_part import asked

_GONE = (Outcome.DIVERGED.value, Outcome.AIRCRAFT_LOST.value)

_Tables = dict[str, list[Row]]
"""Rows by the file name of their table."""


@dataclass(frozen=True, kw_only=True)
class FlightWork:
    """Plans, flies, measures and records the flights of experiments.

    Attributes
    ----------
    experiments : one after the other; a task's number counts through them
    histories : number of time histories to be kept, beside those of flights that failed a criterion
    setup : of the aircraft, if there is one
    spreads : predicted for flights in turbulence
    refusal : why flights in six degrees of freedom cannot be flown, or nothing
    viewer : host and port of a FlightGear that shows flights in real time, or none
    """

    experiments: tuple[Experiment, ...]
    histories: int
    setup: VehicleSetup | None
    spreads: PredictedSpreads
    refusal: str = ""
    viewer: tuple[str, int] | None = None

    @cached_property
    def columns(self) -> Table:
        """What the columns of time histories are."""
        return history_columns(self.experiments)

    @property
    def model(self) -> Path | None:
        """Return the JSBSim root of the aircraft with its autopilot, if it is to fly."""
        return self.setup.aircraft.model if self.setup and self.setup.aircraft else None

    def moved(self, model: Path) -> "FlightWork":
        """Return the same work with its files in another directory."""
        if self.setup is None or self.setup.aircraft is None:
            return self
        return replace(
            self, setup=replace(self.setup, aircraft=replace(self.setup.aircraft, model=model))
        )

    @cached_property
    def _ends(self) -> list[int]:
        """The number of the task after each experiment's last."""
        return list(itertools.accumulate(experiment.flights for experiment in self.experiments))

    def located(self, number: int) -> tuple[Experiment, int]:
        """Return the experiment of a task and the flight's number in it."""
        i = bisect.bisect_right(self._ends, number)
        return self.experiments[i], number - (self._ends[i - 1] if i else 0)

    def request(self, task: Task) -> FlightRequest:
        """Return the flight of a task.

        Raises
        ------
        InputError : a sampled value is out of range
        """
        experiment, number = self.located(task.number)
        return experiment.request(number, task.point, seed=task.seed)

    def fly(self, task: Task) -> Result:
        """Plan, fly, measure and record one flight."""
        began = time.perf_counter()
        row, tables = self._named(task), _Tables()
        history: pd.DataFrame | None = None
        document: Mapping[str, Any] | None = None
        try:
            request = self.request(task)
            row |= _request_row(request)
            named = {key: row[key] for key in ("flight_id", "trial", "variant")}
            tables[DRAWS] = [
                named | {"nu": row.get("nu")} | dict(task.labels) | _plain(request.inputs)
            ]
            experiment, _ = self.located(task.number)
            tables[OVERRIDES] = [named | _cells(experiment.overrides(request.scenario))]
            if self.refusal and request.scenario.fidelity == "six_dof":
                return self._result(task, row | unflown(Outcome.TRIM_FAILED, self.refusal), tables)
            plan = self.plan(request)
            row |= plan_row(plan)
            tables[DRAWS][0]["nu"] = row.get("nu")
            instruments = payload_of(request, plan)
            read = [instrument for instrument in instruments if isinstance(instrument, Instrument)]
            vehicle = release(plan, self.setup_of(request), self.viewer)
            record = fly(
                plan, vehicle, read, reader=reader_of(plan, instruments), every_step=task.every_step
            )
            history = flight_history(plan, record)
            figures, found = flight_figures(plan, record)
            row |= figures | _never_flown(request, figures)
            # Before an instrument of a user's own may fail.
            if "keepout_violations" in row:
                row["kept_out"] = KeepOut.of(row).is_known_outside
            tables[CROSSINGS] = [
                named | {"nu": row.get("nu")} | crossing for crossing in crossing_rows(found)
            ]
            tables[INTERVENTIONS] = [named | stretch._asdict() for stretch in record.interventions]
            for name, instrument in zip(plan.payload, instruments, strict=True):
                if isinstance(instrument, EvaluatedInstrument):
                    evaluation = evaluated(
                        name, instrument, record.column, _measured_from(request, record)
                    )
                    # Each sample stands until the next, where every step is recorded.
                    held = (
                        np.searchsorted(record.column("time_s"), history["time_s"], side="right")
                        - 1
                    )
                    history[list(instrument.COLUMNS)] = evaluation.columns[held]
                    row |= evaluation.figures
                    tables |= {
                        file: [named | of | named for of in rows]
                        for file, rows in evaluation.tables.items()
                    }
                    document = evaluation.document or document
            if sniffer := next(
                (instrument for instrument in instruments if isinstance(instrument, GasReader)),
                None,
            ):
                noise = sniffer.spec.known("co2").noise
                sampled = history[:: plan.log_interval] if task.every_step else history
                row |= finding_figures(
                    sampled, request.scenario.flight, noise=noise, enough=record.enough
                )
            if record.verdict is not None and "sulphur_verdict" in row:
                row |= repeated_figures(record.verdict, row)
                document = with_verdict(document, str(row["sulphur_verdict"]))
            tables |= self.more_tables(request, plan, record, row)
            failed = failed_criteria(row, request.scenario.criteria)
            row |= {"criteria_met": not failed, "message": "; ".join(failed)}
        except Exception as error:  # noqa: BLE001 - a flight that fails is a row with its reason, and the study goes on
            # After its flight an aircraft stays lost, whatever fails then, and what was flown is
            # not infeasible.
            flown = (
                {"outcome": row["outcome"] if row["outcome"] in _GONE else Outcome.FAILED.value}
                if "outcome" in row
                else {}
            )
            row |= failure(error) | flown
        return self._result(
            task, row | {"wall_time_s": time.perf_counter() - began}, tables, history, document
        )

    def lost(self, task: Task, reason: str) -> Result:
        """Return the result of a flight whose process was lost."""
        row = self._named(task)
        # What the study says of a flight is known without it.
        tables = {DRAWS: [row | dict(task.labels)]} if task.labels else {}
        return replace(self._result(task, row | unflown(Outcome.FAILED, reason), tables), lost=True)

    def plan(self, request: FlightRequest) -> FlightPlan:
        """Return the plan of a flight.

        Raises
        ------
        InfeasibleError : it has no solution
        """
        return plan_flight(
            request.scenario,
            flight_id=request.flight_id,
            seed=request.noise,
            setup=self.setup_of(request),
            spreads=self.spreads,
        )

    def more_tables(
        self,
        request: FlightRequest,  # noqa: ARG002
        plan: FlightPlan,  # noqa: ARG002
        record: FlightRecord,  # noqa: ARG002
        row: Row,  # noqa: ARG002
    ) -> _Tables:
        """Return rows of tables that a study of its own adds to a flight's row, by the file name of
        the table.
        """
        return {}

    def setup_of(self, request: FlightRequest) -> VehicleSetup:
        """Return what a flight needs of its vehicle."""
        kinematic = self.setup is None or request.scenario.fidelity == "kinematic"
        return kinematic_setup(request.scenario) if kinematic or self.setup is None else self.setup

    def _named(self, task: Task) -> Row:
        experiment, number = self.located(task.number)
        flight_id, variant = experiment.named(number)
        named = {"flight_id": flight_id, "trial": experiment.name, "variant": variant}
        return named | ({"beside": beside} if (beside := experiment.beside(number)) else {})

    def _result(
        self,
        task: Task,
        row: Row,
        tables: Mapping[str, list[Row]] | None = None,
        history: pd.DataFrame | None = None,
        document: Mapping[str, Any] | None = None,
    ) -> Result:
        table = table_of(row["variant"])
        return Result(
            task=task,
            items=int(row["variant"] == STUDY),
            tables={table: [row], **(tables or {})},
            files=history_files(
                task,
                history,
                document,
                columns={} if history is None else self.columns,
                planned=self._ends[-1],
                kept=self.histories,
                row=row,
            ),
        )


def history_columns(experiments: Iterable[Experiment]) -> dict[str, Column]:
    """Return the columns that time histories of some experiments may have."""
    points = (point.scenario for of in experiments for point in of.points)
    beliefs = BELIEF_COLUMNS | GuardBelief.COLUMNS
    return HISTORY_COLUMNS | beliefs | declarations(points).histories


def _request_row(request: FlightRequest) -> Row:
    """Return the part of a row that is known before the flight is planned."""
    scenario = request.scenario
    row: Row = {
        "aircraft": scenario.aircraft if scenario.fidelity == "six_dof" else "none",
        "fidelity": scenario.fidelity,
        "seed": request.seed,
        "fault": scenario.fault.kind,
        "required": scenario.criteria.required,
    }
    if scenario.circles:
        return row
    return row | {
        "nu": scenario.nu_over_ground,
        "wind_speed_mps": scenario.wind.speed_mps,
        "wind_from_deg": scenario.wind.from_deg,
        "vessel_speed_mps": scenario.vessel_speed,
        "turbulence": scenario.turbulence.level,
        "keepout_radius_m": scenario.keepout.radius_m,
    }


def _never_flown(request: FlightRequest, figures: Row) -> Row:
    """Return how many manoeuvres of the vessel begin after the end of the flight, of one that has
    any.
    """
    begins = [manoeuvre.at_s for manoeuvre in request.scenario.vessel.manoeuvres]
    return (
        {"manoeuvres_unflown": sum(at >= figures["duration_s"] for at in begins)} if begins else {}
    )


def _measured_from(request: FlightRequest, record: FlightRecord) -> float:
    """Return when instruments begin to be evaluated, from settling on if nothing else is said; not
    a number if never [s].
    """
    measured = request.scenario.flight.measured_s
    return record.settled_at if measured is None else float(record.column("time_s")[-1]) - measured


def payload_of(request: FlightRequest, plan: FlightPlan) -> list[Instrument | EvaluatedInstrument]:
    """Return the flight's instruments, fresh.

    Raises
    ------
    PluginError : one cannot be made
    InputError : one fills a column, a figure or a table that the flight or another one fills
    """
    given = request.scenario, plan.world, own_generator(request.noise, PAYLOAD)
    called_with = "the scenario, the world and a random generator"
    instruments = [
        asked(f"payload '{name}'", "cannot be made", called_with, PAYLOADS.get(name), *given)
        for name in plan.payload
    ]
    check_instruments(zip(plan.payload, instruments, strict=True))
    return instruments


def reader_of(
    plan: FlightPlan, instruments: list[Instrument | EvaluatedInstrument]
) -> GasReader | None:
    """Return the instrument that is read in flight, of a flight that reads one."""
    if plan.sensing is None or not plan.sensing.reads_plume:
        return None
    return next(
        (instrument for instrument in instruments if isinstance(instrument, GasReader)), None
    )


def _plain(values: Mapping[str, object]) -> Row:
    """Return inputs as they go into a table: numbers and words, times in ISO 8601, anything else as
    JSON.
    """
    return {key: _cell(value) for key, value in values.items()}


def _cell(value: object) -> object:
    if isinstance(value, datetime):
        return value.isoformat()
    return value if isinstance(value, str | float | int) else json.dumps(value)


def _cells(overrides: Mapping[str, object]) -> Row:
    """Return values as a table has them from which they are read back as they are."""
    return {key: as_json_cell(value) for key, value in overrides.items()}
