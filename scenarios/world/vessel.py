"""The vessel's true motion, at constant velocity or through manoeuvres, and the place on earth at
which a flight begins.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
import numpy.typing as npt

from common.geodesy import LocalFrame
from gnc.errors import InfeasibleError
from scenarios.scenario.extension_points import VESSEL_TRACKS
from scenarios.scenario.sections.world import PlaceConfig, VesselConfig

TRACK_STEP = 0.05
"""Time step of a tabled track [s]; between its points the track is a parabola to 1e-5 m."""

_ROUNDING = 1e-6
"""Relative error of values from a table of velocities [-]: 4e-13 for vessels at their limit;
millimetres in 5 minutes.
"""

Array = npt.NDArray[np.float64]


class VesselTruth(Protocol):
    """A vessel's motion over the ground, from the origin at time 0."""

    def motion(self, time: float) -> tuple[float, float, float, float]:
        """Return north, east [m] and their rates [m/s] at a time [s]."""

    def course(self, time: float) -> float:
        """Return the course, clockwise from north, without jumps [rad]; for a vessel at rest, the
        direction of its bow.
        """

    @property
    def manoeuvres_end(self) -> float:
        """Time at which the last manoeuvre ends, NaN without any [s]."""


vessel_track = VESSEL_TRACKS.register
"""Decorator that registers a vessel track by a name."""


class SteadyVessel:
    """A vessel at constant velocity.

    Parameters
    ----------
    speed, course : over the ground [m/s, rad]
    """

    def __init__(self, speed: float, course: float) -> None:
        self._course = course
        self._v_north, self._v_east = speed * math.cos(course), speed * math.sin(course)
        self.manoeuvres_end = math.nan

    def motion(self, time: float) -> tuple[float, float, float, float]:
        """Return north, east [m] and their rates [m/s] at a time [s]."""
        return self._v_north * time, self._v_east * time, self._v_north, self._v_east

    def course(self, _time: float) -> float:
        """Return the course [rad]."""
        return self._course


class TabledVessel:
    """A vessel whose velocity and course are tabled at ``track_times``; its place is their integral
    from the origin.

    Parameters
    ----------
    velocity : north and east, shape (n, 2) [m/s]
    course : shape (n,) [rad]
    manoeuvres_end : when the last manoeuvre ends, NaN without any [s]
    """

    def __init__(self, velocity: Array, course: Array, manoeuvres_end: float) -> None:
        self._table = np.column_stack([_integral(velocity), velocity, course])
        self._last = len(velocity) - 2
        self.manoeuvres_end = manoeuvres_end

    @property
    def samples(self) -> tuple[Array, Array]:
        """Return velocity over the ground [m/s], shape (n, 2), and course [rad], shape (n,), at
        ``track_times``.
        """
        return self._table[:, 2:4], self._table[:, 4]

    @property
    def places(self) -> Array:
        """Return north and east at ``track_times``, shape (n, 2) [m]."""
        return self._table[:, :2]

    @cached_property
    def _rows(self) -> list[list[float]]:
        """North, east, their rates and the course as plain floats, for one time after the other."""
        rows: list[list[float]] = self._table.tolist()
        return rows

    def motion(self, time: float) -> tuple[float, float, float, float]:
        """Return north, east [m] and their rates [m/s] at a time [s]."""
        step, last = int(time / TRACK_STEP), self._last
        step = step if step < last else last
        north, east, v_north, v_east, _ = self._rows[step]
        _, _, v_north_after, v_east_after, _ = self._rows[step + 1]
        since = time - step * TRACK_STEP
        half = 0.5 * since * since / TRACK_STEP
        fraction = since / TRACK_STEP
        return (
            north + since * v_north + half * (v_north_after - v_north),
            east + since * v_east + half * (v_east_after - v_east),
            v_north + fraction * (v_north_after - v_north),
            v_east + fraction * (v_east_after - v_east),
        )

    def course(self, time: float) -> float:
        """Return the course [rad] at a time [s]."""
        step = min(int(time / TRACK_STEP), self._last)
        *_, course = self._rows[step]
        *_, after = self._rows[step + 1]
        return course + (time / TRACK_STEP - step) * (after - course)


@vessel_track("manoeuvres")
class ManoeuvringVessel(TabledVessel):
    """A vessel whose course and speed change at the steady rates of its manoeuvres, which do not
    overlap (``check_manoeuvres``).

    Parameters
    ----------
    vessel : its manoeuvres and its course before them
    speed : before them [m/s]
    duration : time for which its track is computed [s]
    """

    def __init__(self, vessel: VesselConfig, speed: float, duration: float) -> None:
        times = track_times(duration)
        course = np.full_like(times, math.radians(vessel.course_deg))
        speeds, before = np.full_like(times, speed), speed
        for m in vessel.manoeuvres:
            turn, rate = math.radians(m.turn_deg), math.radians(m.turn_rate_deg_s)
            since = np.maximum(0.0, times - m.at_s)
            course += np.sign(turn) * np.minimum(abs(turn), rate * since)
            change = 0.0 if m.speed_mps is None else m.speed_mps - before
            speeds += np.sign(change) * np.minimum(abs(change), m.acceleration_mps2 * since)
            before += change
        speeds = np.maximum(speeds, 0.0)
        velocity = np.stack([speeds * np.cos(course), speeds * np.sin(course)], axis=-1)
        super().__init__(velocity, course, max(manoeuvre_ends(vessel, speed), default=math.nan))


def manoeuvre_ends(vessel: VesselConfig, speed: float) -> list[float]:
    """Return when each manoeuvre of a vessel ends [s], given its speed before them [m/s]."""
    ends = []
    for m in vessel.manoeuvres:
        change = 0.0 if m.speed_mps is None else m.speed_mps - speed
        speed += change
        ends.append(
            m.at_s + max(abs(m.turn_deg) / m.turn_rate_deg_s, abs(change) / m.acceleration_mps2)
        )
    return ends


def check_manoeuvres(vessel: VesselConfig, speed: float) -> None:
    """Refuse manoeuvres that overlap: their rates would add up.

    Raises
    ------
    InfeasibleError : a manoeuvre begins before an earlier one has ended
    """
    end = -math.inf
    for i, (m, until) in enumerate(
        zip(vessel.manoeuvres, manoeuvre_ends(vessel, speed), strict=True)
    ):
        if m.at_s < end - TRACK_STEP:
            raise InfeasibleError(
                f"vessel.manoeuvres.{i} begins at {m.at_s:g} s, before an earlier one has ended, at"
                f" {end:g} s; let it begin later, or turn faster (turn_rate_deg_s) or accelerate"
                " harder (acceleration_mps2), or make one manoeuvre of both"
            )
        end = max(end, until)


def largest_acceleration(vessel: VesselTruth, duration: float) -> float:
    """Return the largest acceleration of a vessel, along its course and across it together, less
    rounding [m/s^2].
    """
    velocity, _ = sampled(vessel, duration)
    return (1.0 - _ROUNDING) * float(np.hypot(*np.diff(velocity, axis=0).T).max()) / TRACK_STEP


def largest_speed(vessel: VesselTruth, duration: float) -> float:
    """Return the largest speed of a vessel over the ground, less rounding [m/s]."""
    velocity, _ = sampled(vessel, duration)
    return (1.0 - _ROUNDING) * float(np.hypot(*velocity.T).max())


def largest_inconsistency(vessel: VesselTruth, duration: float) -> float:
    """Return the largest difference, between any two times, of the way of a track from the integral
    of its velocity [m].

    It is 0 where both come from one table, and otherwise exact to the trapezoidal rule: less than a
    millimetre in an hour.
    """
    if type(vessel) is SteadyVessel or isinstance(vessel, TabledVessel):
        return 0.0
    motion = np.array([vessel.motion(time) for time in track_times(duration).tolist()])
    off = motion[:, :2] - _integral(motion[:, 2:])
    return float(np.hypot(*np.ptp(off, axis=0)))


def track_times(duration: float) -> Array:
    """Return the times at which a track is tabled [s], somewhat beyond ``duration``."""
    return np.asarray(
        TRACK_STEP * np.arange(math.ceil(duration / TRACK_STEP) + 3), dtype=np.float64
    )


def _integral(velocity: Array) -> Array:
    """Return the way since the first of the velocities at ``track_times`` [m], both of shape (n,
    2).
    """
    way = np.zeros_like(velocity)
    way[1:] = np.cumsum(0.5 * TRACK_STEP * (velocity[1:] + velocity[:-1]), axis=0)
    return way


def sampled(vessel: VesselTruth, duration: float) -> tuple[Array, Array]:
    """Return velocity over the ground [m/s], shape (n, 2), and course [rad], shape (n,), at
    ``track_times``.
    """
    if isinstance(vessel, TabledVessel):
        return vessel.samples
    times = track_times(duration).tolist()
    return np.array([vessel.motion(time)[2:] for time in times]), np.array(
        [vessel.course(time) for time in times]
    )


@dataclass(frozen=True, kw_only=True)
class Place:
    """Place and time of a flight's start; NaN where they are unknown.

    Attributes
    ----------
    latitude, longitude : of the origin [rad]
    altitude : at which north and east metres are counted [m]
    utc : of the start, since 1970 [s]
    """

    latitude: float
    longitude: float
    altitude: float
    utc: float

    @cached_property
    def frame(self) -> LocalFrame:
        """The frame of north and east in metres."""
        return LocalFrame(self.latitude, self.longitude, self.altitude)


def given_place(config: PlaceConfig, altitude: float) -> Place:
    """Return the place that a scenario gives, with metres at an altitude [m]."""
    return Place(
        latitude=math.nan if config.latitude_deg is None else math.radians(config.latitude_deg),
        longitude=math.nan if config.longitude_deg is None else math.radians(config.longitude_deg),
        altitude=altitude,
        utc=math.nan if config.utc is None else config.utc.timestamp(),
    )
