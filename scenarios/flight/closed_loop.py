"""The closed loop: a vehicle, its sensing, the guidance at its rate, and the record. No other
module closes it.
"""

import math
from collections.abc import Generator, Sequence
from typing import Any, Protocol

from aircraft.fdm import Fdm
from aircraft.wind import CALM
from gnc.guard.guard import GuardStatus
from gnc.guidance import Guidance
from gnc.mission.axis import SearchedAxis
from gnc.mission.follow import PlumeFollowing
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from scenarios.flight.ending import EarlyStop, Ending, Settling
from scenarios.flight.guard_belief import GuardBelief
from scenarios.flight.onboard import OnboardSensing, PlumeBelief, PlumeReadings, axis_of
from scenarios.flight.record import NO_REFERENCE, FlightRecord, GuardedStep, Recorder, interventions
from scenarios.flight.traffic_belief import TrafficBelief
from scenarios.instruments.instrument import GasReader, Instrument
from scenarios.planning.flight_plan import FlightPlan
from scenarios.vehicles.jsbsim import JsbsimVehicle
from scenarios.vehicles.kinematic import KinematicVehicle
from scenarios.vehicles.vehicle import Vehicle
from scenarios.vehicles.vehicle_setup import VehicleSetup

Commands = tuple[float, float]
"""Heading rate [rad/s] and airspeed [m/s]."""


class ClosedLoop:
    """One flight: a vehicle at its start, and the guidance of the flight's plan.

    Parameters
    ----------
    plan, vehicle : the flight
    payload : instruments on board
    reader : sniffer that is read in flight, or None
    every_step : whether every step of the guidance is recorded in addition to the samples; the
        flight stays the same

    Attributes
    ----------
    plan, vehicle, guidance : of the flight
    settling : when it has settled, and how often it has crossed since
    ending : how it ended
    """

    def __init__(
        self,
        plan: FlightPlan,
        vehicle: Vehicle,
        payload: Sequence[Instrument],
        *,
        reader: GasReader | None,
        every_step: bool = False,
    ) -> None:
        self.plan, self.vehicle, self._every_step = plan, vehicle, every_step
        self.guidance = guidance = Guidance(plan.guidance)
        self.settling = Settling(
            band=plan.settling_band,
            period=plan.settling_period,
            crossings=plan.crossings,
            after=plan.after_settling,
        )
        axis = axis_of(guidance)
        beliefs: list[Any] = [PlumeBelief(axis)] if isinstance(axis, SearchedAxis) else []
        self._guard_belief: GuardBelief | None = None
        if guidance.guard is not None and plan.world is not None:
            vessel = plan.world.vessel
            self._guard_belief = GuardBelief(guidance, guidance.guard, vessel, plan.time_step)
            beliefs.append(self._guard_belief)
            if guidance.traffic is not None:
                beliefs.append(TrafficBelief(guidance, plan.world.traffic))
        self._recorder = Recorder(
            guidance, vehicle, plan.world, (*payload, *beliefs), self.settling
        )
        self._sensing = _sensing(plan, vehicle, guidance, reader)
        self.ending = Ending(
            plan,
            vehicle,
            guidance,
            self.settling,
            _early_stop(plan, guidance, reader, self.settling),
        )

    def steps(self) -> Generator[Commands, Commands, FlightRecord]:
        """Fly: yield the guidance's commands at each step, receive the commands to fly instead, and
        return the record at the end.

        The flight ends one sample after its last required crossing, so that every crossing lies
        inside the record; or when its time is up, when it has left with a verdict, when it is on
        the water, or when it is out of control.
        """
        # Local names are faster: this is the innermost loop of every flight.
        plan, guidance, sensing = self.plan, self.guidance, self._sensing
        recorder, ending, belief = self._recorder, self.ending, self._guard_belief
        mission, target, guard = guidance.mission, guidance.target, guidance.guard
        guide, reference_of = guidance.step, recorder.reference
        motion_of, advance = self.vehicle.motion, self.vehicle.advance
        time_step, log_interval = plan.time_step, plan.log_interval
        record_interval = 1 if self._every_step else log_interval
        demand_max = command_max = airspeed_error = 0.0
        saturated = step = 0
        guarded: list[GuardedStep] = []
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
            demand, command = tracker.heading_rate_demand, guidance.heading_rate_command
            if demand > demand_max or -demand > demand_max:
                demand_max = abs(demand)
            commanded = abs(command)
            if commanded > plan.heading_rate_max:
                # In a gust, omega_max over the mean air may take more through the air.
                commanded = min(commanded, abs(tracker.heading_rate_command))
            command_max = max(command_max, commanded)
            saturated += tracker.saturated
            if guidance.guarding and guard is not None:
                distance = math.hypot(motion.north - target.north, motion.east - target.east)
                guarded.append(GuardedStep(step, distance, guard.status is GuardStatus.LOST))
            if recorded:
                sampled = step % log_interval == 0
                placed = reference or reference_of() or NO_REFERENCE
                sample, complete = recorder.record(time, motion, placed, judged=sampled)
                if sampled and ending.reached(time, motion, sample, complete=complete):
                    break
            command, airspeed = yield command, guidance.airspeed_command
            if belief is not None:
                belief.command(tracker.heading_rate_command)
            advance(command, airspeed - airspeed_error)
        ending.guarded, ending.saturated = bool(guarded), saturated / (step + 1)
        rows = recorder.rows()
        return FlightRecord(
            outcome=ending.outcome,
            message=ending.message,
            mode=ending.mode,
            stop_reason=ending.stop_reason,
            verdict=ending.verdict,
            settled_at=self.settling.at,
            interventions=interventions(guarded, time_step),
            columns=recorder.columns,
            history=rows[::log_interval] if self._every_step else rows,
            every_step=rows,
            saturation_fraction=ending.saturated,
            heading_rate_demand_max=demand_max,
            heading_rate_command_max=command_max,
            guard_time=len(guarded) * time_step,
        )


def fly(
    plan: FlightPlan,
    vehicle: Vehicle,
    payload: Sequence[Instrument] = (),
    *,
    reader: GasReader | None = None,
    every_step: bool = False,
) -> FlightRecord:
    """Fly ``plan`` by the commands of its guidance, with a vehicle that is at the start; parameters
    are those of ``ClosedLoop``.
    """
    steps = ClosedLoop(plan, vehicle, payload, reader=reader, every_step=every_step).steps()
    follow = steps.send
    try:
        commands = next(steps)
        while True:
            commands = follow(commands)
    except StopIteration as over:
        return record_of(over)


def record_of(over: StopIteration) -> FlightRecord:
    """Return the record of a flight from the end of its steps.

    Raises
    ------
    RuntimeError : a user's part has ended the steps. Python raises this itself (PEP 479), but not
        for compiled steps
    """
    record = over.value
    if not isinstance(record, FlightRecord):
        raise RuntimeError("generator raised StopIteration") from over
    return record


def _sensing(
    plan: FlightPlan, vehicle: Vehicle, guidance: Guidance, reader: GasReader | None
) -> OnboardSensing | None:
    """Return the sensing of a flight; None where everything is known exactly."""
    sensing, world, axis = plan.sensing, plan.world, axis_of(guidance)
    if sensing is None or world is None:
        return None
    readings = None
    if axis is not None and (reader is not None or sensing.knows_axis):
        readings = PlumeReadings(
            reader, world, vehicle, axis, interval=plan.log_interval, knows_axis=sensing.knows_axis
        )
    return OnboardSensing(
        sensing, world, vehicle, guidance, altitude=plan.altitude, readings=readings
    )


def _early_stop(
    plan: FlightPlan, guidance: Guidance, reader: GasReader | None, settling: Settling
) -> EarlyStop | None:
    """Return the early stop of a flight that may end early, or None."""
    mission = guidance.mission
    if not plan.until_verdict or reader is None or not isinstance(mission, PlumeFollowing):
        return None
    return EarlyStop(reader, mission, settling)


class Viewer(Protocol):
    """Another program that shows an aircraft while its flight is replayed, in real time.

    Its class is called with the address that the user gives. An installed package announces the
    class in the group ``plume_flight_study.viewer``, and its name becomes an option of
    ``plume-flight run``. The class raises an ``InputError`` for an invalid address.
    """

    def show(self, fdm: Fdm) -> None:
        """Show an aircraft from now on; the caller places it after this call."""


def failable(plan: FlightPlan) -> bool:
    """Return whether a part of the aircraft may fail in a flight."""
    return plan.world is not None and bool(plan.world.faults.of_aircraft())


def release(
    plan: FlightPlan,
    setup: VehicleSetup,
    viewer: Viewer | None = None,
    *,
    flown: AutopilotedAircraft | None = None,
) -> Vehicle:
    """Return the vehicle at the start of a flight.

    Parameters
    ----------
    plan : the flight
    setup : of the aircraft, or of the kinematic vehicle
    viewer : shows the aircraft in real time; by default there is no viewer
    flown : an aircraft of an earlier flight, to be used again; by default a new one
    """
    start, world = plan.start, plan.world
    where = {
        "north": start.north,
        "east": start.east,
        "altitude": plan.altitude,
        "course": start.course,
    }
    aircraft = setup.aircraft
    if aircraft is None:
        wind = world.weather.wind if world else CALM
        return KinematicVehicle(
            **where, speed=plan.guidance.speed, time_step=plan.time_step, lag=setup.lag, wind=wind
        )
    flown = flown or AutopilotedAircraft(aircraft.spec, aircraft.model, failable=failable(plan))
    if viewer is not None:
        viewer.show(flown.fdm)
    # Still air needs no weather model.
    weather = world.weather if world and plan.sensing else None
    return JsbsimVehicle(
        flown, aircraft.start, aircraft.envelope, **where, time_step=plan.time_step, weather=weather
    )
