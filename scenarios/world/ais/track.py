"""A vessel on a smooth track through the reports of a file, and reports of any vessel as they
arrive on board: every few seconds, noisy, late, or not at all.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from pydantic import ValidationError

from common.geodesy import LocalFrame
from common.tables import FOUND, TableFormat
from common.text import utc_text
from gnc.estimation.antenna import AntennaReport, at_antenna, at_funnel, turned_offset
from gnc.estimation.vessel import VesselReport
from scenarios.errors import InputError
from scenarios.scenario.sections.equipment import VesselReportsConfig
from scenarios.scenario.sections.world import VesselConfig
from scenarios.world.ais.reports import AisReports, read_others, read_reports
from scenarios.world.vessel import TRACK_STEP, Place, TabledVessel, VesselTruth, track_times

if TYPE_CHECKING:
    from scipy.interpolate import BPoly

Array = npt.NDArray[np.float64]

AT_THE_FUNNEL = (0.0, 0.0)
"""Offset of an antenna that is at the funnel, or assumed to be there [m]."""

_TURN_TIME = 20.0
"""Least time over which a rate of turn is averaged [s]: with an error of the course of a degree,
the rate is wrong by 0.05 deg/s."""

_AROUND = 600.0
"""Time before a flight and after it whose reports contribute to its smooth track [s]."""

_KNOWN_BEFORE = 60.0
"""Time before a flight whose reports are known at its start [s]; the last report before it always
is.
"""

_AT_REST = 0.3
"""Speed below which a vessel keeps the course that it had [m/s]."""

_MANOEUVRE, _MANOEUVRE_TIME = 0.03, 30.0
"""Mean acceleration over some time above which a vessel manoeuvres [m/s^2, s]."""

_OTHERS_KEPT = 64
"""Number of other ships' tracks that a process caches."""

_KEPT = 4
"""Number of tracks that a process caches: flights of a study mostly share one."""


class AisVessel(TabledVessel):
    """A vessel on a smooth track through its reports.

    Parameters
    ----------
    reports : of the vessel
    altitude : at which metres are counted [m]
    start : time of the start, since 1970 [s]
    duration : of the longest flight [s]
    margin : time for which the track goes straight on after it [s]
    antenna : place that reports are of, ahead of the funnel and to starboard of it [m]

    Attributes
    ----------
    place : where and when the flight begins: the origin is on the smooth track of the funnel
    reports : of the file, in the flight's time and frame
    source : the file's
    """

    def __init__(
        self,
        reports: AisReports,
        *,
        altitude: float,
        start: float,
        duration: float,
        margin: float,
        antenna: tuple[float, float] = AT_THE_FUNNEL,
    ) -> None:
        self.source = reports
        near = _around(reports.time, start, start + duration)
        since = reports.time[near] - start
        latitude, longitude = reports.latitude[near], reports.longitude[near]
        speed, course = reports.speed[near], reports.course[near]
        first = LocalFrame(float(latitude[0]), float(longitude[0]), altitude)
        smooth = smooth_motion(since, *_in_frame(first, latitude, longitude, speed, course))
        times = np.minimum(track_times(duration + margin), duration)
        origin = smooth(0.0)
        if antenna != AT_THE_FUNNEL:
            heading = float(_course_of(smooth.derivative()(times))[0])
            origin = origin - np.array(turned_offset(antenna, heading))
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
        track = smooth_motion(since, place, velocity).derivative()(times)
        course = _course_of(track)
        if antenna != AT_THE_FUNNEL:
            self.reports = _at_the_funnel(self.reports, antenna)
            flown = int(np.count_nonzero(np.diff(times))) + 1
            turning = _turning(course[:flown], antenna)
            # After that the track goes straight on.
            track = track + turning[np.minimum(np.arange(len(track)), flown - 1)]
        super().__init__(track, course, _manoeuvres_end(track))


def _turning(heading: Array, antenna: tuple[float, float]) -> Array:
    """Return the velocity of the funnel over that of the antenna at ``track_times``, shape (n, 2)
    [m/s], given the ship's heading there [rad].
    """
    ahead, right = antenna
    rate = np.gradient(heading, TRACK_STEP)
    cos_h, sin_h = np.cos(heading), np.sin(heading)
    north, east = ahead * cos_h - right * sin_h, ahead * sin_h + right * cos_h
    return np.column_stack([rate * east, -rate * north])


def _at_the_funnel(reports: list[VesselReport], antenna: tuple[float, float]) -> list[VesselReport]:
    """Return the reports of an antenna converted to the funnel, with the knowledge at the time of
    each report.

    The ship's heading is assumed to be its course, and its rate of turn is the mean over the
    reports of at least ``_TURN_TIME``.
    """
    times = np.array([report.time for report in reports])
    course = _course_of(np.array([report[3:5] for report in reports]))
    taken = []
    for i, report in enumerate(reports):
        before = max(0, int(np.searchsorted(times, report.time - _TURN_TIME, "right")) - 1)
        since = report.time - times[before]
        rate = float(course[i] - course[before]) / since if since > 0.0 else 0.0
        taken.append(at_funnel(AntennaReport(report, float(course[i]), rate), antenna))
    return taken


def ais_vessel(
    config: VesselConfig,
    *,
    altitude: float,
    utc: datetime | None,
    duration: float,
    margin: float,
    written: TableFormat = FOUND,
) -> AisVessel:
    """Return the vessel of a scenario whose track is a file.

    Parameters
    ----------
    config : the ``[vessel]`` section
    altitude : at which metres are counted [m]
    utc : of the start; by default that of the first report
    duration, margin : of the longest flight, and time for which the track goes on after it [s]
    written : format of the file if it is a table, as far as it is given

    Raises
    ------
    InputError : the file is not usable, or does not cover the flight
    """
    reports = _read(*_file_of(config), config.mmsi, written)
    begin = float(reports.time[0]) if utc is None else utc.timestamp()
    _check_covered(reports, begin, begin + duration, config.gap_max_s)
    _check_jumps(reports, begin, begin + duration)
    hull = config.hull
    antenna = AT_THE_FUNNEL if hull is None else hull.antenna_offset
    return _vessel(reports, altitude, begin, duration, margin, antenna)


def with_size_of_file(config: VesselConfig, written: TableFormat = FOUND) -> VesselConfig:
    """Return the section, completed by the size and the place of the antenna from the reports of
    its file where it does not give them. ``written`` is that of ``ais_vessel``.

    Raises
    ------
    InputError : the file is not usable, or its size contradicts a given key
    """
    said = _read(*_file_of(config), config.mmsi, written).size
    if said is None:
        return config
    found = {
        "length_m": said.length,
        "beam_m": said.beam,
        "antenna_from_bow_m": said.to_bow,
        "antenna_from_port_m": said.to_port,
    }
    given = config.model_dump(exclude_none=True)
    known = {name: value for name, value in found.items() if value is not None}
    try:
        return VesselConfig.model_validate(known | given)
    except ValidationError as error:
        raise InputError(
            f"vessel: {error.errors()[0]['msg'].removeprefix('Value error, ')}; {config.track} says"
            f" {said.described()}"
        ) from None


def _file_of(config: VesselConfig) -> tuple[Path, tuple[int, int]]:
    """Return the file of a track, and a key of the file's present state.

    Raises
    ------
    InputError : there is none
    """
    path = Path(config.track)
    try:
        stamp = path.stat()
    except OSError as error:
        raise InputError(
            f"vessel.track: {path}: cannot be read: {error.strerror}; check the path"
        ) from None
    return path, (stamp.st_mtime_ns, stamp.st_size)


def _check_covered(reports: AisReports, begin: float, end: float, gap_max: float) -> None:
    """Raise an InputError where reports do not cover a flight between two times [s], or have too
    long a gap in it [s].
    """
    if not reports.time[0] <= begin < end <= reports.time[-1]:
        raise InputError(
            f"{reports.path}: reports of MMSI {reports.mmsi} go from {utc_text(reports.time[0])}"
            f" (line {reports.line[0]:.0f}) to {utc_text(reports.time[-1])} (line"
            f" {reports.line[-1]:.0f}); the longest flight goes from {utc_text(begin)} to"
            f" {utc_text(end)}: set place.utc or flight.duration_max_s"
        )
    gaps = np.diff(reports.time)
    used = (reports.time[1:] > begin) & (reports.time[:-1] < end)
    worst = int(np.argmax(np.where(used, gaps, 0.0)))
    if gaps[worst] > gap_max:
        raise InputError(
            f"{reports.path}, line {reports.line[worst]:.0f}: after {utc_text(reports.time[worst])}"
            f" there is no report of MMSI {reports.mmsi} for {gaps[worst]:.0f} s; the track is"
            f" bridged over vessel.gap_max_s = {gap_max:g} s at most: set it, or fly another time"
            " (place.utc, flight.duration_max_s)"
        )


def _check_jumps(reports: AisReports, begin: float, end: float) -> None:
    """Raise an InputError where reports that contribute to the track of a flight between two times
    [s] are too far apart for any vessel.
    """
    part = _around(reports.time, begin, end)
    jumps = reports.jumps(part)
    if jumps:
        raise InputError(
            f"{reports.path}: {jumps[0].described(reports.line[part])}: correct or remove the rows"
            " that are wrong, or fly another time (place.utc, flight.duration_max_s)"
        )


@lru_cache(maxsize=_KEPT)
def _vessel(
    reports: AisReports,
    altitude: float,
    start: float,
    duration: float,
    margin: float,
    antenna: tuple[float, float],
) -> AisVessel:
    return AisVessel(
        reports,
        altitude=altitude,
        start=start,
        duration=duration,
        margin=margin,
        antenna=antenna,
    )


@lru_cache(maxsize=_KEPT)
def _read(
    path: Path, _stamp: tuple[int, int], mmsi: int | None, written: TableFormat
) -> AisReports:
    return read_reports(path, mmsi, written)


@dataclass(frozen=True, slots=True, kw_only=True)
class FileShip:
    """A ship of a file besides the one that is measured.

    Attributes
    ----------
    mmsi : of the ship
    track : smooth, from the origin at time 0; straight on where it has no reports
    origin : its place at time 0, north and east [m]
    begins, ends : times of its first and last report within the flight or about it [s]
    reports : in the flight's time and frame
    """

    mmsi: int
    track: TabledVessel
    origin: tuple[float, float]
    begins: float
    ends: float
    reports: tuple[VesselReport, ...]


@lru_cache(maxsize=_KEPT)
def _read_others(
    path: Path,
    _stamp: tuple[int, int],
    without: int | None,
    only: int | None,
    begin: float,
    end: float,
    written: TableFormat,
) -> tuple[AisReports, ...]:
    return tuple(
        read_others(path, without=without, only=only, begin=begin, end=end, written=written)
    )


@lru_cache(maxsize=_KEPT * _OTHERS_KEPT)
def _file_ship(reports: AisReports, place: Place, duration: float, margin: float) -> FileShip:
    """Return a ship on the smooth track through its reports, in the frame of a flight."""
    since = reports.time - place.utc
    at, velocity = _in_frame(
        place.frame, reports.latitude, reports.longitude, reports.speed, reports.course
    )
    smooth = smooth_motion(since, at, velocity)
    first, last = float(since[0]), float(since[-1])
    times = track_times(duration + margin)
    along = smooth.derivative()(np.clip(times, first, min(last, duration)))
    origin = smooth(max(first, 0.0)) - max(first, 0.0) * along[0]
    earliest = max((float(t) for t in since if t <= -_KNOWN_BEFORE), default=float(since[0]))
    return FileShip(
        mmsi=reports.mmsi,
        track=TabledVessel(along, _course_of(along), _manoeuvres_end(along)),
        origin=(float(origin[0]), float(origin[1])),
        begins=first,
        ends=last,
        reports=tuple(
            VesselReport(float(t), float(p[0]), float(p[1]), float(v[0]), float(v[1]))
            for t, p, v in zip(since, at, velocity, strict=True)
            if earliest <= t <= duration
        ),
    )


def ships_of_file(
    path: str | Path,
    *,
    without: int | None,
    only: int | None = None,
    place: Place,
    duration: float,
    margin: float,
    key: str = "vessel",
    written: TableFormat = FOUND,
) -> list[FileShip]:
    """Return the ships of a file of AIS reports that have reports during a flight, without the
    measured one.

    Parameters
    ----------
    path : of the file
    without, only : MMSI of a ship that is left out; or of the only one that is taken
    place : where and when the flight begins
    duration, margin : of the longest flight, and for how long tracks go on after it [s]
    key : of the scenario that has the file
    written : how the file is written if it is a table, as far as it is given

    Raises
    ------
    InputError : the file cannot be read, its layout is unknown, or it does not have the ship
        ``only``
    """
    path = Path(path)
    try:
        stamp = path.stat()
    except OSError as error:
        raise InputError(
            f"{key}.track: {path}: cannot be read: {error.strerror}; check the path"
        ) from None
    begin, end = place.utc - _AROUND, place.utc + duration + _AROUND
    state = (stamp.st_mtime_ns, stamp.st_size)
    read = _read_others(path, state, without, only, begin, end, written)
    ships = [
        _file_ship(reports, place, duration, margin)
        for reports in read
        if reports.time[0] <= place.utc + duration and reports.time[-1] >= place.utc
    ]
    if not ships and key != "vessel":
        which = "no other ship" if only is None else f"no ship of MMSI {only}"
        raise InputError(
            f"{key}.track: {path}: {which} has two reports from {utc_text(place.utc)} to"
            f" {utc_text(place.utc + duration)}, the time of the longest flight: check"
            f" {key}.mmsi, place.utc and the file"
        )
    return ships


def received_of_file(
    reports: VesselReportsConfig,
    ship: Sequence[VesselReport],
    *,
    outages: Sequence[tuple[float, float]],
    generator: np.random.Generator,
) -> list[tuple[float, VesselReport]]:
    """Return reports of a file as they are received, with the time of each [s]; parameters of
    ``received_reports``.
    """
    return _received(reports, ship, outages=outages, generator=generator)


def usual_intervals(vessel: AisVessel) -> tuple[float, float]:
    """Return the shortest time between reports, and the longest but for one in twenty [s]: of the
    file where a flight has one.
    """
    times = [report.time for report in vessel.reports]
    gaps = np.diff(times if len(times) > 1 else vessel.source.time)
    return float(gaps.min()), float(np.quantile(gaps, 0.95))


def _around(time: Array, begin: float, end: float) -> slice:
    """Return which reports contribute to the track of a flight between two times [s]; the last
    before it and the first after it always do."""
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
    """Return the course over the ground without jumps [rad]; a vessel at rest keeps the last."""
    moving = np.hypot(velocity[:, 0], velocity[:, 1]) > _AT_REST
    if not moving.any():
        return np.zeros(len(velocity))
    # Before its first motion, the vessel points in the direction of that motion.
    last = np.maximum(
        np.maximum.accumulate(np.where(moving, np.arange(len(velocity)), -1)),
        int(np.argmax(moving)),
    )
    course: Array = np.unwrap(np.arctan2(velocity[:, 1], velocity[:, 0])[last])
    return course


def _manoeuvres_end(velocity: Array) -> float:
    """Return when the vessel last changed its velocity as in a manoeuvre [s]; NaN if it
    never did.
    """
    window = round(_MANOEUVRE_TIME / TRACK_STEP)
    change = np.hypot(*(velocity[window:] - velocity[:-window]).T) / _MANOEUVRE_TIME
    manoeuvring = np.flatnonzero(change > _MANOEUVRE)
    return TRACK_STEP * float(manoeuvring[-1] + window // 2) if len(manoeuvring) else math.nan


POSITION_SIGMA, VELOCITY_SIGMA = 5.0, 0.15
"""Errors of a report in the smoothing, one sigma: satellite navigation on board, whose fix is up to
a second old [m, m/s]."""

JERK_DENSITY = 5e-4
"""Density of the white noise that models the rate of acceleration: in 20 s a ship's acceleration
changes by 0.1 m/s^2 and more [m^2/s^5]."""


def smooth_motion(time: Array, place: Array, velocity: Array) -> "BPoly":
    """Return place over time: of degree 5 between reports, with continuous velocity and
    acceleration.

    It is the mean of a motion whose jerk is white noise, given all reports (H. E. Rauch, F. Tung,
    C. T. Striebel, AIAA J. 3:1445, 1965): between two reports that mean is the polynomial of degree
    5 through both smoothed states.

    Parameters
    ----------
    time : of the reports, rising, shape (n,) [s]
    place, velocity : as reported, shape (n, 2) [m, m/s]
    """
    from scipy.interpolate import BPoly

    filtered, predicted = [], []
    # At first only the usual size of a ship's acceleration is known.
    state = np.stack([place[0], velocity[0], np.zeros(2)])
    covariance = np.diag([POSITION_SIGMA**2, VELOCITY_SIGMA**2, 0.1**2])
    errors = np.diag([POSITION_SIGMA**2, VELOCITY_SIGMA**2])
    for i, step in enumerate(np.diff(time, prepend=time[0]).tolist()):
        transition = _transition(step)
        if i:
            state = transition @ state
            covariance = transition @ covariance @ transition.T + _noise(step)
            predicted.append((state, covariance, transition))
            gain = np.linalg.solve(covariance[:2, :2] + errors, covariance[:2]).T
            state = state + gain @ (np.stack([place[i], velocity[i]]) - state[:2])
            left = np.eye(3) - gain @ np.eye(2, 3)
            # Joseph's form: it stays positive definite where a gap has made the covariance large.
            covariance = left @ covariance @ left.T + gain @ errors @ gain.T
        filtered.append((state, covariance))
    smoothed = [state]
    for (state_before, covariance_before), (ahead, ahead_covariance, transition) in zip(
        reversed(filtered[:-1]), reversed(predicted), strict=True
    ):
        gain = np.linalg.solve(ahead_covariance, transition @ covariance_before).T
        smoothed.append(state_before + gain @ (smoothed[-1] - ahead))
    return BPoly.from_derivatives(time, np.stack(smoothed[::-1]))


def _transition(step: float) -> Array:
    return np.array([[1.0, step, 0.5 * step**2], [0.0, 1.0, step], [0.0, 0.0, 1.0]])


def _noise(step: float) -> Array:
    """Return the covariance that white jerk adds in a time step (Bar-Shalom et al., Estimation with
    Applications, 6.2.3).
    """
    t = step
    return JERK_DENSITY * np.array(
        [
            [t**5 / 20.0, t**4 / 8.0, t**3 / 6.0],
            [t**4 / 8.0, t**3 / 3.0, t**2 / 2.0],
            [t**3 / 6.0, t**2 / 2.0, t],
        ]
    )


def received_reports(
    reports: VesselReportsConfig,
    vessel: VesselTruth,
    *,
    duration: float,
    outages: Sequence[tuple[float, float]],
    generator: np.random.Generator,
    antenna: tuple[float, float] = AT_THE_FUNNEL,
    heading_generator: np.random.Generator | None = None,
) -> list[tuple[float, VesselReport]]:
    """Return the reports that are received, with the time at which each is [s], in the order in
    which they are received.

    The first one, at time 0, is always received: a flight begins with a known vessel.

    Parameters
    ----------
    reports : how reports are sent and received; exact knowledge does not need them
    vessel : its motion
    duration : of the flight [s]
    outages : times between which nothing is received [s]
    generator : of the random numbers
    antenna : place to which reports refer, ahead of the funnel and to starboard of it [m]; received
        reports are converted to the funnel
    heading_generator : of the errors of heading and rate of turn, where the antenna is elsewhere
    """
    if isinstance(vessel, AisVessel):
        return _received_from_file(reports, vessel, outages=outages, generator=generator)
    received = []
    time = 0.0
    while time <= duration:
        late = float(generator.uniform(0.0, reports.latency_max_s)) if time > 0.0 else 0.0
        missed = bool(generator.random() < reports.missing)
        errors = generator.standard_normal(4)
        north, east, v_north, v_east = vessel.motion(time)
        report = VesselReport(
            time=time,
            north=north + reports.position_sigma_m * float(errors[0]),
            east=east + reports.position_sigma_m * float(errors[1]),
            velocity_north=v_north + reports.velocity_sigma_mps * float(errors[2]),
            velocity_east=v_east + reports.velocity_sigma_mps * float(errors[3]),
        )
        if antenna != AT_THE_FUNNEL and heading_generator is not None:
            report = _by_antenna(report, vessel, reports, antenna, heading_generator)
        if time == 0.0 or not (missed or _within(outages, time + late)):
            received.append((time + late, report))
        time += float(generator.uniform(*reports.interval_s))
    return sorted(received, key=lambda entry: entry[0])


def _by_antenna(
    funnel: VesselReport,
    vessel: VesselTruth,
    reports: VesselReportsConfig,
    antenna: tuple[float, float],
    generator: np.random.Generator,
) -> VesselReport:
    """Return the report of the funnel that is computed on board from one of the antenna.

    Parameters
    ----------
    funnel : motion that a report of the funnel would have
    vessel, reports, antenna, generator : as in ``received_reports``
    """
    time, off = funnel.time, generator.standard_normal(2)
    heading, rate = vessel.course(time), _turn_rate(vessel, time)
    reported = AntennaReport(
        motion=at_antenna(funnel, antenna, heading, rate),
        heading=heading + math.radians(reports.heading_sigma_deg) * float(off[0]),
        turn_rate=rate + math.radians(reports.turn_rate_sigma_deg_s) * float(off[1]),
    )
    return at_funnel(reported, antenna)


def _turn_rate(vessel: VesselTruth, time: float) -> float:
    """Return how fast a vessel turns [rad/s], over a step of its track."""
    return (vessel.course(time + TRACK_STEP) - vessel.course(time)) / TRACK_STEP


def _received_from_file(
    reports: VesselReportsConfig,
    vessel: AisVessel,
    *,
    outages: Sequence[tuple[float, float]],
    generator: np.random.Generator,
) -> list[tuple[float, VesselReport]]:
    """Return the file's reports as they are received: late or missing where the scenario says so,
    except for those before the flight.
    """
    return _received(reports, vessel.reports, outages=outages, generator=generator)


def _received(
    reports: VesselReportsConfig,
    sent: Sequence[VesselReport],
    *,
    outages: Sequence[tuple[float, float]],
    generator: np.random.Generator,
) -> list[tuple[float, VesselReport]]:
    """Return reports of a file as they are received."""
    received = []
    for report in sent:
        late = float(generator.uniform(0.0, reports.latency_max_s))
        missed = bool(generator.random() < reports.missing)
        if report.time <= 0.0:
            received.append((report.time, report))
        elif not (missed or _within(outages, report.time + late)):
            received.append((report.time + late, report))
    return sorted(received, key=lambda entry: entry[0])


def _within(intervals: Sequence[tuple[float, float]], time: float) -> bool:
    return any(begins <= time < ends for begins, ends in intervals)
