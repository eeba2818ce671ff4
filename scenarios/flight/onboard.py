"""What the guidance learns by sensors and reports, and what it passes on to the vehicle beside its
commands.
"""

from gnc.estimation.health import Fault
from gnc.estimation.navigation import MeasuredMotion, SensorReadings
from gnc.estimation.vessel import ReportedTarget, VesselReport
from gnc.guidance import Guidance
from scenarios.flight.plume_readings import PlumeReadings
from scenarios.planning.flight_plan import Sensing
from scenarios.vehicles.vehicle import Vehicle
from scenarios.world.faults import SATELLITES, VESSEL_DATA
from scenarios.world.world import World


class OnboardSensing:
    """Sensors with errors, reports of the vessel, and the flight's fault.

    Parameters
    ----------
    sensing : reports and errors
    world : what is true, and what fails
    vehicle, guidance : under way; reports go straight to the filter of its target, at each plan
        where the vessel is known exactly
    altitude : that the vehicle holds at the start [m]
    readings : passes on what is learnt of the plume, or none

    Attributes
    ----------
    airspeed_error : of the last reading [m/s]; an autopilot that measures it flies that much past
        the command
    """

    __slots__ = (
        "_air_data", "_altitude", "_engine", "_exact", "_fault", "_guidance", "_held", "_read_with_errors", "_readings", "_received",
        "_report", "_satellites_fail", "_servo_error", "_vehicle", "_vessel", "airspeed_error", "failing",
    )  # fmt: skip

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
                "the guidance knows its target exactly, and has no use for reports; give it a filter"
            )
        self._fault, self._vessel = world.fault, world.vessel
        self._read_with_errors, self._air_data = sensing.errors.read, vehicle.air_data
        self._servo_error, self._engine = vehicle.servo_error, vehicle.engine
        self._exact, self._received = (
            sensing.received is None,
            list(reversed(sensing.received or [])),
        )
        self._vehicle, self._guidance, self._readings = vehicle, guidance, readings
        self._report = guidance.target.report
        self._altitude, self._held, self.failing = altitude, False, world.fault.of_aircraft()
        self._satellites_fail = world.fault.kind == SATELLITES
        self.airspeed_error = 0.0

    def read(self, step: int, time: float, motion: MeasuredMotion) -> SensorReadings:
        """Return what the sensors say at a step; hand on what reports have come, and let fail what
        fails now.
        """
        airspeed, heading, roll = self._air_data()
        fault = self._fault
        if self._exact:
            # The flight begins with a vessel that is known, whatever fails.
            outage = step > 0 and fault.lasts(VESSEL_DATA, time)
            if step % self._guidance.plan_interval == 0 and not outage:
                self._report(VesselReport(time, *self._vessel.motion(time)))
        else:
            while self._received and self._received[-1][0] <= time:
                self._report(self._received.pop()[1])
        if self.failing and time >= fault.begins:
            self.failing = False
            self._vehicle.fail(fault.kind)
        # It begins with a place that is known, too: dead reckoning goes on from one.
        satellites = not self._satellites_fail or step == 0 or not fault.lasts(SATELLITES, time)
        fix, measured, measured_heading = self._read_with_errors(
            step, motion, airspeed, heading, satellites=satellites
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

    def act(self, step: int, time: float, motion: MeasuredMotion) -> None:
        """Pass on what the guidance has decided beside heading rate and airspeed, and to it what
        has been read.
        """
        guidance = self._guidance
        if self._readings is not None:
            self._readings.pass_on(step, time, motion, guidance)
        if guidance.altitude_command != self._altitude:
            self._altitude = guidance.altitude_command
            self._vehicle.command_altitude(self._altitude)
        monitor = guidance.monitor
        if not self._held and monitor is not None and monitor.fault is Fault.ACTUATOR_STUCK:
            # Where one surface is elevator and aileron, each would undo the other's work.
            self._held = True
            self._vehicle.hold_elevator()
