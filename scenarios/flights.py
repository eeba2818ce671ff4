"""The flights of a scenario, and flying one of them in a process of its own."""

import signal
import time
import traceback
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from aircraft.errors import AircraftError
from aircraft.spec import find_spec
from aircraft.trim import Trim
from gnc.errors import InfeasibleError
from innerloop.flight import AutopilotedAircraft
from scenarios.closed_loop import COLUMNS, Outcome, fly
from scenarios.config import Scenario
from scenarios.load import with_values
from scenarios.metrics import Row, flight_figures, plan_row, unmet_criteria
from scenarios.plan import FlightPlan, plan_flight
from scenarios.run_directory import RunDirectory


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightRequest:
    """A flight to be planned and flown.

    Attributes
    ----------
    flight_id : unique in the run
    variant : ``study``, or the name of a comparison
    nu : speed ratio [-]
    seed : of the start
    scenario : with the variant's values set
    """

    flight_id: str
    variant: str
    nu: float
    seed: int
    scenario: Scenario


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightResult:
    """A flown flight: its row and the rows of its crossings."""

    request: FlightRequest
    row: Row
    crossings: list[Row]


def flight_requests(scenario: Scenario) -> list[FlightRequest]:
    """Return the study's flights and then the comparisons. A flight's start depends on the run's seed and nu alone.

    Raises
    ------
    InputError : a comparison sets a key that does not exist or a value out of range
    """
    requests = [_request(scenario, "study", nu) for nu in dict.fromkeys(scenario.sweep.nu)]
    for variant in scenario.comparison.variants:
        changed = with_values(scenario, variant.set)
        requests += [_request(changed, variant.name, nu) for nu in scenario.comparison.nu if nu in scenario.sweep.nu]
    return requests


def _request(scenario: Scenario, variant: str, nu: float) -> FlightRequest:
    name = f"nu_{nu:.6f}".rstrip("0").ljust(len("nu_0.00"), "0")
    seed = int(np.random.SeedSequence([scenario.seed, round(nu * 1e6)]).generate_state(1)[0])
    flight_id = name if variant == "study" else f"{name}_{variant}"
    return FlightRequest(flight_id=flight_id, variant=variant, nu=nu, seed=seed, scenario=scenario)


def fly_request(request: FlightRequest, directory: Path, start: Trim, lag: float) -> FlightResult:
    """Plan, fly, measure and record one flight. Every way it can end is a row.

    Parameters
    ----------
    request : the flight
    directory : the run directory, which holds the aircraft with its autopilot
    start : equilibrium to start from
    lag : of the guidance loop's heading rate [s]
    """
    began = time.perf_counter()
    run = RunDirectory(directory)
    row = _request_row(request)
    crossings: list[Row] = []
    try:
        plan = plan_flight(request.scenario, flight_id=request.flight_id, nu=request.nu, seed=request.seed, lag=lag)
        row |= plan_row(plan)
        figures, crossings = _fly(request, plan, run, start)
        if figures["outcome"] == Outcome.COMPLETED.value:
            unmet = unmet_criteria(row | figures, request.scenario.criteria)
            figures |= {"criteria_met": not unmet, "message": "; ".join(unmet)}
        row |= figures
    except InfeasibleError as error:
        row |= {"outcome": Outcome.INFEASIBLE.value, "message": str(error)}
    except AircraftError as error:
        row |= {"outcome": Outcome.FAILED.value, "message": str(error)}
    except Exception as error:  # noqa: BLE001 - a flight that fails is a row with its reason, and the sweep goes on
        where = traceback.extract_tb(error.__traceback__)[-1]
        row |= {
            "outcome": Outcome.FAILED.value,
            "message": f"{type(error).__name__}: {error} ({Path(where.filename).name}:{where.lineno})",
        }
    row.setdefault("criteria_met", False)
    row["wall_time_s"] = time.perf_counter() - began
    return FlightResult(request=request, row=row, crossings=crossings)


def failed(request: FlightRequest, outcome: Outcome, message: str) -> FlightResult:
    """Return the result of a flight that was never begun, or whose process died."""
    row = {**_request_row(request), "outcome": outcome.value, "message": message, "criteria_met": False}
    return FlightResult(request=request, row=row, crossings=[])


def _request_row(request: FlightRequest) -> Row:
    """Return the part of a row that is known before the flight is planned."""
    return {
        "flight_id": request.flight_id,
        "aircraft": request.scenario.aircraft,
        "seed": request.seed,
        "nu": request.nu,
        "keepout_radius_m": request.scenario.keepout.radius_m,
    }


def _fly(request: FlightRequest, plan: FlightPlan, run: RunDirectory, start: Trim) -> tuple[Row, list[Row]]:
    aircraft = AutopilotedAircraft(find_spec(request.scenario.aircraft), run.model)
    record = fly(plan, aircraft, start)
    run.write_history(request.flight_id, pd.DataFrame(record.history, columns=list(COLUMNS)))
    figures, crossings = flight_figures(plan, record)
    if record.outcome is not Outcome.COMPLETED and figures["keepout_violations"]:
        figures["message"] = f"entered the keep-out area {figures['keepout_violations']} times; {figures['message']}"
    rows: list[dict[str, Any]] = [
        {
            "flight_id": request.flight_id,
            "variant": request.variant,
            "nu": plan.nu,
            "crossing": i,
            "time_s": crossing.time,
            "axis_distance_m": crossing.axis_distance,
            "distance_m": crossing.distance,
            "angle_deg": float(np.degrees(crossing.angle)),
            "height_m": crossing.height,
        }
        for i, crossing in enumerate(crossings, start=1)
    ]
    return figures, rows


def ignore_interrupt() -> None:
    """Leave Ctrl-C to the parent process, which lets flights under way finish and keeps what is done."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
