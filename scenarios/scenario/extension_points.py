"""Registries of the parts of a flight that users may add. A scenario file names these parts; world
and vehicles create them.
"""

from collections.abc import Callable
from typing import Any

from common.registry import Registry

VESSEL_TRACKS: Registry[Callable[..., Any]] = Registry(
    "vessel_track", folder="scenarios.world", methods=("motion", "course")
)
"""Vessel tracks by name. Each is called with the ``[vessel]`` section, the speed [m/s] and the
duration [s] to cover.
"""

PLUME_MODELS: Registry[Callable[..., Any]] = Registry(
    "plume_model", folder="scenarios.world", methods=("axis",)
)
"""Plume models by name. Each is called as ``StraightPlume`` is, and returns a ``Plume``."""

PAYLOADS: Registry[Callable[..., Any]] = Registry(
    "payload", folder="scenarios.instruments", methods=("read|evaluate",)
)
"""Instruments by name. Each is called with the flight's scenario, its world and a random generator.
"""
