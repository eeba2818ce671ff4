"""Keeps the samples of a flight under way."""

import math
import struct
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from common.plugins import call_plugin, numbers
from gnc.estimation.navigation import MeasuredMotion
from gnc.guidance import Guidance
from gnc.mission.mission import NO_CENTRE, OrbitStatus
from scenarios.flight.record import COLUMNS, Array
from scenarios.flight.settling import Settling
from scenarios.instruments.instrument import Instrument
from scenarios.vehicles.vehicle import Vehicle
from scenarios.world.world import World

_NO_ORBIT = OrbitStatus(NO_CENTRE, math.nan, in_place=False)

Place = tuple[float, float, float, float]
"""North and east [m], course [rad] and heading rate [rad/s]."""


class Recorder:
    """Records one flight, and watches whether it has settled.

    Parameters
    ----------
    guidance, vehicle, world : of the flight; the world may be absent
    payload : instruments on board
    settling : watches the flight

    Attributes
    ----------
    columns : of the record
    """

    __slots__ = (
        "_axis_at", "_guard", "_guidance", "_mission", "_own", "_pack", "_payload", "_rows", "_sample", "_settled", "_target",
        "_vessel_at", "columns",
    )  # fmt: skip

    def __init__(
        self,
        guidance: Guidance,
        vehicle: Vehicle,
        world: World | None,
        payload: Sequence[Instrument],
        settling: Settling,
    ) -> None:
        self._guidance, self._own, self._target = guidance, guidance.own, guidance.target
        self._mission, self._guard = guidance.mission, guidance.guard
        instruments: Sequence[Any] = payload
        self._sample, self._payload, self._settled = vehicle.sample, instruments, settling.update
        # A track, plume or instrument of a user's own may answer in other numbers than Python's,
        # and in other rows than tuples.
        self._vessel_at: Callable[[float], Any] = world.vessel.motion if world else _no_vessel
        self._axis_at: Callable[[float], Any] = world.plume.axis if world else _no_axis
        self.columns = COLUMNS + tuple(
            column for instrument in instruments for column in instrument.COLUMNS
        )
        # As bytes: tuples would be numbers by the hundred thousand for Python to look after, and
        # slow to make an array of.
        self._rows, self._pack = list[bytes](), struct.Struct(f"{len(self.columns)}d").pack

    def reference(self) -> Place | None:
        """Return where the reference is in the frame of the air mass; nothing before the mission
        has placed it.
        """
        if self._mission.orbit is None:
            return None
        reference = self._mission.tracker.reference
        return reference.north, reference.east, reference.course, reference.heading_rate

    def record(
        self, time: float, motion: MeasuredMotion, reference: Place, *, judged: bool
    ) -> tuple[tuple[float, ...], bool]:
        """Keep a row; return the vehicle's sample, and whether the flight has all its crossings, by
        ``judged`` samples.

        Parameters
        ----------
        time : [s]
        motion : of the vehicle, true
        reference : as the guidance had it when it computed its commands
        """
        guidance, own, target, mission, guard = (
            self._guidance,
            self._own,
            self._target,
            self._mission,
            self._guard,
        )
        tracker = mission.tracker
        centre, centre_error, in_place = mission.orbit or _NO_ORBIT
        own_north, own_east, v_north, v_east, _ = motion
        north, east, course, heading_rate = reference
        north += own.drift_north
        east += own.drift_east
        vessel, axis = self._vessel_at(time), self._axis_at(time)
        seen_north, seen_east = target.north, target.east
        sample = self._sample()
        read: Sequence[Any] = ()
        if self._payload:
            read = _read_all(self._payload, time, motion, sample)
        self._rows.append(self._pack(
            time, *motion, math.atan2(v_east, v_north), *vessel, axis, north, east, course, heading_rate,
            seen_north + centre.x, seen_east + centre.y, centre_error, own.wind_north, own.wind_east,
            seen_north, seen_east, centre.speed_ratio, guidance.mode.number,
            tracker.heading_rate_demand, guidance.heading_rate_command, guidance.airspeed_command, guidance.altitude_command,
            tracker.saturated, float(guard.status) if guard is not None else 0.0,
            *sample, *read,
        ))  # fmt: skip
        if not judged:
            return sample, False
        error = math.hypot(north - own_north, east - own_east)
        place = centre_error if in_place else math.inf
        x, y = float(own_north - vessel[0]), float(own_east - vessel[1])
        return sample, self._settled(time, error, place, x, y, float(axis))

    def rows(self) -> Array:
        """Return what is recorded, shape (rows, columns)."""
        return np.frombuffer(b"".join(self._rows)).reshape(-1, len(self.columns))


def _read_all(
    payload: Sequence[Any], time: float, motion: MeasuredMotion, sample: tuple[float, ...]
) -> list[float]:
    """Return what instruments read, one after the other."""
    values: list[float] = []
    for instrument in payload:
        part = f"payload: instrument of class {type(instrument).__qualname__}"
        read = numbers(len(instrument.COLUMNS), "one for each of COLUMNS", finite=False)
        values += call_plugin(part, instrument.read, time, motion, sample, result=read)
    return values


def _no_vessel(_time: float) -> Place:
    return 0.0, 0.0, 0.0, 0.0


def _no_axis(_time: float) -> float:
    return math.nan
