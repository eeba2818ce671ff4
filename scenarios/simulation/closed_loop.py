"""The closed loop: a vehicle, what is sensed, the guidance at its own rate, and the record. It is closed here only."""

import math
from collections.abc import Sequence

from gnc.compose import compose
from gnc.guidance import Guidance
from gnc.mission.plume_following import PlumeFollowing
from gnc.mission.searched_axis import SearchedAxis
from scenarios.instruments.instrument import GasReader, Instrument
from scenarios.planning.flight_plan import FlightPlan
from scenarios.simulation.ending import Ending
from scenarios.simulation.interventions import interventions
from scenarios.simulation.judge import Judge
from scenarios.simulation.onboard import OnboardSensing
from scenarios.simulation.plume_readings import PlumeBelief, PlumeReadings, axis_of
from scenarios.simulation.record import FlightRecord
from scenarios.simulation.recorder import Recorder
from scenarios.simulation.settling import Settling
from scenarios.vehicles.vehicle import Vehicle


def fly(
    plan: FlightPlan,
    vehicle: Vehicle,
    payload: Sequence[Instrument] = (),
    *,
    reader: GasReader | None = None,
    every_step: bool = False,
) -> FlightRecord:
    """Fly ``plan`` with a vehicle that stands at its start, and with a sniffer as ``reader`` where it is read in flight.

    The flight ends one sample after the last crossing that it is to fly, so that every crossing lies inside the record; when its
    time is up; when it has left with a verdict; on the water; or out of control. To record ``every_step`` of the guidance, beside
    the samples, changes nothing of the flight.
    """
    guidance = compose(plan.guidance)
    settling = Settling(band=plan.settling_band, period=plan.settling_period, crossings=plan.crossings, after=plan.after_settling)
    axis = axis_of(guidance)
    beliefs = (PlumeBelief(axis),) if isinstance(axis, SearchedAxis) else ()
    recorder = Recorder(guidance, vehicle, plan.world, (*payload, *beliefs), settling)
    sensing = _sensing(plan, vehicle, guidance, reader)
    mission, target, guard = guidance.mission, guidance.target, guidance.guard
    guide, motion_of, advance, reference_of = guidance.step, vehicle.motion, vehicle.advance, recorder.reference
    time_step, log_interval = plan.time_step, plan.log_interval
    record_interval = 1 if every_step else log_interval
    ending = Ending(plan, vehicle, guidance, settling, _judge(plan, guidance, reader, settling))
    demand_max = command_max = airspeed_error = 0.0
    saturated = step = 0
    guarding: list[tuple[int, float, bool]] = []
    for step in range(round(plan.duration_max / time_step) + 1):
        time, motion = step * time_step, motion_of()
        recorded = step % record_interval == 0
        # The guidance moves the reference on as it computes its commands.
        reference = reference_of() if recorded else None
        if sensing is None:
            guide(time, motion)
        else:
            guide(time, sensing.read(step, time, motion))
            sensing.act(step, time, motion)
            airspeed_error = sensing.airspeed_error
        tracker = mission.tracker
        demand, command = abs(tracker.heading_rate_demand), guidance.heading_rate_command
        demand_max = demand if demand > demand_max else demand_max
        size = abs(command)
        command_max = size if size > command_max else command_max
        saturated += tracker.saturated
        if guidance.guarding and guard is not None:
            guarding.append((step, math.hypot(motion[0] - target.north, motion[1] - target.east), guard.lost))
        if recorded:
            sampled = step % log_interval == 0
            sample, complete = recorder.record(time, motion, reference or reference_of() or (math.nan,) * 4, judged=sampled)
            if sampled and ending.reached(time, motion, sample, complete=complete):
                break
        advance(command, guidance.airspeed_command - airspeed_error)
    rows = recorder.rows()
    return FlightRecord(
        outcome=ending.outcome,
        message=ending.message,
        mode=ending.mode,
        enough=ending.enough,
        settled_at=settling.at,
        interventions=interventions(guarding, time_step),
        columns=recorder.columns,
        history=rows[::log_interval] if every_step else rows,
        every_step=rows,
        saturation_fraction=saturated / max(1, step),
        heading_rate_demand_max=demand_max,
        heading_rate_command_max=command_max,
        guard_time=len(guarding) * time_step,
    )


def _sensing(plan: FlightPlan, vehicle: Vehicle, guidance: Guidance, reader: GasReader | None) -> OnboardSensing | None:
    """Return the sensing of a flight; none where everything is known exactly."""
    sensing, world, axis = plan.sensing, plan.world, axis_of(guidance)
    if sensing is None or world is None:
        return None
    readings = None
    if axis is not None and (reader is not None or sensing.told):
        readings = PlumeReadings(reader, world, vehicle, axis, interval=plan.log_interval, told=sensing.told)
    return OnboardSensing(sensing, world, vehicle, guidance, altitude=plan.altitude, readings=readings)


def _judge(plan: FlightPlan, guidance: Guidance, reader: GasReader | None, settling: Settling) -> Judge | None:
    """Return what ends a flight when it has enough, of one that is to."""
    mission = guidance.mission
    if not plan.until_verdict or reader is None or not isinstance(mission, PlumeFollowing):
        return None
    return Judge(reader, mission, settling)
