"""The reference of a scenario: its oscillations over the speed ratio, or a circle."""

import functools
import math
from typing import Any

import numpy as np

from common.plugins import call_plugin, passed
from gnc.errors import InfeasibleError
from gnc.paper import PlumeAxis, distance_by_paper, distance_exact, reach
from gnc.reference.builtin_floats import BuiltinFloats, with_builtin_floats
from gnc.reference.oscillating import JoinedOrbit
from gnc.reference.reference import (
    REFERENCE_SHAPES,
    CirclingReference,
    Orbit,
    ReferenceShape,
    Swing,
)
from scenarios.planning.limits import omega_max
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.guidance import GuidanceConfig, ReferenceConfig
from scenarios.scenario.sections.world import KeepoutConfig

STEPS_MIN = 6
"""Least steps of the guidance between two crossings [-]: fewer do not show the oscillation."""

RATIO_STEPS = 48
"""Steps of nu at which orbits are tabled."""

_REACH_POINTS = 513
"""Number of points of an orbit at which its reach is computed [-]: the error is below 1e-4 of its
width.
"""

_REACH_ROUNDING = 1e-6
"""Excess over (11) that counts as rounding, where (11) is exact: a plume abeam or astern [m]."""

_OF_ORBIT = ("nu", "speed", "eta", "omega_0", "amplitude", "period", "crossing_interval")
"""Numbers that an orbit has."""

_OF_SWING = ("eta", "frequency", "course", "slopes", "offset")
"""Methods that a shape's courses have."""


def shape_of(reference: ReferenceConfig) -> ReferenceShape:
    """Return the shape of a reference's orbit.

    Raises
    ------
    PluginError : there is no such shape, or it cannot be made
    """
    made = call_plugin(_named(reference), REFERENCE_SHAPES.get(reference.shape), result=_shape)
    shape: ReferenceShape = with_builtin_floats(made)
    return shape


def _shape(made: Any) -> Any:
    if not _is_number(getattr(made, "turn_rate_fraction_until_tracked", None)):
        raise TypeError(
            "a shape with a number turn_rate_fraction_until_tracked, the fraction of its heading"
            " rate that the reference turns with until it is tracked [-], 1.0 as the sinusoid has"
        )
    return made


def _is_number(found: object) -> bool:
    return isinstance(found, int | float | np.number) and bool(np.isfinite(found))


def _named(reference: ReferenceConfig) -> str:
    return f"reference.shape '{reference.shape}'"


def oscillation_at(guidance: GuidanceConfig, reference: ReferenceConfig, nu: float) -> Orbit:
    """Return the reference's oscillation at a speed ratio.

    Raises
    ------
    InfeasibleError : it has none
    PluginError : a shape of a user's own failed, or returned none
    """
    part, shape = _named(reference), shape_of(reference)
    own = isinstance(shape, BuiltinFloats)
    orbit: Orbit = call_plugin(
        part,
        shape.design,
        result=_orbit if own else passed,
        nu=nu,
        speed=guidance.airspeed_mps,
        vessel_heading_rate=0.0,
        heading_rate_max=omega_max(guidance),
        reserve=guidance.reserve,
        roll_rate_max=math.radians(guidance.roll_rate_max_deg_s),
    )
    if own:
        call_plugin(part, orbit.offset, np.zeros(1))
        call_plugin(part, orbit.half_widths)
    steps = orbit.crossing_interval * guidance.rate_hz
    if steps < STEPS_MIN:
        raise InfeasibleError(
            f"speed ratio nu is {nu:.9g}, so near 1 that at {guidance.roll_rate_max_deg_s:g} deg/s"
            " of roll rate the reference"
            f" crosses every {orbit.crossing_interval:.2g} s, {steps:.1f} steps of the guidance; at"
            f" least {STEPS_MIN} show an"
            " oscillation: fly faster, lower guidance.roll_rate_max_deg_s, or raise"
            " guidance.rate_hz"
        )
    return orbit


def _orbit(found: Any) -> Any:
    """Return the design of a user's shape, which has to be an orbit."""
    has_numbers = all(_is_number(getattr(found, name, None)) for name in _OF_ORBIT)
    if not has_numbers or not isinstance(getattr(found, "symmetric", None), bool | np.bool_):
        raise TypeError(
            f"an orbit, with finite {', '.join(_OF_ORBIT)}, and symmetric, true or false"
        )
    return found


def _swing(found: Any) -> Any:
    if not all(callable(getattr(found, name, None)) for name in _OF_SWING):
        raise TypeError(f"courses, with the methods {', '.join(_OF_SWING)}")
    return found


def swing_of(guidance: GuidanceConfig, reference: ReferenceConfig) -> Swing:
    """Return the courses of a reference that is steered.

    Raises
    ------
    InfeasibleError : it cannot be
    PluginError : a shape of a user's own failed, or returned none
    """
    part, shape = _named(reference), shape_of(reference)
    swing: Swing = call_plugin(
        part,
        shape.swing,
        result=_swing,
        speed=guidance.airspeed_mps,
        heading_rate=(1.0 - guidance.reserve) * omega_max(guidance),
        roll_rate_max=math.radians(guidance.roll_rate_max_deg_s),
    )
    return swing


@functools.lru_cache(maxsize=8)
def orbits(
    guidance: GuidanceConfig, reference: ReferenceConfig, speed_ratio_max: float
) -> tuple[tuple[float, ...], tuple[tuple[float, float], ...]]:
    """Return periods [s] and half-widths along and across the course [m] at equal steps of nu from
    0 to ``speed_ratio_max``.

    Remembered: the flights of a trial share them.
    """
    ratios = np.linspace(0.0, speed_ratio_max, RATIO_STEPS + 1).tolist()
    oscillations = [oscillation_at(guidance, reference, ratio) for ratio in ratios]
    return tuple(o.period for o in oscillations), tuple(o.half_widths() for o in oscillations)


def distance_kept(
    guidance: GuidanceConfig, keepout: KeepoutConfig, orbit: Orbit, axis: PlumeAxis
) -> float:
    """Return r_CO [m], at which an orbit keeps the tracking allowance from the keep-out area.

    The paper's rule is for orbits for which its reach holds; others are placed exactly.
    """
    by_paper = guidance.placement == "paper" and _reach_holds(orbit, axis)
    rule = distance_by_paper if by_paper else distance_exact
    distance_min = keepout.radius_m + guidance.tracking_allowance_m
    if keepout.shape == "sphere":
        return rule(orbit, axis, distance_min)
    # The horizontal distance is that for a level plume.
    return rule(orbit, PlumeAxis(heading=axis.heading), distance_min) / math.cos(axis.elevation)


def _reach_holds(orbit: Orbit, axis: PlumeAxis) -> bool:
    """Return whether the reach by (11) holds for an orbit, so that (10) keeps it out.

    The half-widths do not describe an orbit that reaches farther on one side than on the other. For
    orbits with equal halves, (11) is an upper bound for a figure of eight, which is wider than
    long; for a user's orbit it may be too small.
    """
    if not orbit.symmetric:
        return False
    along, across = orbit.offset(np.linspace(0.0, orbit.period, _REACH_POINTS))
    towards = -along * math.cos(axis.heading) - across * math.sin(axis.heading)
    return float(np.max(towards)) <= reach(orbit, axis) + _REACH_ROUNDING


def joined_orbit(scenario: Scenario, orbit: Orbit, course: float) -> JoinedOrbit:
    """Return an orbit beside a vessel on a course [rad], from which a reference can be taken at any
    phase.
    """
    shape, time_step = shape_of(scenario.reference), 1.0 / scenario.guidance.rate_hz
    return JoinedOrbit(shape=shape, orbit=orbit, vessel_course=course, time_step=time_step)


def circle(scenario: Scenario) -> CirclingReference:
    """Return the reference that circles from the origin, to the right.

    Raises
    ------
    InfeasibleError : the circle is tighter than omega_max allows
    """
    speed, radius = scenario.guidance.airspeed_mps, scenario.reference.radius_m
    least = speed / omega_max(scenario.guidance)
    if radius < least:
        raise InfeasibleError(
            f"reference.radius_m is {radius:g} m; at {speed:g} m/s and omega_max ="
            f" {speed / least:.3f} rad/s it must be at least"
            f" {least:.1f} m: widen the circle or raise omega_max"
        )
    return CirclingReference(
        speed=speed, heading_rate=speed / radius, time_step=1.0 / scenario.guidance.rate_hz
    )
