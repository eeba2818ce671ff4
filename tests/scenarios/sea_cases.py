"""What the tests of the real sea share: scenarios, and the kinematic vehicle that flies them."""

from dataclasses import dataclass

import numpy as np

from gnc.sea_parameters import Mode
from innerloop.flight.turn_reversal import TurnReversalResponse
from scenarios.engine.task import Task
from scenarios.schema.sea_config import SeaScenario
from scenarios.sea_flights import SeaWork, Trial
from scenarios.simulation.sea_loop import SEA_COLUMNS
from scenarios.vehicles.sea_airframe import KINEMATIC_BANDWIDTH, KINEMATIC_LAG, Airframe
from scenarios.world.vessel import VesselTrack

SPEED = 19.42

AIRFRAME = Airframe(
    lag=KINEMATIC_LAG + 0.025,
    airspeed_bandwidth=KINEMATIC_BANDWIDTH,
    airspeed_min=0.7 * SPEED,
    airspeed_max=1.3 * SPEED,
    turning_airspeed=1.3 * SPEED,
    reversal=TurnReversalResponse(delay=0.0, lag=KINEMATIC_LAG),
    crab_banks=(-1.0, 1.0),
    crab_offsets=(0.0, 0.0),
    six_dof=None,
    model=None,
)
"""As ``scenarios.vehicles.sea_airframe`` makes it at 20 Hz."""

ASTERN = {"distance_m": (400.0, 400.0), "spread_deg": 10.0}


def scenario(**changes):
    """Return a kinematic trial: a vessel at 8 m/s in calm air unless ``changes`` say otherwise."""
    values = {"title": "test", "fidelity": "kinematic", "vessel": {"speed_mps": 8.0}}
    return SeaScenario.model_validate(values | changes)


def work(**changes):
    """Return the flying of one trial."""
    return SeaWork(trials=(Trial(name="trial", scenario=scenario(**changes), spreads={}),), histories=1, airframe=AIRFRAME)


@dataclass(frozen=True)
class Flown:
    """A flight's row in the summary, and its rows in all tables."""

    row: dict
    tables: dict


def fly(directory, **changes):
    """Fly one flight as a run does; leave its time history in ``directory``."""
    result = work(**changes).fly(Task(number=0))
    for name, content in result.files.items():
        path = directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    (row,) = result.tables["summary.csv"]
    return Flown(row=row, tables=result.tables)


def modes(history):
    """Return what the guidance did, one after the other, with the time at which it began [s]."""
    numbers = history["mode"].to_numpy()
    begins = np.flatnonzero(np.diff(numbers, prepend=-1.0))
    return [(list(Mode)[int(numbers[i])], float(history["time_s"].iloc[i])) for i in begins]


def track(vessel, duration=600.0, *, wind=(0.0, 0.0), plume_heading=None):
    """Return the track of a vessel of a scenario."""
    return VesselTrack(scenario(vessel=vessel).vessel, duration, wind_north=wind[0], wind_east=wind[1], plume_heading=plume_heading)


__all__ = ["AIRFRAME", "ASTERN", "SEA_COLUMNS", "SPEED", "fly", "modes", "scenario", "track", "work"]
