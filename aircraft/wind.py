"""The mean wind over time and height, without turbulence and gusts."""

import itertools
import math
from bisect import bisect_right
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from aircraft.spec import AircraftError

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]

_LOWEST = 1e-9
"""Height below which the wind is constant [m]: the logarithm of 0 is not finite."""

_ROUNDING = 1e-9
"""Relative tolerance of the distance between two points, for rounding [-]."""

_PROFILE_TOP = 1000.0
"""Height above which a logarithmic profile is constant [m]."""


class WindField:
    """Velocity of the air over time and height.

    The velocity is interpolated on a grid, linearly in time and in the logarithm of height; outside
    the grid it is the value at the edge. Two heights thus describe a logarithmic profile exactly.

    Parameters
    ----------
    velocity : velocity of the air, north and east, at each time and height, shape (n, m, 2) [m/s]
    times : times of the grid, ascending, shape (n,) [s]
    heights : heights of the grid above the sea, ascending, shape (m,) [m]

    Attributes
    ----------
    constant : whether the velocity is the same at all times and heights

    Raises
    ------
    AircraftError : a value is not finite, or times or heights do not ascend
    """

    def __init__(
        self,
        velocity: npt.ArrayLike,
        times: Sequence[float] = (0.0,),
        heights: Sequence[float] = (10.0,),
    ) -> None:
        self._velocity = np.asarray(velocity, dtype=np.float64).reshape(len(times), len(heights), 2)
        self._times = [float(t) for t in times]
        self._log_heights = [math.log(max(float(z), _LOWEST)) for z in heights]
        finite = np.isfinite(self._velocity)
        if not finite.all():
            wrong = self._velocity[~finite][0]
            raise AircraftError(f"weather: wind is {wrong} m/s; it must be finite")
        for name, values in (("times", self._times), ("heights", self._log_heights)):
            if any(after <= before for before, after in itertools.pairwise(values)):
                raise AircraftError(f"weather: {name} of the wind do not ascend")
        self._rows: list[list[list[float]]] = self._velocity.tolist()
        self.constant = bool((self._velocity == self._velocity[0, 0]).all())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, WindField) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[object, ...]:
        return tuple(self._times), tuple(self._log_heights), self._velocity.tobytes()

    def now(self, time: float, height: float) -> tuple[float, float]:
        """North and east velocity of the air [m/s] at one time [s] and height [m]."""
        if self.constant:
            north, east = self._rows[0][0]
            return north, east
        i, after, share = _bracket(self._times, time)
        j, above, upper = _bracket(self._log_heights, math.log(max(height, _LOWEST)))
        low, high = self._rows[i][j], self._rows[i][above]
        low_after, high_after = self._rows[after][j], self._rows[after][above]
        north, east = (
            (1.0 - share) * (low[k] + upper * (high[k] - low[k]))
            + share * (low_after[k] + upper * (high_after[k] - low_after[k]))
            for k in (0, 1)
        )
        return north, east

    def at(self, time: npt.ArrayLike, height: npt.ArrayLike) -> tuple[Array, Array]:
        """North and east velocity of the air [m/s] at times [s] and heights [m], broadcast."""
        return self._interpolated(self._velocity, time, height)

    def largest_change(self, interval: float, duration: float, heights: Sequence[float]) -> float:
        """Largest change of the velocity of the air within an interval [m/s].

        Parameters
        ----------
        interval : [s]
        duration : end of the searched times, which begin at 0 [s]
        heights : searched heights, in addition to the grid's heights between them [m]
        """
        if len(self._times) == 1:
            return 0.0
        times = _corners(self._times, 0.0, duration, interval)
        grid = [math.exp(height) for height in self._log_heights]
        inner = [height for height in grid if min(heights) < height < max(heights)]
        velocity = self.at(times[:, None], np.array([*heights, *inner]))
        return _largest_step(times, *velocity, interval)

    def largest_shear(self, apart: float, lowest: float, highest: float, duration: float) -> float:
        """Largest difference of the velocity of the air between two heights [m/s].

        Parameters
        ----------
        apart : largest distance between the two heights [m]
        lowest, highest : range of the heights [m]
        duration : end of the searched times, which begin at 0 [s]
        """
        if len(self._log_heights) == 1:
            return 0.0
        grid = [math.exp(height) for height in self._log_heights]
        heights = _corners(grid, lowest, highest, apart)
        times = np.array([0.0, duration, *(time for time in self._times if 0.0 < time < duration)])
        return _largest_step(heights, *self.at(times, heights[:, None]), apart)

    def displacement(self, time: npt.ArrayLike, height: npt.ArrayLike) -> tuple[Array, Array]:
        """Distance north and east [m] that the air moves from time 0 to ``time`` [s].

        This is the exact integral of ``at`` over time at a constant height [m]. Times and heights
        are broadcast.
        """
        north, east = (
            end - start
            for end, start in zip(
                self._integral(time, height), self._integral(0.0, height), strict=True
            )
        )
        return north, east

    def _integral(self, time: npt.ArrayLike, height: npt.ArrayLike) -> tuple[Array, Array]:
        """Integral of the velocity from the first time of the grid [m]."""
        times, time = np.array(self._times), np.asarray(time, dtype=np.float64)
        mean = 0.5 * (self._velocity[1:] + self._velocity[:-1])
        moved = np.cumsum(np.diff(times)[:, None, None] * mean, axis=0)
        nodes = np.concatenate([np.zeros((1, *self._velocity.shape[1:])), moved])
        last = np.clip(np.searchsorted(times, time, side="right") - 1, 0, len(times) - 1)
        since = time - times[last]
        begin, now = self.at(times[last], height), self.at(time, height)
        whole = self._interpolated(nodes, times[last], height)
        north, east = (w + 0.5 * since * (b + n) for w, b, n in zip(whole, begin, now, strict=True))
        return north, east

    def _interpolated(
        self, grid: Array, time: npt.ArrayLike, height: npt.ArrayLike
    ) -> tuple[Array, Array]:
        time, height = np.broadcast_arrays(
            np.asarray(time, dtype=np.float64), np.asarray(height, dtype=np.float64)
        )
        if len(self._times) == len(self._log_heights) == 1:
            return np.full(time.shape, grid[0, 0, 0]), np.full(time.shape, grid[0, 0, 1])
        i, after, share = _brackets(self._times, time)
        j, above, upper = _brackets(self._log_heights, np.log(np.maximum(height, _LOWEST)))
        share, upper = share[..., None], upper[..., None]
        velocity = (1.0 - share) * (grid[i, j] + upper * (grid[i, above] - grid[i, j]))
        velocity += share * (grid[after, j] + upper * (grid[after, above] - grid[after, j]))
        return velocity[..., 0], velocity[..., 1]


def constant_wind(north: float, east: float) -> WindField:
    """Wind that is the same at all times and heights, by its velocity north and east [m/s]."""
    return WindField([north, east])


CALM = constant_wind(0.0, 0.0)
"""No wind."""


def over_the_sea(
    wind: Array, times: Sequence[float], *, roughness: float, height: float
) -> WindField:
    """Wind with a logarithmic profile, V(z) = V(h) ln(z/z_0)/ln(h/z_0): neutral air over the sea.

    Parameters
    ----------
    wind : velocity north and east at the reference height at each time, shape (n, 2) [m/s]
    times : [s]
    roughness : roughness length z_0 [m]; 2e-4 m over open sea (J. Wieringa, Boundary-Layer
        Meteorology 63:323, 1993)
    height : reference height h [m]

    Raises
    ------
    AircraftError : the roughness is not below the height, or below 1e-9 m
    """
    if not _LOWEST <= roughness < height:
        raise AircraftError(
            f"weather: roughness length is {roughness:g} m; it must lie between {_LOWEST:g} m and"
            f" the height of the wind, {height:g} m"
        )
    top = math.log(_PROFILE_TOP / roughness) / math.log(height / roughness)
    profile = np.stack([np.zeros_like(wind), top * wind], axis=1)
    return WindField(profile, times, (roughness, _PROFILE_TOP))


def _corners(nodes: Sequence[float], first: float, last: float, apart: float) -> Array:
    """Points at which the largest change over the distance ``apart`` can begin or end.

    Changes are monotonic between the nodes of the grid, so the largest begins or ends at a node.
    """
    inner = np.array([node for node in nodes if first < node < last])
    points = [first, last, *inner, *(inner - apart), *(inner + apart), first + apart, last - apart]
    return np.unique(np.clip(points, first, last))


def _largest_step(points: Array, north: Array, east: Array, apart: float) -> float:
    """Largest change of velocity between points at most ``apart`` from each other [m/s]."""
    largest = 0.0
    for step in range(1, len(points)):
        near = points[step:] - points[:-step] <= apart + _ROUNDING * abs(apart)
        if not near.any():
            break
        change = np.hypot(north[step:] - north[:-step], east[step:] - east[:-step])
        largest = max(largest, float(change[near].max()))
    return largest


def _bracket(points: list[float], value: float) -> tuple[int, int, float]:
    """Indices of the points around a value, and its fraction of the distance between them [-]."""
    i = bisect_right(points, value) - 1
    if i < 0 or i + 1 == len(points):
        i = max(i, 0)
        return i, i, 0.0
    return i, i + 1, (value - points[i]) / (points[i + 1] - points[i])


def _brackets(points: list[float], values: Array) -> tuple[Indices, Indices, Array]:
    """Same as ``_bracket`` for many values."""
    known = np.array(points)
    i = np.clip(np.searchsorted(known, values, side="right") - 1, 0, len(points) - 1)
    after = np.minimum(i + 1, len(points) - 1)
    width = np.where(after > i, known[after] - known[i], 1.0)
    return i, after, np.where(after > i, np.clip((values - known[i]) / width, 0.0, 1.0), 0.0)
