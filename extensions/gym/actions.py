"""The agent's commands: one space for every flight of a scenario, and the limits of each."""

from collections.abc import Iterator

import numpy as np
from gymnasium import spaces

from extensions.gym.observation import Array
from scenarios.engine.task import Task
from scenarios.errors import InputError
from scenarios.experiment.draws import value_at
from scenarios.flight_runner import FlightRunner
from scenarios.planning.flight_plan import FlightPlan
from scenarios.planning.limits import omega_max
from scenarios.scenario.files import with_values
from scenarios.scenario.scenario import Scenario
from scenarios.vehicles.vehicle_setup import VehicleSetup


def action_box(work: FlightRunner) -> "spaces.Box[np.float64]":
    """Return the ranges of heading rate [rad/s] and airspeed [m/s] that cover the commands of all
    flights of a scenario.

    Raises
    ------
    InputError : commands of a flight have no limit
    """
    guidances = [setting.guidance for setting in _settings(work)]
    if not all(guidance.command_limit for guidance in guidances):
        raise InputError(
            "guidance.command_limit is false; an environment needs a limit of the heading rate"
        )
    turn = max(map(omega_max, guidances))
    setups = [
        work.setup_of(work.request(Task(number=number))) for number in _first_of_each_point(work)
    ]
    slowest, fastest = (
        min(setup.airspeed_min for setup in setups),
        max(setup.airspeed_max for setup in setups),
    )
    return spaces.Box(np.array([-turn, slowest]), np.array([turn, fastest]), dtype=np.float64)


def limits_of(plan: FlightPlan, setup: VehicleSetup) -> tuple[Array, Array]:
    """Return the least and the largest heading rate [rad/s] and airspeed [m/s] of one flight, shape
    (2,) each.
    """
    turn = plan.guidance.tracking.heading_rate_max
    return np.array([-turn, setup.airspeed_min]), np.array([turn, setup.airspeed_max])


def _settings(work: FlightRunner) -> Iterator[Scenario]:
    """Yield scenarios that cover the guidance of every flight, or at least the largest and the
    least heading rates.
    """
    for experiment in work.experiments:
        for setting in experiment.settings():
            ranges = [
                draw
                for draw in setting.draws
                if draw.choice is None and draw.key.startswith("guidance.")
            ]
            for end in (0.0, 1.0):
                yield (
                    with_values(setting, {draw.key: value_at(draw, end) for draw in ranges})
                    if ranges
                    else setting
                )


def _first_of_each_point(work: FlightRunner) -> Iterator[int]:
    number = 0
    for experiment in work.experiments:
        for point in experiment.points:
            yield number
            number += point.flights
