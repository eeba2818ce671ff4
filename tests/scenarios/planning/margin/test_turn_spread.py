"""How far turbulence takes a turn off its commands: against simulated turns."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from scenarios.planning.margin.tracking_spread import FREQUENCIES
from scenarios.planning.margin.turn_spread import displacement_sigma

SPEED, TURN = 19.42, 0.5
SIGMA, CORRELATED = 0.02, 2.0
"""Of a deviation of the course rate [rad/s, s]."""

STEP = 0.02


def spectrum(sigma):
    """Return the density of a process of exponential correlation, shape (frequencies, 1)."""
    return (2.0 * sigma**2 * CORRELATED / (1.0 + (FREQUENCIES * CORRELATED) ** 2))[:, None]


def simulated(sigma, count, steps, seed):
    """Return such processes at steps of 0.02 s, shape (count, steps)."""
    kept = math.exp(-STEP / CORRELATED)
    kicks = np.random.default_rng(seed).standard_normal((count, steps))
    kicks[:, 1:] *= math.sqrt(1.0 - kept**2)
    return sigma * lfilter([1.0], [1.0, -kept], kicks, axis=1)


@pytest.mark.parametrize("time", [1.0, 4.0, 9.0])
@pytest.mark.parametrize(("by_speed", "by_rate"), [(0.0, 1.0), (20.0, 0.0), (20.0, 1.0)])
def test_the_deviation_is_that_of_simulated_turns(time, by_speed, by_rate):
    steps = round(time / STEP)
    gusts = simulated(SIGMA, 3000, steps, seed=20261128)
    course = STEP * np.cumsum(by_rate * gusts, axis=1)
    turned = TURN * STEP * (np.arange(steps) + 0.5)
    velocity = (SPEED + by_speed * gusts) * np.exp(1j * (turned + course))
    off = STEP * (velocity - SPEED * np.exp(1j * turned)).sum(axis=1)
    covariance = np.cov(off.real, off.imag)
    worst = math.sqrt(np.linalg.eigvalsh(covariance).max())
    response = np.ones((len(FREQUENCIES), 1), dtype=complex)
    found = displacement_sigma(
        time, by_speed * response, by_rate * response, spectrum(SIGMA), SPEED, TURN
    )
    # 3,000 deviations are known to 1.3 %; waves slower than 0.003 rad/s are left out.
    assert found == pytest.approx(worst, rel=0.05)
