"""Subset simulation: the probability of a rare event as a product of larger probabilities.

S.-K. Au and J. L. Beck, "Estimation of small failure probabilities in high dimensions by subset
simulation", Probabilistic Engineering Mechanics 16 (2001). The event is that a value, here the
distance kept beyond r_min, is below 0. The first level is a plain random sample. Its lowest tenth
(``conditional_probability``) gives the threshold of the next level. The sample of the next level
consists of Markov chains that start in this tenth and stay at or below the threshold. Levels follow
until a tenth of a level is below 0. The probability is the product of the fractions that passed
each threshold.

The chains move in standard normal space by conditional sampling with adaptive steps: I.
Papaioannou, W. Betz, K. Zwirglmaier, D. Straub, "MCMC algorithms for subset simulation",
Probabilistic Engineering Mechanics 41 (2015). A proposal has the declared distribution, given the
state, and is accepted if its value is at or below the threshold. After every wave of proposals the
steps adapt to the acceptance rate that the same paper recommends. The adaptation decreases from
wave to wave, so the steps depend less and less on the chains' past.

Noise within a flight follows from seeds. If every proposal had new seeds, the same point would have
another value each time, and no chain could stay below a threshold. The noise is therefore part of
the state. The event is one of inputs and noise together, with the same probability as in a plain
study. The noise has two parts:

- a blend: (seed, weight) pairs. Each seed stands for a series of independent standard normal
  numbers, and the noise is their weighted sum. The squares of the weights add up to 1, so the sum
  is standard normal as well. A move multiplies all weights by sqrt(1 - step^2), and adds a new seed
  with the weight ``step``. This is a small step in as many dimensions as a flight has random
  numbers, and takes only one seed (preconditioned Crank-Nicolson; S. L. Cotter, G. O. Roberts, A.
  M. Stuart, D. White, "MCMC methods for functions: modifying old algorithms to make them faster",
  Statistical Science 28 (2013)).
- a single seed, for noise that cannot be blended: JSBSim computes its turbulence from one seed. The
  seed is kept while the other parts move (common random numbers). Some moves renew only the seed;
  they are accepted by the same rule. If the event depends strongly on this seed, renewals are
  seldom accepted (``Counts.renewed_accepted``), chains depend on the few seeds that they began
  with, and estimates of repeated simulations scatter more, which widens the interval.

Each move changes either the inputs, the blend or the seed, because steps of wind or start can be
many times as large as steps of all the noise at once. The steps of inputs and blend adapt
separately, and are never smaller than ``SCALE_MIN``: the closest approach is a rugged function, for
which smaller steps are hardly accepted more often and make no progress.

A simulation is a Python generator that yields the points of a wave and is sent their values. Any
number of processes can evaluate the points, and several simulations can run together. The result
depends on the random generator only.

Several simulations together give the probability and its interval, the same as a function of the
threshold, and the influence of the inputs. Estimates of single simulations are skewed,
approximately log-normal. The mean is estimated from their logarithms, with the interval of Cox for
the mean of a log-normal distribution, which uses Student's t for few values: U. Olsson, "Confidence
intervals for the mean of a log-normal distribution", Journal of Statistics Education 13 (2005). The
standard deviation is the larger of two: the one between the repeats, and the one within them by Au
and Beck's formula (for correlated chains and independent levels). Thus neither a chance agreement
of few repeats nor hidden correlation makes the interval narrow. Tests measure the coverage of the
interval.

If a simulation has not reached the event, its estimate is 0 and the logarithm does not exist. An
upper bound remains: with 0 of n chains of the last level in the event, 1 - (1 - confidence)^(1/n)
of that level's probability (Clopper and Pearson). States of one chain are correlated, and so are
chains that began at copies of one state, so n is the number of different initial states. If no
simulation has reached the event, the bound is computed at the lowest threshold that all of them
have reached. If some came much nearer than others, the probability of that threshold scatters, and
the bound is larger.

The first levels of all simulations together are a plain sample, with the interval of Clopper and
Pearson.
"""

import math
from collections.abc import Callable, Generator, Sequence
from dataclasses import asdict, dataclass, field, replace

import numpy as np
import numpy.typing as npt
import pandas as pd
from scipy.special import ndtr, stdtrit

from common.intervals import clopper_pearson, upper_bound
from scenarios.statistics.estimates import (
    Json,
    count_violations,
    share,
    unknown_flights,
    without_nan,
    word_counts,
)

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.int64]


@dataclass(slots=True, kw_only=True)
class Counts:
    """Numbers of evaluations and moves for the sample of a level.

    Attributes
    ----------
    evaluated : number of evaluated points
    moved, accepted : moves of the inputs, and accepted ones
    blended, blended_accepted : moves of the blended noise, and accepted ones
    renewed, renewed_accepted : renewals of a seed on which the value depends, and accepted ones
    outside : moves to points that are not allowed, which were not evaluated
    """

    evaluated: int = 0
    moved: int = 0
    accepted: int = 0
    blended: int = 0
    blended_accepted: int = 0
    renewed: int = 0
    renewed_accepted: int = 0
    outside: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Level:
    """The sample of one level.

    Attributes
    ----------
    below : upper limit of the sample's values; infinite for the first level
    threshold : threshold of the next level; 0 for the last level
    probability : fraction of the sample at or below ``threshold``; in the last level, below 0 [-]
    variation : coefficient of variation of ``probability``, with the correlation within chains [-]
    points : cumulative probabilities of the inputs, in the unit cube, shape (n, inputs)
    dummies : the same of inputs without effect, shape (n, ``DUMMIES``)
    values : values of the points, infinite if missing, shape (n,)
    chains : number of each point's chain, shape (n,)
    counts : numbers of evaluations and moves
    scale, noise_scale : scales of the steps of inputs and blend at the end of the level [-]
    """

    below: float
    threshold: float
    probability: float
    variation: float
    points: Array
    dummies: Array
    values: Array
    chains: Indices
    counts: Counts
    scale: float
    noise_scale: float

    @property
    def beginnings(self) -> int:
        """Return the number of different initial states of the chains; copies count once."""
        _, first = np.unique(self.chains, return_index=True)
        return len(np.unique(np.column_stack([self.points[first], self.values[first]]), axis=0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Simulation:
    """One subset simulation.

    Attributes
    ----------
    levels : levels in order; the first is a plain sample
    stalled : whether no lower threshold was found, because a level has a single value
    """

    levels: tuple[Level, ...]
    stalled: bool

    @property
    def reached(self) -> float:
        """Return the estimated probability of the last level [-]."""
        return math.prod(level.probability for level in self.levels[:-1])

    @property
    def reached_variation(self) -> float:
        """Return the coefficient of variation of ``reached`` [-]; see ``below``."""
        return math.sqrt(sum(level.variation**2 for level in self.levels[:-1]))

    def below(self, value: float) -> tuple[float, float]:
        """Return the estimated probability of values below ``value``, and its variation [-].

        The coefficient of variation is Au and Beck's (2001) for independent levels; it is infinite
        if no value is below.
        """
        reached, squares = 1.0, 0.0
        for level in self.levels:
            if value > level.threshold or level is self.levels[-1]:
                event = level.values < value
                return reached * float(np.mean(event)), math.hypot(
                    math.sqrt(squares), variation(event, level.chains)
                )
            reached *= level.probability
            squares += level.variation**2
        raise ValueError("a simulation has one level at least")


def variation(event: Mask, chains: Indices) -> float:
    """Return the coefficient of variation of an event's fraction in a level, by Au and Beck [-].

    Parameters
    ----------
    event : whether each state has the event, in the order of each chain, shape (n,)
    chains : number of each state's chain, shape (n,)

    Returns
    -------
    variation : infinite if no state has the event
    """
    share, count = float(np.mean(event)), len(event)
    if share == 0.0:
        return math.inf
    order = np.argsort(chains, kind="stable")
    chain, centred = chains[order], event[order].astype(np.float64) - share
    factor, every = 1.0, share * (1.0 - share)
    for lag in range(1, int(np.bincount(chains).max())):
        together = chain[lag:] == chain[:-lag]
        if every and together.any():
            # Twice the covariance at this lag, weighted by the number of its pairs.
            factor += (
                2.0
                * float(np.sum(centred[lag:][together] * centred[:-lag][together]))
                / (count * every)
            )
    return math.sqrt((1.0 - share) / (share * count) * max(factor, 1.0))


ACCEPTANCE = 0.44
"""Acceptance rate to which steps adapt [-]: Papaioannou et al. (2015)."""

FIRST_SCALE = 0.6
"""Initial scale of the steps [-], from the same paper."""

SCALE_MIN = 0.2
"""Least scale of the steps [-].

Without a limit it fell to 0.01 in 3,400 flights, and chains made no progress at about 0.3 m.
"""

SCALE_MAX = 1e3
"""Largest scale of the steps [-]; the steps reach their limit of 1 at smaller scales."""

RENEWALS, BLENDS = 0.2, 0.3
"""Fractions of moves that renew the seed and that move the blend [-].

Of the nine moves of a chain they are about two and three.
"""

DUMMIES = 5
"""Number of additional coordinates without effect: any shift of their distribution is chance."""

SEEDS = 2**32
"""Number of different seeds, as in other studies."""

Point = tuple[float, ...]
"""Cumulative probabilities of the inputs, from 0 to 1, and the noise.

The noise is the single seed, followed by seed and weight of each part of the blend.
"""

Simulating = Generator[list[Point], Array, Simulation]
"""A running simulation: it yields points, is sent their values, and returns its result."""


@dataclass(slots=True, kw_only=True)
class _States:
    """States of chains: normal coordinates of inputs and dummies, noise, and values."""

    normal: Array
    noise: list[Point]
    values: Array

    def at(self, chosen: Indices) -> "_States":
        return _States(
            normal=self.normal[chosen],
            noise=[self.noise[i] for i in chosen],
            values=self.values[chosen],
        )

    @staticmethod
    def joined(parts: "list[_States]") -> "_States":
        return _States(
            normal=np.concatenate([part.normal for part in parts]),
            noise=[noise for part in parts for noise in part.noise],
            values=np.concatenate([part.values for part in parts]),
        )


@dataclass(slots=True, kw_only=True)
class _Scales:
    inputs: float = FIRST_SCALE
    blend: float = FIRST_SCALE


@dataclass(frozen=True, slots=True, kw_only=True)
class SubsetSimulation:
    """Settings of a subset simulation, and its execution.

    Attributes
    ----------
    dimension : number of inputs
    noise : whether points have noise
    flights : number of points per level
    conditional_probability : approximate fraction of a level that passes its threshold [-]
    levels_max : largest number of levels, including the first one
    allowed : function that returns whether inputs, shape (dimension,) in the unit cube, are
        allowed; the distribution is the declared one, restricted to allowed inputs
    seeded : function that returns whether the value at such inputs depends on the seed; if not, a
        new seed is accepted without an evaluation
    """

    dimension: int
    noise: bool
    flights: int
    conditional_probability: float
    levels_max: int
    allowed: Callable[[Array], bool] = field(default=lambda _: True)
    seeded: Callable[[Array], bool] = field(default=lambda _: True)

    def run(self, generator: np.random.Generator) -> Simulating:
        """Yield the points of each wave and receive their values; a missing value is infinity."""
        counts, levels = Counts(), list[Level]()
        states, chains = (yield from self._first(generator, counts)), np.arange(self.flights)
        below, scales = math.inf, _Scales()
        while True:
            passing = max(1, round(self.conditional_probability * self.flights))
            threshold = _threshold(states.values, passing)
            passed = states.values <= threshold
            stalled = threshold >= 0.0 and bool(passed.all())
            last = threshold < 0.0 or len(levels) + 1 == self.levels_max or stalled
            event = states.values < 0.0 if last else passed
            levels.append(
                Level(
                    below=below,
                    threshold=0.0 if last else threshold,
                    probability=float(np.mean(event)),
                    variation=variation(event, chains),
                    points=self._inputs(states.normal),
                    dummies=ndtr(states.normal[:, self.dimension :]),
                    values=states.values,
                    chains=chains,
                    counts=counts,
                    scale=scales.inputs,
                    noise_scale=scales.blend,
                )
            )
            if last:
                return Simulation(levels=tuple(levels), stalled=stalled)
            counts, below = Counts(), threshold
            seeds = states.at(np.flatnonzero(passed))
            states, chains = yield from self._grown(seeds, threshold, scales, generator, counts)

    def _first(
        self, generator: np.random.Generator, counts: Counts
    ) -> Generator[list[Point], Array, _States]:
        """Evaluate a plain random sample."""
        found: list[Array] = []
        while len(found) < self.flights:
            normal = generator.standard_normal(self.dimension + DUMMIES)
            if self.allowed(self._inputs(normal)):
                found.append(normal)
            else:
                counts.outside += 1
        normal = np.array(found)
        noise: list[Point] = [()] * self.flights
        if self.noise:
            noise = [(*_seeds(generator, 2), 1.0) for _ in range(self.flights)]
        counts.evaluated = self.flights
        values = yield self._points(normal, noise)
        return _States(normal=normal, noise=noise, values=values)

    def _grown(
        self,
        seeds: _States,
        threshold: float,
        scales: _Scales,
        generator: np.random.Generator,
        counts: Counts,
    ) -> Generator[list[Point], Array, tuple[_States, Indices]]:
        """Extend chains from the seeds until a level is complete; return states and chains."""
        # The order is random, so that the chains with an additional state do not always have the
        # same seeds.
        states = seeds.at(generator.permutation(len(seeds.values)))
        spread = states.normal.std(axis=0)
        parts, missing = [states], self.flights - len(states.values)
        wave = 0
        while missing > 0:
            wave += 1
            states = states.at(np.arange(min(missing, len(states.values))))
            before = replace(counts)
            states = yield from self._moved(states, threshold, scales, spread, generator, counts)
            moved, accepted = counts.moved - before.moved, counts.accepted - before.accepted
            scales.inputs = _adapted(scales.inputs, moved, accepted, wave)
            moved = counts.blended - before.blended
            accepted = counts.blended_accepted - before.blended_accepted
            scales.blend = _adapted(scales.blend, moved, accepted, wave)
            parts.append(states)
            missing -= len(states.values)
        chains = np.concatenate([np.arange(len(part.values)) for part in parts])
        return _States.joined(parts), chains

    def _moved(
        self,
        states: _States,
        threshold: float,
        scales: _Scales,
        spread: Array,
        generator: np.random.Generator,
        counts: Counts,
    ) -> Generator[list[Point], Array, _States]:
        """Propose a move of each chain; return the new states."""
        count = len(states.values)
        kind = generator.random(count) if self.noise else np.ones(count)
        renewed = kind < RENEWALS
        blended = (kind >= RENEWALS) & (kind < RENEWALS + BLENDS)
        moved = kind >= RENEWALS + BLENDS
        steps = np.minimum(1.0, scales.inputs * spread)
        proposed = np.sqrt(1.0 - steps**2) * states.normal + steps * generator.standard_normal(
            states.normal.shape
        )
        normal = np.where(moved[:, None], proposed, states.normal)
        noise = states.noise
        if self.noise:
            step = min(1.0, scales.blend)
            noise = list(noise)
            for i, seed in enumerate(_seeds(generator, count)):
                if renewed[i]:
                    noise[i] = (seed, *noise[i][1:])
                elif blended[i]:
                    noise[i] = _blended(noise[i], seed, step)
        inputs = self._inputs(normal)
        known = np.array(
            [new and not self.seeded(at) for new, at in zip(renewed, inputs, strict=True)]
        )
        renewed &= ~known
        evaluated = np.flatnonzero(
            renewed | blended | (moved & np.array([self.allowed(at) for at in inputs]))
        )
        values = np.where(known, states.values, math.inf)
        if len(evaluated):
            values[evaluated] = yield self._points(normal[evaluated], [noise[i] for i in evaluated])
        accepted = values <= threshold
        counts.evaluated += len(evaluated)
        counts.outside += count - len(evaluated) - int(np.count_nonzero(known))
        counts.moved += int(np.count_nonzero(moved))
        counts.accepted += int(np.count_nonzero(accepted & moved))
        counts.blended += int(np.count_nonzero(blended))
        counts.blended_accepted += int(np.count_nonzero(accepted & blended))
        counts.renewed += int(np.count_nonzero(renewed))
        counts.renewed_accepted += int(np.count_nonzero(accepted & renewed))
        return _States(
            normal=np.where(accepted[:, None], normal, states.normal),
            noise=[
                new if better else old
                for new, old, better in zip(noise, states.noise, accepted, strict=True)
            ],
            values=np.where(accepted, values, states.values),
        )

    def _inputs(self, normal: Array) -> Array:
        inputs: Array = ndtr(normal[..., : self.dimension])
        return inputs

    def _points(self, normal: Array, noise: Sequence[Point]) -> list[Point]:
        return [
            (*at, *of_noise)
            for at, of_noise in zip(self._inputs(normal).tolist(), noise, strict=True)
        ]


def _threshold(values: Array, passing: int) -> float:
    """Return the threshold that ``passing`` values are at or below.

    It lies half way to the next greater value. Chains repeat states: a threshold at a repeated
    value would let all repetitions pass, and be biased by half of them.
    """
    least = float(np.sort(values)[passing - 1])
    above = float(np.min(values[values > least], initial=math.inf))
    between = 0.5 * (least + above)
    # The event begins at 0, so a threshold must not lie half way across 0.
    return between if math.isfinite(above) and (least < 0.0) == (between < 0.0) else least


def _seeds(generator: np.random.Generator, count: int) -> list[float]:
    seeds: list[float] = generator.integers(SEEDS, size=count).astype(np.float64).tolist()
    return seeds


def _adapted(scale: float, moved: int, accepted: int, wave: int) -> float:
    """Return the scale of steps after a wave, adapted to the acceptance rate."""
    if not moved:
        return scale
    return float(
        np.clip(
            scale * math.exp((accepted / moved - ACCEPTANCE) / math.sqrt(wave)),
            SCALE_MIN,
            SCALE_MAX,
        )
    )


def _blended(noise: Point, seed: float, step: float) -> Point:
    """Return noise whose blend has moved by a step towards a new seed."""
    kept = math.sqrt(1.0 - step**2)
    parts = [(noise[i], kept * noise[i + 1]) for i in range(1, len(noise), 2)] if kept else []
    return (noise[0], *(number for part in parts for number in part), seed, step)


CURVE_POINTS = 80
"""Number of thresholds at which the probability is computed."""

BINS = 20
"""Number of classes of an input's histogram."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RareProbability:
    """A probability, estimated by several simulations.

    Attributes
    ----------
    estimate : estimated probability; the plain mean if some simulations' estimates are 0 [-]
    low, high : two-sided interval [-]
    upper : one-sided upper bound [-]
    reached : number of simulations that have reached the event
    """

    estimate: float
    low: float
    high: float
    upper: float
    reached: int


@dataclass(frozen=True, slots=True, kw_only=True)
class InputShift:
    """Distribution of an input near the event, compared with the declared distribution.

    Attributes
    ----------
    key : key of the input
    distance : Kolmogorov distance, the largest difference of the cumulative distributions [-]
    median, median_near : medians as declared and near the event; None for words
    edges : edges of the classes, one more than classes; empty for words
    names : names of the classes for words; otherwise empty
    declared, near : fraction in each class [-]
    """

    key: str
    distance: float
    median: float | None
    median_near: float | None
    edges: tuple[float, ...]
    names: tuple[str, ...]
    declared: tuple[float, ...]
    near: tuple[float, ...]


def rare_probability(
    simulations: Sequence[Simulation], confidence: float, *, value: float = 0.0
) -> RareProbability:
    """Return the probability of values below ``value``, from all simulations together.

    Parameters
    ----------
    simulations : at least three repeats with different random numbers
    confidence : confidence of the interval and of the one-sided bound, between 0 and 1
    value : limit of the values; below 0 the last level is used, as there are no further levels
    """
    found = np.array([simulation.below(value) for simulation in simulations])
    estimates, reached = found[:, 0], found[:, 0] > 0.0
    two_sided, one_sided = 0.5 + 0.5 * confidence, confidence
    first = [simulation.levels[0] for simulation in simulations]
    if reached.any() and all(
        value > level.threshold or len(of.levels) == 1
        for level, of in zip(first, simulations, strict=True)
    ):
        return _of_plain_samples(
            np.concatenate([level.values for level in first]) < value,
            int(reached.sum()),
            confidence,
        )
    if reached.all():
        centre, deviation = _log_mean(estimates, found[:, 1])
        t = _t_quantile(two_sided, len(estimates)) * deviation
        return RareProbability(
            estimate=_at_most_one(centre),
            low=_at_most_one(centre - t),
            high=_at_most_one(centre + t),
            upper=_at_most_one(centre + _t_quantile(one_sided, len(estimates)) * deviation),
            reached=len(estimates),
        )
    high, upper = (
        _left_open(simulations, estimates, found[:, 1], level) for level in (two_sided, one_sided)
    )
    return RareProbability(
        estimate=float(estimates.mean()),
        low=0.0,
        high=high,
        upper=upper,
        reached=int(np.count_nonzero(reached)),
    )


def _of_plain_samples(
    event: npt.NDArray[np.bool_], reached: int, confidence: float
) -> RareProbability:
    """Return a probability that is not rare, with the exact interval of the plain first levels."""
    events, trials = int(np.count_nonzero(event)), len(event)
    interval = clopper_pearson(events, trials, confidence)
    return RareProbability(
        estimate=events / trials,
        low=interval.low,
        high=interval.high,
        upper=upper_bound(events, trials, confidence),
        reached=reached,
    )


def _left_open(
    simulations: Sequence[Simulation], estimates: Array, variations: Array, confidence: float
) -> float:
    """Return an upper bound if some simulations have not reached the event.

    The error probability is divided equally between the probability of the last levels and the
    fraction of events in them.
    """
    half = 0.5 + 0.5 * confidence
    chains = [simulation.levels[-1].beginnings for simulation in simulations]
    if not estimates.any():
        common = max(simulation.levels[-1].below for simulation in simulations)
        if math.isinf(common):
            # If a simulation has only its plain sample, all plain samples together give the bound.
            return upper_bound(
                0, sum(len(simulation.levels[0].values) for simulation in simulations), confidence
            )
        # The next greater number is used, because states at the threshold belong to the level.
        levels, within = np.array(
            [simulation.below(math.nextafter(common, math.inf)) for simulation in simulations]
        ).T
        factor = upper_bound(0, sum(chains), half)
    else:
        open_levels = [
            simulation.reached * upper_bound(0, n, half)
            for simulation, n in zip(simulations, chains, strict=True)
        ]
        levels = np.where(estimates > 0.0, estimates, open_levels)
        within = np.where(
            estimates > 0.0,
            variations,
            [simulation.reached_variation for simulation in simulations],
        )
        factor = 1.0
    centre, deviation = _log_mean(levels, within)
    return _at_most_one(math.log(factor) + centre + _t_quantile(half, len(levels)) * deviation)


def _at_most_one(logarithm: float) -> float:
    """Return the probability with this logarithm, at most 1; a large scatter would overflow."""
    return math.exp(min(0.0, logarithm))


def _log_mean(estimates: Array, variations: Array) -> tuple[float, float]:
    """Return the logarithm of the mean of a log-normal distribution, and its standard deviation."""
    count, logarithms = len(estimates), np.log(estimates)
    between = float(np.var(logarithms, ddof=1))
    variance = max(between, math.log1p(float(np.mean(variations**2))))
    return float(np.mean(logarithms)) + 0.5 * between, math.sqrt(
        variance / count + variance**2 / (2.0 * (count - 1))
    )


def _t_quantile(probability: float, count: int) -> float:
    return float(stdtrit(count - 1, probability))


def curve(
    simulations: Sequence[Simulation], confidence: float
) -> list[tuple[float, RareProbability]]:
    """Return probabilities over thresholds, from the lowest that all simulations have reached."""
    lowest = max(float(simulation.levels[-1].values.min()) for simulation in simulations)
    first = np.concatenate([simulation.levels[0].values for simulation in simulations])
    known = first[np.isfinite(first)]
    if not len(known) or not math.isfinite(lowest):
        return []
    highest = float(np.quantile(known, 0.9))
    values = np.unique(
        np.append(
            np.linspace(lowest, highest, CURVE_POINTS), 0.0 if lowest < 0.0 < highest else lowest
        )
    )
    found = [
        (float(value), rare_probability(simulations, confidence, value=float(value)))
        for value in values
    ]
    return [
        (value, probability)
        for value, probability in found
        if probability.reached == len(simulations)
    ]


def near_event(simulations: Sequence[Simulation]) -> list[tuple[Simulation, Indices]]:
    """Return each simulation with the indices of its last level's states below 0.

    If no simulation has such states, the indices of the whole last level are returned.
    """
    inside = [np.flatnonzero(simulation.levels[-1].values < 0.0) for simulation in simulations]
    every = [np.arange(len(simulation.levels[-1].values)) for simulation in simulations]
    return list(
        zip(simulations, inside if any(len(chosen) for chosen in inside) else every, strict=True)
    )


def input_shifts(
    declared: pd.DataFrame, near: pd.DataFrame, at: tuple[Array, Array]
) -> list[InputShift]:
    """Return the shift of each input's distribution near the event, the largest distance first.

    Parameters
    ----------
    declared, near : values of the inputs in the first levels and near the event, a column per input
    at : the same values in the unit cube, shapes (n, inputs)
    """
    shifts = [
        _shift(str(key), declared[key], near[key], distance(at[0][:, i], at[1][:, i]))
        for i, key in enumerate(declared.columns)
    ]
    return sorted(shifts, key=lambda shift: -shift.distance)


def noise_floor(simulations: Sequence[Simulation]) -> float:
    """Return the largest distance of the dummies, which move with the chains but have no effect."""
    first = np.concatenate([simulation.levels[0].dummies for simulation in simulations])
    last = np.concatenate(
        [simulation.levels[-1].dummies[chosen] for simulation, chosen in near_event(simulations)]
    )
    return max(distance(first[:, i], last[:, i]) for i in range(first.shape[1]))


def distance(one: Array, other: Array) -> float:
    """Return the Kolmogorov-Smirnov distance of two samples [-]."""
    every = np.sort(np.concatenate([one, other]))
    shares = [
        np.searchsorted(np.sort(values), every, side="right") / len(values)
        for values in (one, other)
    ]
    return float(np.max(np.abs(shares[0] - shares[1])))


def _shift(
    key: str, declared: "pd.Series[float]", near: "pd.Series[float]", found: float
) -> InputShift:
    if pd.api.types.is_numeric_dtype(declared):
        both = np.concatenate(
            [declared.to_numpy(dtype=np.float64), near.to_numpy(dtype=np.float64)]
        )
        edges = np.histogram_bin_edges(both, bins=BINS)
        shares = [
            tuple((np.histogram(values, edges)[0] / len(values)).tolist())
            for values in (declared, near)
        ]
        medians = (float(declared.median()), float(near.median()))
        return InputShift(
            key=key,
            distance=found,
            median=medians[0],
            median_near=medians[1],
            edges=tuple(edges.tolist()),
            names=(),
            declared=shares[0],
            near=shares[1],
        )
    words = [declared.astype(str), near.astype(str)]
    names = tuple(dict.fromkeys([*sorted(words[0].unique()), *words[1].unique()]))
    fractions = [tuple(float((values == name).mean()) for name in names) for values in words]
    return InputShift(
        key=key,
        distance=found,
        median=None,
        median_near=None,
        edges=(),
        names=names,
        declared=fractions[0],
        near=fractions[1],
    )


def subset_statistics(
    rows: pd.DataFrame,
    simulations: Sequence[Simulation],
    shifts: Sequence[InputShift],
    *,
    confidence: float,
) -> Json:
    """Return the content of ``statistics.json``; NaN becomes None.

    Flights of the first levels are a plain random sample with its own bound. The pessimistic bound
    counts flights without a measurement, and flights lost without a violation, as violations.

    Parameters
    ----------
    rows : columns ``COLUMNS`` of the summary, a row per flight in the order of flights
    simulations : the repeats, at least three
    shifts : shifts of the inputs' distributions
    confidence : confidence of each interval, between 0 and 1
    """
    plain = count_violations(
        rows.head(sum(len(simulation.levels[0].values) for simulation in simulations))
    )
    every = count_violations(rows)
    found = rare_probability(simulations, confidence)
    content: Json = without_nan(
        {
            "method": "subset",
            "confidence": confidence,
            "flights": {
                "done": every.flights,
                "measured": every.measured,
                "unknown": unknown_flights(every),
            },
            "outcomes": word_counts(rows["outcome"]),
            "modes_at_end": word_counts(rows["mode_at_end"]),
            "violation": {
                **asdict(found),
                "repeats": len(simulations),
                "events": every.events,
                "pessimistic": {
                    "upper": pessimistic_upper(
                        simulations,
                        found,
                        plain.events_at_most - plain.events,
                        plain.flights,
                        confidence,
                    )
                },
                "first_levels": share(plain.events, plain.measured, confidence),
                "first_levels_unknown": plain.events_at_most - plain.events,
            },
            "simulations": [_simulation(simulation) for simulation in simulations],
            "curve": [
                {"clearance_m": value, **asdict(point)}
                for value, point in curve(simulations, confidence)
            ],
            "inputs": [asdict(shift) for shift in shifts],
            "noise_floor": noise_floor(simulations),
        }
    )
    return content


def pessimistic_upper(
    simulations: Sequence[Simulation],
    found: RareProbability,
    unknown: int,
    flights: int,
    confidence: float,
) -> float:
    """Return the bound if unknown flights count as violations.

    The error probability is divided equally between the two bounds that are added.
    """
    if not unknown:
        return found.upper
    half = 0.5 + 0.5 * confidence
    return min(1.0, rare_probability(simulations, half).upper + upper_bound(unknown, flights, half))


def _simulation(simulation: Simulation) -> Json:
    probability, variation = simulation.below(0.0)
    return {
        "probability": probability,
        "variation": variation,
        "stalled": simulation.stalled,
        "levels": [_level(level) for level in simulation.levels],
    }


def _level(level: Level) -> Json:
    counts = asdict(level.counts)
    flights = counts.pop("evaluated")
    return {
        "below_m": level.below,
        "threshold_m": level.threshold,
        "probability": level.probability,
        "variation": level.variation,
        "flights": flights,
        "nearest_m": float(level.values.min()),
        "without_measurement": int(sum(math.isinf(value) for value in level.values)),
        **counts,
        "scale": level.scale,
        "noise_scale": level.noise_scale,
    }
