"""The flights of a scenario, and flying one of them in a process of its own."""

import math
import time
import traceback
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from aircraft.errors import AircraftError
from aircraft.find import find_spec
from aircraft.spec import Envelope
from aircraft.trim import Trim
from aircraft.weather import Weather
from gnc.errors import InfeasibleError
from innerloop.flight import AutopilotedAircraft
from innerloop.reversal import Reversal
from scenarios.closed_loop import Outcome, fly
from scenarios.config import Case, Scenario
from scenarios.errors import InputError
from scenarios.history import flight_history
from scenarios.jsbsim_vehicle import JsbsimVehicle
from scenarios.kinematic_vehicle import KinematicVehicle
from scenarios.load import with_values
from scenarios.metrics import Row, flight_figures, plan_row, unmet_criteria
from scenarios.plan import FlightPlan, plan_flight
from scenarios.run_directory import RunDirectory
from scenarios.vehicle import Vehicle

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


@dataclass(frozen=True, slots=True, kw_only=True)
class SixDof:
    """What flights of the aircraft need beyond their scenario.

    Attributes
    ----------
    start : equilibrium to start from
    lag : of the autopilot's heading rate behind its command [s]
    reversal : how the heading rate follows a reversal of the turn
    envelope : where the autopilot may fly it
    """

    start: Trim
    lag: float
    reversal: Reversal
    envelope: Envelope


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


def fly_request(request: FlightRequest, directory: Path, six_dof: SixDof | None) -> FlightResult:
    """Plan, fly, measure and record one flight. Every way it can end is a row.

    Parameters
    ----------
    request : the flight
    directory : the run directory, which holds the aircraft with its autopilot
    six_dof : what the aircraft needs; a kinematic flight does without
    """
    began = time.perf_counter()
    run = RunDirectory(directory)
    if request.scenario.fidelity == "kinematic":
        six_dof = None
    row = _request_row(request)
    crossings: list[Row] = []
    try:
        lag = guidance_lag(request.scenario, six_dof)
        reversal = six_dof.reversal if six_dof else None
        plan = plan_flight(
            request.scenario, flight_id=request.flight_id, nu=request.nu, seed=request.seed, lag=lag, reversal=reversal
        )
        row |= plan_row(plan)
        figures, crossings = _fly(request, plan, run, six_dof)
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
    model: Path,
    six_dof: SixDof | None,
    *,
    weather: Weather | None = None,
    failable: bool = False,
) -> Vehicle:
    """Return the scenario's vehicle at the start of a flight.

    Parameters
    ----------
    scenario : whose fidelity chooses the vehicle
    plan : the flight
    model : JSBSim root of the aircraft with its autopilot
    six_dof : what the aircraft needs, if it is to fly
    weather : the air it flies in; none for still air. A kinematic vehicle feels the steady wind alone
    failable : whether the aircraft is to have faults on the way
    """
    where = {"north": plan.start_north, "east": plan.start_east, "altitude": plan.altitude, "course": plan.start_course}
    time_step = plan.guidance.time_step
    if scenario.fidelity == "kinematic" or six_dof is None:
        lag = scenario.kinematic.heading_rate_lag_s
        north, east = weather.wind if weather else (0.0, 0.0)
        return KinematicVehicle(**where, speed=plan.reference.speed, time_step=time_step, lag=lag, wind_north=north, wind_east=east)
    aircraft = AutopilotedAircraft(find_spec(scenario.aircraft), model, failable=failable)
    return JsbsimVehicle(aircraft, six_dof.start, six_dof.envelope, **where, time_step=time_step, weather=weather)


def _fly(request: FlightRequest, plan: FlightPlan, run: RunDirectory, six_dof: SixDof | None) -> tuple[Row, list[Row]]:
    record = fly(plan, place_vehicle(request.scenario, plan, run.model, six_dof))
    run.write_history(request.flight_id, flight_history(plan, record))
    figures, crossings = flight_figures(plan, record)
    if record.outcome is not Outcome.COMPLETED and figures.get("keepout_violations"):
        figures["message"] = f"entered the keep-out area {figures['keepout_violations']} times; {figures['message']}"
    rows: list[dict[str, Any]] = [
        {
            "flight_id": request.flight_id,
            "variant": request.variant,
            "nu": request.nu,
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
