"""Inputs of the guidance: sensors, reports and plume readings; and its outputs to the vehicle other
than heading rate and airspeed.
"""

import math

import numpy as np

from common.columns import described
from gnc.estimation.health import Fault
from gnc.estimation.navigation import MeasuredMotion, SensorReadings
from gnc.estimation.vessel import ReportedTarget, VesselReport
from gnc.guidance import Guidance
from gnc.mission.axis import ExpectedAxis, PredictedAxis, SearchedAxis
from gnc.mission.follow import PlumeFollowing
from scenarios.instruments.instrument import GasReader
from scenarios.planning.flight_plan import Sensing
from scenarios.vehicles.vehicle import Vehicle
from scenarios.world.faults import SATELLITES, VESSEL_DATA
from scenarios.world.world import World

_BELIEF_INTERVAL = 15.0
"""Time between evaluations of costly quantities [s]."""


class PlumeReadings:
    """Passes on the readings of a sniffer, and the true axis of the plume to a flight that knows
    it.

    Parameters
    ----------
    reader : a sniffer that is read in flight, or None
    world, vehicle : of the flight
    axis : of the plume, as the guidance has it
    interval : guidance steps between rows of the record, at which the sniffer's path is known
    knows_axis : whether the guidance is given the true axis
    """

    def __init__(
        self,
        reader: GasReader | None,
        world: World,
        vehicle: Vehicle,
        axis: ExpectedAxis,
        *,
        interval: int,
        knows_axis: bool,
    ) -> None:
        self._reader, self._world, self._vehicle, self._axis = reader, world, vehicle, axis
        self._interval, self._knows_axis = interval, knows_axis

    def pass_on(self, step: int, time: float, motion: MeasuredMotion, guidance: Guidance) -> None:
        """Pass on the readings up to a step, at which the guidance already knows its motion."""
        if step % self._interval == 0:
            sample, axis = self._vehicle.sample(), self._axis
            axis.flown = sample[0]
            readings = self._reader.follow(time, motion, sample) if self._reader is not None else ()
            if isinstance(axis, SearchedAxis):
                axis.take_readings(time, readings)
        if self._knows_axis and step % guidance.plan_interval == 0:
            self._set_true_axis(time, guidance)

    def _set_true_axis(self, time: float, guidance: Guidance) -> None:
        """Set the true mean axis at the guidance's centre of oscillation."""
        exhaust, orbit = self._world.exhaust, guidance.mission.orbit
        if exhaust is None or orbit is None or not isinstance(self._axis, PredictedAxis):
            return
        centre = orbit.centre
        north, east, _, _ = self._world.vessel.motion(time)
        height = self._world.source_height
        at = (np.array([value]) for value in (time, north + centre.x, east + centre.y, height))
        plume = exhaust.sample(*at)
        across, above = float(plume.across[0]), float(plume.axis_height[0])
        if math.isfinite(above):
            bearing, distance = math.atan2(centre.y, centre.x), math.hypot(centre.x, centre.y)
            self._axis.set_true_axis(above, bearing - math.atan2(across, distance))


BELIEF_COLUMNS = described(
    {
        "axis_height_estimated_m": "estimated height of the plume's axis",
        "axis_height_deviation_m": "standard deviation of the estimated height",
        "axis_offset_estimated_m": "estimated offset of the axis across the predicted one",
        "axis_offset_deviation_m": "standard deviation of the estimated offset",
        "axis_spread_estimated_m": "estimated vertical spread of the plume",
        "axis_spread_across_estimated_m": "estimated horizontal spread of the plume",
        "axis_measurable": "estimated probability that the plume can be crossed within the limits"
        " of the altitude",
        "axis_innovation": "mean normalised innovation squared of the passes, 1 where the filter is"
        " consistent",
    }
)
"""Columns of the time history of flights that search for the plume."""


class PlumeBelief:
    """The guidance's estimate of the plume, as columns of the time history.

    Parameters
    ----------
    axis : of the plume, as the guidance has it
    """

    COLUMNS = tuple(BELIEF_COLUMNS)

    def __init__(self, axis: SearchedAxis) -> None:
        self._axis = axis
        self._measurable, self._next = math.nan, 0.0

    def read(
        self,
        time: float,
        motion: MeasuredMotion,  # noqa: ARG002 - of an instrument
        sample: tuple[float, ...],  # noqa: ARG002 - of an instrument
    ) -> tuple[float, ...]:
        """Return a value for each column."""
        found = self._axis.estimate
        if time >= self._next:
            self._measurable, self._next = self._axis.measurable(), time + _BELIEF_INTERVAL
        return (
            found.height,
            found.height_deviation,
            found.offset,
            found.offset_deviation,
            found.spread,
            found.spread_across,
            self._measurable,
            found.innovation,
        )


def axis_of(guidance: Guidance) -> ExpectedAxis | None:
    """Return the axis of the plume that a guidance follows, if it follows one."""
    return guidance.mission.axis if isinstance(guidance.mission, PlumeFollowing) else None


class OnboardSensing:
    """Sensors with errors, reports of the vessel, and the flight's faults.

    Parameters
    ----------
    sensing : reports and errors
    world : the true motions, and the faults
    vehicle, guidance : of the flight; reports go straight to the filter of the guidance's target,
        at each plan where the vessel is known exactly
    altitude : of the vehicle at the start [m]
    readings : passes on the readings of the plume, or None

    Attributes
    ----------
    airspeed_error : of the last reading [m/s]; an autopilot that uses the reading misses its
        command by as much
    """

    def __init__(
        self,
        sensing: Sensing,
        world: World,
        vehicle: Vehicle,
        guidance: Guidance,
        *,
        altitude: float,
        readings: PlumeReadings | None = None,
    ) -> None:
        if not isinstance(guidance.target, ReportedTarget):
            raise TypeError(
                "the guidance knows its target exactly, and has no use for reports; give it a"
                " filter"
            )
        self._vehicle, self._guidance, self._readings = vehicle, guidance, readings
        self._faults, self._vessel = world.faults, world.vessel
        self._pending = list(reversed(world.faults.of_aircraft()))
        self._vessel_lost = bool(world.faults.intervals(VESSEL_DATA))
        self._satellites_lost = bool(world.faults.intervals(SATELLITES))
        self._read_with_errors = sensing.errors.read
        self._air_data, self._servo_error = vehicle.air_data, vehicle.servo_error
        self._engine = vehicle.engine
        self._exact = sensing.received is None
        self._received = list(reversed(sensing.received or []))
        self._report = guidance.target.report
        self._ships = [ship.track for ship in world.traffic]
        self._of_traffic = [
            None if received is None else list(reversed(received)) for received in sensing.traffic
        ]
        self._altitude, self._elevator_held = altitude, False
        self.airspeed_error = 0.0

    def read(self, step: int, time: float, motion: MeasuredMotion) -> SensorReadings:
        """Return the sensors' readings at a step; also pass on the reports that have arrived, and
        begin the faults that are due.
        """
        airspeed, heading, roll = self._air_data()
        faults = self._faults
        if self._exact:
            # The flight begins with a known vessel, regardless of faults.
            outage = self._vessel_lost and step > 0 and faults.lasts(VESSEL_DATA, time)
            if step % self._guidance.plan_interval == 0 and not outage:
                self._report(VesselReport(time, *self._vessel.motion(time)))
        else:
            while self._received and self._received[-1][0] <= time:
                self._report(self._received.pop()[1])
        if self._ships:
            self._report_traffic(step, time)
        while self._pending and time >= self._pending[-1].begins:
            self._vehicle.fail(self._pending.pop().kind)
        # It begins with a known own place, too: dead reckoning needs one.
        lost = self._satellites_lost and step > 0 and faults.lasts(SATELLITES, time)
        fix, measured, measured_heading = self._read_with_errors(
            step, motion, airspeed, heading, satellites=not lost
        )
        self.airspeed_error = measured - airspeed
        return SensorReadings(
            fix,
            measured,
            measured_heading,
            roll,
            motion.heading_rate,
            self._servo_error(),
            self._engine(),
        )

    def _report_traffic(self, step: int, time: float) -> None:
        """Pass on the reports of other ships that have arrived, at each plan."""
        traffic = self._guidance.traffic
        if traffic is None or step % self._guidance.plan_interval != 0:
            return
        outage = self._vessel_lost and step > 0 and self._faults.lasts(VESSEL_DATA, time)
        for number, received in enumerate(self._of_traffic):
            if received is None:
                if traffic.is_due(number, time) and not outage:
                    motion = self._ships[number].motion(time)
                    traffic.report(number, VesselReport(time, *motion))
            else:
                while received and received[-1][0] <= time:
                    traffic.report(number, received.pop()[1])

    def act(self, step: int, time: float, motion: MeasuredMotion) -> None:
        """Pass on the guidance's decisions other than heading rate and airspeed, and pass the
        readings to it.
        """
        guidance = self._guidance
        if self._readings is not None:
            self._readings.pass_on(step, time, motion, guidance)
        if guidance.altitude_command != self._altitude:
            self._altitude = guidance.altitude_command
            self._vehicle.command_altitude(self._altitude)
        monitor = guidance.monitor
        if (
            not self._elevator_held
            and monitor is not None
            and monitor.fault is Fault.ACTUATOR_STUCK
        ):
            # Where one surface is elevator and aileron, each function would counteract the other.
            self._elevator_held = True
            self._vehicle.hold_elevator()
