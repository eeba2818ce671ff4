"""The record of a flight: its columns, each with unit and meaning, the way the flight ended, and
the commands that the keep-out guard changed.
"""

import math
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from common.columns import described
from common.plugins import call_plugin, numbers
from common.text import did_you_mean
from gnc.estimation.navigation import MeasuredMotion
from gnc.guidance import Guidance
from gnc.mission.mission import NO_CENTRE, OrbitStatus
from scenarios.flight.ending import Settling
from scenarios.flight.outcome import Outcome
from scenarios.instruments.instrument import Instrument
from scenarios.vehicles.vehicle import Vehicle
from scenarios.world.world import World

if TYPE_CHECKING:
    from measurement.estimate.repeated import RepeatedVerdict


class GuardedStep(NamedTuple):
    """A step of the guidance at which the keep-out guard changed the command.

    Attributes
    ----------
    step : its number
    distance : to the vessel, as the guidance knows it [m]
    lost : whether the guard's radius could not be held
    """

    step: int
    distance: float
    lost: bool


class Intervention(NamedTuple):
    """Consecutive guidance steps at which the guard changed the command.

    Attributes
    ----------
    time_s : when it began [s]
    duration_s : for how long it lasted [s]
    distance_min_m : least distance to the vessel, as the guidance knew it [m]
    lost : whether the guard's radius could not be held at some step
    """

    time_s: float
    duration_s: float
    distance_min_m: float
    lost: bool


def interventions(guarded: Sequence[GuardedStep], time_step: float) -> list[Intervention]:
    """Return the stretches of steps at which the guard changed commands, by the guidance's time
    step [s].
    """
    stretches: list[list[GuardedStep]] = []
    for entry in guarded:
        if stretches and entry.step == stretches[-1][-1].step + 1:
            stretches[-1].append(entry)
        else:
            stretches.append([entry])
    return [
        Intervention(
            time_s=stretch[0].step * time_step,
            duration_s=len(stretch) * time_step,
            distance_min_m=min(entry.distance for entry in stretch),
            lost=any(entry.lost for entry in stretch),
        )
        for stretch in stretches
    ]


Array = npt.NDArray[np.float64]

HISTORY_COLUMNS = described(
    {
        "time_s": "time since the start",
        "north_m": "place of the UAV over the ground, true",
        "east_m": "place of the UAV over the ground, true",
        "velocity_north_mps": "velocity over the ground, true",
        "velocity_east_mps": "velocity over the ground, true",
        "heading_rate_rad_s": "rate of the course through the air",
        "course_rad": "course over the ground, from -pi to pi",
        "vessel_north_m": "place of the vessel, true",
        "vessel_east_m": "place of the vessel, true",
        "vessel_velocity_north_mps": "velocity of the vessel over the ground, true",
        "vessel_velocity_east_mps": "velocity of the vessel over the ground, true",
        "plume_axis_rad": "course along which the plume trails, true",
        "reference_north_m": "place of the reference over the ground",
        "reference_east_m": "place of the reference over the ground",
        "reference_course_rad": "course of the reference through the air",
        "reference_heading_rate_rad_s": "rate of the reference's course",
        "centre_north_m": "centre of oscillation, as the guidance estimates it",
        "centre_east_m": "centre of oscillation, as the guidance estimates it",
        "centre_error_m": "distance of the orbit's centre from the centre of oscillation",
        "wind_north_mps": "velocity of the air mass, as estimated",
        "wind_east_mps": "velocity of the air mass, as estimated",
        "vessel_seen_north_m": "place of the vessel, as the guidance estimates it",
        "vessel_seen_east_m": "place of the vessel, as the guidance estimates it",
        "speed_ratio": "nu, as the guidance estimates it",
        "mode": "mode of the guidance, as an index into the manifest's modes",
        "heading_rate_demand_rad_s": "heading rate that the law demands, before any limit",
        "heading_rate_command_rad_s": "commanded heading rate",
        "airspeed_command_mps": "commanded airspeed",
        "altitude_command_m": "commanded altitude; far below the sea while a vehicle with a fault"
        " glides",
        "command_saturated": "1 while the demand is limited to omega_max",
        "guard": "1 while the keep-out guard changes commands, 2 while it cannot hold its radius",
        "altitude_m": "altitude above the sea",
        "airspeed_mps": "true airspeed, with gusts",
        "roll_rad": "roll",
        "climb_rate_mps": "climb rate",
        "heading_rad": "heading, from 0 to 2 pi",
        "pitch_rad": "pitch",
        "alpha_rad": "angle of attack",
        "sideslip_rad": "sideslip",
        "elevator": "elevator command, or its effect if it is commanded by that",
        "aileron": "aileron command, or its effect if it is commanded by that",
        "throttle": "throttle command",
        "rudder": "rudder command, or its effect if it is commanded by that",
        "delta_m": "look-ahead of the reference, equation (15)",
        "rho_m": "length of z, equation (16)",
        "phi_r_rad": "course of the reference against that of z, equation (19)",
        "phi_rad": "course through the air against that of z, equation (19)",
        "true_wind_north_mps": "velocity of the mean wind at the place and height of the UAV, true",
        "true_wind_east_mps": "velocity of the mean wind at the place and height of the UAV, true",
        "vessel_heading_rad": "heading of the vessel, true",
        "latitude_deg": "latitude of the UAV, true",
        "longitude_deg": "longitude of the UAV, true",
        "time_utc": "time in UTC",
    }
)
"""Columns of a time history, in order, with their meanings. The vehicle's columns, from
``altitude_m`` on, may be NaN.
"""

RELATIVE_COLUMNS = ("delta_m", "rho_m", "phi_r_rad", "phi_rad")
"""The states of equation (19), in its order: they follow from other columns."""

WIND_COLUMNS = ("true_wind_north_mps", "true_wind_east_mps")
"""The mean wind, for flights in wind: it follows from the scenario, too."""

HULL_COLUMNS = ("vessel_heading_rad",)
"""Heading of the bow, for flights beside a ship whose size is known."""

PLACE_COLUMNS = ("latitude_deg", "longitude_deg", "time_utc")
"""Place and time on earth, for flights whose place is known: they follow from other columns,
too.
"""

_DERIVED = RELATIVE_COLUMNS + WIND_COLUMNS + HULL_COLUMNS + PLACE_COLUMNS

COLUMNS = tuple(column for column in HISTORY_COLUMNS if column not in _DERIVED)
"""Columns of a flight's record."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightRecord:
    """The record of one flight.

    Attributes
    ----------
    outcome, message : how it ended, in a word and in a sentence
    mode : of the guidance at the end, or ``DITCHED``
    stop_reason : why it left early; empty if it did not
    verdict : on the fuel by all looks, of a flight that may end with a verdict, or None
    settled_at : time at which it had settled; NaN if it did not settle [s]
    interventions : each time that the keep-out guard changed commands
    columns : of the histories: ``COLUMNS``, and those of the payload
    history : shape (samples, len(columns))
    every_step : the same for every step of the guidance, if that was recorded; otherwise
        ``history``
    saturation_fraction : fraction of guidance steps whose demand was cut at omega_max [-]
    heading_rate_demand_max, heading_rate_command_max : largest heading rate that the law demanded,
        and that was commanded, at any step of the guidance [rad/s]
    guard_time : total time for which the guard changed commands [s]
    """

    outcome: Outcome
    message: str
    mode: str
    stop_reason: str = ""
    verdict: "RepeatedVerdict | None" = None
    settled_at: float
    interventions: list[Intervention]
    columns: tuple[str, ...]
    history: Array
    every_step: Array
    saturation_fraction: float
    heading_rate_demand_max: float
    heading_rate_command_max: float
    guard_time: float

    def column(self, name: str) -> Array:
        """Return one column of the history.

        Raises
        ------
        ValueError : it has no such column
        """
        if name not in self.columns:
            raise ValueError(
                f"the flight's record has no column '{name}'{did_you_mean(name, self.columns)}"
            )
        return self.history[:, self.columns.index(name)]


class ReferencePoint(NamedTuple):
    """Place and motion of the reference in the frame of the air mass.

    Attributes
    ----------
    north, east : [m]
    course, heading_rate : [rad, rad/s]
    """

    north: float
    east: float
    course: float
    heading_rate: float


NO_REFERENCE = ReferencePoint(math.nan, math.nan, math.nan, math.nan)
"""The reference before the mission has placed it."""

_NO_ORBIT = OrbitStatus(NO_CENTRE, math.nan, in_place=False)


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

    def __init__(
        self,
        guidance: Guidance,
        vehicle: Vehicle,
        world: World | None,
        payload: Sequence[Instrument],
        settling: Settling,
    ) -> None:
        instruments: Sequence[Any] = payload
        self._guidance = guidance
        self._own, self._target = guidance.own, guidance.target
        self._mission, self._guard = guidance.mission, guidance.guard
        self._sample, self._payload = vehicle.sample, instruments
        self._update_settling = settling.update
        # A user's track, plume or instrument may return numbers that are not Python's, and rows
        # that are not tuples.
        self._vessel_at: Callable[[float], Any] = world.vessel.motion if world else _no_vessel
        self._axis_at: Callable[[float], Any] = world.plume.axis if world else _no_axis
        own_columns = [column for instrument in instruments for column in instrument.COLUMNS]
        self.columns = COLUMNS + tuple(own_columns)
        # As bytes: tuples would be some hundred thousand numbers for Python's garbage collector,
        # and slow to convert to an array.
        self._rows: list[bytes] = []
        self._pack = struct.Struct(f"{len(self.columns)}d").pack

    def reference(self) -> ReferencePoint | None:
        """Return place and motion of the reference; None before the mission has placed it."""
        if self._mission.orbit is None:
            return None
        reference = self._mission.tracker.reference
        return ReferencePoint(
            reference.north, reference.east, reference.course, reference.heading_rate
        )

    def record(
        self, time: float, motion: MeasuredMotion, reference: ReferencePoint, *, judged: bool
    ) -> tuple[tuple[float, ...], bool]:
        """Keep a row; return the vehicle's sample, and whether the flight has all its crossings,
        from ``judged`` samples.

        Parameters
        ----------
        time : [s]
        motion : of the vehicle, true
        reference : as the guidance had it when it computed its commands
        """
        guidance, own, target = self._guidance, self._own, self._target
        mission, guard = self._mission, self._guard
        tracker = mission.tracker
        centre, centre_error, in_place = mission.orbit or _NO_ORBIT
        reference_north = reference.north + own.drift_north
        reference_east = reference.east + own.drift_east
        vessel, axis = self._vessel_at(time), self._axis_at(time)
        sample = self._sample()
        read: Sequence[Any] = ()
        if self._payload:
            read = _read_all(self._payload, time, motion, sample)
        self._rows.append(
            self._pack(
                time,
                *motion,
                math.atan2(motion.velocity_east, motion.velocity_north),
                *vessel,
                axis,
                reference_north,
                reference_east,
                reference.course,
                reference.heading_rate,
                target.north + centre.x,
                target.east + centre.y,
                centre_error,
                own.wind_north,
                own.wind_east,
                target.north,
                target.east,
                centre.speed_ratio,
                guidance.mode.number,
                tracker.heading_rate_demand,
                guidance.heading_rate_command,
                guidance.airspeed_command,
                guidance.altitude_command,
                tracker.saturated,
                float(guard.status) if guard is not None else 0.0,
                *sample,
                *read,
            )
        )
        if not judged:
            return sample, False
        settled = self._update_settling(
            time,
            math.hypot(reference_north - motion.north, reference_east - motion.east),
            centre_error if in_place else math.inf,
            float(motion.north - vessel[0]),
            float(motion.east - vessel[1]),
            float(axis),
        )
        return sample, settled

    def rows(self) -> Array:
        """Return the recorded rows, shape (rows, columns)."""
        return np.frombuffer(b"".join(self._rows)).reshape(-1, len(self.columns))


def _read_all(
    payload: Sequence[Any], time: float, motion: MeasuredMotion, sample: tuple[float, ...]
) -> list[float]:
    """Return the readings of the instruments, one after the other."""
    values: list[float] = []
    for instrument in payload:
        part = f"payload: instrument of class {type(instrument).__qualname__}"
        read = numbers(len(instrument.COLUMNS), "one for each of COLUMNS", finite=False)
        values += call_plugin(part, instrument.read, time, motion, sample, result=read)
    return values


def _no_vessel(_time: float) -> tuple[float, float, float, float]:
    return 0.0, 0.0, 0.0, 0.0


def _no_axis(_time: float) -> float:
    return math.nan
