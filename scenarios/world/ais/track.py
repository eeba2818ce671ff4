"""A vessel that sails as a file of AIS reports says: smoothly through them, and reported as it was."""

import math
from datetime import datetime
from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from common.geodesy import LocalFrame
from common.text import utc_text
from gnc.estimation.vessel import VesselReport
from scenarios.errors import InputError
from scenarios.scenario.sections.world import VesselConfig
from scenarios.world.ais.reports import AisReports, read_ais
from scenarios.world.ais.smoothing import smooth_motion
from scenarios.world.place import Place
from scenarios.world.vessel import TRACK_STEP, TabledVessel, track_times

Array = npt.NDArray[np.float64]

_AROUND = 600.0
"""Reports of this time before a flight and after it have a part in its smooth track [s]."""

_KNOWN_BEFORE = 60.0
"""Reports of this time before a flight are known at its start [s], the last one before it in any
case.
"""

_AT_REST = 0.3
"""Speed below which a vessel keeps the course that it had [m/s]."""

_MANOEUVRE, _MANOEUVRE_TIME = 0.03, 30.0
"""Mean acceleration over some time above which a vessel manoeuvres [m/s^2, s]."""

_KEPT = 4
"""Tracks that a process keeps: flights of a study mostly share one."""


class AisVessel(TabledVessel):
    """A vessel on a smooth track through its reports.

    Parameters
    ----------
    reports : of the vessel
    altitude : at which metres are counted [m]
    start : time of the start, since 1970 [s]
    duration : of the longest flight [s]
    margin : for how long the track goes straight on after it [s]

    Attributes
    ----------
    place : where and when the flight begins: the origin is on the smooth track
    reports : those of the file, in the flight's time and frame
    source : the file's
    """

    def __init__(
        self, reports: AisReports, *, altitude: float, start: float, duration: float, margin: float
    ) -> None:
        self.source = reports
        near = _around(reports.time, start, start + duration)
        since = reports.time[near] - start
        latitude, longitude = reports.latitude[near], reports.longitude[near]
        speed, course = reports.speed[near], reports.course[near]
        first = LocalFrame(float(latitude[0]), float(longitude[0]), altitude)
        origin = smooth_motion(since, *_in_frame(first, latitude, longitude, speed, course))(0.0)
        latitude_there, longitude_there = first.to_geodetic(origin[0], origin[1])
        self.place = Place(
            latitude=float(latitude_there),
            longitude=float(longitude_there),
            altitude=altitude,
            utc=start,
        )
        place, velocity = _in_frame(self.place.frame, latitude, longitude, speed, course)
        earliest = min(-_KNOWN_BEFORE, float(since[since <= 0.0][-1]))
        self.reports = [
            VesselReport(float(t), float(p[0]), float(p[1]), float(v[0]), float(v[1]))
            for t, p, v in zip(since, place, velocity, strict=True)
            if earliest <= t <= duration
        ]
        smooth = smooth_motion(since, place, velocity).derivative()(
            np.minimum(track_times(duration + margin), duration)
        )
        super().__init__(smooth, _course_of(smooth), _manoeuvres_end(smooth))


def ais_vessel(
    config: VesselConfig, *, altitude: float, utc: datetime | None, duration: float, margin: float
) -> AisVessel:
    """Return the vessel of a scenario whose track is a file.

    Parameters
    ----------
    config : the ``[vessel]`` section
    altitude : at which metres are counted [m]
    utc : of the start; the first report's if not given
    duration, margin : of the longest flight, and for how long the track goes on after it [s]

    Raises
    ------
    InputError : the file is of no use, or does not cover the flight
    """
    path = Path(config.track)
    try:
        stamp = path.stat()
    except OSError as error:
        raise InputError(
            f"vessel.track: {path}: cannot be read: {error.strerror}; check the path"
        ) from None
    reports = _read(path, (stamp.st_mtime_ns, stamp.st_size), config.mmsi)
    begin = float(reports.time[0]) if utc is None else utc.timestamp()
    _check_covered(reports, begin, begin + duration, config.gap_max_s)
    return _vessel(reports, altitude, begin, duration, margin)


def _check_covered(reports: AisReports, begin: float, end: float, gap_max: float) -> None:
    """Raise an InputError where reports do not cover a flight between two times [s], or have too
    long a gap in it [s].
    """
    if not reports.time[0] <= begin < end <= reports.time[-1]:
        raise InputError(
            f"{reports.path}: reports of MMSI {reports.mmsi} go from {utc_text(reports.time[0])} (line {reports.line[0]:.0f}) to"
            f" {utc_text(reports.time[-1])} (line {reports.line[-1]:.0f}); the longest flight goes from {utc_text(begin)} to"
            f" {utc_text(end)}: set place.utc or flight.duration_max_s"
        )
    gaps = np.diff(reports.time)
    used = (reports.time[1:] > begin) & (reports.time[:-1] < end)
    worst = int(np.argmax(np.where(used, gaps, 0.0)))
    if gaps[worst] > gap_max:
        raise InputError(
            f"{reports.path}, line {reports.line[worst]:.0f}: after {utc_text(reports.time[worst])} there is no report of MMSI"
            f" {reports.mmsi} for {gaps[worst]:.0f} s; the track is bridged over vessel.gap_max_s = {gap_max:g} s at"
            " most: set it, or fly another time (place.utc, flight.duration_max_s)"
        )


@lru_cache(maxsize=_KEPT)
def _vessel(
    reports: AisReports, altitude: float, start: float, duration: float, margin: float
) -> AisVessel:
    return AisVessel(reports, altitude=altitude, start=start, duration=duration, margin=margin)


@lru_cache(maxsize=_KEPT)
def _read(path: Path, _stamp: tuple[int, int], mmsi: int | None) -> AisReports:
    return read_ais(path, mmsi)


def usual_intervals(vessel: AisVessel) -> tuple[float, float]:
    """Return the shortest time between reports, and the longest but for one in twenty [s]: of the
    file where a flight has one.
    """
    times = [report.time for report in vessel.reports]
    gaps = np.diff(times if len(times) > 1 else vessel.source.time)
    return float(gaps.min()), float(np.quantile(gaps, 0.95))


def _around(time: Array, begin: float, end: float) -> slice:
    """Return which reports have a part in the track of a flight between two times [s]: the last
    before it and the first after it, however long a gap they bound."""
    first = min(np.searchsorted(time, begin - _AROUND), np.searchsorted(time, begin, "right") - 1)
    last = max(np.searchsorted(time, end + _AROUND, "right"), np.searchsorted(time, end) + 1)
    return slice(int(first), int(last))


def _in_frame(
    frame: LocalFrame, latitude: Array, longitude: Array, speed: Array, course: Array
) -> tuple[Array, Array]:
    """Return places and velocities in a frame, each shape (n, 2) [m, m/s]: courses are from true
    north at each place.
    """
    along = course + frame.true_north(latitude, longitude)
    return np.column_stack(frame.to_local(latitude, longitude)), speed[:, None] * np.column_stack(
        [np.cos(along), np.sin(along)]
    )


def _course_of(velocity: Array) -> Array:
    """Return the course over the ground without jumps; a vessel at rest keeps the last one [rad]."""
    moving = np.hypot(velocity[:, 0], velocity[:, 1]) > _AT_REST
    if not moving.any():
        return np.zeros(len(velocity))
    # Before it first moves, it points where it then goes.
    last = np.maximum(
        np.maximum.accumulate(np.where(moving, np.arange(len(velocity)), -1)),
        int(np.argmax(moving)),
    )
    course: Array = np.unwrap(np.arctan2(velocity[:, 1], velocity[:, 0])[last])
    return course


def _manoeuvres_end(velocity: Array) -> float:
    """Return when the vessel last changed its velocity as in a manoeuvre [s]; not a number if it
    never did.
    """
    window = round(_MANOEUVRE_TIME / TRACK_STEP)
    change = np.hypot(*(velocity[window:] - velocity[:-window]).T) / _MANOEUVRE_TIME
    manoeuvring = np.flatnonzero(change > _MANOEUVRE)
    return TRACK_STEP * float(manoeuvring[-1] + window // 2) if len(manoeuvring) else math.nan
