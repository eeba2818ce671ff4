"""From a scenario to results: world, closed loop and studies. ``docs/reference/api.md`` describes
the programming interface:

``from scenarios import fly, run, load, read_ais, Scenario``. A name is loaded at its first use:
importing the package is light.
"""

import importlib
import sys
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scenarios.api import (
        Flight,
        InputError,
        Run,
        Scenario,
        Statistics,
        fly,
        load,
        read_ais,
        run,
    )

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


class _Package(ModuleType):
    """This package, with ``run`` kept as the function: importing the command line ``scenarios.run``
    would otherwise replace it by that module.
    """

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in __all__ and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package

# This import comes before any module of this package, so that compiled modules are found.
importlib.import_module("gnc.compiled")


def __getattr__(name: str) -> object:
    """Return a public name, loaded at its first use."""
    if name not in __all__:
        raise AttributeError(f"module 'scenarios' has no attribute '{name}'")
    return getattr(importlib.import_module("scenarios.api"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
