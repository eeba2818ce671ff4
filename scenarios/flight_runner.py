"""One flight, from its task to its row: request, plan, fly, measure, judge.

Every way that a flight can end is a row: only ``FlightRunner.run`` catches.
"""

import bisect
import itertools
import json
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from common.columns import Column, Table
from common.faults import fault_columns
from common.plugins import call_plugin
from common.run_layout import CROSSINGS, DRAWS, INTERVENTIONS, OVERRIDES, TRAFFIC
from common.text import as_json_cell
from common.verdict import KeepOut
from scenarios.engine.task import Result, Row, Task
from scenarios.experiment.requests import Experiment, FlightRequest, table_of
from scenarios.flight.closed_loop import Viewer, fly, release
from scenarios.flight.ending import failure, unflown
from scenarios.flight.guard_belief import GuardBelief
from scenarios.flight.onboard import BELIEF_COLUMNS
from scenarios.flight.outcome import Outcome
from scenarios.flight.record import HISTORY_COLUMNS, FlightRecord
from scenarios.flight.smoke import smoke_record
from scenarios.flight.time_history import flight_history, history_files
from scenarios.flight.traffic_belief import TrafficBelief
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
from scenarios.measures.finding import TRUE_CO2, finding_figures
from scenarios.measures.own_instruments import check_instruments, evaluated
from scenarios.measures.traffic import traffic_record, traffic_rows
from scenarios.planning.flight_plan import FlightPlan
from scenarios.planning.missions import plan_flight
from scenarios.planning.spreads import PredictedSpreads
from scenarios.scenario.extension_points import PAYLOADS
from scenarios.scenario.sections.experiment import STUDY
from scenarios.vehicles.vehicle_setup import VehicleSetup, kinematic_setup
from scenarios.world.noise import PAYLOAD, own_generator

_GONE = (Outcome.DIVERGED.value, Outcome.AIRCRAFT_LOST.value)

Tables = dict[str, list[Row]]
"""Rows by the file name of their table."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Flown:
    """A flight that was flown.

    Attributes
    ----------
    request, plan : what was to be flown
    instruments : on board, in the order of ``plan.payload``
    record : what was recorded
    every_step : whether every step of the guidance was recorded, and not only the samples of the
        log
    """

    request: FlightRequest
    plan: FlightPlan
    instruments: list[Instrument | EvaluatedInstrument]
    record: FlightRecord
    every_step: bool

    @classmethod
    def by(
        cls,
        fly: Callable[[list[Instrument], GasReader | None], FlightRecord],
        request: FlightRequest,
        plan: FlightPlan,
        instruments: list[Instrument | EvaluatedInstrument],
        *,
        every_step: bool,
    ) -> "Flown":
        """Return a flight flown by ``fly``, which is given the instruments that are read at each
        step, and the gas reader.
        """
        each_step = [each for each in instruments if isinstance(each, Instrument)]
        return cls(
            request=request,
            plan=plan,
            instruments=instruments,
            record=fly(each_step, reader_of(plan, instruments)),
            every_step=every_step,
        )


@dataclass(slots=True)
class Findings:
    """The results of a flight so far; they are kept if a later step fails.

    Attributes
    ----------
    row : of the flight in the summary
    tables : its rows in other tables
    history : its time history, once it was flown
    document : further results of an instrument, beside its columns and figures
    smoke : parcels of the exhaust that it was flown in, if there was any
    traffic : tracks of other ships, if there were any
    """

    row: Row
    tables: Tables = field(default_factory=dict)
    history: pd.DataFrame | None = None
    document: Mapping[str, Any] | None = None
    smoke: bytes | None = None
    traffic: bytes | None = None

    @property
    def named(self) -> Row:
        """Return the columns that name the flight in every table."""
        return {key: self.row[key] for key in ("flight_id", "trial", "variant")}

    def add_request(self, request: FlightRequest, labels: Mapping[str, str]) -> None:
        """Add the entries that are known before the flight is planned; ``labels`` are those of its
        task.
        """
        self.row |= _request_row(request)
        inputs = {key: _cell(value) for key, value in request.inputs.items()}
        self.tables[DRAWS] = [{**self.named, "nu": self.row.get("nu"), **labels, **inputs}]

    def add_overrides(self, overrides: Mapping[str, object]) -> None:
        """Add the keys whose values differ from those in the scenario of the flight's trial."""
        cells = {key: as_json_cell(value) for key, value in overrides.items()}
        self.tables[OVERRIDES] = [self.named | cells]

    def add_plan(self, plan: FlightPlan) -> None:
        """Add the figures of the plan."""
        self.row |= plan_row(plan)
        self.tables[DRAWS][0]["nu"] = self.row.get("nu")

    def add_record(self, flown: Flown) -> None:
        """Add the time history, and the figures that need no instrument."""
        plan, record = flown.plan, flown.record
        self.history = flight_history(plan, record)
        self.smoke = smoke_record(
            plan.world.exhaust if plan.world else None,
            float(self.history["time_s"].iloc[-1]),
            flown.request.scenario.keepout.radius_m,
        )
        figures, crossings = flight_figures(plan, record)
        self.row |= figures
        if flown.plan.world is not None and flown.plan.world.traffic:
            rows = traffic_rows(plan, record)
            self.tables[TRAFFIC] = [self.named | of for of in rows]
            self.traffic = traffic_record(plan, float(self.history["time_s"].iloc[-1]))
        # Number of the vessel's manoeuvres that begin after the end of the flight.
        if begins := [each.at_s for each in flown.request.scenario.vessel.manoeuvres]:
            self.row["manoeuvres_unflown"] = sum(at >= figures["duration_s"] for at in begins)
        if "keepout_violations" in self.row:
            self.row["kept_out"] = KeepOut.of(self.row).is_known_outside
        nu = {"nu": self.row.get("nu")}
        self.tables[CROSSINGS] = [
            self.named | nu | crossing for crossing in crossing_rows(crossings)
        ]
        self.tables[INTERVENTIONS] = [self.named | each._asdict() for each in record.interventions]

    def add_evaluations(self, flown: Flown) -> None:
        """Add the results of the instruments, after the flight."""
        record, history = flown.record, self.history
        for name, instrument in zip(flown.plan.payload, flown.instruments, strict=True):
            if not isinstance(instrument, EvaluatedInstrument) or history is None:
                continue
            found = evaluated(name, instrument, record.column, _measured_from(flown))
            # Each sample stands until the next, where every step is recorded.
            held = np.searchsorted(record.column("time_s"), history["time_s"], side="right") - 1
            history[list(instrument.COLUMNS)] = found.columns[held]
            self.row |= found.figures
            for file, rows in found.tables.items():
                # An instrument cannot give the row of another flight.
                self.tables[file] = [self.named | row | self.named for row in rows]
            self.document = found.document or self.document

    def add_search(self, flown: Flown) -> None:
        """Add the figures of the search for the plume and the verdict on the fuel, for a flight
        with a gas reader.
        """
        plan, record, history = flown.plan, flown.record, self.history
        reader = next((each for each in flown.instruments if isinstance(each, GasReader)), None)
        # Only a simulated flight knows the true gases in the air.
        if reader is not None and history is not None and TRUE_CO2 in history:
            self.row |= finding_figures(
                history[:: plan.log_interval] if flown.every_step else history,
                flown.request.scenario.flight,
                noise=reader.spec.known("co2").noise,
                stop_reason=record.stop_reason,
            )
        if record.verdict is not None and "sulphur_verdict" in self.row:
            self.row |= repeated_figures(record.verdict, self.row)
            self.document = with_verdict(self.document, str(self.row["sulphur_verdict"]))

    def add_failure(self, error: Exception) -> None:
        """Add the error that ended the flight before its row was complete.

        An error after the flight does not change that its aircraft was lost, and a flight that was
        flown does not become infeasible.
        """
        before = self.row.get("outcome")
        self.row |= failure(error)
        if before is not None:
            self.row["outcome"] = before if before in _GONE else Outcome.FAILED.value


@dataclass(frozen=True, kw_only=True)
class FlightRunner:
    """Plans, flies, measures and records the flights of experiments.

    Attributes
    ----------
    experiments : one after the other; a task's number counts through them
    histories : number of time histories to be kept, beside those of flights that failed a criterion
    setup : of the aircraft, if there is one
    spreads : predicted for flights in turbulence
    refusal : why flights in six degrees of freedom cannot be flown, or nothing
    viewer : shows flights in real time, or none
    """

    experiments: tuple[Experiment, ...]
    histories: int
    setup: VehicleSetup | None
    spreads: PredictedSpreads
    refusal: str = ""
    viewer: Viewer | None = None

    def run(self, task: Task) -> Result:
        """Return the result of one flight, even if it fails."""
        began = time.perf_counter()
        findings = Findings(self._identity(task))
        try:
            self._fly_and_judge(task, findings)
        # A flight that fails is a row with its reason, and the study goes on.
        except Exception as error:  # noqa: BLE001
            findings.add_failure(error)
        findings.row["wall_time_s"] = time.perf_counter() - began
        return self._result(task, findings)

    def _fly_and_judge(self, task: Task, findings: Findings) -> None:
        request = self.request(task)
        findings.add_request(request, dict(task.labels))
        experiment, _ = self.located(task.number)
        findings.add_overrides(experiment.overrides(request.scenario))
        if self.refusal and request.scenario.fidelity == "six_dof":
            findings.row |= unflown(Outcome.TRIM_FAILED, self.refusal)
            return
        plan = self.plan(request)
        findings.add_plan(plan)
        flown = self.fly(request, plan, every_step=task.every_step)
        self.measure(flown, findings)
        failed = failed_criteria(findings.row, request.scenario.criteria)
        findings.row |= {"criteria_met": not failed, "message": "; ".join(failed)}

    def request(self, task: Task) -> FlightRequest:
        """Return the flight of a task.

        Raises
        ------
        InputError : a sampled value is out of range
        """
        experiment, number = self.located(task.number)
        return experiment.request(number, task.point, seed=task.seed)

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

    def fly(self, request: FlightRequest, plan: FlightPlan, *, every_step: bool) -> Flown:
        """Return a planned flight, flown; with ``every_step`` every step of it is recorded."""
        instruments = payload_of(request, plan)
        vehicle = release(plan, self.setup_of(request), self.viewer)

        def flown(payload: list[Instrument], reader: GasReader | None) -> FlightRecord:
            return fly(plan, vehicle, payload, reader=reader, every_step=every_step)

        return Flown.by(flown, request, plan, instruments, every_step=every_step)

    def measure(self, flown: Flown, findings: Findings) -> None:
        """Add the figures of a flight, of its instruments and of its study."""
        findings.add_record(flown)
        findings.add_evaluations(flown)
        findings.add_search(flown)
        more = self.more_tables(flown.request, flown.plan, flown.record, findings.row)
        findings.tables |= more

    def more_tables(
        self,
        request: FlightRequest,  # noqa: ARG002
        plan: FlightPlan,  # noqa: ARG002
        record: FlightRecord,  # noqa: ARG002
        row: Row,  # noqa: ARG002
    ) -> Tables:
        """Return the rows that a user's study adds in further tables, by the file name of the
        table.
        """
        return {}

    def lost(self, task: Task, reason: str) -> Result:
        """Return the result of a flight whose process was lost."""
        findings = Findings(self._identity(task))
        if task.labels:
            # The study's labels of a flight are known without flying it.
            findings.tables[DRAWS] = [findings.row | dict(task.labels)]
        findings.row = findings.row | unflown(Outcome.FAILED, reason)
        return replace(self._result(task, findings), lost=True)

    def setup_of(self, request: FlightRequest) -> VehicleSetup:
        """Return the vehicle's data that a flight needs."""
        if self.setup is None or request.scenario.fidelity == "kinematic":
            return kinematic_setup(request.scenario)
        return self.setup

    @cached_property
    def columns(self) -> Table:
        """Descriptions of the columns of time histories."""
        return history_columns(self.experiments)

    @property
    def model(self) -> Path | None:
        """Return the JSBSim root of the aircraft with its autopilot, if there is an aircraft."""
        return self.setup.aircraft.model if self.setup and self.setup.aircraft else None

    def moved(self, model: Path) -> "FlightRunner":
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

    def _identity(self, task: Task) -> Row:
        experiment, number = self.located(task.number)
        flight_id, variant = experiment.named(number)
        row: Row = {"flight_id": flight_id, "trial": experiment.name, "variant": variant}
        if paired := experiment.paired_flight(number):
            row["beside"] = paired
        return row

    def _result(self, task: Task, findings: Findings) -> Result:
        row, history = findings.row, findings.history
        return Result(
            task=task,
            items=int(row["variant"] == STUDY),
            tables={table_of(row["variant"]): [row], **findings.tables},
            files=history_files(
                task,
                history,
                findings.document,
                findings.smoke,
                traffic=findings.traffic,
                columns={} if history is None else self.columns,
                planned=self._ends[-1],
                kept=self.histories,
                row=row,
            ),
        )


def history_columns(experiments: Iterable[Experiment]) -> dict[str, Column]:
    """Return the columns that time histories of some experiments may have."""
    points = [point.scenario for of in experiments for point in of.points]
    beliefs = BELIEF_COLUMNS | GuardBelief.COLUMNS
    if any(point.has_traffic for point in points):
        beliefs = beliefs | TrafficBelief.COLUMNS
    return HISTORY_COLUMNS | beliefs | declarations(points).histories


def _request_row(request: FlightRequest) -> Row:
    """Return the part of a row that is known before the flight is planned."""
    scenario = request.scenario
    row: Row = {
        "aircraft": scenario.aircraft if scenario.fidelity == "six_dof" else "none",
        "fidelity": scenario.fidelity,
        "seed": request.seed,
        **{
            fault_columns(number)[0]: fault.kind
            for number, fault in enumerate(scenario.faults, start=1)
        },
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


def _measured_from(flown: Flown) -> float:
    """Return the time from which instruments are evaluated [s]: settling, unless the scenario gives
    another; NaN if never.
    """
    measured = flown.request.scenario.flight.measured_s
    if measured is None:
        return flown.record.settled_at
    return float(flown.record.column("time_s")[-1]) - measured


def payload_of(request: FlightRequest, plan: FlightPlan) -> list[Instrument | EvaluatedInstrument]:
    """Return the flight's instruments, fresh.

    Raises
    ------
    PluginError : an instrument cannot be made
    InputError : an instrument fills a column, a figure or a table that the flight or another
        instrument fills
    """
    given = request.scenario, plan.world, own_generator(request.noise, PAYLOAD)
    instruments: list[Any] = [
        call_plugin(f"payload '{name}'", PAYLOADS.get(name), *given) for name in plan.payload
    ]
    check_instruments(zip(plan.payload, instruments, strict=True))
    return instruments


def reader_of(
    plan: FlightPlan, instruments: list[Instrument | EvaluatedInstrument]
) -> GasReader | None:
    """Return the instrument that is read in flight, or None."""
    if plan.sensing is None or not plan.sensing.reads_plume:
        return None
    return next(
        (instrument for instrument in instruments if isinstance(instrument, GasReader)), None
    )


def _cell(value: object) -> object:
    """Return an input as a cell of a table: a number or a word, a time in ISO 8601, or JSON."""
    if isinstance(value, datetime):
        return value.isoformat()
    return value if isinstance(value, str | float | int) else json.dumps(value)
