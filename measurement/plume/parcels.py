"""The line of parcels behind a ship, in the frame of the air mass: where a parcel was left, there
it stays.
"""

import math
from dataclasses import dataclass, fields
from itertools import pairwise

import numpy as np

from measurement.errors import MeasurementError
from measurement.plume.arrays import Array, Flags, Indices

WIND_MIN = 1.0
"""Least apparent wind [m/s]: below it a plume has no direction."""

_TURN = 0.15
"""Largest change of course of the apparent wind within a block [rad]; one block has one nearest
parcel to a place.
"""

_CLOSE = 1e-7
"""Emission times of nearest parcels are found to within this [s]: to a micrometre along the plume.
"""

_ROUNDS = 60
"""Most rounds of the search. It takes 3 to 6; near a centre of curvature each round only halves
what is left, of an hour in 35.
"""


@dataclass(frozen=True)
class Nearest:
    """Parcels whose cross-section goes through a place, one entry for each pair of a place and such
    a parcel, shape (k,).

    Attributes
    ----------
    place : index of the place
    emitted : time at which the parcel was emitted [s]
    wind : apparent wind at that time [m/s]
    path : air that had passed the funnel by then [m]
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

    def of(self, chosen: Flags) -> "Nearest":
        """Return the pairs that are chosen, shape (k,)."""
        return Nearest(*(getattr(self, each.name)[chosen] for each in fields(self)))


class Parcels:
    """The line of parcels that a funnel leaves, as a smooth curve of emission time.

    Parameters
    ----------
    time : [s], increasing, shape (n,), n at least 2
    north, east : place of the funnel in the frame of the air mass [m], shape (n,)
    interval : between the curve's nodes [s], about; between them it is a cubic

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
                f"apparent wind is {speed[weakest]:.2f} m/s at {nodes[weakest]:.0f} s; below {WIND_MIN:g} m/s a plume has no "
                "direction: change the speed or course of the ship or the wind"
            )
        self.wind_min, self.wind_max = float(speed.min()), float(speed.max())
        curve = _cubics(places, self._step * velocities)
        middle = (curve[1] + curve[2] + 0.75 * curve[3]) / self._step
        passed = self._step / 6.0 * (speed[:-1] + 4.0 * np.hypot(*middle) + speed[1:])
        path = np.concatenate([[0.0], np.cumsum(passed)])
        # Rows of the cubics' coefficients of north, east and path, from the constant on.
        self._rows = (
            np.concatenate([curve, _cubics(path, self._step * speed)[:, np.newaxis]], axis=1)
            .transpose(2, 1, 0)
            .reshape(count, 12)
        )
        ends = _blocks(np.unwrap(np.arctan2(-velocities[1], -velocities[0])))
        self._ends = nodes[ends]
        axes = -velocities[:, ends] / speed[ends]
        self._axes, self._offsets = axes, (axes * places[:, ends]).sum(axis=0)

    def path(self, time: Array) -> Array:
        """Return how much air has passed the funnel at times from start to end [m], shape as given."""
        row, rest = self._row(time)
        return _value(row[8:], rest)

    @property
    def path_end(self) -> float:
        """How much air has passed the funnel in all [m]."""
        return float(self.path(np.array([self.end]))[0])

    def at(self, emitted: Array) -> tuple[Array, Array, Array]:
        """Return north, east [m] and apparent wind [m/s] of parcels by the time they were emitted,
        from start to end.
        """
        row, rest = self._row(emitted)
        speed = np.hypot(_slope(row[:4], rest), _slope(row[4:8], rest)) / self._step
        return _value(row[:4], rest), _value(row[4:8], rest), speed

    def nearest(self, north: Array, east: Array, oldest: float, newest: float) -> Nearest:
        """Return the parcels nearest to places [m], shape (m,), among those emitted from ``oldest``
        to ``newest`` [s].

        A parcel's cross-section is the line across its apparent wind. Where the line of parcels
        bends or folds, a place can be in several cross-sections, or in none; only those are
        returned from which the distance grows both ways.
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
        """Newton's method on the place's component along the parcel's axis, kept within brackets
        that shrink with every round.
        """
        found = np.empty((5, len(place)))
        left: Indices | slice = slice(None)
        for _ in range(_ROUNDS):
            row, rest = self._row(emitted)
            to_north, to_east = north - _value(row[:4], rest), east - _value(row[4:8], rest)
            north_rate, east_rate = _slope(row[:4], rest), _slope(row[4:8], rest)
            north_bend, east_bend = _bend(row[:4], rest), _bend(row[4:8], rest)
            square = north_rate**2 + east_rate**2
            along = -(to_north * north_rate + to_east * east_rate)
            change = along / (square - to_north * north_bend - to_east * east_bend) * -self._step
            speed = np.sqrt(square)
            found[:, left] = (
                emitted,
                speed / self._step,
                _value(row[8:], rest),
                (to_north * east_rate - to_east * north_rate) / speed,
                (north_bend * east_rate - east_bend * north_rate) / (square * speed),
            )
            open_ = np.flatnonzero(~(np.abs(along) * self._step <= _CLOSE * square))
            if not len(open_):
                break
            early = along[open_] < 0.0
            emitted, change, bracket = emitted[open_], change[open_], bracket[:, open_]
            bracket = np.where(early, [emitted, bracket[1]], [bracket[0], emitted])
            following = emitted + change
            follows = (following > bracket[0]) & (following < bracket[1])
            emitted = np.where(follows, following, 0.5 * (bracket[0] + bracket[1]))
            north, east = north[open_], east[open_]
            left = open_ if isinstance(left, slice) else left[open_]
        return Nearest(place, *found)

    def _row(self, time: Array) -> tuple[Array, Array]:
        """Coefficients of the cubics at times, shape (12, n), and how far into their steps the
        times are [-].
        """
        steps = (time - self.start) / self._step
        index = np.clip(steps.astype(np.intp), 0, len(self._rows) - 1)
        return self._rows.take(index, axis=0).T, steps - index


def _check_track(time: Array, north: Array, east: Array) -> None:
    if not (time.ndim == 1 and len(time) >= 2 and time.shape == north.shape == east.shape):
        raise MeasurementError(
            f"times, north and east of the ship's track have shapes {time.shape}, {north.shape}, {east.shape}; "
            "give three of one length, 2 or more"
        )
    if not (np.isfinite(time).all() and np.isfinite(north).all() and np.isfinite(east).all()):
        raise MeasurementError(
            "ship's track has values that are missing or infinite; remove or fill them"
        )
    if not (np.diff(time) > 0.0).all():
        first = int(np.argmax(np.diff(time) <= 0.0))
        raise MeasurementError(
            f"times of the ship's track do not increase after {time[first]:g} s; sort them and remove doubles"
        )


def _cubics(values: Array, slopes: Array) -> Array:
    """Coefficients of cubics through ``values`` with ``slopes`` per step, (4, ..., steps), of
    arrays whose last axis are nodes.
    """
    value, slope = values[..., :-1], slopes[..., :-1]
    rise, after = np.diff(values), slopes[..., 1:]
    return np.stack([value, slope, 3.0 * rise - 2.0 * slope - after, slope + after - 2.0 * rise])


def _value(row: Array, rest: Array) -> Array:
    result: Array = row[0] + rest * (row[1] + rest * (row[2] + rest * row[3]))
    return result


def _slope(row: Array, rest: Array) -> Array:
    result: Array = row[1] + rest * (2.0 * row[2] + rest * (3.0 * row[3]))
    return result


def _bend(row: Array, rest: Array) -> Array:
    result: Array = 2.0 * row[2] + 6.0 * rest * row[3]
    return result


def _blocks(course: Array) -> list[int]:
    """Nodes at which blocks end, first and last included: within a block courses differ by at most
    0.15 rad, or it is one step.
    """
    ends, low, high = [0], course[0], course[0]
    for k in range(1, len(course)):
        low, high = min(low, course[k]), max(high, course[k])
        if high - low > _TURN and k - 1 > ends[-1]:
            ends.append(k - 1)
            low, high = min(course[k - 1], course[k]), max(course[k - 1], course[k])
    return [*ends, len(course) - 1]
