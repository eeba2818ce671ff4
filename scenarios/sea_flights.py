"""Flying flights over the real sea in processes of their own. Every way that one can end is a row."""

import bisect
import itertools
import json
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import pandas as pd

from common.run_layout import CROSSINGS, DRAWS, INTERVENTIONS, SUMMARY
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from scenarios.engine.task import Result, Row, Task
from scenarios.experiment.draws import DrawnFlight, drawn_flight
from scenarios.margin.keepout_margin import SpreadTable
from scenarios.metrics.crossings import crossing_rows
from scenarios.metrics.sea_figures import sea_figures, sea_plan_row, sea_unmet
from scenarios.planning.sea_planner import SeaPlan, plan_sea_flight
from scenarios.schema.sea_config import SeaScenario
from scenarios.simulation.failure import failure, unflown
from scenarios.simulation.interventions import INTERVENTION_COLUMNS
from scenarios.simulation.outcome import Outcome
from scenarios.simulation.sea_loop import SEA_COLUMNS, fly_sea
from scenarios.simulation.time_history import history_files
from scenarios.vehicles.jsbsim import JsbsimVehicle
from scenarios.vehicles.kinematic import KinematicVehicle
from scenarios.vehicles.sea_airframe import KINEMATIC_LAG, Airframe
from scenarios.vehicles.vehicle import Vehicle

_CROSSING_COLUMNS = ("flight_id", "trial", "crossing", "time_s", "axis_distance_m", "distance_m", "angle_deg", "height_m")

DETAILS = {CROSSINGS: _CROSSING_COLUMNS, INTERVENTIONS: INTERVENTION_COLUMNS}
"""Tables with several rows of a flight, and their columns."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """Flights of one scenario.

    Attributes
    ----------
    name : of the trial
    scenario : of its flights
    spreads : predicted in the levels of turbulence that they may have
    """

    name: str
    scenario: SeaScenario
    spreads: Mapping[str, SpreadTable]

    def flight_id(self, number: int) -> str:
        """Return the name of a flight in the run, by its number in the trial."""
        return f"{self.name}_{number:05d}"


@dataclass(frozen=True, kw_only=True)
class SeaWork:
    """Draws, plans, flies, measures and records flights.

    Attributes
    ----------
    trials : one after the other; a task's number counts through them
    histories : number of time histories to be kept, beside those of flights that did not meet their criteria
    airframe : what flies, or none
    refusal : why nothing can be flown, or nothing
    """

    trials: tuple[Trial, ...]
    histories: int
    airframe: Airframe
    refusal: str = ""

    @property
    def model(self) -> Path | None:
        """Return the JSBSim root of the aircraft with its autopilot, if it is to fly."""
        return self.airframe.model

    def moved(self, model: Path) -> "SeaWork":
        """Return the same work with its files in another directory."""
        return replace(self, airframe=replace(self.airframe, model=model))

    @cached_property
    def _ends(self) -> list[int]:
        """The number of the task after each trial's last."""
        return list(itertools.accumulate(trial.scenario.flights for trial in self.trials))

    def flight(self, number: int) -> tuple[Trial, int]:
        """Return the trial of a task and the flight's number in it."""
        i = bisect.bisect_right(self._ends, number)
        return self.trials[i], number - (self._ends[i - 1] if i else 0)

    def fly(self, task: Task) -> Result:
        """Draw, plan, fly, measure and record one flight."""
        began = time.perf_counter()
        trial, number = self.flight(task.number)
        named: Row = {"flight_id": trial.flight_id(number), "trial": trial.name}
        if self.refusal:
            return self._result(task, named | unflown(Outcome.TRIM_FAILED, self.refusal))
        row, tables = dict(named), dict[str, list[Row]]()
        history: pd.DataFrame | None = None
        try:
            drawn = drawn_flight(trial.name, trial.scenario, number, task.point)
            row |= _drawn_row(drawn)
            tables[DRAWS] = [named | {"nu": drawn.nu} | _plain(drawn.values)]
            plan = plan_sea_flight(
                drawn.scenario, flight_id=named["flight_id"], seed=drawn.seed, airframe=self.airframe, spreads=trial.spreads
            )
            row |= sea_plan_row(plan)
            record = fly_sea(plan, self._vehicle(plan), every_step=task.every_step)
            history = pd.DataFrame(record.every_step, columns=list(SEA_COLUMNS))
            figures, found = sea_figures(plan, record)
            tables[CROSSINGS] = [named | crossing for crossing in crossing_rows(found)]
            tables[INTERVENTIONS] = [named | stretch._asdict() for stretch in record.interventions]
            row |= figures
            unmet = sea_unmet(row, drawn.scenario.criteria)
            row |= {"criteria_met": not unmet, "message": "; ".join([*unmet, *([record.message] if record.message else [])])}
        except Exception as error:  # noqa: BLE001 - a flight that fails is a row with its reason, and the trial goes on
            row |= failure(error)
        return self._result(task, row | {"wall_time_s": time.perf_counter() - began}, tables, history)

    def lost(self, task: Task, reason: str) -> Result:
        """Return the result of a flight whose process was lost."""
        trial, number = self.flight(task.number)
        row = {"flight_id": trial.flight_id(number), "trial": trial.name} | unflown(Outcome.FAILED, reason)
        return replace(self._result(task, row), lost=True)

    def _result(
        self, task: Task, row: Row, tables: Mapping[str, list[Row]] | None = None, history: pd.DataFrame | None = None
    ) -> Result:
        return Result(
            task=task,
            tables={SUMMARY: [row], **(tables or {})},
            files=history_files(task, history, planned=self._ends[-1], wanted=self.histories, row=row),
        )

    def _vehicle(self, plan: SeaPlan) -> Vehicle:
        """Return the vehicle at the start of a flight."""
        where = {"north": plan.start_north, "east": plan.start_east, "altitude": plan.altitude, "course": plan.start_course}
        time_step = plan.guidance.guidance.time_step
        six_dof, model = self.airframe.six_dof, self.airframe.model
        if six_dof is None or model is None:
            north, east = plan.weather.wind
            speed = plan.guidance.centre.speed
            return KinematicVehicle(**where, speed=speed, time_step=time_step, lag=KINEMATIC_LAG, wind_north=north, wind_east=east)
        aircraft = AutopilotedAircraft(six_dof.spec, model, failable=plan.fault.of_aircraft())
        return JsbsimVehicle(aircraft, six_dof.start, six_dof.envelope, **where, time_step=time_step, weather=plan.weather)


def _drawn_row(drawn: DrawnFlight) -> Row:
    scenario = drawn.scenario
    return {
        "aircraft": scenario.aircraft if scenario.fidelity == "six_dof" else "none",
        "fidelity": scenario.fidelity,
        "seed": drawn.seed,
        "nu": drawn.nu,
        "wind_speed_mps": scenario.wind.speed_mps,
        "wind_from_deg": scenario.wind.from_deg,
        "vessel_speed_mps": scenario.vessel.speed_mps,
        "turbulence": scenario.turbulence.level,
        "fault": scenario.fault.kind,
        "keepout_radius_m": scenario.keepout.radius_m,
    }


def _plain(values: Mapping[str, object]) -> Row:
    """Return what was drawn as it goes into a table: numbers and words, anything else as JSON."""
    return {key: value if isinstance(value, str | float | int) else json.dumps(value) for key, value in values.items()}
