"""The oscillations of the reference point that a scenario's guidance asks for."""

import functools
import math

import numpy as np

from gnc.reference.reference import REFERENCE_SHAPES, Orbit, ReferenceShape
from scenarios.planning.limits import omega_max
from scenarios.schema.config import Guidance

RATIO_STEPS = 48
"""Steps of nu at which orbits are tabled."""


def shape_of_reference() -> ReferenceShape:
    """Return the shape of the reference's orbit."""
    return REFERENCE_SHAPES.get("sinusoid")()


def oscillation_at(guidance: Guidance, nu: float) -> Orbit:
    """Return the reference's oscillation at a speed ratio, or raise an InfeasibleError."""
    return shape_of_reference().design(
        nu=nu,
        speed=guidance.airspeed_mps,
        heading_rate_max=omega_max(guidance),
        reserve=guidance.reserve,
        vessel_heading_rate=0.0,
        roll_rate_max=math.radians(guidance.roll_rate_max_deg_s),
    )


@functools.lru_cache(maxsize=8)
def orbits(guidance: Guidance, speed_ratio_max: float) -> tuple[tuple[float, ...], tuple[tuple[float, float], ...]]:
    """Return periods [s] and half-widths along and across the course [m] at equal steps of nu from 0 to ``speed_ratio_max``.

    Remembered: the flights of a trial share them.
    """
    ratios = np.linspace(0.0, speed_ratio_max, RATIO_STEPS + 1).tolist()
    oscillations = [oscillation_at(guidance, ratio) for ratio in ratios]
    return tuple(o.period for o in oscillations), tuple(o.half_widths() for o in oscillations)
