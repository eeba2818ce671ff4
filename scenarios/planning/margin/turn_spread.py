"""Deviation of an aircraft from a commanded turn away by turbulence.

In the turn the guidance keeps the speed over the mean air, and commands the heading rate that turns
the motion over the mean air at omega_max (``gnc.airspeed``). Both loops are closed around the
linear aircraft, frequency by frequency. Gusts cause a deviation dV of the speed and a deviation dr
of the course's rate. From a start at which position, course and speed are measured, and in the
complex plane of north and east, they displace the vehicle by

    z(t) = integral over s from 0 to t of  exp(i omega s) (dV(s) + i V (X(s) - X(0))),    X' = dr.

A gust along a fixed direction comes round in the axes of the path: a spectrum S of both horizontal
components becomes (S(|w - omega|) + S(w + omega))/2 there.
"""

import math

import numpy as np
import numpy.typing as npt

from aircraft.weather import GustStatistics
from gnc.estimation.error_budget import TurnDeviation
from innerloop.gusts import GUSTS, dryden_filters, gust_loop
from innerloop.law import COMMANDS
from innerloop.schedule import Schedule
from scenarios.planning.margin.tracking_spread import FREQUENCIES

_TIMES = 24
"""Number of intervals at which the deviation is computed [-]."""

_HALF_TURNS = 1.5
"""Number of half turns up to which it is computed [-]: the longest turn away."""

_TURNED = (("gust_along", "gust_right"), ("gust_p", "gust_q"))
"""Components that the course turns into each other."""

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]


def turn_deviation(
    schedule: Schedule,
    turbulence: GustStatistics,
    *,
    speed: float,
    heading_rate: float,
    time_step: float,
    span: float,
    key: str = "",
) -> TurnDeviation:
    """Return the deviation of a turn in turbulence from the turn that is commanded.

    Parameters
    ----------
    schedule : the autopilot; its design airspeed nearest to ``speed`` counts, and its gain bank
        nearest to the turn
    turbulence, span : the air, and the wing that averages its rotation [m]
    speed, heading_rate : V_r, and omega_max [m/s, rad/s]
    time_step : of the guidance [s]
    key : of the scenario that declares the turbulence
    """
    index = int(np.argmin(np.abs(np.array(schedule.airspeeds) - speed)))
    turns = [schedule.gain_trim(index, j).yaw_rate for j in range(len(schedule.gain_banks))]
    bank_index = int(np.argmin(np.abs(np.array(turns) - heading_rate)))
    by_speed, by_rate = _responses(
        schedule, index, bank_index, speed=speed, heading_rate=heading_rate, time_step=time_step
    )
    density = _gusts_in_turn(turbulence, speed, span, heading_rate)
    interval = _HALF_TURNS * math.pi / heading_rate / _TIMES
    sigmas = [
        displacement_sigma(interval * i, by_speed, by_rate, density, speed, heading_rate)
        for i in range(_TIMES + 1)
    ]
    # A deviation that the loop corrects later may still be there at the next turn: here it never
    # decreases.
    grown = np.maximum.accumulate(sigmas).tolist()
    return TurnDeviation(interval=interval, sigmas=tuple(grown), key=key)


def _responses(
    schedule: Schedule,
    index: int,
    bank_index: int,
    *,
    speed: float,
    heading_rate: float,
    time_step: float,
) -> tuple[Complex, Complex]:
    """Return the response of speed and course rate to ``GUSTS``, each of shape (frequencies, 6)."""
    s = 1j * FREQUENCIES
    loop = gust_loop(schedule, index, bank_index)
    whole = np.moveaxis(loop(s, squeeze=False), -1, 0)
    labels = list(loop.output_labels)
    columns = [COMMANDS.index("airspeed_command"), COMMANDS.index("heading_rate_command")]
    gusts = {name: whole[:, labels.index(name), len(COMMANDS) :] for name in _READ}
    commands = {name: whole[:, labels.index(name)][:, columns] for name in _READ}
    held = np.exp(-0.5 * s * time_step) * np.sinc(0.5 * FREQUENCIES * time_step / np.pi)
    # The commands are the airspeed less the speed over the mean air, and omega V/V_a: both follow
    # from the same difference.
    difference = commands["airspeed"] - commands["speed"]
    per_difference = np.array([1.0, -heading_rate / speed])
    # c = held per_difference (difference c + gusts' difference)
    met = gusts["airspeed"] - gusts["speed"]
    gain = held / (1.0 - held * (difference @ per_difference))
    commanded = gain[:, None, None] * per_difference[None, :, None] * met[:, None, :]
    by_speed, by_rate = (
        np.einsum("fc,fcg->fg", commands[name], commanded) + gusts[name]
        for name in ("speed", "course_rate")
    )
    return by_speed, by_rate


_READ = ("speed", "airspeed", "course_rate")


def _gusts_in_turn(
    turbulence: GustStatistics, airspeed: float, span: float, heading_rate: float
) -> Array:
    """Return the densities of ``GUSTS`` in the axes of a path that turns, shape (frequencies,
    6).
    """
    filters = dryden_filters(turbulence, airspeed=airspeed, span=span)

    def density(frequencies: Array) -> Array:
        response = np.moveaxis(filters(1j * frequencies, squeeze=False), -1, 0)
        return np.asarray(np.sum(np.abs(response) ** 2, axis=2))

    found = density(FREQUENCIES)
    below = density(np.abs(FREQUENCIES - heading_rate))
    above = density(FREQUENCIES + heading_rate)
    for pair in _TURNED:
        columns = [GUSTS.index(name) for name in pair]
        turned = 0.5 * (below[:, columns] + above[:, columns])
        found[:, columns] = turned.mean(axis=1)[:, None]
    return found


def displacement_sigma(
    time: float,
    by_speed: Complex,
    by_rate: Complex,
    density: Array,
    speed: float,
    heading_rate: float,
) -> float:
    """Return the standard deviation of z in its worst direction after a time [m].

    Parameters
    ----------
    time : since the start [s]
    by_speed, by_rate : response of speed and course rate to gusts at ``FREQUENCIES``, shape
        (frequencies, gusts)
    density : of the gusts, of the same shape; their variance is its integral over pi
    speed, heading_rate : of the turn [m/s, rad/s]
    """
    if time == 0.0:
        return 0.0
    w = FREQUENCIES[:, None]
    once = _integral_of_turn(np.array([heading_rate]), time)
    ahead = _integral_of_turn(heading_rate + w, time)
    behind = _integral_of_turn(heading_rate - w, time)
    course = by_rate / (1j * w)
    z_ahead = by_speed * ahead + 1j * speed * course * (ahead - once)
    z_behind = by_speed.conj() * behind + 1j * speed * course.conj() * (behind - once)
    # A complex process with E|z|^2 and E z^2 has the variance (E|z|^2 + |E z^2|)/2 in its worst
    # direction.
    square = 0.5 * (np.abs(z_ahead) ** 2 + np.abs(z_behind) ** 2) * density
    pseudo = z_ahead * z_behind * density
    mean_square = float(np.trapezoid(square.sum(axis=1), FREQUENCIES)) / math.pi
    mean_pseudo = complex(np.trapezoid(pseudo.sum(axis=1), FREQUENCIES)) / math.pi
    return math.sqrt(0.5 * (mean_square + abs(mean_pseudo)))


def _integral_of_turn(rate: Array, time: float) -> Complex:
    """Return the integral of exp(i rate s) over s from 0 to ``time``."""
    half = 0.5 * rate * time
    return np.asarray(time * np.sinc(half / np.pi) * np.exp(1j * half))
