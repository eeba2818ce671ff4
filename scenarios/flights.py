"""The flights of a scenario, and flying one of them in a process of its own."""

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from common.run_layout import COMPARISON, CROSSINGS, SUMMARY
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from scenarios.engine.task import Result, Row, Task
from scenarios.errors import InputError
from scenarios.metrics.crossings import Crossing, crossing_rows
from scenarios.metrics.figures import flight_figures, plan_row, unmet_criteria
from scenarios.metrics.relative_state import flight_history
from scenarios.planning.planner import FlightPlan, plan_flight
from scenarios.schema.config import Case, Scenario
from scenarios.schema.load import with_values
from scenarios.simulation.closed_loop import fly
from scenarios.simulation.failure import failure, unflown
from scenarios.simulation.outcome import Outcome
from scenarios.simulation.time_history import history_files
from scenarios.vehicles.jsbsim import JsbsimVehicle
from scenarios.vehicles.kinematic import KinematicVehicle
from scenarios.vehicles.six_dof import SixDof
from scenarios.vehicles.vehicle import Vehicle

STUDY = "study"
"""The variant of flights that count; others are comparisons."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightRequest:
    """A flight to be planned and flown.

    Attributes
    ----------
    flight_id : unique in the run
    variant : ``study``, or the name of a comparison
    nu : speed ratio [-]; not a number where there is no vessel
    seed : of the start
    scenario : with the variant's values set; its fidelity is one vehicle
    refusal : why it cannot be flown, or nothing
    """

    flight_id: str
    variant: str
    nu: float
    seed: int
    scenario: Scenario
    refusal: str = ""

    @property
    def table(self) -> str:
        """Return the file that its row is in."""
        return SUMMARY if self.variant == STUDY else COMPARISON


def flight_requests(scenario: Scenario) -> list[FlightRequest]:
    """Return the study's flights and then the comparisons. A flight's start depends on the run's seed and nu alone.

    Raises
    ------
    InputError : a comparison or a case sets a key that does not exist or a value out of range
    """
    if scenario.cases:
        requests = [request for case in scenario.cases for request in _case_requests(scenario, case)]
        return sorted(requests, key=lambda request: request.variant != STUDY)
    requests = [_request(scenario, STUDY, nu) for nu in dict.fromkeys(scenario.sweep.nu)]
    for variant in scenario.comparison.variants:
        changed = with_values(scenario, variant.set)
        requests += [_request(changed, variant.name, nu) for nu in scenario.comparison.nu if nu in scenario.sweep.nu]
    return requests


def _request(scenario: Scenario, variant: str, nu: float) -> FlightRequest:
    name = f"nu_{nu:.6f}".rstrip("0").ljust(len("nu_0.00"), "0")
    flight_id = name if variant == STUDY else f"{name}_{variant}"
    return FlightRequest(flight_id=flight_id, variant=variant, nu=nu, seed=_seed(scenario, nu), scenario=scenario)


def _case_requests(scenario: Scenario, case: Case) -> list[FlightRequest]:
    requests = []
    for fidelity in ("kinematic", "six_dof") if scenario.fidelity == "both" else (scenario.fidelity,):
        values = case.set | (case.set_kinematic if fidelity == "kinematic" else {})
        if "fidelity" in values:
            raise InputError(f"case '{case.name}' sets fidelity; set it for the whole scenario, or to 'both'")
        try:
            changed = with_values(scenario, {**values, "fidelity": fidelity})
        except InputError as error:
            raise InputError(f"case '{case.name}': {error}") from None
        if len(changed.sweep.nu) > 1:
            raise InputError(f"case '{case.name}' has {len(changed.sweep.nu)} speed ratios in sweep.nu; give it one")
        nu = changed.sweep.nu[0]
        requests.append(
            FlightRequest(
                flight_id=f"{case.name}_{fidelity}",
                variant=case.name if case.comparison else STUDY,
                nu=math.nan if changed.reference.path == "circle" else nu,
                seed=_seed(scenario, nu),
                scenario=changed,
            )
        )
    return requests


def _seed(scenario: Scenario, nu: float) -> int:
    return int(np.random.SeedSequence([scenario.seed, round(nu * 1e6)]).generate_state(1)[0])


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightWork:
    """Plans, flies, measures and records flights. Every way that one can end is a row.

    Attributes
    ----------
    requests : the flights, by the numbers of their tasks
    histories : number of time histories to be kept, beside those of flights that did not meet their criteria
    six_dof : what the aircraft needs; kinematic flights do without
    model : JSBSim root of the aircraft with its autopilot, if it is to fly
    """

    requests: tuple[FlightRequest, ...]
    histories: int
    six_dof: SixDof | None
    model: Path | None

    def moved(self, model: Path) -> "FlightWork":
        """Return the same work with its files in another directory."""
        return replace(self, model=model)

    def fly(self, task: Task) -> Result:
        """Plan, fly, measure and record one flight."""
        began = time.perf_counter()
        request = self.requests[task.number]
        row = _request_row(request)
        if request.refusal:
            return self._result(task, row | unflown(Outcome.TRIM_FAILED, request.refusal))
        crossings: list[Row] = []
        history: pd.DataFrame | None = None
        try:
            plan = self._plan(request)
            row |= plan_row(plan)
            vehicle = place_vehicle(request.scenario, plan, self.model, self.six_dof)
            record = fly(plan, vehicle, every_step=task.every_step)
            history = flight_history(plan, record)
            figures, found = flight_figures(plan, record)
            row = _judged(request, row | figures)
            crossings = _crossing_rows(request, found)
        except Exception as error:  # noqa: BLE001 - a flight that fails is a row with its reason, and the sweep goes on
            row |= failure(error)
        return self._result(task, row | {"wall_time_s": time.perf_counter() - began}, crossings, history)

    def lost(self, task: Task, reason: str) -> Result:
        """Return the result of a flight whose process was lost."""
        row = _request_row(self.requests[task.number]) | unflown(Outcome.FAILED, reason)
        return replace(self._result(task, row), lost=True)

    def _plan(self, request: FlightRequest) -> FlightPlan:
        six_dof = self.six_dof if request.scenario.fidelity == "six_dof" else None
        return plan_flight(
            request.scenario,
            flight_id=request.flight_id,
            nu=request.nu,
            seed=request.seed,
            lag=guidance_lag(request.scenario, six_dof),
            reversal=six_dof.reversal if six_dof else None,
        )

    def _result(self, task: Task, row: Row, crossings: Sequence[Row] = (), history: pd.DataFrame | None = None) -> Result:
        request = self.requests[task.number]
        return Result(
            task=task,
            items=int(request.variant == STUDY),
            tables={request.table: [row], CROSSINGS: list(crossings)},
            files=history_files(task, history, planned=len(self.requests), wanted=self.histories, row=row),
        )


def _request_row(request: FlightRequest) -> Row:
    """Return the part of a row that is known before the flight is planned."""
    row: Row = {
        "flight_id": request.flight_id,
        "aircraft": request.scenario.aircraft if request.scenario.fidelity == "six_dof" else "none",
        "fidelity": request.scenario.fidelity,
        "seed": request.seed,
    }
    if math.isnan(request.nu):
        return row
    return row | {"nu": request.nu, "keepout_radius_m": request.scenario.keepout.radius_m}


def guidance_lag(scenario: Scenario, six_dof: SixDof | None) -> float:
    """Return how late the vehicle's heading rate follows the guidance [s]: by its own lag, and half a step of holding commands."""
    return (six_dof.lag if six_dof else scenario.kinematic.heading_rate_lag_s) + 0.5 / scenario.guidance.rate_hz


def place_vehicle(
    scenario: Scenario,
    plan: FlightPlan,
    model: Path | None,
    six_dof: SixDof | None,
) -> Vehicle:
    """Return the scenario's vehicle at the start of a flight.

    Parameters
    ----------
    scenario : whose fidelity chooses the vehicle
    plan : the flight
    model : JSBSim root of the aircraft with its autopilot, if that is to fly
    six_dof : what the aircraft needs, if it is to fly
    """
    where: dict[str, float] = {
        "north": plan.start_north,
        "east": plan.start_east,
        "altitude": plan.altitude,
        "course": plan.start_course,
    }
    time_step = plan.guidance.time_step
    if scenario.fidelity == "kinematic" or six_dof is None or model is None:
        lag = scenario.kinematic.heading_rate_lag_s
        return KinematicVehicle(**where, speed=plan.reference.speed, time_step=time_step, lag=lag)
    aircraft = AutopilotedAircraft(six_dof.spec, model)
    return JsbsimVehicle(aircraft, six_dof.start, six_dof.envelope, **where, time_step=time_step, weather=None)


def _judged(request: FlightRequest, row: Row) -> Row:
    """Return the row of a flown flight, and whether it met its criteria, and why not."""
    if row["outcome"] == Outcome.COMPLETED.value:
        unmet = unmet_criteria(row, request.scenario.criteria)
        return row | {"criteria_met": not unmet, "message": "; ".join(unmet)}
    entries = row.get("keepout_violations")
    message = f"entered the keep-out area {entries} times; {row['message']}" if entries else row["message"]
    return row | {"criteria_met": False, "message": message}


def _crossing_rows(request: FlightRequest, crossings: Sequence[Crossing]) -> list[Row]:
    return [
        {
            "flight_id": request.flight_id,
            "variant": request.variant,
            "nu": request.nu,
            **row,
        }
        for row in crossing_rows(crossings)
    ]
