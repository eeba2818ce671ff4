"""The studies of flights, and how to add one."""

from collections.abc import Callable

from common.registry import Registry
from scenarios.engine.runner import Study

STUDIES: Registry[Callable[..., Study]] = Registry(
    "study", folder="scenarios.studies", methods=("work", "run", "postprocess", "export", "summary")
)
"""Studies by the word that a scenario file has for them.

Each is called as ``scenarios.studies.flight_study.FlightStudy`` is: with the scenario, its name,
the scenarios to fly by name, and the overrides.
"""

study = STUDIES.register
"""Decorator that registers a study by a name."""
