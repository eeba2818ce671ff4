"""How much nearer the noise of satellite navigation takes a vehicle to a vessel that is known
exactly, as its guidance sees it.

Where the vehicle takes itself to be wanders with the noise. It follows its reference there, late:
what it has not yet made up for stands, for guidance and keep-out guard alike, between it and its
reference. In axes along and across the reference's course, which turn at omega_r, the true error e
and the error of the position n obey e_along' = -dV + omega_r e_right, e_right' = -V dchi - omega_r
e_along and n' = -n/T + omega_r (n_right, -n_along) + noise of the density 2 sigma^2/T; the steering
law and the airspeed act on e - n. Its covariance solves a Lyapunov equation.

Noise of the velocity, new at each step, turns and stretches the predicted turn away: up to where it
comes nearest, a quarter of a turn from where it begins.
"""

import math
from collections.abc import Iterable

import numpy as np
import numpy.typing as npt
from scipy.linalg import solve_continuous_lyapunov

from common.physics import SECONDS_PER_HOUR
from gnc.airspeed import SpeedHold
from gnc.estimation.error_budget import deviations
from gnc.tracker import TrackingParameters
from scenarios.planning.margin.report_scatter import GUARDED_PER_HOUR
from scenarios.planning.margin.steering_gains import STEERED_BY, steering_gains

_ALONG, _RIGHT, _COURSE, _TURN, _FASTER, _NOISE_ALONG, _NOISE_RIGHT = range(7)
"""Rows of the linear loop: true error [m], course [rad], heading rate [rad/s], speed [m/s], error
of the position [m].
"""

Array = npt.NDArray[np.float64]


def noise_allowance(seen: float, turned: float, *, time_step: float) -> float:
    """Return what both errors together exceed no oftener than ``GUARDED_PER_HOUR``, as if they were
    new at each step [m].

    Parameters
    ----------
    seen, turned : standard deviations of the error that is seen, and of the place where a turn away
        comes nearest [m]
    time_step : of the guidance [s]
    """
    looks = SECONDS_PER_HOUR / time_step
    return math.hypot(seen, turned) * deviations(GUARDED_PER_HOUR, draws=looks)


def position_scatter(
    tracking: TrackingParameters,
    hold: SpeedHold,
    turns: Iterable[float],
    *,
    speed: float,
    lag: float,
    airspeed_bandwidth: float,
    noise_time: float,
) -> float:
    """Return the standard deviation of the error that is seen, per that of the noise, in the worst
    direction and turn [-].

    Parameters
    ----------
    tracking, hold : how the reference is tracked
    turns : heading rates of the reference [rad/s]
    speed : V_r [m/s]
    lag : of the heading rate behind its command [s]
    airspeed_bandwidth : of the airspeed behind its command [rad/s]
    noise_time : time constant T of the noise [s]
    """
    loops = [
        _loop(tracking, hold, turn, speed, lag, airspeed_bandwidth, noise_time) for turn in turns
    ]
    return max(map(_seen, loops))


def _loop(
    tracking: TrackingParameters,
    hold: SpeedHold,
    turn: float,
    speed: float,
    lag: float,
    bandwidth: float,
    noise_time: float,
) -> Array:
    gains = dict(zip(STEERED_BY, steering_gains(tracking, turn, speed).tolist(), strict=True))
    # A command that depends on the last one has gone where it leads to.
    along, right, course, faster, rate = (
        gains[name] / (1.0 - gains["last"])
        for name in ("along", "right", "course", "speed", "heading_rate")
    )
    faster += gains["airspeed"] / (1.0 - gains["last"])
    loop = np.zeros((7, 7))
    loop[_ALONG, [_RIGHT, _FASTER]] = turn, -1.0
    loop[_RIGHT, [_ALONG, _COURSE]] = -turn, -speed
    loop[_COURSE, _TURN] = 1.0
    loop[_TURN] = np.array([along, right, course, rate - 1.0, faster, -along, -right]) / lag
    loop[_FASTER, [_ALONG, _NOISE_ALONG, _FASTER]] = (
        bandwidth * hold.gain,
        -bandwidth * hold.gain,
        -bandwidth,
    )
    loop[_NOISE_ALONG, [_NOISE_ALONG, _NOISE_RIGHT]] = -1.0 / noise_time, turn
    loop[_NOISE_RIGHT, [_NOISE_ALONG, _NOISE_RIGHT]] = -turn, -1.0 / noise_time
    return loop


def _seen(loop: Array) -> float:
    """Return the deviation of the error seen; 1 where the law does not track, and the vehicle is
    where its noise is not.
    """
    if np.linalg.eigvals(loop).real.max() >= 0.0:
        return 1.0
    kicks = np.zeros((7, 7))
    kicks[_NOISE_ALONG, _NOISE_ALONG] = kicks[_NOISE_RIGHT, _NOISE_RIGHT] = (
        -2.0 * loop[_NOISE_ALONG, _NOISE_ALONG]
    )
    covariance = solve_continuous_lyapunov(loop, -kicks)
    seen = np.zeros((2, 7))
    seen[[0, 1], [_ALONG, _RIGHT]], seen[[0, 1], [_NOISE_ALONG, _NOISE_RIGHT]] = 1.0, -1.0
    return math.sqrt(np.linalg.eigvalsh(seen @ covariance @ seen.T).max())
