"""The references of an ensemble, which circle, oscillate or wander; the starts beside them, and the
time to approach them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np
import numpy.typing as npt
from scipy.special import j0

from gnc.paper import LookAhead, design_oscillation

Array = npt.NDArray[np.float64]


class TurningReferences:
    """Courses of n references, in closed form: heading rates are a constant and a sum of sinusoids.

    omega_r = c + sum_k a_k sin(w_k t + p_k), so that chi_r = chi_r0 + c t - sum_k a_k/w_k (cos(w_k
    t + p_k) - cos p_k). A circle has c alone, the oscillation of equation (2) one term a = -A, w =
    omega_0, p = phi_0, a wandering course several terms, and a straight course nothing. The heading
    rate is bounded by |c| + sum |a_k|, its derivative by sum |a_k| w_k.

    Parameters
    ----------
    course : chi_r0, at time 0, shape (n,) [rad]
    rate : c, shape (n,) [rad/s]
    amplitude, frequency, phase : a_k [rad/s], w_k [rad/s] and p_k [rad], shape (terms, n);
        frequencies above 0
    """

    def __init__(
        self,
        *,
        course: npt.ArrayLike,
        rate: npt.ArrayLike,
        amplitude: npt.ArrayLike,
        frequency: npt.ArrayLike,
        phase: npt.ArrayLike,
    ) -> None:
        self.course: Array = np.array(course, dtype=float)
        self.rate: Array = np.array(rate, dtype=float)
        self.amplitude: Array = np.array(amplitude, dtype=float)
        self.frequency: Array = np.array(frequency, dtype=float)
        self.phase: Array = np.array(phase, dtype=float)
        self.swing: Array = self.amplitude / self.frequency
        self.mean_course: Array = self.course + (self.swing * np.cos(self.phase)).sum(axis=0)

    def __len__(self) -> int:
        return len(self.course)

    @property
    def anisotropy(self) -> Array:
        """Mean of cos 2(chi_r - mean course), shape (n,), from -1 to 1 [-].

        It is 0 for a circle, 1 for a straight course, and the product of J_0(2 a_k/w_k) for terms
        whose frequencies are incommensurable.
        """
        product: Array = np.prod(j0(2.0 * self.swing), axis=0)
        return np.where(self.rate == 0.0, product, 0.0)

    def take(self, which: npt.NDArray[Any]) -> Self:
        """Return the references that an index or mask selects."""
        return type(self)(
            course=self.course[which],
            rate=self.rate[which],
            amplitude=self.amplitude[:, which],
            frequency=self.frequency[:, which],
            phase=self.phase[:, which],
        )

    def course_at(self, time: Array) -> Array:
        """Return chi_r [rad], not wrapped, at a time of each reference, shape (n,) [s]."""
        course: Array = self.mean_course + self.rate * time
        if len(self.swing):
            course -= (self.swing * np.cos(self.frequency * time + self.phase)).sum(axis=0)
        return course

    def heading_rate_at(self, time: Array) -> Array:
        """Return omega_r [rad/s] at a time of each reference, shape (n,) [s]."""
        if not len(self.amplitude):
            return self.rate
        swinging = self.amplitude * np.sin(self.frequency * time + self.phase)
        rate: Array = self.rate + swinging.sum(axis=0)
        return rate


def averaged_settling_time(
    look_ahead: LookAhead,
    speed: float,
    references: TurningReferences,
    to_reference: npt.ArrayLike,
    distance: float,
) -> Array:
    """Return the time until d is ``distance``, by the averaged motion, shape (n,) [s].

    It is 0 where d starts there, and infinite for straight courses.

    With phi = 0 and d well below delta, only the part of d across chi_r decays, at the rate
    V/delta. On average over the reference's courses the part along the mean course decays at
    V/(2 delta) (1 - m), the part across it at V/(2 delta) (1 + m), with m the anisotropy. In the
    time tau with d tau = V/delta dt both decay exponentially. For a circle, m = 0, the time from
    d_0 to d_1 is [2 R ln(d_0/d_1) + epsilon (d_0^2 - d_1^2)]/V. The average is wrong for a slow
    oscillation, and the expansion is rough near d = delta.

    Parameters
    ----------
    look_ahead, speed : of the vehicles [m/s]
    references : of n vehicles
    to_reference : d at the start, north and east, shape (2, n) [m]
    distance : at the end, above 0 [m]
    """
    north, east = np.asarray(to_reference, dtype=float)
    cos_m, sin_m = np.cos(references.mean_course), np.sin(references.mean_course)
    anisotropy = references.anisotropy
    along, across = (north * cos_m + east * sin_m) ** 2, (east * cos_m - north * sin_m) ** 2
    along_rate, across_rate = 1.0 - anisotropy, 1.0 + anisotropy
    target = distance * distance
    start = along + across
    settled = start <= target
    slowest = np.minimum(along_rate, across_rate)
    possible = (slowest > 0.0) & ~settled
    # Bisection for the tau at which d^2 is the target; d^2 decays at least at the slowest rate.
    later = np.zeros_like(start)
    np.divide(np.log(np.maximum(start / target, 1.0)), slowest, out=later, where=possible)
    earlier = np.zeros_like(start)
    for _ in range(60):
        middle = 0.5 * (earlier + later)
        squared = along * np.exp(-along_rate * middle) + across * np.exp(-across_rate * middle)
        above = squared > target
        earlier = np.where(above, middle, earlier)
        later = np.where(above, later, middle)
    # The integral of d^2 over tau.
    area = np.zeros_like(start)
    for part, rate in ((along, along_rate), (across, across_rate)):
        area += part * np.divide(-np.expm1(-rate * later), rate, out=later.copy(), where=rate > 0.0)
    time: Array = (look_ahead.radius * later + look_ahead.epsilon * area) / speed
    return np.where(settled, 0.0, np.where(possible, time, np.inf))


# ---------------------------------------------------------------- Starts and references at random

REFERENCES = ("circle", "oscillation", "random")
"""Kinds of reference, cycled through the trajectories."""

CIRCLE_HEADING_RATES = (0.05, 0.5)
"""|omega_r| of circles, uniform, to either side [rad/s]."""
OSCILLATION_NU_MAX = 0.95
"""Speed ratios of oscillations are uniform from 0 to this [-]."""
OSCILLATION_ROLL_RATE_MAX = math.radians(40.0)
"""Roll rate that oscillations are designed for [rad/s]."""
RANDOM_TERMS = 4
"""Number of sinusoids in a random heading rate."""
RANDOM_HEADING_RATES = (0.1, 0.5)
"""Bound of a random heading rate, uniform, split at random among its sinusoids [rad/s]."""
RANDOM_FREQUENCIES = (0.05, 1.0)
"""Frequencies of a random heading rate, log-uniform [rad/s]."""


class Term(NamedTuple):
    """A sinusoid of the reference's heading rate: amplitude [rad/s], frequency [rad/s] and phase
    [rad].
    """

    amplitude: float
    frequency: float
    phase: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One trajectory's start and reference.

    Attributes
    ----------
    trajectory : its number
    kind : kind of its reference, one of ``REFERENCES``
    north, east : the vehicle's start from the reference's [m]
    course : chi at the start [rad]
    reference_course : chi_r at the start [rad]
    rate : constant part of omega_r [rad/s]
    terms : sinusoids that are added to it
    """

    trajectory: int
    kind: str
    north: float
    east: float
    course: float
    reference_course: float
    rate: float
    terms: tuple[Term, ...]


def draw_case(
    seed: int, trajectory: int, distance_max: float, speed: float, heading_rate_max: float
) -> Case:
    """Return a trajectory's start and reference, which depend on the arguments alone.

    Parameters
    ----------
    seed, trajectory : of the study, and which of it
    distance_max : radius of the disc of starts [m]
    speed : of vehicle and reference [m/s]
    heading_rate_max : omega_max; an oscillation may use all of it [rad/s]
    """
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(trajectory,)))
    kind = REFERENCES[trajectory % len(REFERENCES)]
    distance, bearing = distance_max * math.sqrt(rng.random()), rng.uniform(-math.pi, math.pi)
    course, reference_course = rng.uniform(-math.pi, math.pi, 2).tolist()
    rate = 0.0
    terms: tuple[Term, ...] = ()
    if kind == "circle":
        rate = math.copysign(rng.uniform(*CIRCLE_HEADING_RATES), rng.random() - 0.5)
    elif kind == "oscillation":
        oscillation = design_oscillation(
            nu=rng.uniform(0.0, OSCILLATION_NU_MAX),
            speed=speed,
            heading_rate_max=heading_rate_max,
            roll_rate_max=OSCILLATION_ROLL_RATE_MAX,
        )
        terms = (Term(-oscillation.amplitude, oscillation.omega_0, rng.uniform(-math.pi, math.pi)),)
    else:
        amplitudes = rng.uniform(*RANDOM_HEADING_RATES) * rng.dirichlet(np.ones(RANDOM_TERMS))
        slowest, fastest = RANDOM_FREQUENCIES
        frequencies = slowest * (fastest / slowest) ** rng.random(RANDOM_TERMS)
        phases = rng.uniform(-math.pi, math.pi, RANDOM_TERMS)
        terms = tuple(map(Term, amplitudes.tolist(), frequencies.tolist(), phases.tolist()))
    return Case(
        trajectory=trajectory,
        kind=kind,
        north=distance * math.cos(bearing),
        east=distance * math.sin(bearing),
        course=course,
        reference_course=reference_course,
        rate=rate,
        terms=terms,
    )


def references_of(cases: Sequence[Case]) -> TurningReferences:
    """Return the references of cases of one kind."""
    terms = (
        np.array([case.terms for case in cases], dtype=float)
        .reshape(len(cases), -1, 3)
        .transpose(1, 2, 0)
    )
    return TurningReferences(
        course=[case.reference_course for case in cases],
        rate=[case.rate for case in cases],
        amplitude=terms[:, 0],
        frequency=terms[:, 1],
        phase=terms[:, 2],
    )
