"""Random variables: the sample of each flight, which follows only from the trial's seed and the
flight's number.
"""

import math
import zlib
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, ndtri

from scenarios.errors import InputError
from scenarios.scenario.files import with_values
from scenarios.scenario.overrides import displaced
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.experiment import DrawConfig
from scenarios.world.noise import Noise
from scenarios.world.world import apparent_wind, vessel_of

_TRIES = 1000

_ALMOST_ALL = 1.0 - 1e-15
"""The share of a distribution up to its end, where it has none."""

Values = dict[str, object]
"""Samples, by key."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SampledFlight:
    """One flight of a trial.

    Attributes
    ----------
    scenario : with its samples set
    noise : of its start, air, sensors and reports
    values : the samples, by key, without those that give way to given keys
    """

    scenario: Scenario
    noise: Noise
    values: dict[str, object]

    @property
    def seed(self) -> int:
        """Return the seed of its noise; of a blend, of the part that is not blended."""
        return self.noise.seed


def sampled_flight(
    trial: str,
    scenario: Scenario,
    number: int,
    point: Sequence[float] = (),
    *,
    given: Collection[str] = (),
    paired: Callable[[Values], Scenario] | None = None,
    stream: int = 0,
) -> SampledFlight:
    """Return one flight of a trial.

    Parameters
    ----------
    trial : its name
    scenario : the trial
    number : of the flight, from 0
    point : position of each random variable in its distribution, from 0 to 1, in the order of the
        variables; random if empty. Where that has no speed ratio within ``scenario.speed_ratio``,
        the flight is sampled again at random. Further numbers are those of its noise
        (``Noise.at``); without them the noise has its own seed.
    given : keys that the scenario sets for each of its flights. The draws of these keys keep their
        places among the random numbers, so that all other samples stay the same
    stream : number of the random numbers of the flight's point, 0 for those of all points
    paired : returns, for samples, the flight whose speed ratio decides whether to sample again; by
        default the flight itself

    Raises
    ------
    InputError : a sampled key does not exist or is out of range, or no sample has a speed ratio
        within ``scenario.speed_ratio``
    """
    sequence = np.random.SeedSequence(entropy_of(scenario.seed, trial, number, stream))
    inputs, of_noise = point[: len(scenario.draws)], point[len(scenario.draws) :]
    for values in _tried(scenario.draws, np.random.default_rng(sequence), number, inputs):
        kept = not_displaced(values, given)
        flight = with_values(scenario, kept)
        judged = flight if paired is None else paired(values)
        if has_speed_ratio(judged):
            own = (
                int(sequence.generate_state(1)[0])
                if flight.flight_seed is None
                else flight.flight_seed
            )
            noise = Noise.at(of_noise) if of_noise and flight.flight_seed is None else Noise(own)
            return SampledFlight(scenario=flight, noise=noise, values=kept)
    (low, high), (least, most) = judged.speed_ratio, speed_ratios(judged)
    raise InputError(
        f"trial '{trial}': {_TRIES} samples had no speed ratio within {low:g} to {high:g}; the"
        f" last one went from {least:.3f} to {most:.3f}: widen speed_ratio, or sample other winds"
        " and vessel speeds"
    )


def entropy_of(seed: int, trial: str, number: int, stream: int) -> list[int]:
    """Return the numbers that seed a flight's random generator.

    Parameters
    ----------
    seed, trial : of the study, and name of the trial
    number : of the flight in its point, from 0
    stream : number of the point's random numbers, 0 for those of all points
    """
    entropy = [seed, zlib.crc32(trial.encode()), number]
    return [*entropy, stream] if stream else entropy


def not_displaced(values: Mapping[str, object], given: Collection[str]) -> Values:
    """Return samples, by key, without those that given keys replace."""
    return {key: value for key, value in values.items() if not displaced(key, given)}


def speed_ratios(flight: Scenario) -> tuple[float, float]:
    """Return a flight's least and greatest speed ratio [-]."""
    wind, speed = apparent_wind(flight, vessel_of(flight)), flight.guidance.airspeed_mps
    return wind.least / speed, wind.greatest / speed


def has_speed_ratio(flight: Scenario) -> bool:
    """Return whether a flight's speed ratios lie within the declared range; otherwise it is sampled
    again.
    """
    (low, high), (least, most) = flight.speed_ratio, speed_ratios(flight)
    return low <= least and most <= high


def value_at(draw: DrawConfig, share: float) -> object:
    """Return the quantile of a random variable for a probability from 0 to 1."""
    if draw.uniform is not None:
        low, high = draw.uniform
        return low + (high - low) * share
    if draw.choice is not None:
        weights = np.cumsum(draw.weights or [1.0] * len(draw.choice))
        return draw.choice[
            int(np.searchsorted(weights, min(share, _ALMOST_ALL) * weights[-1], side="right"))
        ]
    low, high = (_share_below(draw, limit) for limit in draw.within) if draw.within else (0.0, 1.0)
    # A distribution without an end has no value at it.
    share = min(max(low + (high - low) * share, 1.0 - _ALMOST_ALL), _ALMOST_ALL)
    if draw.normal is not None:
        mean, sigma = draw.normal
        value = mean + sigma * float(ndtri(share))
    else:
        shape, scale = draw.weibull or (1.0, 1.0)
        value = scale * (-math.log1p(-share)) ** (1.0 / shape)
    return min(max(value, draw.within[0]), draw.within[1]) if draw.within else value


def values_at(draws: Sequence[DrawConfig], point: Sequence[float]) -> Values:
    """Return the values of random variables, by key, for their positions from 0 to 1."""
    return {draw.key: value_at(draw, share) for draw, share in zip(draws, point, strict=True)}


def _share_below(draw: DrawConfig, limit: float) -> float:
    """Return the share of a normal or Weibull distribution that lies below a limit."""
    if draw.normal is not None:
        mean, sigma = draw.normal
        return float(ndtr((limit - mean) / sigma))
    shape, scale = draw.weibull or (1.0, 1.0)
    return -math.expm1(-((max(limit, 0.0) / scale) ** shape))


def _tried(
    draws: Sequence[DrawConfig], generator: np.random.Generator, number: int, point: Sequence[float]
) -> Iterator[Values]:
    """Yield samples for a flight, to be tried one after the other."""
    if point:
        yield values_at(draws, point)
    for _ in range(_TRIES):
        values: Values = {}
        remainder = number
        for draw in draws:
            if draw.choice is None or draw.weights is not None or point:
                values[draw.key] = value_at(draw, float(generator.random()))
            else:
                # Several choices are taken like the digits of a number: every combination comes
                # equally often.
                remainder, i = divmod(remainder, len(draw.choice))
                values[draw.key] = draw.choice[i]
        yield values


def check_draws(trial: str, scenario: Scenario, given: Collection[str] = ()) -> None:
    """Check every choice, and both ends of each range, before any flight; parameters are those of
    ``sampled_flight``.

    Raises
    ------
    InputError : same as ``sampled_flight``
    """
    for draw in scenario.draws:
        if draw.within is not None and not _share_below(draw, draw.within[0]) < _share_below(
            draw, draw.within[1]
        ):
            raise InputError(
                f"draw of '{draw.key}' has within {list(draw.within)}, which holds nothing of its"
                " distribution; widen it"
            )
    for number in range(max((len(draw.choice or ()) for draw in scenario.draws), default=0) or 1):
        for end in (0.0, 1.0):
            values = {
                draw.key: draw.choice[number % len(draw.choice)]
                if draw.choice
                else value_at(draw, end)
                for draw in scenario.draws
            }
            with_values(scenario, not_displaced(values, given))
    sampled_flight(trial, scenario, 0, given=given)
