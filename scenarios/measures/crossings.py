"""Where the aircraft's path cuts the plume's axis."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicHermiteSpline, PPoly

from scenarios.measures.keepout import bezier_points

Array = npt.NDArray[np.float64]

_ROUNDING = 1e-9
"""Coefficients that are 0 but for rounding, over the largest of the same cubic [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Crossing:
    """A point at which the path cuts the vertical plane through the plume's axis, on the plume's
    side of the vessel.

    Attributes
    ----------
    time : [s]
    axis_distance : along the axis from the plume's origin [m]
    distance, horizontal_distance : to the plume's origin, three-dimensional, and seen from above
        [m]
    angle : between the path in the vessel's frame and the axis, 90 degrees for a square cut [rad]
    height : above the straight axis from the plume's origin [m]; for smoke that axis is level, and
        the smoke rises above it
    """

    time: float
    axis_distance: float
    distance: float
    horizontal_distance: float
    angle: float
    height: float


def find_crossings(
    time: Array, position: Array, velocity: Array, axis: tuple[float, float], elevation: float = 0.0
) -> list[Crossing]:
    """Return every crossing, in time.

    The path between samples is the cubic through their positions and velocities; crossings are its
    roots, not samples.

    Parameters
    ----------
    time : shape (n,) [s]
    position : shape (n, 3), north, east and up from the plume's origin, which moves with the vessel
        [m]
    velocity : shape (n, 3), its rate [m/s]
    axis : unit vector along the plume, north and east
    elevation : alpha_P [rad]
    """
    axis_north, axis_east = axis
    across = axis_north * position[:, 1] - axis_east * position[:, 0]
    path = CubicHermiteSpline(time, position, velocity)
    rate = path.derivative()
    crossings = []
    moments = _roots(time, across, axis_north * velocity[:, 1] - axis_east * velocity[:, 0])
    for moment, (north, east, up), (v_north, v_east, _) in zip(
        moments.tolist(), path(moments).tolist(), rate(moments).tolist(), strict=True
    ):
        along = axis_north * north + axis_east * east
        if along <= 0.0:
            continue
        v_along = axis_north * v_north + axis_east * v_east
        v_across = axis_north * v_east - axis_east * v_north
        crossings.append(
            Crossing(
                time=moment,
                axis_distance=along / math.cos(elevation),
                distance=math.sqrt(north * north + east * east + up * up),
                horizontal_distance=math.hypot(north, east),
                angle=abs(math.atan2(abs(v_across), v_along)),
                height=up - along * math.tan(elevation),
            )
        )
    return crossings


def _roots(time: Array, across: Array, rate: Array) -> Array:
    """Return the times at which the cubic through values and their rates is 0 [s], in order; all
    shapes (n,).

    Between samples a cubic stays within its Bernstein coefficients; roots are computed only where
    these have both signs.
    """
    side, coefficients = CubicHermiteSpline(time, across, rate), bezier_points(time, across, rate)
    rounding = _ROUNDING * np.abs(coefficients).max(axis=0)
    pieces = np.flatnonzero(
        (coefficients.min(axis=0) <= rounding) & (coefficients.max(axis=0) >= -rounding)
    )
    found = [np.empty(0)]
    # Neighbouring pieces are searched together, so that a root at the sample between two counts
    # once.
    for run in np.split(pieces, np.flatnonzero(np.diff(pieces) > 1) + 1):
        if len(run):
            part = PPoly.construct_fast(
                side.c[:, run[0] : run[-1] + 1], side.x[run[0] : run[-1] + 2]
            )
            found.append(part.roots(extrapolate=False))
    moments = np.concatenate(found)
    return moments[np.isfinite(moments)]


def crossing_rows(crossings: Sequence[Crossing]) -> list[dict[str, Any]]:
    """Return a row for each crossing of a flight, numbered from 1; columns have units in their
    names.
    """
    return [
        {
            "crossing": i,
            "time_s": crossing.time,
            "axis_distance_m": crossing.axis_distance,
            "distance_m": crossing.distance,
            "horizontal_distance_m": crossing.horizontal_distance,
            "angle_deg": math.degrees(crossing.angle),
            "height_m": crossing.height,
        }
        for i, crossing in enumerate(crossings, start=1)
    ]
