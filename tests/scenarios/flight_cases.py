"""What tests of flights share: scenarios in operational conditions, and the kinematic vehicle that
flies them.
"""

import tomllib
from dataclasses import dataclass

import numpy as np

from gnc.mission.mission import Mode
from scenarios.engine.task import Task
from scenarios.experiment.requests import Experiment
from scenarios.flight_runner import FlightRunner
from scenarios.planning.missions import plan_flight
from scenarios.planning.spreads import PredictedSpreads
from scenarios.scenario.files import OPERATIONAL, bases
from scenarios.scenario.overrides import merged
from scenarios.scenario.scenario import Scenario
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


def work(**changes):
    """Return the work on the one flight of a scenario."""
    experiment = Experiment("trial", scenario(**changes))
    return FlightRunner(
        experiments=(experiment,), histories=1, setup=None, spreads=PredictedSpreads()
    )


@dataclass(frozen=True)
class Flown:
    """A flight's row in the summary, its rows in all tables, and its time history."""

    row: dict
    tables: dict
    history: object


def fly(**changes):
    """Fly one flight as a run does."""
    result = work(**changes).run(Task(number=0))
    (row,) = result.tables["summary.csv"]
    return Flown(row=row, tables=result.tables, history=history_in(result))


def modes(history):
    """Return what the guidance did, one after the other, with the time at which it began [s]."""
    numbers = history["mode"].to_numpy()
    begins = np.flatnonzero(np.diff(numbers, prepend=-1.0))
    return [(list(Mode)[int(numbers[i])], float(history["time_s"].iloc[i])) for i in begins]
