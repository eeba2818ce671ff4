"""Loop margins of the autopilot on the full linear aircraft, and the required margins.

Gain, phase and disk margins are computed at each loop break. They follow from the frequency
responses of the autopilot and of the aircraft with servos, engine and computing delay (an exact
exponential). The delay allows for an on-board computer (``innerloop.schedule.loop_delay``); in
JSBSim the fast loops have more margin.

With every loop closed, the sensitivity at a break is S = 1/(1 + L), where L is the loop gain at
that break, with all other loops closed. One matrix inverse thus gives L = 1/S - 1 at all breaks.

python-control and slycot are imported only where they are used: a flight with a cached design does
not need them.
"""

import copy
import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from aircraft.linearise import LinearModel
from innerloop.law import COMMANDS

if TYPE_CHECKING:
    import control

NOMINAL = "as modelled"
"""Name of the aircraft without any perturbation."""

ALL_CONTROLS = "all controls"
"""Name of the loop break at all controls at once."""

SENSOR_BREAKS = ("airspeed", "altitude", "heading_rate", "beta")
"""Measurements at which the loop is opened, in addition to the controls."""

BREAK_NAMES = {"beta": "sideslip"}
"""Names of breaks in reports, if they differ from the model's."""

FREQUENCIES = np.logspace(-3.0, 2.4, 300)
"""Frequencies at which loops are evaluated [rad/s], from integral action to beyond any servo."""

_MU_STRIDE = 4
"""Stride over the frequencies for the structured singular value [-].

The value takes a hundred times as long to compute as a gain. Around its peak all frequencies are
evaluated.
"""

_MU_ACCURACY = 1.01
"""Factor that allows for the iteration error of structured singular values [-]."""

_WELL_CONDITIONED = 1e7
"""Condition number of eigenvectors up to which frequency responses have nine digits [-]."""

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class Margin:
    """Margins with one loop opened and every other closed.

    Attributes
    ----------
    loop : name of the loop break
    gain_db : smallest change of gain, up or down, that makes the loop unstable [dB], or infinity
    phase_deg : smallest change of phase that makes the loop unstable [deg], or infinity
    crossover : highest gain crossover [rad/s]; NaN if the gain never crosses 1
    disk_gain_db, disk_phase_deg : margins for simultaneous changes of gain and phase [dB, deg]
    """

    loop: str
    gain_db: float
    phase_deg: float
    crossover: float
    disk_gain_db: float
    disk_phase_deg: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """The required margins.

    Attributes
    ----------
    gain_db, phase_deg : margins of the aircraft as modelled, at each loop break
    perturbed_gain_db, perturbed_phase_deg : margins of the perturbed aircraft
    """

    gain_db: float = 6.0
    phase_deg: float = 45.0
    perturbed_gain_db: float = 4.0
    perturbed_phase_deg: float = 30.0


REQUIRED = Requirement()
"""MIL-F-9490D as modelled; a change of effectiveness by a fifth takes up to 1.9 dB, 4 dB remain."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """The margins of one operating point, with the aircraft as modelled or perturbed.

    Attributes
    ----------
    case : name of the perturbation
    airspeed, bank : [m/s, rad]
    between : whether the point lies between points of the design's grid
    stable : whether the closed loop is stable
    margins : margins of every loop
    """

    case: str
    airspeed: float
    bank: float
    between: bool
    stable: bool
    margins: tuple[Margin, ...]

    @property
    def required(self) -> tuple[float, float]:
        """Return the least gain margin [dB] and phase margin [deg]."""
        if self.case == NOMINAL:
            return REQUIRED.gain_db, REQUIRED.phase_deg
        return REQUIRED.perturbed_gain_db, REQUIRED.perturbed_phase_deg

    @property
    def short_loops(self) -> tuple[str, ...]:
        """Return the loops with too little margin; all loops if the closed loop is unstable."""
        gain, phase = self.required
        return tuple(
            m.loop
            for m in self.margins
            if m.loop != ALL_CONTROLS
            and not (self.stable and m.gain_db >= gain and m.phase_deg >= phase)
        )

    @property
    def met(self) -> bool:
        """Whether every margin is as required."""
        return self.stable and not self.short_loops

    @property
    def worst_gain(self) -> Margin:
        """Return the loop with the smallest gain margin."""
        return min(self.margins, key=lambda m: math.inf if math.isnan(m.gain_db) else m.gain_db)

    @property
    def worst_phase(self) -> Margin:
        """Return the loop with the smallest phase margin."""
        return min(self.margins, key=lambda m: math.inf if math.isnan(m.phase_deg) else m.phase_deg)

    @property
    def shortfall(self) -> float:
        """Return the smallest ratio of a margin to the required one [-]; -1 if unstable."""
        if not self.stable:
            return -1.0
        gain, phase = self.required
        return min(self.worst_gain.gain_db / gain, self.worst_phase.phase_deg / phase)

    def describe(self) -> str:
        """Return the smallest margins in words."""
        bank_deg = math.degrees(self.bank)
        where = f"at {self.airspeed:.1f} m/s and {bank_deg:.0f} deg of bank, {self.case}"
        if not self.stable:
            return f"an unstable closed loop {where}"
        gain, phase = self.worst_gain, self.worst_phase
        return (
            f"{gain.gain_db:.1f} dB ({gain.loop}) and {phase.phase_deg:.1f} deg ({phase.loop})"
            f" {where}"
        )


class Loops:
    """The loops of an aircraft and its autopilot at one operating point, over frequency.

    Parameters
    ----------
    aircraft : linear model from ``aircraft.linearise``
    autopilot : linear model from ``innerloop.law.linear_controller``
    delay : delay between measurement and servo [s]
    frequencies : [rad/s]
    """

    def __init__(
        self,
        aircraft: LinearModel,
        autopilot: LinearModel,
        delay: float,
        frequencies: Array = FREQUENCIES,
    ) -> None:
        self._aircraft = aircraft
        self._autopilot = autopilot
        self._delay = delay
        self.frequencies = frequencies
        self.controls = tuple(autopilot.output_labels)
        self.measurements = tuple(name for name in autopilot.input_labels if name not in COMMANDS)
        self._rows = [aircraft.output_labels.index(name) for name in self.measurements]
        self._columns = [aircraft.input_labels.index(name) for name in self.controls]
        self._reads = [autopilot.input_labels.index(name) for name in self.measurements]
        self._plant = self._response_of(aircraft)
        self._law = -_response(autopilot, frequencies)[:, :, self._reads]

    def with_aircraft(self, aircraft: LinearModel) -> "Loops":
        """Return the loops with a changed aircraft; the autopilot's response is reused."""
        loops = self.with_delay(self._delay)
        loops._aircraft = aircraft
        loops._plant = self._response_of(aircraft)
        return loops

    def with_delay(self, delay: float) -> "Loops":
        """Return the loops with another delay [s]; both responses are reused."""
        loops = copy.copy(self)
        vars(loops).pop("_closed", None)
        loops._delay = delay
        return loops

    def _response_of(self, aircraft: LinearModel) -> Complex:
        """Return the response of an aircraft's measurements to its controls."""
        return _response(aircraft, self.frequencies)[:, self._rows][:, :, self._columns]

    @functools.cached_property
    def _closed(self) -> tuple[Complex, Complex]:
        """Sensitivity matrix at the controls, and sensitivity at each measurement."""
        plant = self._plant * np.exp(-1j * self.frequencies * self._delay)[:, None, None]
        sensitivity = np.linalg.inv(np.eye(len(self.controls)) + self._law @ plant)
        # At the measurements S = 1 - P (1 + K P)^-1 K; only its diagonal is needed.
        at_measurements = 1.0 - np.einsum("fik,fki->fi", plant @ sensitivity, self._law)
        return sensitivity, at_measurements

    def opened(self, name: str) -> Complex:
        """Return the loop opened at a control or measurement and closed elsewhere.

        The sign is for negative feedback; shape (frequencies,).
        """
        if name in self.controls:
            i = self.controls.index(name)
            sensitivity = self._closed[0][:, i, i]
        else:
            sensitivity = self._closed[1][:, self.measurements.index(name)]
        return np.asarray(1.0 / sensitivity - 1.0)

    @property
    def breaks(self) -> tuple[str, ...]:
        """Return the loop breaks: each control and each regulated measurement."""
        return (*self.controls, *(name for name in SENSOR_BREAKS if name in self.measurements))

    def margins(self) -> list[Margin]:
        """Return the margins at each of ``breaks``."""
        names = [BREAK_NAMES.get(name, name) for name in self.breaks]
        at_controls, at_measurements = self._closed
        measured = [self.measurements.index(name) for name in self.breaks[len(self.controls) :]]
        sensitivities = np.vstack(
            [np.diagonal(at_controls, axis1=1, axis2=2).T, at_measurements[:, measured].T]
        )
        return loop_margins(names, 1.0 / sensitivities - 1.0, self.frequencies)

    def margin_at_all_controls(self) -> Margin:
        """Return the disk margins for independent changes in all controls at once."""
        disk_gain_db, disk_phase_deg = _disk_margin(1.0 / self._peak_structured_singular_value())
        return Margin(
            loop=ALL_CONTROLS,
            gain_db=math.nan,
            phase_deg=math.nan,
            crossover=math.nan,
            disk_gain_db=disk_gain_db,
            disk_phase_deg=disk_phase_deg,
        )

    def _peak_structured_singular_value(self) -> float:
        """Return the largest structured singular value of the balanced sensitivity [-]."""
        from slycot import ab13md

        n = len(self.controls)
        one, complex_block = np.ones(n, dtype=int), np.full(n, 2)
        balanced = self._closed[0] - 0.5 * np.eye(n)
        # The largest singular value is an upper bound of the structured one for any scaling of the
        # controls. Frequencies with a bound below the largest structured value found so far are
        # skipped. A scaling that gives tight bounds at one frequency does so at most frequencies.
        bounds = np.linalg.norm(balanced, 2, axis=(1, 2))
        largest, peak = 0.0, 0
        coarse = np.arange(0, len(bounds), _MU_STRIDE)
        for number, k in enumerate(coarse[np.argsort(-bounds[coarse])]):
            if bounds[k] * _MU_ACCURACY <= largest:
                continue
            found, units, *_ = ab13md(balanced[k], one, complex_block)
            largest, peak = max((largest, peak), (float(found), int(k)))
            if number == 0:
                scaled = balanced * (units[:, None] / units)
                bounds = np.minimum(bounds, np.linalg.norm(scaled, 2, axis=(1, 2)))
        near_peak = range(max(0, peak - _MU_STRIDE + 1), min(len(bounds), peak + _MU_STRIDE))
        higher = [k for k in near_peak if k != peak and bounds[k] * _MU_ACCURACY > largest]
        values = [float(ab13md(balanced[k], one, complex_block)[0]) for k in higher]
        return max([largest, *values])

    @property
    def stable(self) -> bool:
        """Whether every pole of the closed loop has a negative real part."""
        return bool(np.all(self.poles().real < 0.0))

    def poles(self) -> Complex:
        """Return the poles of the closed loop [1/s], with the Pade approximation of the delay."""
        plant, law = self._aircraft, self._autopilot
        # Law, delays and aircraft are in series, and the aircraft's outputs feed back to the law.
        aircraft = _Matrices(
            plant.A,
            plant.B[:, self._columns],
            plant.C[self._rows],
            plant.D[np.ix_(self._rows, self._columns)],
        )
        delayed = _series(_delays(self._delay, len(self.controls)), aircraft)
        autopilot = _Matrices(law.A, law.B[:, self._reads], law.C, law.D[:, self._reads])
        a, b, c, d = _series(autopilot, delayed)
        return np.asarray(np.linalg.eigvals(a + b @ np.linalg.solve(np.eye(len(d)) - d, c)))


class _Matrices(NamedTuple):
    """A, B, C and D of a linear system."""

    a: Array
    b: Array
    c: Array
    d: Array


@functools.cache
def _delays(delay: float, channels: int) -> _Matrices:
    """Return a system with the same delay [s] in each of ``channels`` channels."""
    one = pade(delay)
    return _Matrices(*(np.kron(np.eye(channels), m) for m in (one.A, one.B, one.C, one.D)))


def _series(first: _Matrices, then: _Matrices) -> _Matrices:
    """Return the series connection of two systems."""
    n = len(first.a)
    size = n + len(then.a)
    a = np.zeros((size, size))
    a[:n, :n] = first.a
    a[n:, :n] = then.b @ first.c
    a[n:, n:] = then.a
    b = np.empty((size, first.b.shape[1]))
    b[:n] = first.b
    b[n:] = then.b @ first.d
    c = np.empty((len(then.c), size))
    c[:, :n] = then.d @ first.c
    c[:, n:] = then.c
    return _Matrices(a, b, c, then.d @ first.d)


def _disk_margin(size: float) -> tuple[float, float]:
    """Return the gain [dB] and phase [deg] margins of a balanced disk of given size [-]."""
    gain_db = 20.0 * math.log10((2.0 + size) / (2.0 - size)) if size < 2.0 else math.inf
    return gain_db, math.degrees(2.0 * math.atan(0.5 * size))


def _response(system: LinearModel, frequencies: Array) -> Complex:
    """Return C (jw - A)^-1 B + D over frequency, shape (frequencies, outputs, inputs).

    If the eigenvectors of A are well conditioned, A is diagonalised first.
    """
    values, vectors = np.linalg.eig(system.A)
    if np.linalg.cond(vectors) < _WELL_CONDITIONED:
        left = system.C @ vectors
        right = np.linalg.solve(vectors, system.B.astype(np.complex128))
        gains = 1.0 / (1j * frequencies[:, None] - values)
        return np.asarray((left * gains[:, None, :]) @ right + system.D)
    resolvent = 1j * frequencies[:, None, None] * np.eye(len(values)) - system.A
    forcing = np.broadcast_to(system.B.astype(np.complex128), (len(frequencies), *system.B.shape))
    return np.asarray(system.C @ np.linalg.solve(resolvent, forcing) + system.D)


def loop_margins(names: Sequence[str], loops: Complex, frequencies: Array) -> list[Margin]:
    """Return the margins of single loops; crossings are interpolated between frequencies.

    Parameters
    ----------
    names : names of the loops
    loops : negative feedback, shape (loops, frequencies)
    frequencies : [rad/s]
    """
    logs = np.log(np.abs(loops))
    phases = np.unwrap(np.angle(loops), axis=1)
    disks = np.min(2.0 * np.abs(1.0 + loops) / np.abs(1.0 - loops), axis=1)
    gains = _gains_at_half_turns(logs, phases)
    crossovers = _crossovers(logs, phases, frequencies)
    return [
        _loop_margin(*of_loop)
        for of_loop in zip(names, gains, crossovers, disks.tolist(), strict=True)
    ]


def _loop_margin(
    name: str, gains: list[float], crossovers: list[tuple[float, float]], disk_size: float
) -> Margin:
    """Return the margins of a loop from its log gains at phase crossings and its crossovers."""
    from_half_turn = [
        abs(math.remainder(phase - math.pi, 2.0 * math.pi)) for _, phase in crossovers
    ]
    disk_gain_db, disk_phase_deg = _disk_margin(disk_size)
    return Margin(
        loop=name,
        gain_db=min((abs(20.0 * gain / math.log(10.0)) for gain in gains), default=math.inf),
        phase_deg=math.degrees(min(from_half_turn, default=math.inf)),
        crossover=max((frequency for frequency, _ in crossovers), default=math.nan),
        disk_gain_db=disk_gain_db,
        disk_phase_deg=disk_phase_deg,
    )


def _gains_at_half_turns(logs: Array, phases: Array) -> list[list[float]]:
    """Return each loop's log gains where its phase crosses an odd multiple of pi."""
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
    """Return y at x = 0 on the line through two points."""
    if x1 < x0:
        x0, y0, x1, y1 = x1, y1, x0, y0
    if x0 >= 0.0:
        return y0
    if x1 <= 0.0:
        return y1
    return (y1 - y0) / (x1 - x0) * -x0 + y0


def _crossovers(logs: Array, phases: Array, frequencies: Array) -> list[list[tuple[float, float]]]:
    """Return each loop's gain crossovers: frequencies [rad/s] and phases [rad]."""
    signs = np.sign(logs)
    loops, i = np.nonzero(signs[:, :-1] != signs[:, 1:])
    shares = logs[loops, i] / (logs[loops, i] - logs[loops, i + 1])
    at = phases[loops, i] + shares * (phases[loops, i + 1] - phases[loops, i])
    # Python's powers are used, because NumPy's can differ in the last bit.
    ratios = (frequencies[i + 1] / frequencies[i]).tolist()
    found: list[list[tuple[float, float]]] = [[] for _ in logs]
    for loop, frequency, ratio, share, phase in zip(
        loops.tolist(), frequencies[i].tolist(), ratios, shares.tolist(), at.tolist(), strict=True
    ):
        found[loop].append((frequency * ratio**share, phase))
    return found


@functools.cache
def pade(delay: float) -> "control.StateSpace":
    """Return the second-order Pade approximation of a delay [s]."""
    import control

    return control.ss(control.tf(*control.pade(delay, 2)))


def closed_loop(
    aircraft: LinearModel, autopilot: LinearModel, delay: float
) -> "control.StateSpace":
    """Return the closed loop of aircraft and autopilot.

    Inputs are ``COMMANDS``, then the aircraft's other inputs, such as gusts. Outputs are the
    aircraft's outputs, then ``CONTROL_command`` of each control. ``delay`` is the delay between
    measurement and servo [s].
    """
    import control

    def block(model: LinearModel, name: str) -> control.StateSpace:
        return control.ss(
            model.A,
            model.B,
            model.C,
            model.D,
            inputs=model.input_labels,
            outputs=model.output_labels,
            name=name,
        )

    controls = autopilot.output_labels
    others = [name for name in aircraft.input_labels if name not in controls]
    one = pade(delay)
    delays = [
        control.ss(one, inputs=[f"{name}_delayed_in"], outputs=[name], name=f"{name}_delay")
        for name in controls
    ]
    connections: list[list[object]] = [
        [f"autopilot.{name}", f"aircraft.{name}"]
        for name in autopilot.input_labels
        if name not in COMMANDS
    ]
    for delayed, name in zip(delays, controls, strict=True):
        connections += [
            [f"aircraft.{name}", f"{delayed.name}.{name}"],
            [f"{delayed.name}.{name}_delayed_in", f"autopilot.{name}"],
        ]
    return control.interconnect(
        [block(aircraft, "aircraft"), block(autopilot, "autopilot"), *delays],
        connections=connections,
        inplist=[
            *(f"autopilot.{name}" for name in COMMANDS),
            *(f"aircraft.{name}" for name in others),
        ],
        outlist=[
            *(f"aircraft.{name}" for name in aircraft.output_labels),
            *(f"autopilot.{name}" for name in controls),
        ],
        inputs=[*COMMANDS, *others],
        outputs=[*aircraft.output_labels, *(f"{name}_command" for name in controls)],
        warn_duplicate=False,
        check_unused=False,
    )
