"""Instruments on board: what they read goes into the time history."""

from collections.abc import Callable
from typing import Any, Protocol

from common.registry import Registry
from gnc.estimation.own_motion import Motion


class Instrument(Protocol):
    """An instrument, made fresh for each flight with the flight's scenario and world and a random generator.

    Attributes
    ----------
    COLUMNS : of the time history that it fills; their names end in their units, as in ``so2_ppb``
    """

    COLUMNS: tuple[str, ...]

    def read(self, time: float, motion: Motion, sample: tuple[float, ...], /) -> tuple[float, ...]:
        """Return a value for each column.

        Parameters
        ----------
        time : [s]
        motion : true north, east [m], their rates [m/s], heading rate [rad/s]
        sample : ``scenarios.vehicles.vehicle.SAMPLE_COLUMNS``
        """


PAYLOADS: Registry[Callable[..., Any]] = Registry("payload", folder="scenarios.vehicles", methods=("read",))
"""Instruments by name. Each is called with the flight's scenario, its world and a random generator."""

payload = PAYLOADS.register
"""Decorator that registers an instrument by a name."""
