"""The CO2 of the air beside the exhaust: how it varies along a flight, where it does."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from scenarios.scenario.sections.world import AirConfig

Array = npt.NDArray[np.float64]

_STEP = 0.05
"""Between the times at which the background is computed, linear between them [s]: a tenth of the
quickest sensor's response.
"""


@dataclass(frozen=True, slots=True)
class Background:
    """CO2 above that of clean air, without the exhaust.

    Attributes
    ----------
    time : from the start of the flight on, shape (n,) [s]
    co2 : at these times, shape (n,) [ppm]
    """

    time: Array
    co2: Array

    def at(self, time: Array) -> Array:
        """Return it at some times of the flight, shape (m,) [ppm]."""
        return np.interp(time, self.time, self.co2)


UNIFORM = Background(np.zeros(1), np.zeros(1))
"""The background of clean air, which does not vary."""


def sampled_background(
    config: AirConfig, duration: float, generator: np.random.Generator
) -> Background:
    """Return one realisation of the background of a flight.

    Parameters
    ----------
    config : the ``[air]`` section
    duration : to be covered [s]
    generator : of the background alone, so that all else of the flight is as it is without
    """
    if config.background == "none":
        return UNIFORM
    time = np.arange(0.0, duration + _STEP, _STEP)
    shape = _SHAPES[config.background](time, config.background_s, generator)
    return Background(time, config.background_ppm * shape)


def _haze(time: Array, correlation: float, generator: np.random.Generator) -> Array:
    """Return an Ornstein-Uhlenbeck process of standard deviation 1, shape (n,) [-].

    It forgets a share 1 - a of itself in a step, with a = exp(-step/correlation), and noise of
    variance 1 - a^2 takes its place, exactly (Gillespie, Phys. Rev. E 54:2084, 1996).
    """
    from scipy.signal import lfilter

    kept = math.exp(-_STEP / correlation)
    white = generator.standard_normal(len(time))
    white[1:] *= math.sqrt(1.0 - kept**2)
    return np.asarray(lfilter([1.0], [1.0, -kept], white))


def _sine(time: Array, period: float, generator: np.random.Generator) -> Array:
    """Return a sine of amplitude 1 and of any phase, shape (n,) [-]."""
    return np.sin(2.0 * math.pi * (time / period + generator.uniform()))


def _steps(time: Array, interval: float, generator: np.random.Generator) -> Array:
    """Return a level that jumps at random times, by a standard deviation of 1, shape (n,) [-]."""
    count = generator.poisson(time[-1] / interval)
    jumps = np.zeros(len(time))
    at = generator.integers(1, len(time), size=count)
    np.add.at(jumps, at, generator.standard_normal(count))
    return np.cumsum(jumps)


_SHAPES: Mapping[str, Callable[[Array, float, np.random.Generator], Array]] = {
    "haze": _haze,
    "sine": _sine,
    "steps": _steps,
}
"""How each kind of background varies, over its size."""
