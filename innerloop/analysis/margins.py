"""Loop margins of the autopilot on the full linear aircraft: classical at each loop break, and disk margins.

Everything comes from two frequency responses, of the aircraft (with its servos, its engine and the computing delay, as
the exact exponential) and of the autopilot. With every loop closed, the sensitivity at a break is S = 1/(1 + L), where
L is the loop opened there and closed elsewhere; so L = 1/S - 1 follows for all breaks from one inverse.
"""

import copy
import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import control
import numpy as np
import numpy.typing as npt
from slycot import ab13md

from innerloop.law.control_law import COMMANDS

SENSOR_BREAKS = ("airspeed", "altitude", "heading_rate", "beta")
"""Measurements at which the loop is opened, besides the controls."""

BREAK_NAMES = {"beta": "sideslip"}
"""Names of breaks in reports, where they differ from the model's."""

ALL_CONTROLS = "all controls"
"""Name of the margins for simultaneous changes in every control."""

_MU_STRIDE = 4
"""Stride over the frequencies of the structured singular value, which takes a hundred times as long as a gain [-]; all
frequencies about its peak are looked at."""

FREQUENCIES = np.logspace(-3.0, 2.4, 300)
"""Frequencies at which loops are evaluated [rad/s]: from below any integral action to beyond any servo."""

_WELL_CONDITIONED = 1e7
"""Condition number of the eigenvectors up to which they give frequency responses to nine digits [-]."""


Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class Margin:
    """Margins with one loop opened and every other closed.

    Attributes
    ----------
    loop : where the loop is opened
    gain_db : least change of gain, up or down, that brings instability [dB]; infinite where none does
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


class Loops:
    """The closed loop of an aircraft and its autopilot at one operating point, over frequency.

    Parameters
    ----------
    aircraft : linear model, as ``aircraft.dynamics.linearise`` returns it
    autopilot : as ``innerloop.law.linear_controller.linear_controller`` returns it
    delay : between measurement and servo [s]
    frequencies : [rad/s]
    """

    def __init__(
        self,
        aircraft: control.StateSpace,
        autopilot: control.StateSpace,
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
        self._plant = _response(aircraft, frequencies)[:, self._rows][:, :, self._columns]
        self._law = -_response(autopilot, frequencies)[:, :, self._reads]
        self._close()

    def with_aircraft(self, aircraft: control.StateSpace, delay: float) -> "Loops":
        """Return the loops of a changed aircraft, or of another delay, under the same autopilot, whose response is known."""
        loops = copy.copy(self)
        loops._aircraft, loops._delay = aircraft, delay
        if aircraft is not self._aircraft:
            loops._plant = _response(aircraft, self.frequencies)[:, self._rows][:, :, self._columns]
        loops._close()
        return loops

    def _close(self) -> None:
        """Close every loop."""
        plant, law = self._plant * np.exp(-1j * self.frequencies * self._delay)[:, None, None], self._law
        self._sensitivity = np.linalg.inv(np.eye(len(self.controls)) + law @ plant)
        # At the measurements S = 1 - P (1 + K P)^-1 K; only its diagonal is needed.
        self._at_measurements = 1.0 - np.einsum("fik,fki->fi", plant @ self._sensitivity, law)

    def opened(self, name: str) -> Complex:
        """Return the loop opened at a control or measurement, closed elsewhere, for negative feedback."""
        if name in self.controls:
            i = self.controls.index(name)
            sensitivity = self._sensitivity[:, i, i]
        else:
            sensitivity = self._at_measurements[:, self.measurements.index(name)]
        return np.asarray(1.0 / sensitivity - 1.0)

    @property
    def breaks(self) -> tuple[str, ...]:
        """Return where loops are opened: at each control and at each regulated measurement."""
        return (*self.controls, *(name for name in SENSOR_BREAKS if name in self.measurements))

    def margins(self) -> list[Margin]:
        """Return the margins at each of ``breaks``."""
        names = [BREAK_NAMES.get(name, name) for name in self.breaks]
        return loop_margins(names, np.array([self.opened(name) for name in self.breaks]), self.frequencies)

    def margin_at_all_controls(self) -> Margin:
        """Return the disk margins for independent changes in all controls at once."""
        gain_db, phase_deg = self._disk_at_all_controls()
        nan = math.nan
        return Margin(loop=ALL_CONTROLS, gain_db=nan, phase_deg=nan, crossover=nan, disk_gain_db=gain_db, disk_phase_deg=phase_deg)

    @property
    def stable(self) -> bool:
        """Whether every pole of the closed loop lies to the left of the imaginary axis."""
        return bool(np.all(self.poles().real < 0.0))

    def poles(self) -> Complex:
        """Return the poles of the closed loop [1/s], the delay as a second-order Pade approximation."""
        plant, law = self._aircraft, self._autopilot
        # Law, delays, aircraft, one after the other; the aircraft's outputs come back to the law.
        chain = _series(
            _delays(self._delay, len(self.controls)),
            (plant.A, plant.B[:, self._columns], plant.C[self._rows], plant.D[np.ix_(self._rows, self._columns)]),
        )
        a, b, c, d = _series((law.A, law.B[:, self._reads], law.C, law.D[:, self._reads]), chain)
        return np.asarray(np.linalg.eigvals(a + b @ np.linalg.solve(np.eye(len(d)) - d, c)))

    def _disk_at_all_controls(self) -> tuple[float, float]:
        """Return disk margins for independent changes in all controls, by the structured singular value."""
        n = len(self.controls)
        one, complex_block = np.ones(n, dtype=int), np.full(n, 2)
        balanced = self._sensitivity - 0.5 * np.eye(n)
        # The largest singular value bounds the structured one from above: below the largest found, none need be computed.
        bounds = np.linalg.norm(balanced, 2, axis=(1, 2))
        mu, peak = 0.0, 0
        coarse = np.arange(0, len(bounds), _MU_STRIDE)
        for k in coarse[np.argsort(-bounds[coarse])]:
            if bounds[k] <= mu:
                break
            mu, peak = max((mu, peak), (float(ab13md(balanced[k], one, complex_block)[0]), int(k)))
        beside = range(max(0, peak - _MU_STRIDE + 1), min(len(bounds), peak + _MU_STRIDE))
        return _disk(1.0 / max(float(ab13md(balanced[k], one, complex_block)[0]) for k in beside))


Matrices = tuple[Array, Array, Array, Array]


@functools.cache
def _pade(delay: float) -> control.StateSpace:
    """Return the second-order Pade approximation of a delay [s]."""
    return control.ss(control.tf(*control.pade(delay, 2)))


@functools.cache
def _delays(delay: float, channels: int) -> Matrices:
    """Return A, B, C, D of the same delay [s] in each of some channels."""
    pade = _pade(delay)
    a, b, c, d = (np.kron(np.eye(channels), m) for m in (pade.A, pade.B, pade.C, pade.D))
    return a, b, c, d


def _series(first: Matrices, then: Matrices) -> Matrices:
    """Return A, B, C, D of one system behind another."""
    a1, b1, c1, d1 = first
    a2, b2, c2, d2 = then
    a = np.block([[a1, np.zeros((len(a1), len(a2)))], [b2 @ c1, a2]])
    return a, np.vstack([b1, b2 @ d1]), np.hstack([d2 @ c1, c2]), d2 @ d1


def _disk(alpha: float) -> tuple[float, float]:
    """Return the guaranteed gain [dB] and phase [deg] margins of a balanced disk of size ``alpha``."""
    gain_db = 20.0 * math.log10((2.0 + alpha) / (2.0 - alpha)) if alpha < 2.0 else math.inf
    return gain_db, math.degrees(2.0 * math.atan(0.5 * alpha))


def _response(system: control.StateSpace, frequencies: Array) -> Complex:
    """Return C (jw - A)^-1 B + D over frequency, shape (frequencies, outputs, inputs), along the eigenvectors of A."""
    values, vectors = np.linalg.eig(system.A)
    if np.linalg.cond(vectors) < _WELL_CONDITIONED:
        left, right = system.C @ vectors, np.linalg.solve(vectors, system.B.astype(np.complex128))
        gains = 1.0 / (1j * frequencies[:, None] - values)
        return np.asarray((left * gains[:, None, :]) @ right + system.D)
    resolvent = 1j * frequencies[:, None, None] * np.eye(len(values)) - system.A
    forcing = np.broadcast_to(system.B.astype(np.complex128), (len(frequencies), *system.B.shape))
    return np.asarray(system.C @ np.linalg.solve(resolvent, forcing) + system.D)


def loop_margins(names: Sequence[str], loops: Complex, frequencies: Array) -> list[Margin]:
    """Return the margins of single loops known over frequency, their crossings interpolated between frequencies.

    Parameters
    ----------
    names : of the loops
    loops : negative feedback, shape (loops, frequencies)
    frequencies : [rad/s]
    """
    logs = np.log(np.abs(loops))
    phases = np.unwrap(np.angle(loops), axis=1)
    disks = np.min(2.0 * np.abs(1.0 + loops) / np.abs(1.0 - loops), axis=1)
    return [_loop_margin(*of_loop, frequencies) for of_loop in zip(names, logs, phases, disks.tolist(), strict=True)]


def _loop_margin(name: str, logs: Array, phase: Array, disk: float, frequencies: Array) -> Margin:
    """Return the margins of a loop from its logarithmic gain, its unwrapped phase [rad] and the size of its disk."""
    gains = [float(np.interp(0.0, *_ordered(phase[i : i + 2] - turn, logs[i : i + 2]))) for i, turn in _crossings(phase)]
    at_unity = np.nonzero(np.sign(logs[:-1]) != np.sign(logs[1:]))[0]
    shares = [logs[i] / (logs[i] - logs[i + 1]) for i in at_unity]
    phases = [phase[i] + share * (phase[i + 1] - phase[i]) for i, share in zip(at_unity, shares, strict=True)]
    crossovers = [
        frequencies[i] * (frequencies[i + 1] / frequencies[i]) ** share for i, share in zip(at_unity, shares, strict=True)
    ]
    away = [abs(math.remainder(p - math.pi, 2.0 * math.pi)) for p in phases]
    disk_gain_db, disk_phase_deg = _disk(disk)
    return Margin(
        loop=name,
        gain_db=min((abs(20.0 * g / math.log(10.0)) for g in gains), default=math.inf),
        phase_deg=math.degrees(min(away, default=math.inf)),
        crossover=max(crossovers, default=math.nan),
        disk_gain_db=disk_gain_db,
        disk_phase_deg=disk_phase_deg,
    )


def _crossings(phase: Array) -> list[tuple[int, float]]:
    """Return where an unwrapped phase passes an odd multiple of pi, and that multiple."""
    turns = np.floor((phase - math.pi) / (2.0 * math.pi))
    crossed = np.nonzero(turns[:-1] != turns[1:])[0]
    return [(int(i), math.pi + 2.0 * math.pi * float(max(turns[i], turns[i + 1]))) for i in crossed]


def _ordered(x: Array, y: Array) -> tuple[Array, Array]:
    order = np.argsort(x)
    return x[order], y[order]


def closed_loop(aircraft: control.StateSpace, autopilot: control.StateSpace, delay: float) -> control.StateSpace:
    """Return the closed loop from the autopilot's commands to every output of the aircraft and to the controls.

    The aircraft's other inputs, such as gusts, follow the commands. The ``delay`` is that between measurement and servo [s].
    """
    controls: Sequence[str] = autopilot.output_labels
    others = [name for name in aircraft.input_labels if name not in controls]
    pade = _pade(delay)
    plant = control.ss(aircraft, inputs=aircraft.input_labels, outputs=aircraft.output_labels, name="aircraft")
    delays = [control.ss(pade, inputs=[f"{name}_delayed_in"], outputs=[name], name=f"{name}_delay") for name in controls]
    connections: list[list[object]] = [
        [f"autopilot.{name}", f"aircraft.{name}"] for name in autopilot.input_labels if name not in COMMANDS
    ]
    for block, name in zip(delays, controls, strict=True):
        connections += [
            [f"aircraft.{name}", f"{block.name}.{name}"],
            [f"{block.name}.{name}_delayed_in", f"autopilot.{name}"],
        ]
    return control.interconnect(
        [plant, autopilot, *delays],
        connections=connections,
        inplist=[*(f"autopilot.{name}" for name in COMMANDS), *(f"aircraft.{name}" for name in others)],
        outlist=[*(f"aircraft.{name}" for name in aircraft.output_labels), *(f"autopilot.{name}" for name in controls)],
        inputs=[*COMMANDS, *others],
        outputs=[*aircraft.output_labels, *(f"{name}_command" for name in controls)],
        warn_duplicate=False,
        check_unused=False,
    )
