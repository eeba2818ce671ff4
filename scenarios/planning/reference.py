"""The reference that a scenario asks for: its oscillations over the speed ratio, or a circle."""

import functools
import math

import numpy as np

from gnc.errors import InfeasibleError
from gnc.reference.circling import CirclingReference
from gnc.reference.joining import JoinedOrbit
from gnc.reference.placement import PlumeAxis, distance_by_paper, distance_exact
from gnc.reference.reference import REFERENCE_SHAPES, Orbit, ReferenceShape, ReferenceStart, Swing
from gnc.reference.shapes.plain import made_plain
from scenarios.planning.limits import omega_max
from scenarios.schema.scenario import Scenario
from scenarios.schema.sections.guidance import GuidanceConfig, ReferenceConfig
from scenarios.schema.sections.world import KeepoutConfig

STEPS_MIN = 6
"""Least steps of the guidance between two crossings [-]: fewer do not show the oscillation."""

RATIO_STEPS = 48
"""Steps of nu at which orbits are tabled."""


def shape_of(reference: ReferenceConfig) -> ReferenceShape:
    """Return the shape of a reference's orbit.

    Raises
    ------
    PluginError : there is no such shape
    """
    shape: ReferenceShape = made_plain(REFERENCE_SHAPES.get(reference.shape)())
    return shape


def oscillation_at(guidance: GuidanceConfig, reference: ReferenceConfig, nu: float) -> Orbit:
    """Return the reference's oscillation at a speed ratio, or raise an InfeasibleError."""
    orbit = shape_of(reference).design(
        nu=nu,
        speed=guidance.airspeed_mps,
        vessel_heading_rate=0.0,
        heading_rate_max=omega_max(guidance),
        reserve=guidance.reserve,
        roll_rate_max=math.radians(guidance.roll_rate_max_deg_s),
    )
    steps = orbit.crossing_interval * guidance.rate_hz
    if steps < STEPS_MIN:
        raise InfeasibleError(
            f"speed ratio nu is {nu:.9g}, so near 1 that at {guidance.roll_rate_max_deg_s:g} deg/s of roll rate the reference"
            f" crosses every {orbit.crossing_interval:.2g} s, {steps:.1f} steps of the guidance; at least {STEPS_MIN} show an"
            " oscillation: fly faster, lower guidance.roll_rate_max_deg_s, or raise guidance.rate_hz"
        )
    return orbit


def swing_of(guidance: GuidanceConfig, reference: ReferenceConfig) -> Swing:
    """Return the courses of a reference that is steered, or raise an InfeasibleError."""
    return shape_of(reference).swing(
        speed=guidance.airspeed_mps,
        heading_rate=(1.0 - guidance.reserve) * omega_max(guidance),
        roll_rate_max=math.radians(guidance.roll_rate_max_deg_s),
    )


@functools.lru_cache(maxsize=8)
def orbits(
    guidance: GuidanceConfig, reference: ReferenceConfig, speed_ratio_max: float
) -> tuple[tuple[float, ...], tuple[tuple[float, float], ...]]:
    """Return periods [s] and half-widths along and across the course [m] at equal steps of nu from 0 to ``speed_ratio_max``.

    Remembered: the flights of a trial share them.
    """
    ratios = np.linspace(0.0, speed_ratio_max, RATIO_STEPS + 1).tolist()
    oscillations = [oscillation_at(guidance, reference, ratio) for ratio in ratios]
    return tuple(o.period for o in oscillations), tuple(o.half_widths() for o in oscillations)


def distance_kept(guidance: GuidanceConfig, keepout: KeepoutConfig, orbit: Orbit, axis: PlumeAxis) -> float:
    """Return r_CO [m], at which an orbit keeps the tracking allowance from the keep-out area."""
    rule = distance_by_paper if guidance.placement == "paper" else distance_exact
    distance_min = keepout.radius_m + guidance.tracking_allowance_m
    if keepout.shape == "sphere":
        return rule(orbit, axis, distance_min)
    # As far off horizontally as over a level plume.
    return rule(orbit, PlumeAxis(heading=axis.heading), distance_min) / math.cos(axis.elevation)


def joined_orbit(scenario: Scenario, orbit: Orbit, course: float) -> JoinedOrbit:
    """Return an orbit beside a vessel on a course [rad], of which a reference can be taken at any phase."""
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
            f"reference.radius_m is {radius:g} m; at {speed:g} m/s and omega_max = {speed / least:.3f} rad/s it must be at least"
            f" {least:.1f} m: widen the circle or raise omega_max"
        )
    start = ReferenceStart(north=0.0, east=0.0, course=0.0)
    return CirclingReference(start, speed=speed, heading_rate=speed / radius, time_step=1.0 / scenario.guidance.rate_hz)
