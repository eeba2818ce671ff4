"""The closed loop: a vehicle, the guidance at its own rate, and the record. It is closed here only."""

import math
import struct
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gnc.tracker import Guidance
from scenarios.planning.planner import FlightPlan, Mission
from scenarios.simulation.outcome import Outcome
from scenarios.vehicles.vehicle import SAMPLE_COLUMNS, Vehicle

COLUMNS = (
    "time_s",
    "north_m",
    "east_m",
    "velocity_north_mps",
    "velocity_east_mps",
    "heading_rate_rad_s",
    "course_rad",
    "reference_north_m",
    "reference_east_m",
    "reference_course_rad",
    "reference_heading_rate_rad_s",
    "heading_rate_wanted_rad_s",
    "heading_rate_command_rad_s",
    "airspeed_command_mps",
    "command_saturated",
    "guard_intervening",
    *SAMPLE_COLUMNS,
)
"""Columns of a flight's record. Course is that of the horizontal motion, from -pi to pi."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightRecord:
    """What was flown.

    Attributes
    ----------
    outcome, message : how it ended, in a word and in a sentence
    history : shape (samples, len(COLUMNS))
    every_step : the same of every step of the guidance, if that was recorded; otherwise ``history``
    saturation_fraction : share of guidance steps whose command was cut at omega_max [-]
    heading_rate_wanted_max, heading_rate_command_max : largest heading rate that the law asked for, and that was commanded, at any
        step of the guidance [rad/s]
    guard_interventions : how often the keep-out guard began to change commands
    guard_time : for how long it did, altogether [s]
    """

    outcome: Outcome
    message: str
    history: npt.NDArray[np.float64]
    every_step: npt.NDArray[np.float64]
    saturation_fraction: float
    heading_rate_wanted_max: float
    heading_rate_command_max: float
    guard_interventions: int
    guard_time: float


def fly(plan: FlightPlan, vehicle: Vehicle, *, every_step: bool = False) -> FlightRecord:
    """Fly ``plan`` with a vehicle that stands at its start.

    With a mission the flight ends one sample after the last wanted crossing, so that every crossing lies inside the record; without
    one it lasts as long as planned. To record ``every_step`` of the guidance, beside the samples, changes nothing of the flight.
    """
    guidance = Guidance(plan.guidance, plan.reference, guard=plan.mission.guard if plan.mission else None)
    guard = guidance.guard
    vessel_north, vessel_east = plan.mission.vessel.velocity_ned if plan.mission else (0.0, 0.0)
    counter = _CrossingCounter(plan.mission, plan.settling_band) if plan.mission else None
    reference, time_step, log_interval = guidance.reference, plan.guidance.time_step, plan.log_interval
    steps_max = round(plan.duration_max / time_step)
    # As bytes: tuples would be numbers by the hundred thousand for Python to look after, and slow to make an array of.
    rows, packed = bytearray(), struct.Struct(f"{len(COLUMNS)}d").pack
    outcome, message = (Outcome.NOT_SETTLED if counter else Outcome.COMPLETED), ""
    wanted_max = command_max = 0.0
    saturated = guarded = finished_at = step = 0
    done = guarding = False
    while step <= steps_max:
        motion = north, east, velocity_north, velocity_east, heading_rate = vehicle.motion()
        course = math.atan2(velocity_east, velocity_north)
        time = step * time_step
        disc = at_north, at_east, _, _ = (vessel_north * time, vessel_east * time, vessel_north, vessel_east)
        if counter:
            to_north, to_east = reference.north - north, reference.east - east
            done = counter.update(north - at_north, east - at_east, to_north, to_east)
        sampled = step % log_interval == 0
        recorded = sampled or every_step
        if recorded:
            # The guidance moves the reference on.
            at = (reference.north, reference.east, reference.course, reference.heading_rate)
        guidance.step(north, east, course, math.sqrt(velocity_north**2 + velocity_east**2), heading_rate, disc)
        wanted, command = guidance.heading_rate_wanted, guidance.heading_rate_command
        wanted_max = max(wanted_max, abs(wanted))
        command_max = max(command_max, abs(command))
        saturated += guidance.saturated
        if guard:
            guarding = guard.intervening
            guarded += guarding
        if recorded:
            sample = vehicle.sample()
            rows += packed(
                time, *motion, course, *at, wanted, command, guidance.airspeed_command, guidance.saturated, guarding, *sample
            )
        if sampled:
            message = vehicle.fault(sample)
            if message:
                outcome, message = Outcome.DIVERGED, f"{message} at {time:.1f} s"
                break
            if done and step > finished_at:
                outcome = Outcome.COMPLETED
                break
        if not done:
            finished_at = step
        vehicle.advance(command, guidance.airspeed_command)
        step += 1
    if counter and outcome is Outcome.NOT_SETTLED:
        message = (
            f"{counter.count} of {counter.wanted} crossings flown after settling within {plan.duration_max:g} s;"
            " allow more time (flight.duration_max_s), start closer, or see whether the guard holds it off (guidance.keepout_guard)"
        )
    record = np.frombuffer(rows).reshape(-1, len(COLUMNS))
    return FlightRecord(
        outcome=outcome,
        message=message,
        history=record[::log_interval] if every_step else record,
        every_step=record,
        saturation_fraction=saturated / max(1, step),
        heading_rate_wanted_max=wanted_max,
        heading_rate_command_max=command_max,
        guard_interventions=guard.interventions if guard else 0,
        guard_time=guarded * time_step,
    )


class _CrossingCounter:
    """Counts crossings since the distance to the reference last left the settling band."""

    __slots__ = ("_axis_east", "_axis_north", "_band_squared", "_side", "count", "wanted")

    def __init__(self, mission: Mission, settling_band: float) -> None:
        self._axis_north, self._axis_east = mission.vessel.plume_direction_ned
        self._band_squared = settling_band**2
        self._side = 0.0
        self.wanted = mission.crossings
        self.count = 0

    def update(self, x: float, y: float, to_reference_north: float, to_reference_east: float) -> bool:
        """Take note of a step, ``x`` north and ``y`` east of the vessel; return whether the flight has all it wants."""
        before, self._side = self._side, self._axis_north * y - self._axis_east * x
        if to_reference_north * to_reference_north + to_reference_east * to_reference_east >= self._band_squared:
            self.count = 0
        elif before * self._side < 0.0 and self._axis_north * x + self._axis_east * y > 0.0:
            self.count += 1
        return self.count >= self.wanted
