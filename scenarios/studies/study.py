"""The studies of flights, and how to add one."""

from collections.abc import Callable

from common.registry import Registry
from scenarios.engine.runner import Study

STUDIES: Registry[Callable[..., Study]] = Registry(
    "study", folder="scenarios.studies", methods=("work", "run", "postprocess", "export", "summary")
)
"""Studies by the word that a scenario file has for them.

Each is called as ``scenarios.studies.flight_study.FlightStudy`` is: with the scenario, its name,
the scenarios to fly by name, and the overrides. One that has ``DOCUMENTED``, columns by the titles
of tables, has them on the page of columns of the documentation.
"""

study = STUDIES.register
"""Decorator that registers a study by a name."""
