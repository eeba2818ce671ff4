"""What tests of flights share: scenarios in operational conditions, and the kinematic vehicle that
flies them.
"""

import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gnc.mission.mission import Mode
from scenarios.engine.processes import InProcessExecutor
from scenarios.engine.runner import fly_study
from scenarios.engine.task import Task
from scenarios.experiment.requests import Experiment
from scenarios.flight.outcome import Outcome
from scenarios.flight.record import FlightRecord
from scenarios.flight_runner import FlightRunner
from scenarios.planning.missions import plan_flight
from scenarios.planning.spreads import PredictedSpreads
from scenarios.scenario.files import OPERATIONAL, bases, load_study
from scenarios.scenario.overrides import merged
from scenarios.scenario.scenario import Scenario
from scenarios.studies.base import run_study
from scenarios.studies.replay import Replay
from scenarios.vehicles.vehicle_setup import kinematic_setup
from tests.run_tables import history_in

SPEED = 19.42

ASTERN = {"distance_m": (400.0, 400.0), "spread_deg": 10.0}


def scenario(**changes):
    """Return a kinematic scenario that follows a vessel at 8 m/s in still air unless ``changes``
    say otherwise.
    """
    base = tomllib.loads(bases()[OPERATIONAL].read_text(encoding="utf-8"))
    values = {"title": "test", "fidelity": "kinematic", "vessel": {"speed_mps": 8.0}}
    return Scenario.model_validate(merged(base, values | changes))


def plan(given, *, seed=1, setup=None, **spreads):
    """Return the plan of a scenario's flight; of the kinematic vehicle without a setup."""
    return plan_flight(
        given, flight_id="a", seed=seed, setup=setup or kinematic_setup(given), **spreads
    )


def flight_of(given, name="trial", **task):
    """Return the result of the first flight of a scenario, as a run has it."""
    how = {"histories": 1, "setup": None, "spreads": PredictedSpreads()}
    work = FlightRunner(experiments=(Experiment(name, given),), **how)
    return work.run(Task(number=0, **task))


def run_here(name, out, *overrides, **how):
    """Fly a study in this process; return its summary."""
    study = load_study(str(name) if isinstance(name, Path) else name, overrides)
    given = {"executor_factory": InProcessExecutor, "overrides": overrides} | how
    return run_study(study, Path(name).stem, out, **given)


def replay_here(flight, out):
    """Fly a flight of a run again in this process; return the summary."""
    how = {"executor_factory": InProcessExecutor, "resume": False, "progress": lambda *_: None}
    return fly_study(Replay(str(flight)), out, **how)


def flown_study(name, *overrides, **task):
    """Fly the first flight of a scenario file or document."""
    return Flown.of(flight_of(load_study(name, overrides), **task))


@dataclass(frozen=True)
class Flown:
    """A flight's row in the summary, its rows in all tables, and its time history."""

    row: dict
    tables: dict
    history: object

    @classmethod
    def of(cls, result):
        (row,) = result.tables["summary.csv"]
        return cls(row=row, tables=result.tables, history=history_in(result))


def fly(**changes):
    """Fly one flight as a run does."""
    return Flown.of(flight_of(scenario(**changes)))


def record(history, columns, outcome=Outcome.COMPLETED, *, settled_at=0.0):
    """Return the record of a flight with a time history that is made up."""
    return FlightRecord(
        outcome=outcome, message="", mode="tracking", settled_at=settled_at, interventions=[],
        columns=columns, history=history, every_step=history, saturation_fraction=0.0,
        heading_rate_demand_max=0.6, heading_rate_command_max=0.5, guard_time=0.0,
    )  # fmt: skip


def modes(history):
    """Return what the guidance did, one after the other, with the time at which it began [s]."""
    numbers = history["mode"].to_numpy()
    begins = np.flatnonzero(np.diff(numbers, prepend=-1.0))
    return [(list(Mode)[int(numbers[i])], float(history["time_s"].iloc[i])) for i in begins]
