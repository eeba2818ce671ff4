"""The random numbers of a flight: streams from one seed or from a blend of several.

A blend is a weighted sum of the normal numbers of its parts. With squares of the weights that add
up to 1 they are standard normal again, and uniform numbers are their distribution function. So a
flight's noise can be changed by small steps, as Markov chains do that look for rare events
(``scenarios.statistics.subset_simulation``): with another part of small weight reports, sensor
errors and gusts hardly change. Models that need whole numbers, such as JSBSim's turbulence, follow
from the seed alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_STREAMS = 3

PAYLOAD, EXHAUST, BACKGROUND, TRAFFIC, HEADING, OTHER_EXHAUST = 1, 2, 3, 4, 5, 6
"""Numbers of streams other than those of ``Streams``: a model that uses them does not change
flights without it.
"""


@dataclass(frozen=True, slots=True)
class Noise:
    """The noise of a flight.

    Attributes
    ----------
    seed : of everything; with a blend, of the models that cannot be blended
    blend : seed and weight of each part; empty for noise from one seed
    """

    seed: int
    blend: tuple[tuple[int, float], ...] = ()

    @classmethod
    def at(cls, coordinates: Sequence[float]) -> "Noise":
        """Return noise from numbers in a row: the seed, then seed and weight of each part of the
        blend.
        """
        seed, *parts = coordinates
        return cls(
            int(seed),
            tuple(
                (int(part), weight) for part, weight in zip(parts[::2], parts[1::2], strict=True)
            ),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Streams:
    """Random numbers of a flight that follows a vessel.

    Attributes
    ----------
    world : of start, fault, gusts and turbulence
    reports : of the vessel's reports
    sensors : of the sensors' errors
    """

    world: np.random.Generator
    reports: np.random.Generator
    sensors: np.random.Generator


def streams(noise: Noise) -> Streams:
    """Return the streams of a flight, each from its first number.

    From one seed, the sensors' numbers follow those of the reports. In a blend both have separate
    streams: one more report must not change all later numbers.
    """
    if not noise.blend:
        world, others = (
            np.random.default_rng(s) for s in np.random.SeedSequence(noise.seed).spawn(2)
        )
        return Streams(world=world, reports=others, sensors=others)
    spawned = [
        np.random.SeedSequence(seed).spawn(_STREAMS)
        for seed in (noise.seed, *(seed for seed, _ in noise.blend))
    ]
    weights = [weight for _, weight in noise.blend]
    world, reports, sensors = (
        BlendedGenerator(base, parts, weights) for base, *parts in zip(*spawned, strict=True)
    )
    return Streams(world=world, reports=reports, sensors=sensors)


def start_generator(noise: Noise) -> np.random.Generator:
    """Return the random numbers of a flight that has a random start and no other noise."""
    return streams(noise).world if noise.blend else np.random.default_rng(noise.seed)


def own_generator(noise: Noise, stream: int) -> np.random.Generator:
    """Return the random numbers of a stream: one of the numbers above."""
    return np.random.default_rng([noise.seed, stream])


class BlendedGenerator(np.random.Generator):
    """Random numbers of a blend, as far as they are uniform or normal; all others are those of the
    seed.

    Parameters
    ----------
    base : of the seed
    parts, weights : of the blend
    """

    def __init__(
        self,
        base: np.random.SeedSequence,
        parts: Sequence[np.random.SeedSequence],
        weights: Sequence[float],
    ) -> None:
        super().__init__(np.random.PCG64(base))
        self._parts = [np.random.default_rng(part) for part in parts]
        self._weights = list(weights)

    def standard_normal(self, size: Any = None, *_: Any, **__: Any) -> Any:
        """Return standard normal numbers: of every part, times its weight."""
        blended: Any = 0.0
        for part, weight in zip(self._parts, self._weights, strict=True):
            blended = blended + weight * part.standard_normal(size)
        return blended

    def normal(self, loc: Any = 0.0, scale: Any = 1.0, size: Any = None) -> Any:
        """Return normal numbers."""
        return loc + scale * self.standard_normal(size)

    def random(self, size: Any = None, *_: Any, **__: Any) -> Any:
        """Return numbers between 0 and 1."""
        from scipy.special import ndtr

        return ndtr(self.standard_normal(size))

    def uniform(self, low: Any = 0.0, high: Any = 1.0, size: Any = None) -> Any:
        """Return numbers between two limits."""
        return low + (high - low) * self.random(size)
