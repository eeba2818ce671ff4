"""The spread of the tracking error that turbulence causes, from the linear closed loop and the
spectrum of the turbulence.

It is an upper bound for the linear loop: the orbit is near the keep-out area only at its closest
point, but the bound assumes that point, the largest bank and the worst direction of the error all
the time.

The guidance, linear about a turn, is closed around the linear aircraft frequency by frequency, with
the hold of the commands and the step by which the last one is late. In axes along and across the
reference's course, which turn at omega_r, the error e from aircraft to reference obeys
e_along' = -dV + omega_r e_right and e_right' = -V dchi - omega_r e_along.

The course swings through air whose gusts do not swing with it. A gust along a fixed direction is
one along the path times the cosine of the course between them. With exp(i course) as a Fourier
series of coefficients c_n over the orbit, the mean over the phases of cos(course now - course tau
ago) is the sum of |c_n|^2 cos(n omega_0 tau): slow gusts come back as sidebands of the orbit's
frequency, with these weights. For the sinusoid eta cos(omega_0 t + phase) they are J_n(eta)^2, and
the mean is J_0(2 eta sin(omega_0 tau/2)) by Graf's addition theorem.
"""

import functools
import math
from collections.abc import Sequence

import control
import numpy as np
import numpy.typing as npt

from aircraft.weather import GustStatistics
from gnc.airspeed import SpeedHold
from gnc.reference.reference import Orbit
from gnc.tracker import TrackingParameters
from innerloop.gusts import GUSTS, dryden_filters, gust_loop
from innerloop.law import COMMANDS
from innerloop.schedule import Schedule
from scenarios.planning.margin.keepout_margin import STEERED_BY, Spread, steering_gains

FREQUENCIES = np.logspace(-2.5, 1.9, 400)
"""Frequencies over which spectra are integrated [rad/s]: from far below the corner of a gust, V/L =
0.09, to beyond the hold of the commands.
"""

_ORBIT_POINTS = 60

Array = npt.NDArray[np.float64]

Complex = npt.NDArray[np.complex128]


def tracking_spreads(
    schedule: Schedule,
    turbulence: GustStatistics,
    oscillations: Sequence[Orbit],
    guidance: TrackingParameters,
    hold: SpeedHold,
    *,
    span: float,
) -> tuple[Spread, ...]:
    """Return the spreads that the linear closed loop predicts at the design airspeed nearest to the
    references' speed.

    Parameters
    ----------
    schedule : the autopilot
    turbulence, span : the air, and the wing that averages its rotation [m]
    oscillations, guidance, hold : references of one speed, and how they are tracked
    """
    (speed,) = {oscillation.speed for oscillation in oscillations}
    index = int(np.argmin(np.abs(np.array(schedule.airspeeds) - speed)))
    banks = range(len(schedule.gain_banks))
    responses = [
        tracking_response(schedule, index, j, guidance, hold, speed, FREQUENCIES) for j in banks
    ]
    steps = [schedule.gain_trim(index, j).yaw_rate for j in banks]
    room = min(speed - hold.airspeed_min, hold.airspeed_max - speed)
    gusts = [
        gusts_on_orbit(turbulence, oscillation, FREQUENCIES, airspeed=speed, span=span)
        for oscillation in oscillations
    ]
    return tuple(
        _spread(oscillation, met, responses, steps, RESPONSES.index("pace"), room)
        for oscillation, met in zip(oscillations, gusts, strict=True)
    )


def _spread(
    oscillation: Orbit,
    gusts: Array,
    responses: list[Complex],
    steps: list[float],
    airspeed: int,
    room: float,
) -> Spread:
    """Return the spread on an orbit.

    Parameters
    ----------
    oscillation, gusts : the orbit, and the spectral densities of the gusts on it
    responses, steps : responses to gusts, and their heading rates [rad/s]
    airspeed : row of the responses that keeps pace
    room : largest change of the airspeed [m/s]
    """
    densities = [np.einsum("fig,fg,fjg->fij", r, gusts, r.conj()).real for r in responses]
    now = [_integral(density) for density in densities]
    rates = [_integral(density * FREQUENCIES[:, None, None] ** 2) for density in densities]

    phases = 2.0 * math.pi * (np.arange(_ORBIT_POINTS) + 0.5) / _ORBIT_POINTS
    turns = np.array([-oscillation.heading_rate(phase) for phase in phases.tolist()])
    mean, mean_rate = (
        _over_turns(turns, steps, matrices).mean(axis=0) for matrices in (now, rates)
    )
    steep = np.array([-oscillation.amplitude, oscillation.amplitude])
    largest, fastest = (
        np.linalg.eigvalsh(_over_turns(steep, steps, m)[:, :2, :2]).max() for m in (now, rates)
    )
    return Spread(
        along=math.sqrt(mean[0, 0]),
        across=math.sqrt(mean[1, 1]),
        radial=math.sqrt(largest),
        radial_rate=math.sqrt(fastest),
        airspeed=math.sqrt(mean[airspeed, airspeed]),
        airspeed_rate=math.sqrt(mean_rate[airspeed, airspeed]),
        airspeed_limit=room,
    )


def _integral(density: Array) -> Array:
    """Return the variance of a density over ``FREQUENCIES``."""
    return np.asarray(np.trapezoid(density, FREQUENCIES, axis=0) / math.pi)


def _over_turns(turns: Array, at: list[float], matrices: list[Array]) -> Array:
    """Interpolate matrices, given at ascending heading rates [rad/s], at others, shape (turns, 3,
    3); beyond, the last ones.
    """
    stacked = np.stack(matrices)
    columns = [np.interp(turns, at, stacked[:, i, j]) for i in range(3) for j in range(3)]
    return np.column_stack(columns).reshape(-1, 3, 3)


_SIDEBANDS = np.arange(-12, 13)
"""J_13(2.4)^2 is below 1e-15, and eta is no more than 2.405; a course whose roll rate jumps leaves
below 1e-6 beyond.
"""

_TURNED = (("gust_along", "gust_right"), ("gust_p", "gust_q"))
"""Components that the course turns into each other."""


def gusts_on_orbit(
    turbulence: GustStatistics,
    oscillation: Orbit,
    frequencies: Array,
    *,
    airspeed: float,
    span: float,
) -> Array:
    """Return the power spectral densities of ``GUSTS`` in the axes of the path, shape (frequencies,
    6), averaged over the orbit.

    The variance is the integral over positive frequencies, divided by pi. Components are assumed to
    be independent: those that the course turns into each other are independent in the mean over the
    orbit, up to the difference between their spectra.

    Parameters
    ----------
    turbulence, airspeed, span : same as ``innerloop.gusts.dryden_filters``, in axes that do
        not turn
    oscillation : of the reference's course
    frequencies : [rad/s], above 0
    """
    weights = tuple(oscillation.sidebands(_SIDEBANDS).tolist())
    return _on_orbit(
        turbulence, airspeed, span, oscillation.omega_0, weights, tuple(frequencies.tolist())
    )


@functools.lru_cache(maxsize=64)
def _on_orbit(
    turbulence: GustStatistics,
    airspeed: float,
    span: float,
    omega_0: float,
    weights: tuple[float, ...],
    at: tuple[float, ...],
) -> Array:
    """Return the result of ``gusts_on_orbit``, cached: trials in the same turbulence have the same
    one.
    """
    filters, frequencies = _filters(turbulence, airspeed=airspeed, span=span), np.array(at)
    spectra = _spectra(filters, frequencies)
    shifted = [_spectra(filters, np.abs(frequencies - n * omega_0)) for n in _SIDEBANDS]
    for pair in _TURNED:
        columns = [GUSTS.index(name) for name in pair]
        mean = sum(
            weight * s[:, columns].mean(axis=1) for weight, s in zip(weights, shifted, strict=True)
        )
        spectra[:, columns] = np.asarray(mean)[:, None]
    spectra.flags.writeable = False
    return spectra


_filters = functools.lru_cache(maxsize=8)(dryden_filters)


def _spectra(filters: control.StateSpace, frequencies: Array) -> Array:
    response = np.moveaxis(filters(1j * frequencies, squeeze=False), -1, 0)
    return np.asarray(np.sum(np.abs(response) ** 2, axis=2))


RESPONSES = ("along", "right", "pace")
"""Rows of ``tracking_response``: the error [m], and the part of the commanded airspeed that the
aircraft follows to keep pace [m/s]."""

_READ = ("course_rate", "speed", "airspeed", "heading_rate")


def tracking_response(
    schedule: Schedule,
    index: int,
    bank_index: int,
    guidance: TrackingParameters,
    hold: SpeedHold,
    speed: float,
    frequencies: Array,
) -> Complex:
    """Return the response of ``RESPONSES`` to ``GUSTS`` over frequency, shape (frequencies, 3, 6).

    Parameters
    ----------
    schedule, index, bank_index : the autopilot and its design point, as in ``gust_loop``
    guidance : its steering law, with commands corrected by ``air_turn``
    hold : speed hold by which it keeps pace
    speed : V_r [m/s]
    frequencies : [rad/s], above 0
    """
    loop = gust_loop(schedule, index, bank_index)
    labels = list(loop.output_labels)
    whole = np.moveaxis(loop(1j * frequencies, squeeze=False), -1, 0)[
        :, [labels.index(name) for name in _READ]
    ]
    gusts = whole[:, :, len(COMMANDS) :]
    commands = whole[
        :, :, [COMMANDS.index("airspeed_command"), COMMANDS.index("heading_rate_command")]
    ]
    turn = schedule.gain_trim(index, bank_index).yaw_rate
    steering = dict(zip(STEERED_BY, steering_gains(guidance, turn, speed), strict=True))
    s = 1j * frequencies
    hold_of_step = np.exp(-0.5 * s * guidance.time_step) * np.sinc(
        0.5 * frequencies * guidance.time_step / np.pi
    )

    # Four equations for the error along and right and for the commanded airspeed and turn: left @
    # unknowns = right @ gusts.
    held, per_course = hold_of_step[:, None], (speed / s)[:, None]
    left = np.zeros((len(s), 4, 4), dtype=complex)
    right = np.zeros((len(s), 4, len(GUSTS)), dtype=complex)
    left[:, 0, 0], left[:, 0, 1] = s, -turn
    left[:, 0, 2:], right[:, 0] = commands[:, 1], -gusts[:, 1]
    left[:, 1, 0], left[:, 1, 1] = turn, s
    left[:, 1, 2:], right[:, 1] = per_course * commands[:, 0], -per_course * gusts[:, 0]
    left[:, 2, 0] = -hold_of_step * hold.gain
    left[:, 2, 2:], right[:, 2] = (
        -held * (commands[:, 2] - commands[:, 1]),
        held * (gusts[:, 2] - gusts[:, 1]),
    )
    left[:, 2, 2] += 1.0
    read = np.column_stack(
        [steering["course"] / s, *(np.full(len(s), steering[name]) for name in _READ[1:])]
    )
    left[:, 3, 0], left[:, 3, 1] = (
        -hold_of_step * steering["along"],
        -hold_of_step * steering["right"],
    )
    left[:, 3, 2:] = -held * np.einsum("fi,fij->fj", read, commands)
    left[:, 3, 3] += 1.0 - steering["last"] * np.exp(-s * guidance.time_step)
    right[:, 3] = held * np.einsum("fi,fij->fj", read, gusts)
    found = np.linalg.solve(left, right)
    return np.concatenate([found[:, :2], commands[:, 1, :1, None] * found[:, 2:3]], axis=1)
