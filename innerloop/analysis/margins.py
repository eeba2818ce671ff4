"""Loop margins of the autopilot on the full linear aircraft: classical at each loop break, and disk
margins.

Everything comes from two frequency responses, of the aircraft (with its servos, its engine and the
computing delay, as the exact exponential) and of the autopilot. The delay allows for a computer on
board (``innerloop.synthesis.rate``): in JSBSim the fast loops have more margin. With every loop
closed, the sensitivity at a break is S = 1/(1 + L), where L is the loop opened there and closed
elsewhere; so L = 1/S - 1 follows for all breaks from one inverse.
"""

import copy
import functools
import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from slycot import ab13md

from aircraft.linearise import LinearModel
from innerloop.analysis.checks import ALL_CONTROLS, Margin
from innerloop.analysis.closed_loop import pade
from innerloop.law.control_law import COMMANDS

SENSOR_BREAKS = ("airspeed", "altitude", "heading_rate", "beta")
"""Measurements at which the loop is opened, besides the controls."""

BREAK_NAMES = {"beta": "sideslip"}
"""Names of breaks in reports, where they differ from the model's."""

_MU_STRIDE = 4
"""Stride over the frequencies of the structured singular value, which takes a hundred times as long
as a gain [-]; all frequencies about its peak are looked at."""

_MU_ACCURACY = 1.01
"""By how much a structured singular value may come out above a bound of it: it is found by
iteration [-].
"""

FREQUENCIES = np.logspace(-3.0, 2.4, 300)
"""Frequencies at which loops are evaluated [rad/s]: from below any integral action to beyond any
servo.
"""

_WELL_CONDITIONED = 1e7
"""Condition number of the eigenvectors up to which they give frequency responses to nine digits
[-].
"""


Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]


class Loops:
    """The closed loop of an aircraft and its autopilot at one operating point, over frequency.

    Parameters
    ----------
    aircraft : linear model, as ``aircraft.linearise`` returns it
    autopilot : as ``innerloop.law.linear_controller.linear_controller`` returns it
    delay : between measurement and servo [s]
    frequencies : [rad/s]
    """

    def __init__(
        self,
        aircraft: LinearModel,
        autopilot: LinearModel,
        delay: float,
        frequencies: Array = FREQUENCIES,
    ) -> None:
        self._aircraft, self._autopilot, self._delay = aircraft, autopilot, delay
        self.frequencies = frequencies
        self.controls = tuple(autopilot.output_labels)
        self.measurements = tuple(name for name in autopilot.input_labels if name not in COMMANDS)
        self._rows = [aircraft.output_labels.index(name) for name in self.measurements]
        self._columns = [aircraft.input_labels.index(name) for name in self.controls]
        self._reads = [autopilot.input_labels.index(name) for name in self.measurements]
        self._plant = self._response_of(aircraft)
        self._law = -_response(autopilot, frequencies)[:, :, self._reads]

    def with_aircraft(self, aircraft: LinearModel) -> "Loops":
        """Return the loops of a changed aircraft under the same autopilot, whose response is known."""
        loops = self._opened_copy()
        loops._aircraft, loops._plant = aircraft, self._response_of(aircraft)
        return loops

    def with_delay(self, delay: float) -> "Loops":
        """Return the loops with another delay [s], the responses of aircraft and autopilot being
        known.
        """
        loops = self._opened_copy()
        loops._delay = delay
        return loops

    def _opened_copy(self) -> "Loops":
        loops = copy.copy(self)
        vars(loops).pop("_closed", None)
        return loops

    def _response_of(self, aircraft: LinearModel) -> Complex:
        """Return the response of an aircraft's measurements to its controls."""
        return _response(aircraft, self.frequencies)[:, self._rows][:, :, self._columns]

    @functools.cached_property
    def _closed(self) -> tuple[Complex, Complex]:
        """The sensitivity at the controls, with every loop closed, and that at each measurement."""
        plant, law = (
            self._plant * np.exp(-1j * self.frequencies * self._delay)[:, None, None],
            self._law,
        )
        sensitivity = np.linalg.inv(np.eye(len(self.controls)) + law @ plant)
        # At the measurements S = 1 - P (1 + K P)^-1 K; only its diagonal is needed.
        return sensitivity, 1.0 - np.einsum("fik,fki->fi", plant @ sensitivity, law)

    def opened(self, name: str) -> Complex:
        """Return the loop opened at a control or measurement, closed elsewhere, for negative
        feedback.
        """
        if name in self.controls:
            i = self.controls.index(name)
            sensitivity = self._closed[0][:, i, i]
        else:
            sensitivity = self._closed[1][:, self.measurements.index(name)]
        return np.asarray(1.0 / sensitivity - 1.0)

    @property
    def breaks(self) -> tuple[str, ...]:
        """Return where loops are opened: at each control and at each regulated measurement."""
        return (*self.controls, *(name for name in SENSOR_BREAKS if name in self.measurements))

    def margins(self) -> list[Margin]:
        """Return the margins at each of ``breaks``."""
        names = [BREAK_NAMES.get(name, name) for name in self.breaks]
        of_controls, of_measurements = self._closed
        measured = [self.measurements.index(name) for name in self.breaks[len(self.controls) :]]
        sensitivities = np.vstack(
            [np.diagonal(of_controls, axis1=1, axis2=2).T, of_measurements[:, measured].T]
        )
        return loop_margins(names, 1.0 / sensitivities - 1.0, self.frequencies)

    def margin_at_all_controls(self) -> Margin:
        """Return the disk margins for independent changes in all controls at once."""
        gain_db, phase_deg = self._disk_at_all_controls()
        nan = math.nan
        return Margin(
            loop=ALL_CONTROLS,
            gain_db=nan,
            phase_deg=nan,
            crossover=nan,
            disk_gain_db=gain_db,
            disk_phase_deg=phase_deg,
        )

    @property
    def stable(self) -> bool:
        """Whether every pole of the closed loop lies to the left of the imaginary axis."""
        return bool(np.all(self.poles().real < 0.0))

    def poles(self) -> Complex:
        """Return the poles of the closed loop [1/s], the delay as a second-order Pade
        approximation.
        """
        plant, law = self._aircraft, self._autopilot
        # Law, delays, aircraft, one after the other; the aircraft's outputs come back to the law.
        chain = _series(
            _delays(self._delay, len(self.controls)),
            (
                plant.A,
                plant.B[:, self._columns],
                plant.C[self._rows],
                plant.D[np.ix_(self._rows, self._columns)],
            ),
        )
        a, b, c, d = _series((law.A, law.B[:, self._reads], law.C, law.D[:, self._reads]), chain)
        return np.asarray(np.linalg.eigvals(a + b @ np.linalg.solve(np.eye(len(d)) - d, c)))

    def _disk_at_all_controls(self) -> tuple[float, float]:
        """Return disk margins for independent changes in all controls, by the structured singular
        value.
        """
        n = len(self.controls)
        one, complex_block = np.ones(n, dtype=int), np.full(n, 2)
        balanced = self._closed[0] - 0.5 * np.eye(n)
        # The largest singular value bounds the structured one from above, whatever units controls
        # have: below the largest that is found, none need be computed. Units that are good at one
        # frequency are good at most.
        bounds = np.linalg.norm(balanced, 2, axis=(1, 2))
        mu, peak = 0.0, 0
        coarse = np.arange(0, len(bounds), _MU_STRIDE)
        for number, k in enumerate(coarse[np.argsort(-bounds[coarse])]):
            if bounds[k] * _MU_ACCURACY <= mu:
                continue
            found, units, *_ = ab13md(balanced[k], one, complex_block)
            mu, peak = max((mu, peak), (float(found), int(k)))
            if number == 0:
                scaled = balanced * (units[:, None] / units)
                bounds = np.minimum(bounds, np.linalg.norm(scaled, 2, axis=(1, 2)))
        beside = range(max(0, peak - _MU_STRIDE + 1), min(len(bounds), peak + _MU_STRIDE))
        higher = [k for k in beside if k != peak and bounds[k] * _MU_ACCURACY > mu]
        values = [float(ab13md(balanced[k], one, complex_block)[0]) for k in higher]
        return _disk(1.0 / max([mu, *values]))


Matrices = tuple[Array, Array, Array, Array]


@functools.cache
def _delays(delay: float, channels: int) -> Matrices:
    """Return A, B, C, D of the same delay [s] in each of some channels."""
    one = pade(delay)
    a, b, c, d = (np.kron(np.eye(channels), m) for m in (one.A, one.B, one.C, one.D))
    return a, b, c, d


def _series(first: Matrices, then: Matrices) -> Matrices:
    """Return A, B, C, D of one system behind another."""
    a1, b1, c1, d1 = first
    a2, b2, c2, d2 = then
    n, size = len(a1), len(a1) + len(a2)
    a, b, c = np.zeros((size, size)), np.empty((size, b1.shape[1])), np.empty((len(c2), size))
    a[:n, :n], a[n:, :n], a[n:, n:] = a1, b2 @ c1, a2
    b[:n], b[n:] = b1, b2 @ d1
    c[:, :n], c[:, n:] = d2 @ c1, c2
    return a, b, c, d2 @ d1


def _disk(alpha: float) -> tuple[float, float]:
    """Return the guaranteed gain [dB] and phase [deg] margins of a balanced disk of size ``alpha``."""
    gain_db = 20.0 * math.log10((2.0 + alpha) / (2.0 - alpha)) if alpha < 2.0 else math.inf
    return gain_db, math.degrees(2.0 * math.atan(0.5 * alpha))


def _response(system: LinearModel, frequencies: Array) -> Complex:
    """Return C (jw - A)^-1 B + D over frequency, shape (frequencies, outputs, inputs), along the
    eigenvectors of A.
    """
    values, vectors = np.linalg.eig(system.A)
    if np.linalg.cond(vectors) < _WELL_CONDITIONED:
        left, right = system.C @ vectors, np.linalg.solve(vectors, system.B.astype(np.complex128))
        gains = 1.0 / (1j * frequencies[:, None] - values)
        return np.asarray((left * gains[:, None, :]) @ right + system.D)
    resolvent = 1j * frequencies[:, None, None] * np.eye(len(values)) - system.A
    forcing = np.broadcast_to(system.B.astype(np.complex128), (len(frequencies), *system.B.shape))
    return np.asarray(system.C @ np.linalg.solve(resolvent, forcing) + system.D)


def loop_margins(names: Sequence[str], loops: Complex, frequencies: Array) -> list[Margin]:
    """Return the margins of single loops known over frequency, their crossings interpolated between
    frequencies.

    Parameters
    ----------
    names : of the loops
    loops : negative feedback, shape (loops, frequencies)
    frequencies : [rad/s]
    """
    logs, phases = np.log(np.abs(loops)), np.unwrap(np.angle(loops), axis=1)
    disks = np.min(2.0 * np.abs(1.0 + loops) / np.abs(1.0 - loops), axis=1)
    gains = _gains_at_half_turns(logs, phases)
    crossovers = _crossovers(logs, phases, frequencies)
    return [
        _loop_margin(*of_loop)
        for of_loop in zip(names, gains, crossovers, disks.tolist(), strict=True)
    ]


def _loop_margin(
    name: str, gains: list[float], crossovers: list[tuple[float, float]], disk: float
) -> Margin:
    """Return the margins of a loop.

    Parameters
    ----------
    name : of the loop
    gains : logarithmic, where its phase is half a turn
    crossovers : frequency [rad/s] and phase [rad] where its gain is 1
    disk : its size
    """
    disk_gain_db, disk_phase_deg = _disk(disk)
    return Margin(
        loop=name,
        gain_db=min((abs(20.0 * gain / math.log(10.0)) for gain in gains), default=math.inf),
        phase_deg=math.degrees(
            min(
                (abs(math.remainder(p - math.pi, 2.0 * math.pi)) for _, p in crossovers),
                default=math.inf,
            )
        ),
        crossover=max((frequency for frequency, _ in crossovers), default=math.nan),
        disk_gain_db=disk_gain_db,
        disk_phase_deg=disk_phase_deg,
    )


def _gains_at_half_turns(logs: Array, phases: Array) -> list[list[float]]:
    """Return the logarithmic gains of each loop where its unwrapped phase passes an odd multiple of
    pi.
    """
    turns = np.floor((phases - math.pi) / (2.0 * math.pi))
    before, after = turns[:, :-1], turns[:, 1:]
    at = np.nonzero(before != after)
    passed = math.pi + 2.0 * math.pi * np.maximum(before[at], after[at])
    ends = (
        phases[:, :-1][at] - passed,
        logs[:, :-1][at],
        phases[:, 1:][at] - passed,
        logs[:, 1:][at],
    )
    gains: list[list[float]] = [[] for _ in logs]
    for loop, *of_crossing in zip(at[0].tolist(), *(end.tolist() for end in ends), strict=True):
        gains[loop].append(_at_zero(*of_crossing))
    return gains


def _at_zero(x0: float, y0: float, x1: float, y1: float) -> float:
    """Return y at x = 0 on the line between two points on either side of it."""
    if x1 < x0:
        x0, y0, x1, y1 = x1, y1, x0, y0
    if x0 >= 0.0:
        return y0
    if x1 <= 0.0:
        return y1
    return (y1 - y0) / (x1 - x0) * -x0 + y0


def _crossovers(logs: Array, phases: Array, frequencies: Array) -> list[list[tuple[float, float]]]:
    """Return frequency [rad/s] and phase [rad] of each loop where its gain is 1."""
    signs = np.sign(logs)
    loops, i = np.nonzero(signs[:, :-1] != signs[:, 1:])
    shares = logs[loops, i] / (logs[loops, i] - logs[loops, i + 1])
    at = phases[loops, i] + shares * (phases[loops, i + 1] - phases[loops, i])
    # Powers of arrays can differ from those of numbers in the last bit.
    ratios = (frequencies[i + 1] / frequencies[i]).tolist()
    found: list[list[tuple[float, float]]] = [[] for _ in logs]
    for loop, frequency, ratio, share, phase in zip(
        loops.tolist(), frequencies[i].tolist(), ratios, shares.tolist(), at.tolist(), strict=True
    ):
        found[loop].append((frequency * ratio**share, phase))
    return found
