"""What fails in one flight, and when."""

import math
from dataclasses import dataclass

import numpy as np

from scenarios.scenario.sections.equipment import FaultConfig

VESSEL_DATA, SATELLITES = "vessel_data", "satellite_navigation"
"""Losses of what is received."""

SNIFFER_DEAD, SNIFFER_SATURATED = "sniffer_dead", "sniffer_saturated"
"""Faults of a sniffer on board: it repeats its last reading, or reads the end of its range."""

OF_SNIFFER = frozenset({SNIFFER_DEAD, SNIFFER_SATURATED})
"""Kinds that are the sniffer's."""

NOT_OF_AIRCRAFT = frozenset({"none", VESSEL_DATA, SATELLITES, *OF_SNIFFER})
"""Kinds that are not the aircraft's."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TimedFault:
    """A fault of one flight.

    Attributes
    ----------
    kind : as the scenario names it; ``none`` for none
    begins, ends : when; for good what ends at infinity, and never what begins there [s]
    """

    kind: str
    begins: float
    ends: float

    def lasts(self, kind: str, time: float) -> bool:
        """Return whether a fault of this kind is on."""
        return kind == self.kind and self.begins <= time < self.ends

    def interval(self, kind: str) -> tuple[float, float]:
        """Return when a fault of this kind begins and ends; never where it is of another kind [s]."""
        return (self.begins, self.ends) if kind == self.kind else (math.inf, math.inf)

    def of_aircraft(self) -> bool:
        """Return whether it is a part of the aircraft that fails."""
        return self.kind not in NOT_OF_AIRCRAFT


NO_FAULT = TimedFault(kind="none", begins=math.inf, ends=math.inf)


def sampled_fault(fault: FaultConfig, generator: np.random.Generator) -> TimedFault:
    """Return the flight's fault, at its time; without one, the same draws are made."""
    begins = float(generator.uniform(*fault.at_s))
    if fault.kind == NO_FAULT.kind:
        return NO_FAULT
    lasts = {VESSEL_DATA: fault.vessel_data_s, SATELLITES: fault.satellite_navigation_s}.get(
        fault.kind, math.inf
    )
    return TimedFault(kind=fault.kind, begins=begins, ends=begins + lasts)
