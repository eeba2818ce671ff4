"""The mean wind over time and height, which turbulence and gusts are about: one object for all who
ask for it.
"""

import itertools
import math
from bisect import bisect_right
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from aircraft.errors import AircraftError
from aircraft.simulation.fdm import Fdm
from common.physics.units import METRES_PER_FOOT

Array = npt.NDArray[np.float64]

_LOWEST = 1e-9
"""Height below which there is no wind of its own [m]: its logarithm goes to minus infinity."""

_ROUNDING = 1e-9
"""Part of a distance by which two points may be farther apart and count as near [-]: the sum of two
numbers is rounded.
"""

_PROFILE_TOP = 1000.0
"""Height up to which a logarithmic profile goes on; above it the wind is that at it [m]."""


class WindField:
    """Velocity of the air over time and height: linear in time, and in the logarithm of height,
    between points of a grid.

    Beyond the grid it is that of the nearest point. A logarithmic profile is exact: it is a line
    between two heights.

    Parameters
    ----------
    velocity : where the wind blows to, north and east, at each time and height, shape (n, m, 2)
        [m/s]
    times : of the grid, rising, shape (n,) [s]
    heights : above the sea, rising, shape (m,) [m]

    Attributes
    ----------
    constant : whether it is the same at all times and heights

    Raises
    ------
    AircraftError : a value is not finite, or times or heights do not rise
    """

    def __init__(
        self,
        velocity: npt.ArrayLike,
        times: Sequence[float] = (0.0,),
        heights: Sequence[float] = (10.0,),
    ) -> None:
        self._velocity = np.asarray(velocity, dtype=np.float64).reshape(len(times), len(heights), 2)
        self._times, self._heights = (
            [float(t) for t in times],
            [math.log(max(float(z), _LOWEST)) for z in heights],
        )
        if not np.isfinite(self._velocity).all():
            raise AircraftError(
                f"weather: a wind of {self._velocity[~np.isfinite(self._velocity)][0]} m/s; it must be finite"
            )
        for name, values in (("times", self._times), ("heights", self._heights)):
            if any(after <= before for before, after in itertools.pairwise(values)):
                raise AircraftError(f"weather: {name} of the wind do not rise")
        self._rows: list[list[list[float]]] = self._velocity.tolist()
        self.constant = bool((self._velocity == self._velocity[0, 0]).all())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, WindField) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[object, ...]:
        return tuple(self._times), tuple(self._heights), self._velocity.tobytes()

    def now(self, time: float, height: float) -> tuple[float, float]:
        """Return north and east velocity of the air at a time [s] and a height [m]: one look,
        without arrays.
        """
        if self.constant:
            north, east = self._rows[0][0]
            return north, east
        i, after, share = _between(self._times, time)
        j, above, upper = _between(self._heights, math.log(max(height, _LOWEST)))
        (low, high), (low_after, high_after) = (
            (rows[j], rows[above]) for rows in (self._rows[i], self._rows[after])
        )
        north, east = (
            (1.0 - share) * (low[k] + upper * (high[k] - low[k]))
            + share * (low_after[k] + upper * (high_after[k] - low_after[k]))
            for k in (0, 1)
        )
        return north, east

    def at(self, time: npt.ArrayLike, height: npt.ArrayLike) -> tuple[Array, Array]:
        """Return north and east velocity of the air [m/s] at times [s] and heights [m], which are
        broadcast together.
        """
        return self._interpolated(self._velocity, time, height)

    def largest_change(self, interval: float, duration: float, heights: Sequence[float]) -> float:
        """Return by how much the velocity of the air changes at most within an interval, between
        time 0 and a duration [m/s].

        Parameters
        ----------
        interval, duration : [s]
        heights : at each of which it is looked at, and at those of the grid between the lowest and
            the highest [m]
        """
        if len(self._times) == 1:
            return 0.0
        times = _looked_at(self._times, 0.0, duration, interval)
        inner = [
            math.exp(height)
            for height in self._heights
            if min(heights) < math.exp(height) < max(heights)
        ]
        return _largest_step(
            times, *self.at(times[:, None], np.array([*heights, *inner])), interval
        )

    def largest_shear(self, apart: float, lowest: float, highest: float, duration: float) -> float:
        """Return by how much the velocity of the air differs at most between two heights, at a time
        from 0 to a duration [m/s].

        Parameters
        ----------
        apart : largest distance of the two heights [m]
        lowest, highest : that they have [m]
        duration : [s]
        """
        if len(self._heights) == 1:
            return 0.0
        heights = _looked_at([math.exp(height) for height in self._heights], lowest, highest, apart)
        times = np.array([0.0, duration, *(time for time in self._times if 0.0 < time < duration)])
        return _largest_step(heights, *self.at(times, heights[:, None]), apart)

    def displacement(self, time: npt.ArrayLike, height: npt.ArrayLike) -> tuple[Array, Array]:
        """Return how far the air at some heights [m] has moved north and east from time 0 to some
        times [s], in metres.

        It is the exact integral of ``at`` over time, at a constant height. Times and heights are
        broadcast together.
        """
        north, east = (
            end - start
            for end, start in zip(self._moved(time, height), self._moved(0.0, height), strict=True)
        )
        return north, east

    def _moved(self, time: npt.ArrayLike, height: npt.ArrayLike) -> tuple[Array, Array]:
        """Return the integral of the velocity from the first time of the grid on [m]."""
        times, time = np.array(self._times), np.asarray(time, dtype=np.float64)
        mean = 0.5 * (self._velocity[1:] + self._velocity[:-1])
        nodes = np.concatenate(
            [
                np.zeros((1, *self._velocity.shape[1:])),
                np.cumsum(np.diff(times)[:, None, None] * mean, axis=0),
            ]
        )
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
        if len(self._times) == len(self._heights) == 1:
            return np.full(time.shape, grid[0, 0, 0]), np.full(time.shape, grid[0, 0, 1])
        i, after, share = _all_between(self._times, time)
        j, above, upper = _all_between(self._heights, np.log(np.maximum(height, _LOWEST)))
        share, upper = share[..., None], upper[..., None]
        velocity = (1.0 - share) * (grid[i, j] + upper * (grid[i, above] - grid[i, j]))
        velocity += share * (grid[after, j] + upper * (grid[after, above] - grid[after, j]))
        return velocity[..., 0], velocity[..., 1]


def constant_wind(north: float, east: float) -> WindField:
    """Return a wind that is the same at all times and heights, by where it blows to [m/s]."""
    return WindField([north, east])


CALM = constant_wind(0.0, 0.0)
"""No wind."""


def over_the_sea(
    wind: Array, times: Sequence[float], *, roughness: float, height: float
) -> WindField:
    """Return a wind with a logarithmic profile, V(z) = V(h) ln(z/z_0)/ln(h/z_0), neutral air over
    the sea.

    Parameters
    ----------
    wind : velocity at the height it is given for, north and east at each time, shape (n, 2) [m/s]
    times : [s]
    roughness : length z_0: 2e-4 m over open sea (J. Wieringa, Boundary-Layer Meteorology 63:323,
        1993), below the height [m]
    height : h that the wind is given for [m]

    Raises
    ------
    AircraftError : the roughness is not below the height, or so small that the profile would be cut
        off above it
    """
    if not _LOWEST <= roughness < height:
        raise AircraftError(
            f"weather: a roughness length of {roughness:g} m, and a wind at {height:g} m; give {_LOWEST:g} m or more, and less than"
            " that height"
        )
    top = math.log(_PROFILE_TOP / roughness) / math.log(height / roughness)
    return WindField(
        np.stack([np.zeros_like(wind), top * wind], axis=1), times, (roughness, _PROFILE_TOP)
    )


def windy_run(fdm: Fdm, wind: WindField, run: Callable[[], object]) -> Callable[[], object]:
    """Return what advances the aircraft by a time step in a wind that changes with time or height.

    Parameters
    ----------
    fdm : the aircraft at its release
    wind : timed from now
    run : advances the aircraft

    Returns
    -------
    callable : ``run`` itself where the wind is constant, so that it costs no time
    """
    if wind.constant:
        return run
    height, step = fdm.node("position/h-sl-ft").get_double_value, 0

    def blown() -> object:
        nonlocal step
        fdm.blow(*wind.now(step * fdm.time_step, height() * METRES_PER_FOOT))
        step += 1
        return run()

    return blown


def _looked_at(nodes: Sequence[float], first: float, last: float, apart: float) -> Array:
    """Return where a largest change within a distance begins or ends: between nodes it is steady,
    and at most as large.
    """
    inner = np.array([node for node in nodes if first < node < last])
    return np.unique(
        np.clip(
            [first, last, *inner, *(inner - apart), *(inner + apart), first + apart, last - apart],
            first,
            last,
        )
    )


def _largest_step(points: Array, north: Array, east: Array, apart: float) -> float:
    """Return the largest change [m/s] of velocities at points, shape (n, m), between any two that
    are so near to each other.
    """
    largest = 0.0
    for step in range(1, len(points)):
        near = points[step:] - points[:-step] <= apart + _ROUNDING * abs(apart)
        if not near.any():
            break
        change = np.hypot(north[step:] - north[:-step], east[step:] - east[:-step])
        largest = max(largest, float(change[near].max()))
    return largest


def _between(points: list[float], value: float) -> tuple[int, int, float]:
    """Return the points about a value, and how far it is from the first to the second [-]."""
    i = bisect_right(points, value) - 1
    if i < 0 or i + 1 == len(points):
        i = max(i, 0)
        return i, i, 0.0
    return i, i + 1, (value - points[i]) / (points[i + 1] - points[i])


def _all_between(
    points: list[float], values: Array
) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp], Array]:
    """Return the points about each value, and how far it is from the first to the second [-]."""
    known = np.array(points)
    i = np.clip(np.searchsorted(known, values, side="right") - 1, 0, len(points) - 1)
    after = np.minimum(i + 1, len(points) - 1)
    width = np.where(after > i, known[after] - known[i], 1.0)
    return i, after, np.where(after > i, np.clip((values - known[i]) / width, 0.0, 1.0), 0.0)
