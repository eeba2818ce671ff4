"""Courses of an aircraft that rolls from one bank to the other and back, as hard as it may, and
holds the bank in between.

From the passage through the centre, phase 0, bank falls from 0 at the roll rate p to -phi_max, is
held, and is back at 0 half a period later; then the same to the other side. Turns are coordinated:
omega = g/V tan(phi). While it rolls the course has changed by g/(V p) ln cos(p t), and while bank
is held it changes evenly. A course that turns through less than rolling to phi_max and back takes
is rolled through alone, with less bank.
"""

import functools
import math

import numpy as np

from common.physics.units import STANDARD_GRAVITY
from gnc.reference.orbit_tables import ETA_STEP, SPEED_RATIO_MIN, OrbitTables
from gnc.reference.reference import ETA_FREQUENCY
from gnc.reference.shapes.course_path import fourier_coefficients

_ETA_MIN = 1e-9
"""Least amplitude of which a shape is computed [rad]: a smaller one is as straight."""

_ORDERS = 8
"""Pairs of terms in the series of the orbit; what is left out is below 1e-4 of its width."""

_TURN, _QUARTER_TURN = 2.0 * math.pi, 0.5 * math.pi
_PER_QUARTER = 1.0 / _QUARTER_TURN

_NODES, _WEIGHTS = (values.tolist() for values in np.polynomial.legendre.leggauss(10))
"""Of Gauss's rule, good to 1e-12 of the mean speed while the aircraft rolls."""


class BankSwing:
    """Courses of every amplitude, as of ``gnc.reference.reference.Swing``.

    Parameters
    ----------
    speed : V_r [m/s]
    heading_rate : largest, that of phi_max [rad/s]
    roll_rate_max : p; may be infinite [rad/s]
    """

    __slots__ = (
        "_heading_rate", "_per_tangent", "_ramp", "_roll_rate", "_rolled", "_rolling", "_tables",
    )  # fmt: skip

    def __init__(self, *, speed: float, heading_rate: float, roll_rate_max: float) -> None:
        self._per_tangent = STANDARD_GRAVITY / speed
        self._heading_rate, self._roll_rate = heading_rate, roll_rate_max
        bank_max = math.atan(heading_rate / self._per_tangent)
        # Time in which bank comes to its largest value, and the course that is turned through
        # meanwhile.
        self._ramp = bank_max / roll_rate_max
        self._rolling = self._per_tangent / roll_rate_max
        self._rolled = -self._rolling * math.log(math.cos(bank_max))
        self._tables: OrbitTables | None = None

    def half_period(self, eta: float) -> float:
        """Return the time from one largest course offset to the other at full rates, the crossing
        interval [s].
        """
        return 2.0 * self._shape(eta)[0]

    def largest_heading_rate(self, eta: float) -> float:
        """Return the heading rate at the largest bank of an amplitude [rad/s]."""
        return self._shape(eta)[2]

    def holds_bank(self, eta: float) -> bool:
        """Return whether an amplitude takes the largest bank, or less."""
        return eta > self._rolled

    def eta(self, speed_ratio: float) -> float:
        """Return eta [rad] for a mean speed over speed, by a table, within 1e-5."""
        return self._series().eta(speed_ratio)

    def speed_ratio(self, eta: float) -> float:
        """Return the mean speed over speed [-]: the mean of cos(course) over a quarter of the
        period.
        """
        if eta < _ETA_MIN:
            return 1.0
        quarter, ramp, turning = self._shape(eta)
        total = 0.0
        for node, weight in zip(_NODES, _WEIGHTS, strict=True):
            banked = self._roll_rate * 0.5 * (1.0 + node) * ramp if ramp else 0.0
            total += weight * math.cos(eta + self._rolling * math.log(math.cos(banked)))
        return (0.5 * ramp * total + math.sin(turning * (quarter - ramp)) / turning) / quarter

    def frequency(self, eta: float, heading_rate: float) -> float:
        """Return the largest omega_0 within a heading rate and the roll rate, no more than that at
        ``ETA_FREQUENCY`` [rad/s].
        """
        eta = eta if eta > ETA_FREQUENCY else ETA_FREQUENCY
        if eta > self._rolled:
            quarter, largest = (
                self._ramp + (eta - self._rolled) / self._heading_rate,
                self._heading_rate,
            )
        else:
            quarter, largest = self._rolled_through(eta)
        fastest = _QUARTER_TURN / quarter
        return fastest if heading_rate >= largest else fastest * heading_rate / largest

    def course(self, eta: float, phase: float) -> float:
        """Return the course offset from the mean course [rad]."""
        if eta > self._rolled:
            rate = self._heading_rate
            held = (eta - self._rolled) / rate
            quarter = self._ramp + held
        elif eta < _ETA_MIN:
            return eta * math.cos(phase)
        else:
            quarter, rate = self._rolled_through(eta)
            held = 0.0
        # Time from the middle of the way across, which is one half of the period before phase 0 and
        # the other one after it.
        off = quarter - quarter * _PER_QUARTER * abs(math.remainder(phase, _TURN))
        if -held <= off <= held or not self._ramp:
            return rate * off
        course = eta + self._rolling * math.log(math.cos(self._roll_rate * (quarter - abs(off))))
        return course if off > 0.0 else -course

    def heading_rate(self, eta: float, phase: float) -> float:
        """Return the heading rate of a reference that takes full rates [rad/s]."""
        quarter, ramp, rate = self._shape(eta)
        angle = math.remainder(phase, _TURN)
        time = quarter - abs(quarter - quarter * _PER_QUARTER * abs(angle))
        if ramp and time < ramp:
            rate = self._per_tangent * math.tan(self._roll_rate * time)
        return -rate if angle > 0.0 else rate

    def slopes(self, eta: float, phase: float) -> tuple[float, float]:
        """Return the slope of the course offset over eta, from -1 to 1, and that over the phase
        divided by eta [-].
        """
        if eta > self._rolled:
            rate = self._heading_rate
            held = (eta - self._rolled) / rate
            quarter = self._ramp + held
        elif eta < _ETA_MIN:
            return math.cos(phase), -math.sin(phase)
        else:
            quarter, rate = self._rolled_through(eta)
            held = 0.0
        angle = math.remainder(phase, _TURN)
        off = quarter - quarter * _PER_QUARTER * abs(angle)
        # A quarter of the period grows by 1 over the largest heading rate per unit of eta, whether
        # bank is held or not.
        if -held <= off <= held or not self._ramp:
            by_eta = off / quarter
        else:
            time = quarter - abs(off)
            turning = self._per_tangent * math.tan(self._roll_rate * time)
            by_eta = 1.0 - time * turning / (quarter * rate)
            if off < 0.0:
                by_eta = -by_eta
            rate = turning
        by_phase = _PER_QUARTER * rate * quarter / eta
        return by_eta, -by_phase if angle > 0.0 else by_phase

    def offset(self, eta: float, phase: float) -> tuple[float, float]:
        """Return where the reference is from the orbit's centre, along the mean course and to its
        right [V_r/omega_0].
        """
        return self._series().offset(eta, phase)

    def _rolled_through(self, eta: float) -> tuple[float, float]:
        """Return a quarter of the period [s] and the largest heading rate [rad/s] of an amplitude
        that takes less than phi_max.
        """
        # cos(bank) = exp(-eta/rolling): tan(bank)^2 = exp(2 eta/rolling) - 1.
        tangent = math.sqrt(math.expm1(2.0 * eta / self._rolling))
        return math.atan(tangent) / self._roll_rate, self._per_tangent * tangent

    def _shape(self, eta: float) -> tuple[float, float, float]:
        """Return a quarter of the period, the time until bank is largest [s], and the heading rate
        then [rad/s].
        """
        if eta > self._rolled:
            return (
                self._ramp + (eta - self._rolled) / self._heading_rate,
                self._ramp,
                self._heading_rate,
            )
        quarter, largest = self._rolled_through(eta)
        return quarter, quarter, largest

    def _series(self) -> OrbitTables:
        if self._tables is None:
            self._tables = self._tabled()
        return self._tables

    def _tabled(self) -> OrbitTables:
        """Return the tables of orbits, up to two steps beyond the amplitude whose mean speed is the
        least of them.
        """
        ratios = [1.0]
        while len(ratios) < 3 or ratios[-3] > SPEED_RATIO_MIN:
            ratios.append(self.speed_ratio(ETA_STEP * len(ratios)))
        order = np.arange(1, 2 * _ORDERS + 1)
        # The course is even in the phase, and its negative half a period later: of exp(i course)
        # the cosine has even orders alone, and the sine odd ones.
        series = [
            fourier_coefficients(functools.partial(self.course, ETA_STEP * i))[order]
            for i in range(len(ratios))
        ]
        both = np.where(order % 2, np.imag(series), np.real(series))
        return OrbitTables(np.array(ratios), 2.0 * both / order)


@functools.lru_cache(maxsize=8)
def bank_swing(speed: float, heading_rate: float, roll_rate_max: float) -> BankSwing:
    """Return the courses within some limits, remembered with their tables; parameters are those of
    ``BankSwing``.
    """
    return BankSwing(speed=speed, heading_rate=heading_rate, roll_rate_max=roll_rate_max)
