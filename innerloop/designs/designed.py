"""A designed autopilot: its tables, its margins and the record of its design. What designs it is elsewhere."""

from dataclasses import dataclass
from typing import Any

from aircraft.errors import AircraftError
from innerloop.analysis.checks import Check
from innerloop.synthesis.schedule import Schedule
from innerloop.synthesis.weights import LoopBandwidths

Record = dict[str, Any]
"""The record of a design for its report, as plain data."""


class DesignError(AircraftError):
    """No design of an aircraft has the margins that are required."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """An autopilot and its margins.

    Attributes
    ----------
    schedule : the autopilot's tables
    bandwidths : of its loops
    checks : margins at every grid point, between them, and with the perturbed aircraft
    """

    schedule: Schedule
    bandwidths: LoopBandwidths
    checks: tuple[Check, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Designed:
    """A design and its record."""

    design: Design
    record: Record
