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
"""

import math
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import ndtr

from scenarios.statistics.subset_levels import Array, Counts, Indices, Level, Simulation, variation

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
            moved, accepted = (
                counts.blended - before.blended,
                counts.blended_accepted - before.blended_accepted,
            )
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
        renewed, blended, moved = (
            kind < RENEWALS,
            (kind >= RENEWALS) & (kind < RENEWALS + BLENDS),
            kind >= RENEWALS + BLENDS,
        )
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
