"""A loiter that moves with the vessel: a circle that meets the plume twice a turn, stretched along
the vessel's course.

Below a speed ratio of 0.33 it crosses more often than any oscillation
(docs/fastest_oscillation.md). It turns to the right at the largest bank, all the way round; where
its course is that of the vessel bank falls at the roll rate and rises again, and it flies straight
on for as long as the vessel needs to come along. It cannot be steered: beside a faster vessel it
would have to become an oscillation.
"""

import functools
import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from common.physics.coordinated_turn import bank_for_heading_rate
from common.physics.units import STANDARD_GRAVITY
from gnc.errors import InfeasibleError
from gnc.paper import available_heading_rate
from gnc.reference.reference import Array, Swing, reference_shape
from gnc.reference.shapes.course_path import CoursePath, fourier_coefficients
from gnc.reference.shapes.fastest import JOINING_SHARE

_TURN = 2.0 * math.pi

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
"""Of Gauss's rule, good to 1e-12 of the mean speed while the aircraft rolls."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Loiter:
    """One turn, from the middle of its straight leg: attributes as of
    ``gnc.reference.reference.Orbit``, phase 0 there.

    Attributes
    ----------
    nu : speed ratio [-]
    speed : V_r [m/s]
    amplitude : largest heading rate [rad/s]
    roll_rate : at which bank changes; may be infinite [rad/s]
    least_bank : on the vessel's course [rad]
    straight : half the time for which bank is 0 there [s]
    """

    nu: float
    speed: float
    amplitude: float
    roll_rate: float
    least_bank: float
    straight: float

    @property
    def eta(self) -> float:
        """Largest course offset from that of the vessel [rad]."""
        return math.pi

    @property
    def symmetric(self) -> bool:
        """Return that the second half of the orbit is not the first one's mirror image."""
        return False

    @property
    def crossing_interval(self) -> float:
        """Time between crossings of the plume, half a turn [s]."""
        return self.straight + self._ramp + (math.pi - self.turned) / self.amplitude

    @property
    def period(self) -> float:
        """Time of one turn [s]."""
        return 2.0 * self.crossing_interval

    @property
    def omega_0(self) -> float:
        """Angular frequency [rad/s]."""
        return math.pi / self.crossing_interval

    @property
    def limit(self) -> str:
        """Return what sets the period."""
        return "heading rate"

    def offset(self, time: npt.ArrayLike) -> tuple[Array, Array]:
        """Return where the reference is from the point about which it crosses a plume along its
        course every half turn [m].
        """
        path, side, unit = _path(self)
        along, right = path.offset(self.omega_0 * np.asarray(time, dtype=np.float64))
        return unit * along, unit * (right - side)

    def half_widths(self) -> tuple[float, float]:
        """Return how far the orbit reaches from that point, along its course and across [m]."""
        path, side, unit = _path(self)
        along, _ = path.half_widths()
        _, far = path.offset(math.pi)
        return unit * along, unit * max(side, float(far) - side)

    def course(self, phase: float) -> float:
        """Return the course offset from that of the vessel, growing by a turn a period [rad]."""
        turns = round(phase / _TURN)
        time = (phase - _TURN * turns) / self.omega_0
        return _TURN * turns + math.copysign(self._half(abs(time)), time)

    def heading_rate(self, phase: float) -> float:
        """Return the heading rate at a phase [rad/s]."""
        time = abs(math.remainder(phase, _TURN)) / self.omega_0 - self.straight
        if time >= self._ramp:
            return self.amplitude
        # A roll rate that is infinite is none of a number times 0 s.
        bank = self.least_bank + (self.roll_rate * time if time > 0.0 else 0.0)
        return STANDARD_GRAVITY / self.speed * math.tan(bank)

    def sidebands(self, orders: npt.NDArray[np.int64]) -> Array:
        """Return |c_n|^2 of the Fourier series of exp(i course) [-]."""
        return np.asarray(np.abs(fourier_coefficients(self.course)[orders]) ** 2)

    def forward(self) -> float:
        """Return the integral of cos(course) over half a turn [s]."""
        rolled = 0.0
        if self._ramp:
            times = self.straight + 0.5 * self._ramp * (1.0 + _NODES)
            rolled = (
                0.5
                * self._ramp
                * float(_WEIGHTS @ np.cos([self._half(time) for time in times.tolist()]))
            )
        return self.straight + rolled - math.sin(self.turned) / self.amplitude

    @property
    def _rolling(self) -> float:
        return STANDARD_GRAVITY / (self.speed * self.roll_rate)

    @property
    def _bank(self) -> float:
        return bank_for_heading_rate(self.amplitude, self.speed)

    @property
    def _ramp(self) -> float:
        """Time in which bank rises to its largest value [s]."""
        return (self._bank - self.least_bank) / self.roll_rate

    @property
    def turned(self) -> float:
        """Course that is turned through while bank rises to its largest value [rad]."""
        return self._rolling * math.log(math.cos(self.least_bank) / math.cos(self._bank))

    def _half(self, time: float) -> float:
        """Return the course within half a turn [rad]."""
        time -= self.straight
        if time <= 0.0:
            return 0.0
        if time < self._ramp:
            return self._rolling * math.log(
                math.cos(self.least_bank) / math.cos(self.least_bank + self.roll_rate * time)
            )
        return self.turned + self.amplitude * (time - self._ramp)


@reference_shape("loiter")
@dataclass(frozen=True, slots=True)
class LoiterShape:
    """The reference that circles with the vessel and meets its plume twice a turn.

    Differs from equation (2) in that its course goes all the way round, because a slow vessel's
    plume is crossed more often so.
    """

    @property
    def joining_share(self) -> float:
        """Return the part of the heading rate that is taken while the reference is not tracked [-]."""
        return JOINING_SHARE

    def design(
        self,
        *,
        nu: float,
        speed: float,
        heading_rate_max: float,
        reserve: float,
        vessel_heading_rate: float,
        roll_rate_max: float,
    ) -> Loiter:
        """Return the fastest loiter that the vehicle can follow; parameters are those of
        ``ReferenceShape``.

        Raises
        ------
        InfeasibleError : as ``available_heading_rate``; or the vessel is so fast that the loiter
            stays on one side of its plume, or the vehicle rolls so slowly that it has turned by
            more than half a turn before it has reached its bank
        """
        available = available_heading_rate(
            nu=nu,
            speed=speed,
            heading_rate_max=heading_rate_max,
            reserve=reserve,
            vessel_heading_rate=vessel_heading_rate,
            roll_rate_max=roll_rate_max,
        )
        bank = bank_for_heading_rate(available, speed)

        def turn(least_bank: float, straight: float) -> Loiter:
            return Loiter(
                nu=nu,
                speed=speed,
                amplitude=available,
                roll_rate=roll_rate_max,
                least_bank=least_bank,
                straight=straight,
            )

        level = turn(0.0, 0.0)
        missing = nu * level.crossing_interval - level.forward()
        if missing >= 0.0:
            return _checked(turn(0.0, missing / (1.0 - nu)))

        def excess(least_bank: float) -> float:
            rolled = turn(least_bank, 0.0)
            return rolled.forward() - nu * rolled.crossing_interval

        return _checked(turn(float(brentq(excess, 0.0, bank, xtol=1e-14)), 0.0))

    def swing(self, *, speed: float, heading_rate: float, roll_rate_max: float) -> Swing:  # noqa: ARG002 - of the Protocol
        """Raise an InfeasibleError: beside a faster vessel it would have to become an oscillation."""
        raise InfeasibleError(
            "reference.shape is 'loiter', which cannot be steered in wind or beside a vessel that manoeuvres: fly it in still air"
            " beside a steady vessel (guidance.mission=track), or set reference.shape to 'fastest'"
        )


def _checked(loiter: Loiter) -> Loiter:
    """Return a loiter that goes round as it should, or raise an InfeasibleError."""
    if loiter.turned >= math.pi:
        raise InfeasibleError(
            f"reference.shape is 'loiter', which turns by {math.degrees(loiter.turned):.0f} deg while the vehicle rolls to its bank"
            f" at {math.degrees(loiter.roll_rate):g} deg/s; that must stay below 180 deg: raise guidance.roll_rate_max_deg_s, or"
            " set reference.shape to 'fastest'"
        )
    if loiter.straight >= 0.5 * loiter.crossing_interval:
        raise InfeasibleError(
            f"reference.shape is 'loiter', which beside a vessel of speed ratio nu = {loiter.nu:g} flies straight for half of its"
            " time or more, and stays on one side of the plume; that happens above about 0.5: set reference.shape to 'fastest'"
        )
    return loiter


@functools.lru_cache(maxsize=128)
def _path(loiter: Loiter) -> tuple[CoursePath, float, float]:
    """Return the path, how far off the plume lies to its right in units of V_r/omega_0, and that
    unit [m].
    """
    path = CoursePath(loiter.course)
    _, side = path.offset(0.5 * math.pi)
    return path, float(side), loiter.speed / loiter.omega_0
