"""Subset simulation: the probability of a rare event as a product of probabilities that are not
rare.

S.-K. Au and J. L. Beck, "Estimation of small failure probabilities in high dimensions by subset
simulation", Probabilistic Engineering Mechanics 16 (2001). The event is that a value, here the
distance kept beyond r_min, is below
0. The first level is a plain random sample. Its lowest tenth (``conditional_probability``) gives
the threshold of the next level, whose sample are Markov chains that start there and never leave
what lies at or below the threshold; and so on, until a tenth of a level is below 0. The probability
is the product of the fractions that passed each threshold.

The chains move in standard normal space by conditional sampling with adaptive steps: I.
Papaioannou, W. Betz, K. Zwirglmaier, D. Straub, "MCMC algorithms for subset simulation",
Probabilistic Engineering Mechanics 41 (2015). A proposal is distributed as declared, given the
state; it is accepted if its value is at or below the threshold. Steps adapt after every wave of
proposals to the acceptance rate that the same paper recommends, ever less: they depend on the
chains' past, but the less the longer.

Noise within a flight follows from seeds. If every proposal had others, the same point would have
another value each time, and no chain could stay below a threshold. So the noise is part of the
state, the event is one of inputs and noise together, and its probability is that of the plain
study. It has two parts:

- a blend: (seed, weight) pairs. Each seed stands for a whole series of independent standard normal
  numbers, and the noise is their weighted sum. The squares of the weights add up to 1, so that the
  sum is standard normal, too. A move takes all weights times sqrt(1 - step^2), and adds a new seed
  with the weight step: the same small steps as those of the inputs, in as many dimensions as a
  flight has random numbers, at the price of one seed (preconditioned Crank-Nicolson; S. L. Cotter,
  G. O. Roberts, A. M. Stuart, D. White, "MCMC methods for functions: modifying old algorithms to
  make them faster", Statistical Science 28 (2013)).
- a seed of its own, for what cannot be blended: JSBSim makes its turbulence from a seed alone. It
  is kept while the others move (common random numbers), and some of the moves renew it alone, as
  one coordinate without neighbours, sampled anew and accepted by the same rule. Where it decides,
  renewals are seldom accepted (``Level.renewed_accepted`` says how often), chains depend on the few
  seeds that they began with, and the estimates of repeated simulations scatter more, which their
  interval shows.

Each move is one of the inputs, the blend or the seed, the others being kept: a flight bears steps
of its wind or start that are many times as large as those of all its noise at once. Steps of inputs
and blend adapt apart, and are never smaller than ``SCALE_MIN``. How near a flight comes is a rugged
function of them, of which smaller steps are accepted hardly more often, and lead nowhere.

A simulation is a generator: it yields the points of a whole wave, and is sent their values. So any
number of processes can evaluate them, several simulations can go in step, and the result depends on
the generator of the random numbers alone.

What several subset simulations say together: probability and interval, the same over the
threshold, and the inputs' shares.

Estimates of a simulation are skewed, about log-normal. So the mean of the distribution is estimated
from their logarithms, with the interval of Cox for the mean of a log-normal distribution, which for
few values takes Student's t: U. Olsson, "Confidence intervals for the mean of a log-normal
distribution", Journal of Statistics Education 13 (2005). Its deviation is that between the repeats,
or that which Au and Beck's formula gives within them (for correlated chains, levels independent),
whichever is larger: neither a lucky agreement of few repeats nor chains that hide their correlation
makes it narrow. Tests measure how often it holds what is true.

Where a simulation has reached no event, its estimate is 0 and its logarithm does not exist. There
the upper end is what it leaves open: with 0 of n chains of its last level in the event, 1 - (1 -
confidence)^(1/n) of that level's probability, as Clopper and Pearson have it. States of one chain
are alike, and so are chains that began at copies of one state: n is the number of different states
that they began at. If no simulation has reached any, all are judged at the threshold that even the
least of them has reached: where some came much nearer than others, the probability of that
threshold scatters, and the bound is the larger.

What all simulations have in their first levels needs none of that: together these are a plain
sample (Clopper and Pearson).
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
    counted,
    named,
    share,
    without_nan,
)

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.int64]


@dataclass(slots=True, kw_only=True)
class Counts:
    """What was tried for the sample of a level.

    Attributes
    ----------
    evaluated : number of points whose values were asked for
    moved, accepted : moves of the inputs, and those that were accepted
    blended, blended_accepted : moves of the blended noise, and those that were accepted
    renewed, renewed_accepted : renewals of a seed on which the value depends, and those that were
        accepted
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
    below : values of the sample are at or below this; infinite for the first level
    threshold : that of the next level; 0 for the last one
    probability : fraction of the sample that passes ``threshold``: at or below it, and for the last
        level below 0 [-]
    variation : coefficient of variation of ``probability``, with the correlation within chains [-]
    points : shape (n, inputs), in the unit cube: positions of the inputs in their distributions
    dummies : shape (n, ``DUMMIES``), likewise
    values : shape (n,); infinite where there is none
    chains : number of the chain of each, shape (n,)
    counts : of what was tried
    scale, noise_scale : of the steps of inputs and of the blend at the end of the level [-]
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
        """Return from how many different states its chains began: of states that passed, some are
        copies of one that stayed.
        """
        _, first = np.unique(self.chains, return_index=True)
        return len(np.unique(np.column_stack([self.points[first], self.values[first]]), axis=0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Simulation:
    """One subset simulation.

    Attributes
    ----------
    levels : the first of them plain
    stalled : whether no threshold below the last one could be found, because all of a level has one
        value
    """

    levels: tuple[Level, ...]
    stalled: bool

    @property
    def reached(self) -> float:
        """Return the estimate of the probability of the last level [-]."""
        return math.prod(level.probability for level in self.levels[:-1])

    @property
    def reached_variation(self) -> float:
        """Return the coefficient of variation of ``reached`` [-]; see ``below``."""
        return math.sqrt(sum(level.variation**2 for level in self.levels[:-1]))

    def below(self, value: float) -> tuple[float, float]:
        """Return the estimate of the probability of values below ``value``, and its coefficient of
        variation [-].

        The coefficient is that of Au and Beck (2001), as if levels were independent; infinite where
        none is below.
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
    """Return the coefficient of variation of the fraction of a level that has an event [-], by Au
    and Beck (2001).

    Parameters
    ----------
    event : which states have it, shape (n,), those of each chain in their order
    chains : number of the chain of each state, shape (n,)

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
            # Twice the covariance at this lag, by the number of pairs that have it.
            factor += (
                2.0
                * float(np.sum(centred[lag:][together] * centred[:-lag][together]))
                / (count * every)
            )
    return math.sqrt((1.0 - share) / (share * count) * max(factor, 1.0))


ACCEPTANCE = 0.44
"""Acceptance rate that steps adapt to: Papaioannou et al. (2015)."""

FIRST_SCALE = 0.6
"""Scale of the steps before any adaptation, as in the same paper."""

SCALE_MIN = 0.2
"""Least scale of the steps: in 3,400 flights without a limit it fell to 0.01, and chains stood
still at about 0.3 m.
"""

SCALE_MAX = 1e3
"""Where all proposals are accepted the scale would grow without end; every step is at its largest,
1, long before.
"""

RENEWALS, BLENDS = 0.2, 0.3
"""Fractions of the moves that renew the seed, and that move the blend: of the nine of a chain about
two, and three.
"""

DUMMIES = 5
"""Coordinates without any effect beside those of the inputs: what their distribution seems to show
is chance.
"""

SEEDS = 2**32
"""Number of different seeds, as many as other flights have."""

Point = tuple[float, ...]
"""Positions of the inputs in their distributions, from 0 to 1; then, with noise, the seed, and seed
and weight of each part of the blend."""

Simulating = Generator[list[Point], Array, Simulation]
"""A simulation that runs: it yields points to be evaluated, is sent their values, and returns its
result.
"""


@dataclass(slots=True, kw_only=True)
class _States:
    """States of chains: normal coordinates of inputs and dummies, what follows them in a point, and
    values.
    """

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
    """What a subset simulation is made of.

    Attributes
    ----------
    dimension : number of inputs
    noise : whether points have noise
    flights : points of each level
    conditional_probability : fraction of a level that passes its threshold, about [-]
    levels_max : levels at most, the first one among them
    allowed : whether inputs, shape (dimension,) in the unit cube, can be sampled: the distribution
        is the declared one among these
    seeded : whether the value at such inputs depends on the seed; where it does not, a new seed is
        taken without an evaluation
    """

    dimension: int
    noise: bool
    flights: int
    conditional_probability: float
    levels_max: int
    allowed: Callable[[Array], bool] = field(default=lambda _: True)
    seeded: Callable[[Array], bool] = field(default=lambda _: True)

    def run(self, generator: np.random.Generator) -> Simulating:
        """Yield the points of a wave, take their values; infinite for a point that has none, which
        passes no threshold.
        """
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
        """Have a plain random sample evaluated."""
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
        """Grow a chain from each seed, all in step, until they are as many states as a level has;
        return these and their chains.
        """
        # In random order: the chains that get one state more than others are not always those of
        # the same seeds.
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
        """Propose a move of each chain; return the states after it."""
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
        asked = np.flatnonzero(
            renewed | blended | (moved & np.array([self.allowed(at) for at in inputs]))
        )
        values = np.where(known, states.values, math.inf)
        if len(asked):
            values[asked] = yield self._points(normal[asked], [noise[i] for i in asked])
        accepted = values <= threshold
        counts.evaluated += len(asked)
        counts.outside += count - len(asked) - int(np.count_nonzero(known))
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
    """Return what so many values are at or below, half way to the next greater one.

    Chains repeat states. A threshold at one of them, all of whose repetitions pass, would be too
    low for the fraction that passes, by half of these.
    """
    least = float(np.sort(values)[passing - 1])
    above = float(np.min(values[values > least], initial=math.inf))
    between = 0.5 * (least + above)
    # An event begins at 0: from a value that has it there is no half way to one that has not.
    return between if math.isfinite(above) and (least < 0.0) == (between < 0.0) else least


def _seeds(generator: np.random.Generator, count: int) -> list[float]:
    seeds: list[float] = generator.integers(SEEDS, size=count).astype(np.float64).tolist()
    return seeds


def _adapted(scale: float, moved: int, accepted: int, wave: int) -> float:
    """Return the scale of steps after a wave of them."""
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
    """Return noise whose blend has moved by a step towards that of a new seed."""
    kept = math.sqrt(1.0 - step**2)
    parts = [(noise[i], kept * noise[i + 1]) for i in range(1, len(noise), 2)] if kept else []
    return (noise[0], *(number for part in parts for number in part), seed, step)


CURVE_POINTS = 80
"""Thresholds at which the probability is given."""

BINS = 20
"""Classes of the histogram of an input."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RareProbability:
    """A probability, estimated by several simulations.

    Attributes
    ----------
    estimate : [-]; the mean of the estimates where some of them are 0
    low, high : two-sided interval [-]
    upper : one-sided bound [-]
    reached : number of simulations that have reached the event
    """

    estimate: float
    low: float
    high: float
    upper: float
    reached: int


@dataclass(frozen=True, slots=True, kw_only=True)
class InputShift:
    """How an input is distributed near the event, against how it is declared.

    Attributes
    ----------
    key : of the input
    distance : largest difference of the two cumulative distributions, of Kolmogorov [-]
    median, median_near : medians as declared and near the event; None for words
    edges : of the classes, one more than there are; empty for words
    names : of the classes, for words; otherwise empty
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
    """Return the probability of values below ``value``, by all simulations together.

    Parameters
    ----------
    simulations : repeats, three at least, with their own random numbers
    confidence : of the interval, and of the one-sided bound, between 0 and 1
    value : below 0 there is no level, and the last one gives what it has
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
    """Return a probability that is not rare: first levels are plain samples, of which there is an
    exact interval.
    """
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
    """Return an upper bound where some simulations have not reached the event.

    What may go wrong is shared equally between the probability of the last levels and the fraction
    of these.
    """
    half = 0.5 + 0.5 * confidence
    chains = [simulation.levels[-1].beginnings for simulation in simulations]
    if not estimates.any():
        common = max(simulation.levels[-1].below for simulation in simulations)
        if math.isinf(common):
            # A simulation has a plain sample alone; all together have at least these.
            return upper_bound(
                0, sum(len(simulation.levels[0].values) for simulation in simulations), confidence
            )
        # The next number above it: states at the threshold belong to it.
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
    """Return the probability with this logarithm; estimates that scatter by decades have means and
    bounds beyond any number.
    """
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
    """Return the probability of values below each of some thresholds, from the lowest that all
    simulations have reached.
    """
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
    """Return of each simulation the indices of what its last level has below 0, or of all of it, if
    no simulation has any.
    """
    inside = [np.flatnonzero(simulation.levels[-1].values < 0.0) for simulation in simulations]
    every = [np.arange(len(simulation.levels[-1].values)) for simulation in simulations]
    return list(
        zip(simulations, inside if any(len(chosen) for chosen in inside) else every, strict=True)
    )


def input_shifts(
    declared: pd.DataFrame, near: pd.DataFrame, at: tuple[Array, Array]
) -> list[InputShift]:
    """Return how the inputs near the event differ from those that are declared, the largest
    distance first.

    Parameters
    ----------
    declared, near : values of the inputs of the first levels and of those near the event, a column
        per input
    at : the same in the unit cube, shapes (n, inputs)
    """
    shifts = [
        _shift(str(key), declared[key], near[key], distance(at[0][:, i], at[1][:, i]))
        for i, key in enumerate(declared.columns)
    ]
    return sorted(shifts, key=lambda shift: -shift.distance)


def noise_floor(simulations: Sequence[Simulation]) -> float:
    """Return the largest distance of what has no effect at all: that of the dummies, which move
    with the same chains.
    """
    first = np.concatenate([simulation.levels[0].dummies for simulation in simulations])
    last = np.concatenate(
        [simulation.levels[-1].dummies[chosen] for simulation, chosen in near_event(simulations)]
    )
    return max(distance(first[:, i], last[:, i]) for i in range(first.shape[1]))


def distance(one: Array, other: Array) -> float:
    """Return the largest difference of two cumulative distributions, of Kolmogorov and Smirnov [-]."""
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
    counted = [tuple(float((values == name).mean()) for name in names) for values in words]
    return InputShift(
        key=key,
        distance=found,
        median=None,
        median_near=None,
        edges=(),
        names=names,
        declared=counted[0],
        near=counted[1],
    )


def subset_statistics(
    rows: pd.DataFrame,
    simulations: Sequence[Simulation],
    shifts: Sequence[InputShift],
    *,
    confidence: float,
) -> Json:
    """Return the content of ``statistics.json``; NaN becomes None.

    Flights of the first levels are a plain random sample, which gives a bound by itself. Of those
    that have no measurement, or were lost without a violation, nobody knows where they would have
    gone: the pessimistic bound takes their probability as that of violations, too.

    Parameters
    ----------
    rows : columns ``COLUMNS`` of the summary, a row per flight in the order in which they were
        flown
    simulations : the repeats, at least three
    shifts : of the inputs
    confidence : of each interval, between 0 and 1
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
            "flights": {"done": every.flights, "measured": every.measured, "unknown": named(every)},
            "outcomes": counted(rows["outcome"]),
            "modes_at_end": counted(rows["mode_at_end"]),
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
    """Return the bound if flights of unknown end were violations; what may go wrong is shared
    equally between the two.
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
