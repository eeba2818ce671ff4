"""Rare events whose probabilities are known, and subset simulations of them."""

import math

import numpy as np
from scipy.special import ndtr, ndtri

from scenarios.statistics.subset_simulation import SubsetSimulation

DIMENSION = 10


def normal(points):
    """Return the normal coordinates of the inputs of points."""
    return ndtri(np.clip(np.array([point[:DIMENSION] for point in points]), 1e-16, 1.0 - 1e-16))


def linear(probability):
    """Return a value that is below 0 with this probability: a plane at the distance beta =
    -Phi^-1(p) from the origin.
    """
    return lambda points: -ndtri(probability) - normal(points).sum(axis=1) / math.sqrt(DIMENSION)


def four_branches(distance):
    """Return the series system of four branches, in the first two of the inputs, which is below 0
    in four directions.

    L. Schueremans, D. Van Gemert, "Benefit of splines and neural networks in simulation based
    structural reliability analysis", Structural Safety 27 (2005), with 3 replaced by ``distance``
    and 6/sqrt(2) by sqrt(2) ``distance``.
    """

    def value(points):
        u = normal(points)
        difference, together = u[:, 0] - u[:, 1], (u[:, 0] + u[:, 1]) / math.sqrt(2.0)
        branches = [
            distance + 0.1 * difference**2 - together,
            distance + 0.1 * difference**2 + together,
            difference + math.sqrt(2.0) * distance,
            -difference + math.sqrt(2.0) * distance,
        ]
        return np.min(branches, axis=0)

    return value


def four_branches_probability(distance):
    """Return the probability of a value below 0, by integration.

    With a = (u1 - u2)/sqrt(2) and b = (u1 + u2)/sqrt(2), which are standard normal and independent:
    |b| above distance + 0.2 a^2, or |a| above distance.
    """
    a = np.linspace(-distance, distance, 20_001)
    density = np.exp(-0.5 * a**2) / math.sqrt(2.0 * math.pi)
    inner = np.trapezoid(density * 2.0 * ndtr(-(distance + 0.2 * a**2)), a)
    return float(2.0 * ndtr(-distance) + inner)


def noisy(probability, *, seed_share, blend_share):
    """Return a value that is below 0 with this probability, of whose variance seed and blend have
    these shares.
    """

    def hashed(seeds):
        """Return a standard normal number of each seed: that of the generator's first number would
        take too long.
        """
        mixed = (np.asarray(seeds).astype(np.uint64) + np.uint64(0x9E3779B97F4A7C15)) & np.uint64(
            2**64 - 1
        )
        for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
            mixed = (mixed ^ (mixed >> np.uint64(shift))) * np.uint64(factor)
        return ndtri(((mixed ^ (mixed >> np.uint64(31))).astype(np.float64) + 0.5) / 2.0**64)

    def value(points):
        inputs = normal(points).sum(axis=1) / math.sqrt(DIMENSION)
        seed = hashed([point[DIMENSION] for point in points])
        # Blends have different numbers of parts: all of them in one row, of which each begins where
        # the one before it ends.
        parts = np.concatenate([point[DIMENSION + 1 :] for point in points])
        begins = np.cumsum([0] + [(len(point) - DIMENSION - 1) // 2 for point in points[:-1]])
        blend = np.add.reduceat(hashed(parts[::2]) * parts[1::2], begins)
        shares = (1.0 - seed_share - blend_share, seed_share, blend_share)
        parts = zip(shares, (inputs, seed, blend), strict=True)
        return -ndtri(probability) - np.sum(
            [math.sqrt(share) * part for share, part in parts], axis=0
        )

    return value


def simulated(value, seed, *, flights=500, conditional=0.1, levels=9, noise=False, **functions):
    """Return a subset simulation of a value, and how many points were evaluated."""
    simulation = SubsetSimulation(
        dimension=DIMENSION,
        noise=noise,
        flights=flights,
        conditional_probability=conditional,
        levels_max=levels,
        **functions,
    )
    running = simulation.run(np.random.default_rng(seed))
    points, evaluated = next(running), 0
    while True:
        evaluated += len(points)
        try:
            points = running.send(value(points))
        except StopIteration as end:
            return end.value, evaluated
