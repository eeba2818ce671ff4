"""The faults of one flight and their times."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from common.faults import NO_FAULT as NONE
from scenarios.scenario.sections.equipment import FaultConfig

VESSEL_DATA, SATELLITES = "vessel_data", "satellite_navigation"
"""Losses of reception."""

SNIFFER_DEAD, SNIFFER_SATURATED = "sniffer_dead", "sniffer_saturated"
"""Faults of a sniffer on board: it repeats its last reading, or reads the end of its range."""

OF_SNIFFER = frozenset({SNIFFER_DEAD, SNIFFER_SATURATED})
"""Kinds that are the sniffer's."""

NOT_OF_AIRCRAFT = frozenset({NONE, VESSEL_DATA, SATELLITES, *OF_SNIFFER})
"""Kinds that are not the aircraft's."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TimedFault:
    """A fault of a flight.

    Attributes
    ----------
    kind : as the scenario names it; ``none`` without a fault
    begins, ends : times; a permanent fault ends at infinity, and a fault that does not occur begins
        there [s]
    """

    kind: str
    begins: float
    ends: float

    def of_aircraft(self) -> bool:
        """Return whether a part of the aircraft fails."""
        return self.kind not in NOT_OF_AIRCRAFT


NO_FAULT = TimedFault(kind=NONE, begins=math.inf, ends=math.inf)


@dataclass(frozen=True, slots=True, kw_only=True)
class Faults:
    """The faults of one flight.

    Attributes
    ----------
    each : in the order of time; those of kind ``none`` come last
    """

    each: tuple[TimedFault, ...]

    def lasts(self, kind: str, time: float) -> bool:
        """Return whether a fault of this kind is on."""
        return any(of.kind == kind and of.begins <= time < of.ends for of in self.each)

    def intervals(self, kind: str) -> tuple[tuple[float, float], ...]:
        """Return when each fault of this kind begins and ends [s]."""
        return tuple((of.begins, of.ends) for of in self.each if of.kind == kind)

    def first(self, kinds: Collection[str]) -> TimedFault:
        """Return the first fault of one of some kinds, or ``NO_FAULT``."""
        return next((of for of in self.each if of.kind in kinds), NO_FAULT)

    def of_aircraft(self) -> tuple[TimedFault, ...]:
        """Return the faults in which a part of the aircraft fails."""
        return tuple(of for of in self.each if of.of_aircraft())

    def begun(self, time: float) -> tuple[TimedFault, ...]:
        """Return the faults that have begun by a time [s]."""
        return tuple(of for of in self.each if of.begins <= time)


NO_FAULTS = Faults(each=(NO_FAULT,))


def in_order(faults: Sequence[TimedFault]) -> Faults:
    """Return the faults of a flight, in the order of their times."""
    return Faults(each=tuple(sorted(faults, key=lambda of: of.begins)))


def sampled_fault(fault: FaultConfig, generator: np.random.Generator) -> TimedFault:
    """Return a fault of the flight, at its time; without one, the same draws are made."""
    begins = float(generator.uniform(*fault.at_s))
    if fault.kind == NO_FAULT.kind:
        return NO_FAULT
    lasts = {VESSEL_DATA: fault.vessel_data_s, SATELLITES: fault.satellite_navigation_s}.get(
        fault.kind, math.inf
    )
    return TimedFault(kind=fault.kind, begins=begins, ends=begins + lasts)
