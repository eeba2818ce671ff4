"""Where a vessel that manoeuvres is, and where its plume trails, at any time."""

import math
from functools import cached_property

import numpy as np
import numpy.typing as npt

from scenarios.schema.sea_config import SeaVessel

_STEP = 0.05
"""Time step of the tabled track [s]; between its points the track is a parabola to 1e-5 m."""

_COLUMNS = 6
"""Of the table: north, east, their rates, the plume's course, and the speed through the air."""

_AT_REST = 1e-9
"""Speed through the air below which its direction is rounding alone [m/s]."""

Array = npt.NDArray[np.float64]


class VesselTrack:
    """The track over the ground of a vessel that starts at the origin.

    Course and speed change at the steady rates of its manoeuvres. One that begins before another has ended adds to it.

    Parameters
    ----------
    vessel : what it does
    duration : for how long it is followed [s]
    wind_north, wind_east : velocity of the air mass [m/s]
    plume_heading : of the plume from the bow, or none where it trails behind the motion through the air [rad]

    Attributes
    ----------
    manoeuvres_end : when the last manoeuvre ends, not a number without any [s]
    """

    def __init__(
        self, vessel: SeaVessel, duration: float, *, wind_north: float, wind_east: float, plume_heading: float | None
    ) -> None:
        times = _STEP * np.arange(math.ceil(duration / _STEP) + 3)
        course = np.full_like(times, math.radians(vessel.course_deg))
        speed, before = np.full_like(times, vessel.speed_mps), vessel.speed_mps
        self.manoeuvres_end = math.nan
        for m in vessel.manoeuvres:
            turn, rate = math.radians(m.turn_deg), math.radians(m.turn_rate_deg_s)
            since = np.maximum(0.0, times - m.at_s)
            course += np.sign(turn) * np.minimum(abs(turn), rate * since)
            change = 0.0 if m.speed_mps is None else m.speed_mps - before
            speed += np.sign(change) * np.minimum(abs(change), m.acceleration_mps2 * since)
            before += change
            end = m.at_s + max(abs(turn) / rate, abs(change) / m.acceleration_mps2)
            self.manoeuvres_end = end if math.isnan(self.manoeuvres_end) else max(self.manoeuvres_end, end)
        speed = np.maximum(speed, 0.0)
        velocity = np.stack([speed * np.cos(course), speed * np.sin(course)], axis=-1)
        place = np.zeros_like(velocity)
        place[1:] = np.cumsum(0.5 * _STEP * (velocity[1:] + velocity[:-1]), axis=0)
        axis = course + plume_heading if plume_heading is not None else None
        through_air = velocity - np.array([wind_north, wind_east])
        if axis is None:
            axis = np.unwrap(np.arctan2(-through_air[:, 1], -through_air[:, 0])[_last_moving(through_air)])
        self._table = np.column_stack([place, velocity, axis, np.hypot(through_air[:, 0], through_air[:, 1])])

    @cached_property
    def _flat(self) -> list[float]:
        """The table as plain floats, row after row, for one look at a time."""
        return self._table.ravel().tolist()

    def _place(self, time: float) -> int:
        """Return where the row before a time, and with it the one after, begins in the flat table."""
        return _COLUMNS * min(int(time / _STEP), len(self._table) - 2)

    def motion(self, time: float) -> tuple[float, float, float, float]:
        """Return north, east [m] and their rates [m/s]."""
        at = self._place(time)
        north, east, v_north, v_east = self._flat[at : at + 4]
        v_north_after, v_east_after = self._flat[at + _COLUMNS + 2 : at + _COLUMNS + 4]
        since = time - at // _COLUMNS * _STEP
        half = 0.5 * since * since / _STEP
        share = since / _STEP
        return (
            north + since * v_north + half * (v_north_after - v_north),
            east + since * v_east + half * (v_east_after - v_east),
            v_north + share * (v_north_after - v_north),
            v_east + share * (v_east_after - v_east),
        )

    def axis(self, time: float) -> float:
        """Return the course along which the plume trails [rad]."""
        at = self._place(time)
        axis, after = self._flat[at + 4], self._flat[at + _COLUMNS + 4]
        return axis + (time / _STEP - at // _COLUMNS) * (after - axis)

    @property
    def apparent_wind_at_start(self) -> float:
        """Return the speed of the vessel through the air at time 0 [m/s]."""
        return float(self._table[0, 5])

    @property
    def apparent_wind_range(self) -> tuple[float, float]:
        """Return the least and the greatest speed through the air over the whole track [m/s]."""
        return float(self._table[:, 5].min()), float(self._table[:, 5].max())


def _last_moving(velocity: Array) -> npt.NDArray[np.intp]:
    """Return which row of shape (n, 2) was the last that is not at rest, for each: in still air a plume stays put."""
    moving = np.hypot(velocity[:, 0], velocity[:, 1]) > _AT_REST
    return np.maximum.accumulate(np.where(moving, np.arange(len(velocity)), 0))
