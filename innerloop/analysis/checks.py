"""Margins of loops, what is required of them, and the checks of a design."""

import math
from dataclasses import dataclass

NOMINAL = "as modelled"
"""The aircraft without any perturbation."""

ALL_CONTROLS = "all controls"
"""Name of the margins for simultaneous changes in every control."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Margin:
    """Margins with one loop opened and every other closed.

    Attributes
    ----------
    loop : where the loop is opened
    gain_db : least change of gain, up or down, that brings instability [dB]; infinite where none
        does
    phase_deg : least change of phase that does [deg]; infinite where none does
    crossover : highest gain crossover [rad/s]; nan where the gain never crosses 1
    disk_gain_db, disk_phase_deg : guaranteed for simultaneous changes of gain and phase [dB, deg]
    """

    loop: str
    gain_db: float
    phase_deg: float
    crossover: float
    disk_gain_db: float
    disk_phase_deg: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """Least margins.

    Attributes
    ----------
    gain_db, phase_deg : of the aircraft as modelled, each loop opened alone
    perturbed_gain_db, perturbed_phase_deg : of the perturbed aircraft
    """

    gain_db: float = 6.0
    phase_deg: float = 45.0
    perturbed_gain_db: float = 4.0
    perturbed_phase_deg: float = 30.0


REQUIRED = Requirement()
"""Nominal: MIL-F-9490D's 6 dB and 45 deg. A fifth of effectiveness is 1.6 to 1.9 dB, so 4 dB must
remain.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """The margins of one operating point, with the aircraft as modelled or perturbed.

    Attributes
    ----------
    case : the perturbation
    airspeed, bank : [m/s, rad]
    between : whether the point lies between those of the design's grid
    stable : whether the closed loop is stable
    margins : of every loop
    """

    case: str
    airspeed: float
    bank: float
    between: bool
    stable: bool
    margins: tuple[Margin, ...]

    @property
    def required(self) -> tuple[float, float]:
        """Return the least gain [dB] and phase [deg]."""
        if self.case == NOMINAL:
            return REQUIRED.gain_db, REQUIRED.phase_deg
        return REQUIRED.perturbed_gain_db, REQUIRED.perturbed_phase_deg

    @property
    def short_loops(self) -> tuple[str, ...]:
        """Return the loops with too little margin; all of them if the closed loop is unstable."""
        gain, phase = self.required
        judged = [m for m in self.margins if m.loop != ALL_CONTROLS]
        return tuple(
            m.loop
            for m in judged
            if not (self.stable and m.gain_db >= gain and m.phase_deg >= phase)
        )

    @property
    def met(self) -> bool:
        """Whether every margin is as required."""
        return self.stable and not self.short_loops

    @property
    def worst_gain(self) -> Margin:
        """Return the loop with the least gain margin."""
        return min(self.margins, key=lambda m: math.inf if math.isnan(m.gain_db) else m.gain_db)

    @property
    def worst_phase(self) -> Margin:
        """Return the loop with the least phase margin."""
        return min(self.margins, key=lambda m: math.inf if math.isnan(m.phase_deg) else m.phase_deg)

    @property
    def shortfall(self) -> float:
        """Return the smallest margin as a fraction of the required one; below 0 if unstable."""
        gain, phase = self.required
        return (
            min(self.worst_gain.gain_db / gain, self.worst_phase.phase_deg / phase)
            if self.stable
            else -1.0
        )

    def describe(self) -> str:
        """Return the least margins in words."""
        where = (
            f"at {self.airspeed:.1f} m/s and {math.degrees(self.bank):.0f} deg of bank, {self.case}"
        )
        if not self.stable:
            return f"an unstable closed loop {where}"
        gain, phase = self.worst_gain, self.worst_phase
        return f"{gain.gain_db:.1f} dB ({gain.loop}) and {phase.phase_deg:.1f} deg ({phase.loop}) {where}"
