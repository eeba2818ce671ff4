"""The line of parcels behind a ship, in the frame of the air mass, in which a parcel stays put."""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from measurement.errors import MeasurementError
from measurement.plume.spread import Array, Indices

WIND_MIN = 1.0
"""Least apparent wind [m/s]: below it a plume has no direction."""

_TURN = 0.15
"""Largest change of course within a block [rad], so that a place has one nearest parcel there."""

_CLOSE = 1e-7
"""Tolerance of the emission time of a nearest parcel [s]: a micrometre along the plume."""

_ITERATIONS_MAX = 60
"""Largest number of iterations of the search: it takes 3 to 6, and 35 by bisection of an hour."""


class Nearest(NamedTuple):
    """Pairs of a place and a parcel whose cross-section goes through it, arrays of shape (k,).

    Attributes
    ----------
    place : index of the place
    emitted : time at which the parcel was emitted [s]
    wind : apparent wind at that time [m/s]
    path : air that had passed the stack by then [m]
    across : place relative to the parcel, along the apparent wind turned +90 degrees north to east
        [m]
    curvature : of the line of parcels [1/m], above 0 where its centre is on the positive side
    """

    place: Indices
    emitted: Array
    wind: Array
    path: Array
    across: Array
    curvature: Array

    def where(self, chosen: npt.NDArray[np.bool_]) -> "Nearest":
        """Return the chosen pairs; ``chosen`` has shape (k,)."""
        return Nearest(self.place[chosen], *(values[chosen] for values in self[1:]))


class _Step(NamedTuple):
    """Cubics between two nodes, at several times.

    Attributes
    ----------
    north, east, path : coefficients from the constant on [m], shape (4, n)
    rest : fraction of its step that has passed at each time [-], shape (n,)
    """

    north: Array
    east: Array
    path: Array
    rest: Array


class Parcels:
    """The line of parcels that a stack leaves, as a smooth curve of emission time.

    Parameters
    ----------
    time : [s], increasing, shape (n,), n at least 2
    north, east : place of the stack in the frame of the air mass [m], shape (n,)
    interval : between the curve's nodes [s], about; between them it is a cubic

    Attributes
    ----------
    start, end : of the times [s]
    wind_min, wind_max : least and largest apparent wind [m/s]

    Raises
    ------
    MeasurementError : shapes differ, values are missing, times do not increase, or the apparent
        wind is below 1 m/s
    """

    def __init__(self, time: Array, north: Array, east: Array, interval: float) -> None:
        time, north, east = (np.asarray(values, dtype=np.float64) for values in (time, north, east))
        _check_track(time, north, east)
        count = max(1, math.ceil((time[-1] - time[0]) / interval))
        self.start, self.end = float(time[0]), float(time[-1])
        self._step = (self.end - self.start) / count
        nodes = self.start + self._step * np.arange(count + 1)
        places = np.stack([np.interp(nodes, time, north), np.interp(nodes, time, east)])
        velocities = np.gradient(places, self._step, axis=1, edge_order=min(2, count))
        speed = np.hypot(*velocities)
        weakest = int(np.argmin(speed))
        if not speed[weakest] >= WIND_MIN:
            raise MeasurementError(
                f"apparent wind is {speed[weakest]:.2f} m/s at {nodes[weakest]:.0f} s; "
                f"below {WIND_MIN:g} m/s a plume has no direction: "
                "change the speed or course of the ship or the wind"
            )
        self.wind_min, self.wind_max = float(speed.min()), float(speed.max())
        curve = cubics(places, self._step * velocities)
        middle = (curve[1] + curve[2] + 0.75 * curve[3]) / self._step
        passed = self._step / 6.0 * (speed[:-1] + 4.0 * np.hypot(*middle) + speed[1:])
        path = np.concatenate([[0.0], np.cumsum(passed)])
        path_curve = cubics(path, self._step * speed)
        # Coefficients by step, by north, east and path, and from the constant on.
        self._coefficients = np.ascontiguousarray(
            np.concatenate([curve, path_curve[:, np.newaxis]], axis=1).transpose(2, 1, 0)
        )
        ends = _blocks(np.unwrap(np.arctan2(-velocities[1], -velocities[0])))
        self._ends = nodes[ends]
        self._axes = -velocities[:, ends] / speed[ends]
        self._offsets = (self._axes * places[:, ends]).sum(axis=0)

    def path(self, time: Array) -> Array:
        """Return how much air has passed the stack at times from start to end [m]."""
        step = self._at(time)
        return cubic_value(step.path, step.rest)

    @property
    def path_end(self) -> float:
        """How much air has passed the stack in all [m]."""
        return float(self.path(np.array([self.end]))[0])

    def at(self, emitted: Array) -> tuple[Array, Array, Array]:
        """Return north, east [m] and apparent wind [m/s] of parcels by their emission time [s]."""
        step = self._at(emitted)
        speed = np.hypot(_slope(step.north, step.rest), _slope(step.east, step.rest)) / self._step
        return cubic_value(step.north, step.rest), cubic_value(step.east, step.rest), speed

    def nearest(self, north: Array, east: Array, oldest: float, newest: float) -> Nearest:
        """Return the parcels nearest to places [m], shape (m,), of an interval of emission times.

        A parcel's cross-section is the line across its apparent wind. Where the line of parcels
        bends or folds, a place can be in several cross-sections, or in none; only parcels are
        returned from which the distance grows both ways.

        Parameters
        ----------
        north, east : places in the frame of the air mass [m], shape (m,)
        oldest, newest : ends of the interval [s]
        """
        first = max(0, int(np.searchsorted(self._ends, oldest, side="right")) - 1)
        last = min(len(self._ends) - 1, int(np.searchsorted(self._ends, newest)))
        along = [
            north * self._axes[0, k] + east * self._axes[1, k] - self._offsets[k]
            for k in range(first, last + 1)
        ]
        places, brackets, guesses = [], [], []
        for k, (before, after) in enumerate(pairwise(along), start=first):
            inside = np.flatnonzero((before < 0.0) & (after >= 0.0))
            low, high = self._ends[k], self._ends[k + 1]
            places.append(inside)
            guesses.append(low + (high - low) * before[inside] / (before[inside] - after[inside]))
            brackets.append(np.broadcast_to([[low], [high]], (2, len(inside))))
        if not places:
            return Nearest(np.empty(0, dtype=np.intp), *np.empty((5, 0)))
        place = np.concatenate(places)
        return self._refined(
            place,
            north[place],
            east[place],
            np.concatenate(guesses),
            np.concatenate(brackets, axis=1),
        )

    def _refined(
        self, place: Indices, north: Array, east: Array, emitted: Array, bracket: Array
    ) -> Nearest:
        """Return the nearest parcels, found by Newton's method within brackets that shrink."""
        found = Nearest(place, *np.empty((5, len(place))))
        left: Indices | slice = slice(None)
        for _ in range(_ITERATIONS_MAX):
            step = self._at(emitted)
            to_north = north - cubic_value(step.north, step.rest)
            to_east = east - cubic_value(step.east, step.rest)
            north_rate = _slope(step.north, step.rest)
            east_rate = _slope(step.east, step.rest)
            north_bend = _bend(step.north, step.rest)
            east_bend = _bend(step.east, step.rest)
            square = north_rate**2 + east_rate**2
            along = -(to_north * north_rate + to_east * east_rate)
            change = along / (square - to_north * north_bend - to_east * east_bend) * -self._step
            speed = np.sqrt(square)
            found.emitted[left] = emitted
            found.wind[left] = speed / self._step
            found.path[left] = cubic_value(step.path, step.rest)
            found.across[left] = (to_north * east_rate - to_east * north_rate) / speed
            found.curvature[left] = (north_bend * east_rate - east_bend * north_rate) / (
                square * speed
            )
            open_ = np.flatnonzero(~(np.abs(along) * self._step <= _CLOSE * square))
            if not len(open_):
                break
            early = along[open_] < 0.0
            emitted, change, bracket = emitted[open_], change[open_], bracket[:, open_]
            bracket = np.where(early, [emitted, bracket[1]], [bracket[0], emitted])
            newton = emitted + change
            inside = (newton > bracket[0]) & (newton < bracket[1])
            emitted = np.where(inside, newton, 0.5 * (bracket[0] + bracket[1]))
            north, east = north[open_], east[open_]
            left = open_ if isinstance(left, slice) else left[open_]
        return found

    def _at(self, time: Array) -> _Step:
        """Return the cubics at times [s], shape (n,)."""
        steps = (time - self.start) / self._step
        index = np.clip(steps.astype(np.intp), 0, len(self._coefficients) - 1)
        north, east, path = self._coefficients.take(index, axis=0).transpose(1, 2, 0)
        return _Step(north, east, path, steps - index)


def check_arrays(what: str, *arrays: Array, least: int = 0) -> None:
    """Check that arrays have one dimension and length, of ``least`` or more, and finite values.

    Raises
    ------
    MeasurementError : they do not
    """
    shapes = [values.shape for values in arrays]
    if len(set(shapes)) > 1 or len(shapes[0]) != 1 or shapes[0][0] < least:
        raise MeasurementError(
            f"{what} have shapes {', '.join(map(str, shapes))}; give one length, {least} or more"
        )
    if not all(np.isfinite(values).all() for values in arrays):
        raise MeasurementError(
            f"{what} have values that are missing or infinite; remove or fill them"
        )


def _check_track(time: Array, north: Array, east: Array) -> None:
    check_arrays("times, north and east of the ship's track", time, north, east, least=2)
    if not (np.diff(time) > 0.0).all():
        first = int(np.argmax(np.diff(time) <= 0.0))
        raise MeasurementError(
            f"times of the ship's track do not increase after {time[first]:g} s; "
            "sort them and remove doubles"
        )


def cubics(values: Array, slopes: Array) -> Array:
    """Return the coefficients of cubics between nodes, from the constant on, shape (4, ..., n - 1).

    Parameters
    ----------
    values, slopes : at the nodes, slopes per step, shape (..., n)
    """
    value, slope = values[..., :-1], slopes[..., :-1]
    rise, after = np.diff(values), slopes[..., 1:]
    return np.stack([value, slope, 3.0 * rise - 2.0 * slope - after, slope + after - 2.0 * rise])


def cubic_value(coefficients: Array, rest: Array) -> Array:
    """Return the values of cubics, coefficients of shape (4, n), at fractions of their steps."""
    constant, first, second, third = coefficients
    result: Array = constant + rest * (first + rest * (second + rest * third))
    return result


def _slope(coefficients: Array, rest: Array) -> Array:
    _, first, second, third = coefficients
    result: Array = first + rest * (2.0 * second + rest * (3.0 * third))
    return result


def _bend(coefficients: Array, rest: Array) -> Array:
    _, _, second, third = coefficients
    result: Array = 2.0 * second + 6.0 * rest * third
    return result


def _blocks(course: Array) -> list[int]:
    """Return the nodes at which blocks of at most ``_TURN`` or one step end, and the first node."""
    ends = [0]
    low = high = course[0]
    for k in range(1, len(course)):
        low, high = min(low, course[k]), max(high, course[k])
        if high - low > _TURN and k - 1 > ends[-1]:
            ends.append(k - 1)
            low, high = min(course[k - 1], course[k]), max(course[k - 1], course[k])
    return [*ends, len(course) - 1]
