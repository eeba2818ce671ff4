"""Flying one flight over the real sea in a process of its own. Every way it can end is a row."""

import math
import time
import traceback
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from aircraft.errors import AircraftError
from aircraft.find import find_spec
from gnc.errors import InfeasibleError
from innerloop.flight import AutopilotedAircraft
from scenarios.closed_loop import Outcome
from scenarios.crossings import Crossing
from scenarios.errors import InputError
from scenarios.interventions import INTERVENTION_COLUMNS
from scenarios.jsbsim_vehicle import JsbsimVehicle
from scenarios.kinematic_vehicle import KinematicVehicle
from scenarios.run_directory import RunDirectory
from scenarios.sea_airframe import KINEMATIC_LAG, Airframe
from scenarios.sea_config import SeaScenario
from scenarios.sea_draws import drawn_flight
from scenarios.sea_loop import SEA_COLUMNS, fly_sea
from scenarios.sea_margin import SpreadTable
from scenarios.sea_metrics import Row, sea_figures, sea_plan_row, sea_unmet
from scenarios.sea_plan import SeaPlan, plan_sea_flight
from scenarios.vehicle import Vehicle

_CROSSING_COLUMNS = ("flight_id", "trial", "crossing", "time_s", "axis_distance_m", "distance_m", "angle_deg", "height_m")

DETAILS = {"crossings.csv": _CROSSING_COLUMNS, "interventions.csv": INTERVENTION_COLUMNS}
"""Tables with several rows of a flight, and their columns."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeaRequest:
    """A flight to be drawn and flown.

    Attributes
    ----------
    flight_id : unique in the run
    trial : its name
    scenario : of the trial
    number : of the flight in it, from 0
    spreads : predicted in the trial's turbulence, none in still air
    """

    flight_id: str
    trial: str
    scenario: SeaScenario
    number: int
    spreads: SpreadTable | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SeaResult:
    """A flown flight: its row, and its rows in the tables of ``DETAILS``."""

    flight_id: str
    row: Row
    details: dict[str, list[Row]]


def fly_sea_request(request: SeaRequest, directory: Path, airframe: Airframe) -> SeaResult:
    """Draw, plan, fly, measure and record one flight.

    Parameters
    ----------
    request : the flight
    directory : the run directory
    airframe : what its vehicle needs
    """
    began = time.perf_counter()
    row: Row = {"flight_id": request.flight_id, "trial": request.trial}
    details: dict[str, list[Row]] = {}
    try:
        scenario, seed, nu = drawn_flight(request.trial, request.scenario, request.number)
        row |= _drawn_row(scenario, seed, nu)
        plan = plan_sea_flight(scenario, flight_id=request.flight_id, seed=seed, airframe=airframe, spreads=request.spreads)
        row |= sea_plan_row(plan)
        record = fly_sea(plan, _vehicle(scenario, plan, airframe))
        run = RunDirectory(directory)
        run.write_history(request.flight_id, pd.DataFrame(record.history, columns=list(SEA_COLUMNS)))
        figures, found = sea_figures(plan, record)
        named: Row = {"flight_id": request.flight_id, "trial": request.trial}
        details["crossings.csv"] = [_crossing_row(request, i, crossing) for i, crossing in enumerate(found, start=1)]
        details["interventions.csv"] = [named | stretch._asdict() for stretch in record.interventions]
        row |= figures
        unmet = sea_unmet(row, scenario.criteria)
        row |= {"criteria_met": not unmet, "message": "; ".join([*unmet, *([record.message] if record.message else [])])}
    except InfeasibleError as error:
        row |= {"outcome": Outcome.INFEASIBLE.value, "message": str(error)}
    except (AircraftError, InputError) as error:
        row |= {"outcome": Outcome.FAILED.value, "message": str(error)}
    except Exception as error:  # noqa: BLE001 - a flight that fails is a row with its reason, and the trial goes on
        where = traceback.extract_tb(error.__traceback__)[-1]
        row |= {
            "outcome": Outcome.FAILED.value,
            "message": f"{type(error).__name__}: {error} ({Path(where.filename).name}:{where.lineno})",
        }
    row.setdefault("criteria_met", False)
    row["wall_time_s"] = time.perf_counter() - began
    return SeaResult(flight_id=request.flight_id, row=row, details=details)


def sea_failed(request: SeaRequest, outcome: Outcome, message: str) -> SeaResult:
    """Return the result of a flight that was never begun, or whose process died."""
    row = {"flight_id": request.flight_id, "trial": request.trial, "outcome": outcome.value, "message": message}
    return SeaResult(flight_id=request.flight_id, row={**row, "criteria_met": False}, details={})


def _drawn_row(scenario: SeaScenario, seed: int, nu: float) -> Row:
    return {
        "aircraft": scenario.aircraft if scenario.fidelity == "six_dof" else "none",
        "fidelity": scenario.fidelity,
        "seed": seed,
        "nu": nu,
        "wind_speed_mps": scenario.wind.speed_mps,
        "wind_from_deg": scenario.wind.from_deg,
        "vessel_speed_mps": scenario.vessel.speed_mps,
        "turbulence": scenario.turbulence.level,
        "fault": scenario.fault.kind,
        "keepout_radius_m": scenario.keepout.radius_m,
    }


def _vehicle(scenario: SeaScenario, plan: SeaPlan, airframe: Airframe) -> Vehicle:
    """Return the scenario's vehicle at the start of its flight."""
    where = {"north": plan.start_north, "east": plan.start_east, "altitude": plan.altitude, "course": plan.start_course}
    time_step = plan.guidance.guidance.time_step
    if airframe.six_dof is None or airframe.model is None:
        north, east = plan.weather.wind
        speed = plan.guidance.centre.speed
        return KinematicVehicle(**where, speed=speed, time_step=time_step, lag=KINEMATIC_LAG, wind_north=north, wind_east=east)
    aircraft = AutopilotedAircraft(find_spec(scenario.aircraft), airframe.model, failable=plan.fault.of_aircraft())
    six_dof = airframe.six_dof
    return JsbsimVehicle(aircraft, six_dof.start, six_dof.envelope, **where, time_step=time_step, weather=plan.weather)


def _crossing_row(request: SeaRequest, i: int, crossing: Crossing) -> Row:
    return {
        "flight_id": request.flight_id,
        "trial": request.trial,
        "crossing": i,
        "time_s": crossing.time,
        "axis_distance_m": crossing.axis_distance,
        "distance_m": crossing.distance,
        "angle_deg": math.degrees(crossing.angle),
        "height_m": crossing.height,
    }
