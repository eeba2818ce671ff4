"""The aircraft in six degrees of freedom: JSBSim at 120 Hz with the autopilot at its own rate, 40
to 120 Hz, both in C++.
"""

import itertools
import math
from dataclasses import replace

from aircraft.fdm import Fdm
from aircraft.spec import Envelope
from aircraft.state import EquatorFrame
from aircraft.trim import Trim
from aircraft.weather import Weather
from common.physics import METRES_PER_FOOT
from gnc.estimation.navigation import EngineReadings, MeasuredMotion
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.servo_monitor import ServoMonitor
from innerloop.flight.thrust_map import DOWNWARD_FORCE, FORWARD_FORCE, WEIGHT
from innerloop.jsbsim.system import CONTROL_COMMAND, HEADING_RATE

_CONTROLS = ("elevator", "aileron", "throttle", "rudder")
"""Whose commands are sampled."""


def _nothing() -> float:
    return math.nan


class Telemetry:
    """Reads one aircraft.

    Parameters
    ----------
    fdm : the simulation
    frame : local frame
    """

    def __init__(self, fdm: Fdm, frame: EquatorFrame) -> None:
        self._latitude = fdm.node("position/lat-geod-rad").get_double_value
        self._longitude = fdm.node("position/long-gc-rad").get_double_value
        self._north = fdm.node("velocities/v-north-fps").get_double_value
        self._east = fdm.node("velocities/v-east-fps").get_double_value
        self._heading_rate = fdm.node(HEADING_RATE).get_double_value
        self._airspeed = fdm.node("velocities/vt-fps").get_double_value
        self._heading = fdm.node("attitude/psi-rad").get_double_value
        self._roll = fdm.node("attitude/phi-rad").get_double_value
        self._to_local = frame.to_local
        self._altitude = fdm.node("position/h-sl-ft").get_double_value
        self._climb = fdm.node("velocities/h-dot-fps").get_double_value
        self._pitch = fdm.node("attitude/theta-rad").get_double_value
        self._incidence = fdm.node("aero/alpha-rad").get_double_value
        self._sideslip = fdm.node("aero/beta-rad").get_double_value
        self._throttle = fdm.node(CONTROL_COMMAND.format("throttle")).get_double_value
        self._forward = fdm.node(FORWARD_FORCE).get_double_value
        self._downward = fdm.node(DOWNWARD_FORCE).get_double_value
        self._weight = fdm.node(WEIGHT).get_double_value
        moved = {control.name for control in fdm.spec.inputs}
        self._controls = tuple(
            fdm.node(CONTROL_COMMAND.format(name)).get_double_value if name in moved else _nothing
            for name in _CONTROLS
        )

    def motion(self) -> MeasuredMotion:
        """Return the motion now."""
        north, east = self._to_local(self._latitude(), self._longitude())
        return MeasuredMotion(
            north,
            east,
            self._north() * METRES_PER_FOOT,
            self._east() * METRES_PER_FOOT,
            self._heading_rate(),
        )

    def air_data(self) -> tuple[float, float, float]:
        """Return true airspeed with turbulence and gusts [m/s], heading from 0 to 2 pi, and roll
        [rad].
        """
        return self._airspeed() * METRES_PER_FOOT, self._heading(), self._roll()

    def engine(self) -> EngineReadings:
        """Return throttle and accelerations: forces of air and engines over the weight."""
        weight = self._weight()
        return EngineReadings(
            self._throttle(), self._forward() / weight, -self._downward() / weight
        )

    def sample(self) -> tuple[float, ...]:
        """Return ``SAMPLE_COLUMNS``."""
        elevator, aileron, throttle, rudder = self._controls
        return (
            self._altitude() * METRES_PER_FOOT,
            self._airspeed() * METRES_PER_FOOT,
            self._roll(),
            self._climb() * METRES_PER_FOOT,
            self._heading(),
            self._pitch(),
            self._incidence(),
            self._sideslip(),
            elevator(),
            aileron(),
            throttle(),
            rudder(),
        )


_BANK_LIMIT = 1.4
_AIRSPEED_LIMITS = (8.0 / 15.0, 1.8)
"""Out of control below and above these shares of the slowest and the fastest airspeed of the
envelope [-].
"""

_ALTITUDE_MIN = 1.0
_WATCH_STEP, _WATCH_INTERVAL = 0.05, 2
"""Longest step of the guidance that shows enough of what control surfaces are commanded [s]; in a
longer one it is looked at every so many steps of the simulation.

At 10 Hz a surface that followed a command which came and went between two steps seemed stuck in 8
of 42 flights.
"""


class JsbsimVehicle:
    """An aircraft released from straight and level flight.

    Parameters
    ----------
    aircraft : with its autopilot; its earlier flight is over. It has to be ``failable`` if a part
        fails in the flight
    start : straight and level equilibrium
    envelope : where the autopilot may fly it
    north, east, altitude : where it is released [m]
    course : course of its velocity relative to the air; without wind it is the course over the
        ground [rad]
    time_step : of the guidance, a multiple of the simulation's [s]
    weather : the air it flies in; none for still air
    """

    def __init__(
        self,
        aircraft: AutopilotedAircraft,
        start: Trim,
        envelope: Envelope,
        *,
        north: float,
        east: float,
        altitude: float,
        course: float,
        time_step: float,
        weather: Weather | None = None,
    ) -> None:
        frame = EquatorFrame(altitude)
        latitude, longitude = frame.to_geodetic(north, east)
        state = replace(
            start.state(latitude, longitude, course - start.course_offset()), altitude=altitude
        )
        aircraft.release(state, airspeed=start.airspeed, altitude=altitude, weather=weather)
        telemetry = Telemetry(aircraft.fdm, frame)
        self.motion = telemetry.motion
        self.air_data = telemetry.air_data
        self.engine = telemetry.engine
        self.sample = telemetry.sample
        self.command_altitude = aircraft.command_altitude
        self.fail = aircraft.fail
        self.hold_elevator = aircraft.hold_elevator
        self._command_airspeed = aircraft.command_airspeed
        self._command_heading_rate = aircraft.command_heading_rate
        self._airspeed_limits = (
            _AIRSPEED_LIMITS[0] * envelope.airspeed_min,
            _AIRSPEED_LIMITS[1] * envelope.airspeed_max,
        )
        self._run = aircraft.run
        runs = round(time_step / aircraft.fdm.time_step)
        looks = runs // _WATCH_INTERVAL if time_step > _WATCH_STEP else 1
        ends = [runs * look // looks for look in range(looks + 1)]
        *self._runs_watched, self._runs = [
            range(begin, end) for begin, end in itertools.pairwise(ends)
        ]
        servos = ServoMonitor(aircraft.fdm, time_step / looks)
        self._watch, self.servo_error = servos.watch, servos.error

    def advance(self, heading_rate: float, airspeed: float) -> None:
        """Fly one guidance step with these commands [rad/s, m/s]."""
        self._command_heading_rate(heading_rate)
        self._command_airspeed(airspeed)
        run = self._run
        for runs in self._runs_watched:
            for _ in runs:
                run()
            self._watch()
        for _ in self._runs:
            run()

    def fault(self, sample: tuple[float, ...]) -> str:
        """Return why the aircraft is out of control, or nothing. NaN is
        never within its limits.
        """
        altitude, airspeed, roll = sample[:3]
        low, high = self._airspeed_limits
        if not abs(roll) < _BANK_LIMIT:
            return (
                f"bank reached {math.degrees(roll):.0f} deg against a limit of"
                f" {math.degrees(_BANK_LIMIT):.0f}"
            )
        if not low < airspeed < high:
            return f"airspeed reached {airspeed:.1f} m/s outside {low:.1f} to {high:.1f}"
        if not altitude > _ALTITUDE_MIN:
            return f"altitude fell to {altitude:.1f} m"
        return ""
