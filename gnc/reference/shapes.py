"""Shapes of a reference's orbit: sinusoid, fastest oscillation, and loiter.

The closed forms of the last two are derived in docs/fastest_oscillation.md.
"""

import bisect
import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import brentq
from scipy.special import j0, jv

from common.physics import STANDARD_GRAVITY, bank_for_heading_rate
from gnc.errors import InfeasibleError
from gnc.numeric import clip
from gnc.paper import available_heading_rate, design_oscillation
from gnc.reference.reference import Array, Swing, reference_shape

ETA_FREQUENCY = 0.2
"""Amplitude below which the frequency of a steered reference is constant [rad]."""

SPEED_RATIO_MIN = -0.2
"""Least ratio of mean speed to speed in the tables [-]: a reference may move backwards."""

ETA_STEP = 0.005
"""Step of the tables [rad].

The error of linear interpolation is the squared step over 8, 3e-6, times a curvature up to 1.
"""

_SINUSOID_ORDERS = 4
"""Pairs of Bessel functions in the sinusoid's orbit [-], for errors below 1e-4 of its width."""

_SINUSOID_ETA_MAX = 2.9
"""Largest amplitude in the sinusoid's tables [rad]: J_0(2.9) = -0.224 < ``SPEED_RATIO_MIN``."""

_BANK_SWING_ORDERS = 8
"""Pairs of terms in the series of a bank swing's orbit [-], for errors below 1e-4 of its width."""

_BANK_SWING_ETA_MIN = 1e-9
"""Least amplitude for which a bank swing is computed [rad]; smaller ones are straight."""

_FASTEST_ETA_MAX = 3.2
"""Amplitude with a mean speed below 0 at any roll rate [rad]: sin(3.2)/3.2 = -0.02."""

_FRACTION_UNTIL_TRACKED = 0.8
"""Fraction of the heading rate of a fastest oscillation or loiter until it is tracked [-].

If an orbit uses nearly all of omega_max most of the time, the steering law's saturated commands can
cause limit cycles. Of 48 flights in still air from all around the vessel, 7 did not settle with a
fraction of 0.985, 5 with 0.95, and none with 0.9.
"""

_PATH_PIECES = 1024
"""Pieces of a period [-]: cubic interpolation has errors of 1e-7 V_r/omega_0."""

_FOURIER_SAMPLES = 128
"""Samples of a period [-]: Fourier coefficients decay with the third power, so errors are 1e-6."""

_TURN = 2.0 * math.pi
_QUARTER_TURN = 0.5 * math.pi
_PER_QUARTER = 1.0 / _QUARTER_TURN

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
"""Nodes and weights of Gauss's rule, for errors of 1e-12 of the mean speed during a roll."""

_RULE = tuple(zip(_NODES.tolist(), _WEIGHTS.tolist(), strict=True))
"""Pairs of node and weight."""

Course = Callable[[float], float]
"""Course offset over the phase [rad], with the period 2 pi except for whole turns."""


# Any periodic course: Fourier series, and path without a closed form.


def fourier_coefficients(course: Course) -> npt.NDArray[np.complex128]:
    """Return c_n of exp(i course) = sum of c_n exp(i n phase), in FFT order, shape (128,) [-]."""
    phases = (2.0 * np.pi / _FOURIER_SAMPLES * np.arange(_FOURIER_SAMPLES)).tolist()
    courses = np.array([course(phase) for phase in phases])
    return np.asarray(np.fft.fft(np.exp(1j * courses)) / _FOURIER_SAMPLES)


class CoursePath:
    """The path of a point of unit speed on a periodic course, relative to its mean motion.

    Parameters
    ----------
    course : course offset over the phase

    Attributes
    ----------
    mean : mean of exp(i course), the mean velocity; its real part is along the mean course [-]
    """

    def __init__(self, course: Course) -> None:
        phases = np.linspace(0.0, 2.0 * np.pi, 2 * _PATH_PIECES + 1)
        velocity = np.exp(1j * np.array([course(phase) for phase in phases.tolist()]))
        step = 2.0 * np.pi / _PATH_PIECES
        pieces = step / 6.0 * (velocity[:-1:2] + 4.0 * velocity[1::2] + velocity[2::2])
        self.mean = complex(np.sum(pieces)) / (2.0 * np.pi)
        knots = phases[::2]
        place = np.concatenate([[0.0], np.cumsum(pieces)]) - self.mean * knots
        slope = velocity[::2] - self.mean
        self._along = CubicHermiteSpline(knots, place.real, slope.real)
        self._right = CubicHermiteSpline(knots, place.imag, slope.imag)

    def offset(self, phase: npt.ArrayLike) -> tuple[Array, Array]:
        """Return the offset from the point of phase 0, along and right, per phase [V_r/omega_0]."""
        within = np.mod(phase, 2.0 * np.pi)
        return np.asarray(self._along(within)), np.asarray(self._right(within))

    def half_widths(self) -> tuple[float, float]:
        """Return the largest offsets from the point of phase 0, along and across [V_r/omega_0]."""
        return _farthest(self._along), _farthest(self._right)


def _farthest(part: "CubicHermiteSpline[np.float64]") -> float:
    turns = part.derivative().roots(extrapolate=False)
    return float(np.max(np.abs(part(turns[np.isfinite(turns)])), initial=0.0))


class OrbitTables:
    """Tables of mean speed and orbit over the amplitude eta, for use in flight.

    Parameters
    ----------
    ratios : mean speed over speed at steps ``ETA_STEP`` of eta from 0, descending to below
        ``SPEED_RATIO_MIN``, shape (n,) [-]
    series : coefficients of sin(theta), sin(2 theta), ... in the orbit, alternately right and
        along, shape (n, 2 terms) [V_r/omega_0]
    """

    def __init__(self, ratios: Array, series: Array) -> None:
        etas = ETA_STEP * np.arange(len(ratios))
        # Near 1 the ratio decreases with the square of eta, so eta is smooth over the root of 1 -
        # ratio.
        roots = np.sqrt(np.maximum(0.0, 1.0 - ratios))
        kept = roots <= math.sqrt(1.0 - SPEED_RATIO_MIN)
        self._roots: list[float] = roots[kept].tolist()
        self._etas: list[float] = etas[kept].tolist()
        self._rows: list[list[float]] = series.tolist()
        # In spite of rounding, a row must follow the one that is found.
        self._eta_last = ETA_STEP * (len(ratios) - 3)

    def eta(self, speed_ratio: float) -> float:
        """Return eta for a ratio of mean speed to speed, which is clipped to the table [rad]."""
        if speed_ratio >= 1.0:
            return 0.0
        roots = self._roots
        etas = self._etas
        root = math.sqrt(1.0 - speed_ratio)
        i = min(max(bisect.bisect(roots, root), 1), len(roots) - 1)
        fraction = min(1.0, (root - roots[i - 1]) / (roots[i] - roots[i - 1]))
        return etas[i - 1] + fraction * (etas[i] - etas[i - 1])

    def offset(self, eta: float, phase: float) -> tuple[float, float]:
        """Return the offset from the orbit's centre, along the mean course and right [V_r/omega_0].

        Parameters
        ----------
        eta, phase : amplitude and theta [rad]
        """
        row = clip(eta, 0.0, self._eta_last) / ETA_STEP
        i = int(row)
        fraction = row - i
        low = self._rows[i]
        high = self._rows[i + 1]
        along = right = 0.0
        for k in range(0, len(low), 2):
            odd = low[k] + fraction * (high[k] - low[k])
            even = low[k + 1] + fraction * (high[k + 1] - low[k + 1])
            right += odd * math.sin((k + 1) * phase)
            along += even * math.sin((k + 2) * phase)
        return along, right


# The paper's sinusoid.


@dataclass(frozen=True, slots=True)
class SinusoidSwing:
    """Courses eta cos(theta); methods as in ``gnc.reference.reference.Swing``.

    Differs from ``gnc.paper`` in that eta comes from a table, because a steered reference needs eta
    at every step, also for negative speed ratios, where eta lies beyond the first zero of J_0.

    Attributes
    ----------
    heading_rate : largest heading rate [rad/s]
    acceleration : largest heading acceleration, g/V_r times the roll rate [rad/s^2]
    """

    heading_rate: float
    acceleration: float

    def eta(self, speed_ratio: float) -> float:
        """Return eta for a ratio of mean speed to speed, equation (6), within 1e-5 [rad]."""
        return _sinusoid_tables().eta(speed_ratio)

    def frequency(self, eta: float, heading_rate: float) -> float:
        """Return omega_0, the lower one of the limits by heading rate and by roll rate [rad/s]."""
        eta = eta if eta > ETA_FREQUENCY else ETA_FREQUENCY
        largest = heading_rate if heading_rate < self.heading_rate else self.heading_rate
        by_heading_rate = largest / eta
        by_roll_rate = math.sqrt(self.acceleration / eta)
        return by_heading_rate if by_heading_rate < by_roll_rate else by_roll_rate

    def course(self, eta: float, phase: float) -> float:
        """Return the course offset eta cos(theta) [rad]."""
        return eta * math.cos(phase)

    def slopes(self, eta: float, phase: float) -> tuple[float, float]:  # noqa: ARG002 - of the Protocol
        """Return the derivatives of the course by eta, and by theta over eta [-]."""
        return math.cos(phase), -math.sin(phase)

    def offset(self, eta: float, phase: float) -> tuple[float, float]:
        """Return the offset from the orbit's centre, by ``gnc.paper.offset`` [V_r/omega_0]."""
        return _sinusoid_tables().offset(eta, phase)


@reference_shape("sinusoid")
@dataclass(frozen=True, slots=True)
class Sinusoid:
    """The paper's reference, whose course oscillates sinusoidally about the vessel's course."""

    turn_rate_fraction_until_tracked: ClassVar[float] = 1.0
    design = staticmethod(design_oscillation)

    def swing(self, *, speed: float, heading_rate: float, roll_rate_max: float) -> Swing:
        """Return the sinusoids of every amplitude; see ``ReferenceShape``."""
        return SinusoidSwing(heading_rate, STANDARD_GRAVITY * roll_rate_max / speed)


@functools.lru_cache(maxsize=1)
def _sinusoid_tables() -> OrbitTables:
    etas = np.arange(0.0, _SINUSOID_ETA_MAX + ETA_STEP, ETA_STEP)
    columns = []
    for k in range(1, _SINUSOID_ORDERS + 1):
        columns.append(2.0 * (-1.0) ** (k - 1) * jv(2 * k - 1, etas) / (2 * k - 1))
        columns.append((-1.0) ** k * jv(2 * k, etas) / k)
    return OrbitTables(j0(etas), np.stack(columns, axis=-1))


# The fastest oscillation: the reference turns at its limits, alternately left and right.


class _Quarter(NamedTuple):
    """A quarter period: its duration, the time until bank is largest, and the heading rate then."""

    time: float
    ramp: float
    heading_rate: float


class BankSwing:
    """Courses of an aircraft that rolls from bank to bank at its limits; methods as in ``Swing``.

    From the passage through the centre, phase 0, bank decreases from 0 at the roll rate p to
    -phi_max, is held, and is back at 0 half a period later; the other half period mirrors this.
    Turns are coordinated: omega = g/V tan(phi). During a roll the course changes by g/(V p) ln
    cos(p t); while bank is held the course changes uniformly. If the course change is too small to
    reach phi_max, the aircraft rolls to a smaller bank and back at once.

    Parameters
    ----------
    speed : V_r [m/s]
    heading_rate : largest heading rate, at phi_max [rad/s]
    roll_rate_max : roll rate p; may be infinite [rad/s]
    """

    def __init__(self, *, speed: float, heading_rate: float, roll_rate_max: float) -> None:
        self._per_tangent = STANDARD_GRAVITY / speed
        self._heading_rate = heading_rate
        self._roll_rate = roll_rate_max
        bank_max = math.atan(heading_rate / self._per_tangent)
        # Time in which bank reaches phi_max, and the course change in this time.
        self._ramp = bank_max / roll_rate_max
        self._rolling = self._per_tangent / roll_rate_max
        self._rolled = -self._rolling * math.log(math.cos(bank_max))

    def half_period(self, eta: float) -> float:
        """Return half the period, the crossing interval [s]."""
        return 2.0 * self._quarter(eta).time

    def largest_heading_rate(self, eta: float) -> float:
        """Return the heading rate at the largest bank of an amplitude [rad/s]."""
        return self._quarter(eta).heading_rate

    def holds_bank(self, eta: float) -> bool:
        """Return whether an amplitude reaches the largest bank."""
        return eta > self._rolled

    def eta(self, speed_ratio: float) -> float:
        """Return eta for a ratio of mean speed to speed, from a table, within 1e-5 [rad]."""
        return self._tables.eta(speed_ratio)

    def speed_ratio(self, eta: float) -> float:
        """Return the mean speed over speed, the mean of cos(course) over a quarter period [-]."""
        if eta < _BANK_SWING_ETA_MIN:
            return 1.0
        quarter, ramp, turning = self._quarter(eta)
        total = 0.0
        for node, weight in _RULE:
            banked = self._roll_rate * 0.5 * (1.0 + node) * ramp if ramp else 0.0
            total += weight * math.cos(eta + self._rolling * math.log(math.cos(banked)))
        return (0.5 * ramp * total + math.sin(turning * (quarter - ramp)) / turning) / quarter

    def frequency(self, eta: float, heading_rate: float) -> float:
        """Return the largest omega_0 for a heading rate [rad/s] and the roll-rate limit [rad/s]."""
        quarter, _, largest = self._quarter(max(ETA_FREQUENCY, eta))
        fastest = _QUARTER_TURN / quarter
        return fastest if heading_rate >= largest else fastest * heading_rate / largest

    def course(self, eta: float, phase: float) -> float:
        """Return the course offset from the mean course [rad]."""
        if eta < _BANK_SWING_ETA_MIN and not self.holds_bank(eta):
            return eta * math.cos(phase)
        quarter, rate, held = self._held(eta)
        # Time from the middle of a half period; one half lies before phase 0, the other after it.
        off = quarter - quarter * _PER_QUARTER * abs(math.remainder(phase, _TURN))
        if -held <= off <= held or not self._ramp:
            return rate * off
        course = eta + self._rolling * math.log(math.cos(self._roll_rate * (quarter - abs(off))))
        return course if off > 0.0 else -course

    def heading_rate(self, eta: float, phase: float) -> float:
        """Return the heading rate of a reference at its limits [rad/s]."""
        quarter, ramp, rate = self._quarter(eta)
        angle = math.remainder(phase, _TURN)
        time = quarter - abs(quarter - quarter * _PER_QUARTER * abs(angle))
        if ramp and time < ramp:
            rate = self._per_tangent * math.tan(self._roll_rate * time)
        return -rate if angle > 0.0 else rate

    def slopes(self, eta: float, phase: float) -> tuple[float, float]:
        """Return the derivatives of the course offset by eta, and by phase over eta [-]."""
        if eta < _BANK_SWING_ETA_MIN and not self.holds_bank(eta):
            return math.cos(phase), -math.sin(phase)
        quarter, rate, held = self._held(eta)
        angle = math.remainder(phase, _TURN)
        off = quarter - quarter * _PER_QUARTER * abs(angle)
        # The derivative of the quarter period by eta is 1 over the largest heading rate, whether
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
        """Return the offset from the orbit's centre, along its course and right [V_r/omega_0]."""
        return self._tables.offset(eta, phase)

    def _quarter(self, eta: float) -> _Quarter:
        if self.holds_bank(eta):
            time = self._ramp + (eta - self._rolled) / self._heading_rate
            return _Quarter(time, self._ramp, self._heading_rate)
        # cos(bank) = exp(-eta/rolling): tan(bank)^2 = exp(2 eta/rolling) - 1.
        tangent = math.sqrt(math.expm1(2.0 * eta / self._rolling))
        time = math.atan(tangent) / self._roll_rate
        return _Quarter(time, time, self._per_tangent * tangent)

    def _held(self, eta: float) -> tuple[float, float, float]:
        """Return quarter period [s], largest heading rate [rad/s], and half its duration [s]."""
        quarter = self._quarter(eta)
        held = (eta - self._rolled) / self._heading_rate if self.holds_bank(eta) else 0.0
        return quarter.time, quarter.heading_rate, held

    @functools.cached_property
    def _tables(self) -> OrbitTables:
        """Tables of orbits, up to two steps beyond the amplitude of the least mean speed."""
        ratios = [1.0]
        while len(ratios) < 3 or ratios[-3] > SPEED_RATIO_MIN:
            ratios.append(self.speed_ratio(ETA_STEP * len(ratios)))
        order = np.arange(1, 2 * _BANK_SWING_ORDERS + 1)
        # The course is even in the phase and changes its sign after half a period, so the cosine of
        # the course has even orders only, and the sine odd ones.
        series = [
            fourier_coefficients(functools.partial(self.course, ETA_STEP * i))[order]
            for i in range(len(ratios))
        ]
        both = np.where(order % 2, np.imag(series), np.real(series))
        return OrbitTables(np.array(ratios), 2.0 * both / order)


@functools.lru_cache(maxsize=8)
def bank_swing(speed: float, heading_rate: float, roll_rate_max: float) -> BankSwing:
    """Return a ``BankSwing`` with these parameters, cached because of its tables."""
    return BankSwing(speed=speed, heading_rate=heading_rate, roll_rate_max=roll_rate_max)


@dataclass(frozen=True, slots=True, kw_only=True)
class FastestOscillation:
    """The oscillation with the shortest period for a largest bank and roll rate; an ``Orbit``.

    Attributes
    ----------
    nu : speed ratio [-]
    speed : V_r [m/s]
    eta : course amplitude [rad]
    crossing_interval : time between crossings of the centre of oscillation, half a period [s]
    omega_0 : angular frequency [rad/s]
    courses : courses of every amplitude
    """

    nu: float
    speed: float
    eta: float
    crossing_interval: float
    omega_0: float
    courses: BankSwing
    symmetric: ClassVar[bool] = True

    @property
    def period(self) -> float:
        """Time of one oscillation [s]."""
        return 2.0 * self.crossing_interval

    @property
    def amplitude(self) -> float:
        """Largest heading rate [rad/s]."""
        return self.courses.largest_heading_rate(self.eta)

    @property
    def limit(self) -> str:
        """Return ``heading rate`` if the largest bank is held, otherwise ``roll rate``."""
        return "heading rate" if self.courses.holds_bank(self.eta) else "roll rate"

    def offset(self, time: npt.ArrayLike) -> tuple[Array, Array]:
        """Return the offset from the centre of oscillation, along and right, within 1e-5 m [m]."""
        along, right = _oscillation_path(self.courses, self.eta).offset(
            self.omega_0 * np.asarray(time, dtype=np.float64)
        )
        unit = self.speed / self.omega_0
        return unit * along, unit * right

    def half_widths(self) -> tuple[float, float]:
        """Return the orbit's largest offsets from the centre, along its course and across [m]."""
        along, across = _oscillation_path(self.courses, self.eta).half_widths()
        unit = self.speed / self.omega_0
        return unit * along, unit * across

    def course(self, phase: float) -> float:
        """Return the course offset from the centre's course at a phase [rad]."""
        return self.courses.course(self.eta, phase)

    def heading_rate(self, phase: float) -> float:
        """Return the heading rate at a phase [rad/s]."""
        return self.courses.heading_rate(self.eta, phase)

    def sidebands(self, orders: npt.NDArray[np.int64]) -> Array:
        """Return |c_n|^2 of the Fourier series of exp(i course) [-]."""
        return np.asarray(np.abs(fourier_coefficients(self.course)[orders]) ** 2)


@reference_shape("fastest")
@dataclass(frozen=True, slots=True)
class Fastest:
    """The reference with trapezoidal bank, which crosses most often within its limits.

    Differs from equation (2), whose sinusoidal heading rate reaches its limit for moments only.
    """

    turn_rate_fraction_until_tracked: ClassVar[float] = _FRACTION_UNTIL_TRACKED

    def design(
        self,
        *,
        nu: float,
        speed: float,
        heading_rate_max: float,
        reserve: float,
        vessel_heading_rate: float,
        roll_rate_max: float,
    ) -> FastestOscillation:
        """Return the fastest oscillation that the vehicle can follow; see ``ReferenceShape``."""
        available = available_heading_rate(
            nu=nu,
            speed=speed,
            heading_rate_max=heading_rate_max,
            reserve=reserve,
            vessel_heading_rate=vessel_heading_rate,
            roll_rate_max=roll_rate_max,
        )
        courses = bank_swing(speed, available, roll_rate_max)

        def excess(eta: float) -> float:
            return courses.speed_ratio(eta) - nu

        eta = float(brentq(excess, 0.0, _FASTEST_ETA_MAX, xtol=1e-15, rtol=1e-14))
        interval = courses.half_period(eta)
        return FastestOscillation(
            nu=nu,
            speed=speed,
            eta=eta,
            crossing_interval=interval,
            omega_0=math.pi / interval,
            courses=courses,
        )

    def swing(self, *, speed: float, heading_rate: float, roll_rate_max: float) -> Swing:
        """Return the courses of every amplitude; see ``ReferenceShape``."""
        return bank_swing(speed, heading_rate, roll_rate_max)


@functools.lru_cache(maxsize=128)
def _oscillation_path(courses: BankSwing, eta: float) -> CoursePath:
    return CoursePath(functools.partial(courses.course, eta))


# The loiter: a circle that moves with the vessel and crosses the plume twice per turn.


@dataclass(frozen=True, slots=True, kw_only=True)
class LoiterOrbit:
    """The orbit of a loiter, with phase 0 in the middle of its straight leg; an ``Orbit``.

    The reference turns to the right at the largest bank. On the vessel's course, bank decreases at
    the roll rate, and the reference flies straight for long enough to keep up with the vessel; then
    bank increases again.

    Attributes
    ----------
    nu : speed ratio [-]
    speed : V_r [m/s]
    amplitude : largest heading rate [rad/s]
    roll_rate : rate at which bank changes; may be infinite [rad/s]
    least_bank : bank on the vessel's course [rad]
    straight : half the time of straight flight [s]
    """

    nu: float
    speed: float
    amplitude: float
    roll_rate: float
    least_bank: float
    straight: float
    eta: ClassVar[float] = math.pi
    limit: ClassVar[str] = "heading rate"
    symmetric: ClassVar[bool] = False

    @property
    def crossing_interval(self) -> float:
        """Time between crossings of the plume, half a turn [s]."""
        return self.straight + self._ramp + (math.pi - self.turned) / self.amplitude

    @property
    def period(self) -> float:
        """Duration of one turn [s]."""
        return 2.0 * self.crossing_interval

    @property
    def omega_0(self) -> float:
        """Angular frequency [rad/s]."""
        return math.pi / self.crossing_interval

    @property
    def turned(self) -> float:
        """Change of course while bank rises to its largest value [rad]."""
        return self._rolling * math.log(math.cos(self.least_bank) / math.cos(self._bank))

    def offset(self, time: npt.ArrayLike) -> tuple[Array, Array]:
        """Return the offset from the point where the plume is crossed every half turn [m]."""
        path, side = _loiter_path(self)
        unit = self.speed / self.omega_0
        along, right = path.offset(self.omega_0 * np.asarray(time, dtype=np.float64))
        return unit * along, unit * (right - side)

    def half_widths(self) -> tuple[float, float]:
        """Return the largest offsets from the crossing point, along the course and across [m]."""
        path, side = _loiter_path(self)
        unit = self.speed / self.omega_0
        along, _ = path.half_widths()
        _, far = path.offset(math.pi)
        return unit * along, unit * max(side, float(far) - side)

    def course(self, phase: float) -> float:
        """Return the course relative to the vessel's course, growing by a turn per period [rad]."""
        turns = round(phase / _TURN)
        time = (phase - _TURN * turns) / self.omega_0
        return _TURN * turns + math.copysign(self._half(abs(time)), time)

    def heading_rate(self, phase: float) -> float:
        """Return the heading rate at a phase [rad/s]."""
        time = abs(math.remainder(phase, _TURN)) / self.omega_0 - self.straight
        if time >= self._ramp:
            return self.amplitude
        # An infinite roll rate times 0 s is NaN.
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
            cosines = np.cos([self._half(time) for time in times.tolist()])
            rolled = 0.5 * self._ramp * float(_WEIGHTS @ cosines)
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

    def _half(self, time: float) -> float:
        """Return the course at a time within the first half turn [rad]."""
        time -= self.straight
        if time <= 0.0:
            return 0.0
        if time < self._ramp:
            bank = self.least_bank + self.roll_rate * time
            return self._rolling * math.log(math.cos(self.least_bank) / math.cos(bank))
        return self.turned + self.amplitude * (time - self._ramp)


@reference_shape("loiter")
@dataclass(frozen=True, slots=True)
class LoiterShape:
    """The reference that circles along with the vessel and crosses the plume twice per turn.

    Differs from equation (2) in that the course turns all the way round, because below a speed
    ratio of 0.33 a loiter crosses the plume more often than any oscillation.
    """

    turn_rate_fraction_until_tracked: ClassVar[float] = _FRACTION_UNTIL_TRACKED

    def design(
        self,
        *,
        nu: float,
        speed: float,
        heading_rate_max: float,
        reserve: float,
        vessel_heading_rate: float,
        roll_rate_max: float,
    ) -> LoiterOrbit:
        """Return the fastest loiter that the vehicle can follow; see ``ReferenceShape``.

        Raises
        ------
        InfeasibleError : as in ``available_heading_rate``; or the vessel is so fast that the loiter
            stays on one side of the plume; or the vehicle rolls so slowly that it turns by more
            than half a turn before it reaches its bank
        """
        available = available_heading_rate(
            nu=nu,
            speed=speed,
            heading_rate_max=heading_rate_max,
            reserve=reserve,
            vessel_heading_rate=vessel_heading_rate,
            roll_rate_max=roll_rate_max,
        )

        def turn(least_bank: float, straight: float) -> LoiterOrbit:
            return LoiterOrbit(
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

        bank = bank_for_heading_rate(available, speed)
        return _checked(turn(float(brentq(excess, 0.0, bank, xtol=1e-14)), 0.0))

    def swing(self, *, speed: float, heading_rate: float, roll_rate_max: float) -> Swing:  # noqa: ARG002 - of the Protocol
        """Raise an InfeasibleError: a loiter cannot follow a faster vessel without oscillating."""
        raise InfeasibleError(
            "reference.shape is 'loiter', which cannot be steered in wind or beside a vessel that"
            " manoeuvres: fly it in still air beside a steady vessel (guidance.mission=track), or"
            " set reference.shape to 'fastest'"
        )


def _checked(loiter: LoiterOrbit) -> LoiterOrbit:
    """Return a loiter, or raise an InfeasibleError if it is not a full circle."""
    if loiter.turned >= math.pi:
        raise InfeasibleError(
            f"reference.shape is 'loiter', which turns by {math.degrees(loiter.turned):.0f} deg"
            f" while the vehicle rolls to its bank at {math.degrees(loiter.roll_rate):g} deg/s;"
            " that must stay below 180 deg: raise guidance.roll_rate_max_deg_s, or set"
            " reference.shape to 'fastest'"
        )
    if loiter.straight >= 0.5 * loiter.crossing_interval:
        raise InfeasibleError(
            "reference.shape is 'loiter', which at a speed ratio"
            f" nu = {loiter.nu:g} flies straight for half of its time or more, and stays on one"
            " side of the plume; that happens above about 0.5: set reference.shape to 'fastest'"
        )
    return loiter


@functools.lru_cache(maxsize=128)
def _loiter_path(loiter: LoiterOrbit) -> tuple[CoursePath, float]:
    """Return the path from the middle of the straight leg, and the plume's offset to the right."""
    path = CoursePath(loiter.course)
    _, side = path.offset(0.5 * math.pi)
    return path, float(side)
