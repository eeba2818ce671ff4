"""Measures how a path keeps out of a sphere or an upright cylinder about a moving point, or of the
surroundings of a hull that moves and turns.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicHermiteSpline

from common.hull import ShipHull, ship_frame
from scenarios.scenario.sections.world import Shape

Array = npt.NDArray[np.float64]

_LOOKS = 10
"""Looks at a path between two of its samples, where its distance from a hull is no polynomial [-].
"""

_BINOMIAL = [math.comb(3, i) for i in range(4)]


@dataclass(frozen=True, slots=True, kw_only=True)
class KeepoutFigures:
    """Figures of the keep-out area along a path.

    Attributes
    ----------
    violations : number of separate stays inside
    time_inside : [s]
    depth : how far inside the path came [m]
    distance_min : closest approach to the centre of the sphere or to the axis of the cylinder [m]
    """

    violations: int
    time_inside: float
    depth: float
    distance_min: float


def keepout_figures(
    time: Array, position: Array, velocity: Array, radius: float, shape: Shape = "sphere"
) -> KeepoutFigures:
    """Measure a path against a sphere about the origin, or a cylinder of any height about the
    vertical through it.

    Between samples the path is the cubic through their positions and velocities, and the closest
    approach is that of the cubic. At 10 Hz and 45 degrees of bank it is true to a micrometre, and
    to 6 mm if the turn is reversed at once between two samples; a chord would be optimistic by up
    to 1.2 cm. ``check_recorded`` in ``scenarios.planning.limits`` refuses flights for which this is
    more than 5 cm.

    Parameters
    ----------
    time : shape (n,) [s]
    position : shape (n, 3), north, east and up from the centre, which moves with the vessel [m]
    velocity : shape (n, 3), its rate [m/s]
    radius : of the sphere or the cylinder [m]
    shape : which of them
    """
    squared = _squared_distance(
        time, *(values[:, : 2 if shape == "cylinder" else 3] for values in (position, velocity))
    )
    distance_min = math.sqrt(_least(squared))
    step, excess = np.diff(time), squared - radius**2
    # Where all coefficients have one sign, so has the polynomial.
    first = last = excess.max(axis=1, initial=-math.inf) < 0.0
    fraction = first.astype(np.float64)
    first, last, violations = first.copy(), last.copy(), 0
    for i in np.flatnonzero(~first & (excess.min(axis=1, initial=math.inf) < 0.0)):
        ends = np.array([0.0, *_roots(excess[i]), 1.0])
        pieces = np.diff(ends)
        inside = _value(excess[i], 0.5 * (ends[:-1] + ends[1:])) < 0.0
        inside &= pieces > 0.0
        fraction[i] = float(np.sum(pieces[inside]))
        shown = inside[pieces > 0.0]
        first[i], last[i] = shown[0], shown[-1]
        violations += int(np.count_nonzero(shown[1:] & ~shown[:-1]))
    return KeepoutFigures(
        violations=violations
        + int(np.count_nonzero(first & ~np.concatenate([[False], last[:-1]]))),
        time_inside=float(np.sum(fraction * step)),
        depth=max(0.0, radius - distance_min),
        distance_min=distance_min,
    )


def hull_keepout_figures(
    time: Array,
    position: Array,
    velocity: Array,
    radius: float,
    shape: Shape,
    hull: ShipHull,
    heading: Callable[[Array], Array],
) -> KeepoutFigures:
    """Measure a path against the area within a radius of a hull's outline, at the height of the
    funnel's mouth (sphere) or at every height (cylinder).

    The path between samples is evaluated ``_LOOKS`` times: at 10 Hz and 30 m/s its closest approach
    to a corner at 200 m is true to 0.1 mm.

    Parameters
    ----------
    time, position, velocity, radius, shape : as in ``keepout_figures``, from the funnel
    hull : seen from the funnel
    heading : returns the ship's heading at some times [rad]
    """
    share = np.arange(len(time) * _LOOKS - _LOOKS + 1) / _LOOKS
    fine = np.interp(share, np.arange(len(time)), time)
    place = CubicHermiteSpline(time, position, velocity)(fine)
    distance = hull_distance(hull, place, heading(fine), shape)
    inside = distance < radius
    excess, step = distance - radius, np.diff(fine)
    # If the edge is crossed between two looks, the share of that time spent inside.
    before, after = excess[:-1], excess[1:]
    crossed = inside[:-1] != inside[1:]
    within = np.minimum(before, after) / np.where(crossed, -np.abs(after - before), 1.0)
    part = np.where(crossed, within, inside[:-1].astype(np.float64))
    nearest = float(distance.min())
    return KeepoutFigures(
        violations=int(np.count_nonzero(inside[1:] & ~inside[:-1])) + int(inside[0]),
        time_inside=float(np.sum(part * step)),
        depth=max(0.0, radius - nearest),
        distance_min=nearest,
    )


def hull_distance(hull: ShipHull, position: Array, heading: Array, shape: Shape) -> Array:
    """Return how far places are from a hull's outline, shape (n,) [m].

    Parameters
    ----------
    hull : seen from the funnel
    position : shape (n, 3), north, east and up from the funnel's mouth [m]
    heading : of the ship at each, shape (n,) [rad]
    shape : a sphere counts the height, a cylinder does not
    """
    level = hull.distance(*ship_frame(position[:, 0], position[:, 1], heading))
    distance: Array = level if shape == "cylinder" else np.hypot(level, position[:, 2])
    return distance


def closest_approach(time: Array, position: Array, velocity: Array) -> float:
    """Return the least distance of a path from the origin [m], exact between samples; parameters of
    any number of dimensions.
    """
    return math.sqrt(_least(_squared_distance(time, position, velocity)))


def _squared_distance(time: Array, position: Array, velocity: Array) -> Array:
    """Return the squared distance from the origin between samples: Bernstein coefficients of degree
    6, shape (n - 1, 7).

    The cubic through positions and velocities is a Bezier curve, and the coefficients of its square
    bound it from both sides.
    """
    # A row for each component: to sum three numbers in each of a thousand rows takes longer than to
    # add three rows.
    points = bezier_points(time, np.ascontiguousarray(position.T), np.ascontiguousarray(velocity.T))
    products = {
        (i, j): np.sum(points[i] * points[j], axis=0) for i in range(4) for j in range(i, 4)
    }
    squared = np.zeros((7, len(time) - 1))
    for i in range(4):
        for j in range(4):
            weight = _BINOMIAL[i] * _BINOMIAL[j] / math.comb(6, i + j)
            squared[i + j] += weight * products[min(i, j), max(i, j)]
    return np.ascontiguousarray(squared.T)


def _least(squared: Array) -> float:
    """Return the least value of polynomials on 0 to 1, given their Bernstein coefficients."""
    least = float(min(squared[:, 0].min(), squared[:, -1].min()))
    for coefficients in squared[squared.min(axis=1) < least]:
        # The derivative's coefficients are the differences.
        for root in _roots(np.diff(coefficients)):
            least = min(least, float(_value(coefficients, np.array([root]))[0]))
    return max(0.0, least)


def _roots(coefficients: Array) -> list[float]:
    """Return where a polynomial with these Bernstein coefficients is 0 between 0 and 1, in
    order.
    """
    degree = len(coefficients) - 1
    power = np.zeros(degree + 1)
    for k in range(degree + 1):
        differences = [(-1) ** (k - i) * math.comb(k, i) * coefficients[i] for i in range(k + 1)]
        power[k] = math.comb(degree, k) * float(np.sum(differences))
    # Leading coefficients that are only rounding errors could become arbitrarily large.
    power[np.abs(power) < 1e-14 * np.abs(power).max(initial=0.0)] = 0.0
    found = np.roots(power[::-1])
    real = found.real[np.abs(found.imag) < 1e-9]
    return sorted(float(root) for root in real if 0.0 < root < 1.0)


def _value(coefficients: Array, at: Array) -> Array:
    """Return the values of a polynomial with these Bernstein coefficients."""
    degree = len(coefficients) - 1
    terms = [
        math.comb(degree, k) * at**k * (1.0 - at) ** (degree - k) * coefficients[k]
        for k in range(degree + 1)
    ]
    return np.asarray(np.sum(terms, axis=0))


def bezier_points(time: Array, value: Array, rate: Array) -> Array:
    """Return the Bernstein coefficients of the cubics through values and rates, which each cubic
    stays within.

    Parameters
    ----------
    time : shape (n,) [s]
    value, rate : shapes (..., n), the rate per second

    Returns
    -------
    coefficients : shape (4, ..., n - 1)
    """
    third = np.diff(time) / 3.0
    first, last = value[..., :-1], value[..., 1:]
    points: Array = np.stack(
        [first, first + third * rate[..., :-1], last - third * rate[..., 1:], last]
    )
    return points
