"""The closed loop: JSBSim with its autopilot at 120 Hz, guidance at its own rate, and the record. It is closed here only."""

import math
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
import numpy.typing as npt

from aircraft.local_frame import LocalFrame
from aircraft.trim import Trim
from gnc.guidance import Guidance
from innerloop.flight import AutopilotedAircraft
from scenarios.plan import FlightPlan
from scenarios.telemetry import SAMPLE_COLUMNS, Telemetry


class Outcome(Enum):
    """How a flight ended."""

    COMPLETED = "completed"
    NOT_SETTLED = "not_settled"
    DIVERGED = "diverged"
    INFEASIBLE = "infeasible"
    TRIM_FAILED = "trim_failed"
    FAILED = "failed"


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
    "heading_rate_command_rad_s",
    "airspeed_command_mps",
    "command_saturated",
    *SAMPLE_COLUMNS,
)
"""Columns of a flight's time history. Course is that of the horizontal motion, from -pi to pi."""

_BANK_LIMIT = 1.4
_AIRSPEED_LIMITS = (8.0, 45.0)
_ALTITUDE_MIN = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightRecord:
    """What was flown.

    Attributes
    ----------
    outcome, message : how it ended, in a word and in a sentence
    history : shape (samples, len(COLUMNS))
    saturation_fraction : share of guidance steps whose command was cut at omega_max [-]
    """

    outcome: Outcome
    message: str
    history: npt.NDArray[np.float64]
    saturation_fraction: float


def fly(plan: FlightPlan, aircraft: AutopilotedAircraft, start: Trim) -> FlightRecord:
    """Fly ``plan`` from the straight and level equilibrium ``start``, at the planned place and course.

    The flight ends one sample after the last wanted crossing, so that every crossing lies inside the record.
    """
    frame = LocalFrame(altitude=plan.altitude)
    _release(plan, aircraft, start, frame)
    telemetry = Telemetry(aircraft.fdm, frame)
    guidance = Guidance(plan.guidance, plan.oscillation, plan.reference, phase=plan.phase, guard=plan.guard)
    counter = _CrossingCounter(plan)
    reference, run, time_step = guidance.reference, aircraft.fdm.run, plan.guidance.time_step
    runs_per_step = range(round(time_step / aircraft.fdm.time_step))
    steps_max = round(plan.duration_max / time_step)
    rows: list[tuple[float, ...]] = []
    outcome, message = Outcome.NOT_SETTLED, ""
    saturated = finished_at = step = 0
    while step <= steps_max:
        motion = north, east, velocity_north, velocity_east, heading_rate = telemetry.motion()
        course = math.atan2(velocity_east, velocity_north)
        at = (reference.north, reference.east, reference.course, reference.heading_rate)
        guidance.step(north, east, course, math.sqrt(velocity_north**2 + velocity_east**2), heading_rate)
        aircraft.command_heading_rate(guidance.heading_rate_command)
        aircraft.command_airspeed(guidance.airspeed_command)
        saturated += guidance.saturated
        done = counter.update(step * time_step, north, east, at[0] - north, at[1] - east)
        if step % plan.log_interval == 0:
            commands = (guidance.heading_rate_command, guidance.airspeed_command, guidance.saturated)
            sample = telemetry.sample()
            rows.append((step * time_step, *motion, course, *at, *commands, *sample))
            message = _divergence(*sample[:3])
            if message:
                outcome, message = Outcome.DIVERGED, f"{message} at {step * time_step:.1f} s"
                break
            if done and step > finished_at:
                outcome = Outcome.COMPLETED
                break
        if not done:
            finished_at = step
        for _ in runs_per_step:
            run()
        step += 1
    if outcome is Outcome.NOT_SETTLED:
        message = (
            f"{counter.count} of {plan.crossings} crossings flown after settling within {plan.duration_max:g} s;"
            " allow more time (flight.duration_max_s), start closer, or see whether the guard holds it off (guidance.keepout_guard)"
        )
    return FlightRecord(outcome=outcome, message=message, history=np.array(rows), saturation_fraction=saturated / max(1, step))


def _release(plan: FlightPlan, aircraft: AutopilotedAircraft, start: Trim, frame: LocalFrame) -> None:
    latitude, longitude = frame.to_geodetic(plan.start_north, plan.start_east)
    state = start.state(latitude, longitude, plan.start_course - start.course_offset())
    state = replace(state, altitude=plan.altitude)
    aircraft.release(state, airspeed=start.airspeed, altitude=plan.altitude)


class _CrossingCounter:
    """Counts crossings since the distance to the reference last left the settling band."""

    __slots__ = ("_axis_east", "_axis_north", "_band_squared", "_side", "_vessel_east", "_vessel_north", "_wanted", "count")

    def __init__(self, plan: FlightPlan) -> None:
        self._vessel_north, self._vessel_east = plan.vessel.velocity_ned
        self._axis_north, self._axis_east = plan.vessel.plume_direction_ned
        self._band_squared = plan.settling_band**2
        self._wanted = plan.crossings
        self._side = 0.0
        self.count = 0

    def update(self, time: float, north: float, east: float, to_reference_north: float, to_reference_east: float) -> bool:
        """Take note of a step; return whether the flight has all it wants."""
        x, y = north - self._vessel_north * time, east - self._vessel_east * time
        before, self._side = self._side, self._axis_north * y - self._axis_east * x
        if to_reference_north * to_reference_north + to_reference_east * to_reference_east >= self._band_squared:
            self.count = 0
        elif before * self._side < 0.0 and self._axis_north * x + self._axis_east * y > 0.0:
            self.count += 1
        return self.count >= self._wanted


def _divergence(altitude: float, airspeed: float, roll: float) -> str:
    """Return why the aircraft is out of control, or nothing. A value that is not a number is never within its limits."""
    low, high = _AIRSPEED_LIMITS
    if not abs(roll) < _BANK_LIMIT:
        return f"bank reached {math.degrees(roll):.0f} deg against a limit of {math.degrees(_BANK_LIMIT):.0f}"
    if not low < airspeed < high:
        return f"airspeed reached {airspeed:.1f} m/s outside {low:g} to {high:g}"
    if not altitude > _ALTITUDE_MIN:
        return f"altitude fell to {altitude:.1f} m"
    return ""
