"""The programming interface for scripts and notebooks; ``scenarios`` exports its names."""

from scenarios.api.flying import fly, run
from scenarios.api.results import Flight, Run
from scenarios.api.scenario import Scenario, load
from scenarios.api.statistics import Statistics
from scenarios.errors import InputError
from scenarios.world.ais import read_ais

__all__ = [
    "Flight",
    "InputError",
    "Run",
    "Scenario",
    "Statistics",
    "fly",
    "load",
    "read_ais",
    "run",
]
