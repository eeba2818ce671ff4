"""A designed autopilot: its tables, its margins and the record of its design. What designs it is
elsewhere.
"""

import functools
from dataclasses import dataclass
from typing import Any

from aircraft.spec import AircraftError
from common.files import json_text
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


@dataclass(frozen=True, kw_only=True)
class Designed:
    """A design and its record."""

    design: Design
    record: Record

    @functools.cached_property
    def record_text(self) -> str:
        """The record as every run with the design has it, on one line: half a megabyte of numbers."""
        return json_text(self.record, indent=None)
