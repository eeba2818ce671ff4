"""The closed loop over a real sea: vehicle, sensors, what is heard of the vessel, guidance, faults, and the record."""

import math
import struct
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gnc.estimation.health import Fault
from gnc.estimation.vessel_filter import VesselReport
from gnc.sea_guidance import SeaGuidance
from scenarios.planning.sea_planner import SeaPlan
from scenarios.simulation.interventions import Intervention, interventions
from scenarios.simulation.outcome import Outcome
from scenarios.simulation.sea_settling import Settling
from scenarios.vehicles.vehicle import SAMPLE_COLUMNS, Vehicle
from scenarios.world.weather import SATELLITES, VESSEL_DATA

SEA_COLUMNS = (
    "time_s", "north_m", "east_m", "velocity_north_mps", "velocity_east_mps", "heading_rate_rad_s",
    "vessel_north_m", "vessel_east_m", "vessel_velocity_north_mps", "vessel_velocity_east_mps", "plume_axis_rad",
    "reference_north_m", "reference_east_m", "reference_course_rad", "reference_heading_rate_rad_s",
    "centre_north_m", "centre_east_m", "centre_error_m", "wind_north_mps", "wind_east_mps",
    "vessel_seen_north_m", "vessel_seen_east_m", "speed_ratio", "mode",
    "heading_rate_wanted_rad_s", "heading_rate_command_rad_s", "airspeed_command_mps", "guard",
    *SAMPLE_COLUMNS,
)  # fmt: skip
"""Columns of a flight's record.

Places and velocities are over the ground; the reference's course is through the air. The plume's axis, vessel and own motion are
true; ``seen``, centre, wind and speed ratio are what the guidance takes them to be. ``mode`` is a place in
``gnc.sea_parameters.Mode``; ``guard`` is 1 while the keep-out guard changes commands, 2 while it cannot hold its radius.
"""

DITCHED = "ditched"
"""Mode of a flight that ended on the water, as it meant to."""

_ON_THE_WATER = 2.0
"""Altitude below which a gliding vehicle has come down [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeaRecord:
    """What was flown.

    Attributes
    ----------
    outcome, message : how it ended, in a word and in a sentence
    mode : what the guidance was doing at the end, or ``DITCHED``
    settled_at : when it had settled, not a number if it never had [s]
    interventions : each time that the keep-out guard changed commands
    history : shape (samples, len(SEA_COLUMNS))
    every_step : the same of every step of the guidance, if that was recorded; otherwise ``history``
    """

    outcome: Outcome
    message: str
    mode: str
    settled_at: float
    interventions: list[Intervention]
    history: npt.NDArray[np.float64]
    every_step: npt.NDArray[np.float64]


def fly_sea(plan: SeaPlan, vehicle: Vehicle, *, every_step: bool = False) -> SeaRecord:
    """Fly ``plan`` with a vehicle that stands at its start.

    The flight ends one sample after the last wanted crossing, or when its time is up; on the water; or out of control. To record
    ``every_step`` of the guidance, beside the samples, changes nothing of the flight.
    """
    flight = _Flight(plan, vehicle, record_interval=1 if every_step else plan.log_interval)
    time_step, steps_max = plan.guidance.guidance.time_step, round(plan.duration_max / plan.guidance.guidance.time_step)
    outcome, message, ditched = Outcome.NOT_SETTLED if plan.crossings else Outcome.COMPLETED, "", False
    for step in range(steps_max + 1):
        airspeed_error = flight.guide(step)
        sampled = step % plan.log_interval == 0
        if sampled or every_step:
            sample = vehicle.sample()
            complete = flight.record(step * time_step, sample, judged=sampled)
        if sampled:
            ditched = flight.guidance.health.fault_detected and sample[0] < _ON_THE_WATER
            message = "" if ditched else vehicle.fault(sample)
            if message:
                outcome, message = Outcome.DIVERGED, f"{message} at {step * time_step:.1f} s"
            elif ditched or complete:
                outcome = Outcome.COMPLETED
            if ditched or complete or message:
                break
        # An autopilot that measures its airspeed with an error flies that much past the command.
        vehicle.advance(flight.guidance.heading_rate_command, flight.guidance.airspeed_command - airspeed_error)
    if outcome is Outcome.NOT_SETTLED:
        message = (
            f"{flight.settling.crossings} of {plan.crossings} crossings flown after settling within {plan.duration_max:g} s;"
            " allow more time (flight.duration_max_s) or start closer"
        )
    record = np.frombuffer(flight.rows).reshape(-1, len(SEA_COLUMNS))
    return SeaRecord(
        outcome=outcome,
        message=message,
        mode=DITCHED if ditched else flight.guidance.mode.value,
        settled_at=flight.settling.at,
        interventions=interventions(flight.guarding, time_step),
        history=record[:: plan.log_interval] if every_step else record,
        every_step=record,
    )


class _Flight:
    """A flight under way: what is sensed and heard goes to the guidance, its altitude and faults to the vehicle."""

    def __init__(self, plan: SeaPlan, vehicle: Vehicle, *, record_interval: int) -> None:
        self._plan, self._vehicle, self._track = plan, vehicle, plan.track
        self._heard = None if plan.heard is None else list(reversed(plan.heard))
        self._motion = vehicle.motion()
        self._altitude = plan.altitude
        self._time_step = plan.guidance.guidance.time_step
        self._reference = (0.0, 0.0, 0.0, 0.0)
        self._record_interval = record_interval
        self._held = False
        self._failing = plan.fault.of_aircraft()
        self.guidance = SeaGuidance(plan.guidance, plan.vessel_filter, plan.guard)
        self.settling = Settling(band=plan.settling_band, period=plan.oscillation.period, crossings=plan.crossings)
        # As bytes: tuples would be numbers by the hundred thousand for Python to look after, and slow to make an array of.
        self.rows = bytearray()
        self._pack = struct.Struct(f"{len(SEA_COLUMNS)}d").pack
        self.guarding: list[tuple[int, float, bool]] = []

    def guide(self, step: int) -> float:
        """Let the guidance compute its commands; return the error of the measured airspeed [m/s]."""
        plan, vehicle, guidance = self._plan, self._vehicle, self.guidance
        time = step * self._time_step
        self._motion = motion = vehicle.motion()
        airspeed, heading, roll = vehicle.air_data()
        if self._heard is None:
            # The flight begins with a vessel that is known, whatever fails.
            silent = step > 0 and plan.fault.lasts(VESSEL_DATA, time)
            if step % plan.guidance.plan_interval == 0 and not silent:
                guidance.vessel.report(VesselReport(time, *self._track.motion(time)))
        else:
            while self._heard and self._heard[-1][0] <= time:
                guidance.vessel.report(self._heard.pop()[1])
        if self._failing and time >= plan.fault.begins:
            self._failing = False
            vehicle.fail(plan.fault.kind)
        satellites = not plan.fault.lasts(SATELLITES, time)
        if step > 0 and step % self._record_interval == 0:
            self._note_reference()
        position, measured_airspeed, measured_heading = plan.errors.read(step, motion, airspeed, heading, satellites=satellites)
        guidance.step(time, position, measured_airspeed, measured_heading, roll, motion[4], vehicle.servo_error())
        if step == 0:
            # There is no reference before the guidance has looked for the first time.
            self._note_reference()
        if guidance.altitude_command != self._altitude:
            self._altitude = guidance.altitude_command
            vehicle.command_altitude(self._altitude)
        if not self._held and guidance.health.fault is Fault.ACTUATOR_STUCK:
            # Where one surface is elevator and aileron, each would undo the other's work.
            self._held = True
            vehicle.hold_elevator()
        guard = guidance.guard
        if guard is not None and guard.intervening:
            x, y = motion[0] - guidance.vessel_north, motion[1] - guidance.vessel_east
            self.guarding.append((step, math.hypot(x, y), guard.lost))
        return measured_airspeed - airspeed

    def _note_reference(self) -> None:
        """Note where the reference is now, in the air mass: the guidance moves it on as it computes its commands."""
        reference = self.guidance.guidance.reference
        self._reference = reference.north, reference.east, reference.course, reference.heading_rate

    def record(self, time: float, sample: tuple[float, ...], *, judged: bool) -> bool:
        """Keep a row; return whether the flight has all it wants, which is ``judged`` by samples alone."""
        guidance, motion = self.guidance, self._motion
        vessel, axis = self._track.motion(time), self._track.axis(time)
        air_north, air_east, course, turning = self._reference
        navigation, wind, centre = guidance.navigation, guidance.navigation.wind, guidance.centre
        north, east = air_north + navigation.drift_north, air_east + navigation.drift_east
        guard = guidance.guard
        self.rows += self._pack(
            time, *motion, *vessel, axis,
            north, east, course, turning,
            guidance.vessel_north + centre.x, guidance.vessel_east + centre.y, guidance.centre_error, wind.north, wind.east,
            guidance.vessel_north, guidance.vessel_east, centre.speed_ratio, guidance.mode_number,
            guidance.guidance.heading_rate_wanted, guidance.heading_rate_command, guidance.airspeed_command,
            guard.intervening + guard.lost if guard else 0.0,
            *sample,
        )  # fmt: skip
        if not judged:
            return False
        off_centre = guidance.centre_error if guidance.in_place else math.inf
        return self.settling.update(
            time,
            tracking_error=math.hypot(north - motion[0], east - motion[1]),
            centre_error=off_centre,
            x=motion[0] - vessel[0],
            y=motion[1] - vessel[1],
            axis=axis,
        )
