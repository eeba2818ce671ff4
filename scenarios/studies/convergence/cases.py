"""Starts and references of the convergence study."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from gnc.analysis.turning_reference import TurningReferences
from gnc.paper import design_oscillation

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
    heading_rate_max : omega_max, all of which an oscillation may spend [rad/s]
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
