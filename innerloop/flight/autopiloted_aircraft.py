"""An aircraft under its autopilot in JSBSim."""

import tempfile
from collections.abc import Callable
from pathlib import Path

from aircraft.faults import Faults, failable_root
from aircraft.fdm import CLOCK, Fdm
from aircraft.spec import AircraftError, AircraftSpec
from aircraft.state import RigidBodyState
from aircraft.weather import Weather, begin_weather, end_weather
from innerloop.jsbsim.system import (
    AIRSPEED_COMMAND,
    ALTITUDE_COMMAND,
    CONTROL_COMMAND,
    ELEVATOR_HELD,
    HEADING_RATE_COMMAND,
    HELD_ELEVATOR,
    PERIOD,
    RESET,
    hold_steps,
)


class AutopilotedAircraft:
    """An aircraft with its autopilot, from a root of ``innerloop.jsbsim.system.write_root``.

    Parameters
    ----------
    spec : the aircraft
    root : JSBSim root with the autopilot
    failable : whether parts can fail in flight; the aircraft then flies from a modified copy of
        ``root``

    Attributes
    ----------
    fdm : the simulation
    run : function that flies one time step in the weather given at the release
    command_airspeed, command_altitude, command_heading_rate : functions that set the commands [m/s,
        m, rad/s]
    """

    def __init__(self, spec: AircraftSpec, root: Path, *, failable: bool = False) -> None:
        if failable:
            with tempfile.TemporaryDirectory() as copy:
                self.fdm = Fdm(spec, failable_root(spec, root, Path(copy)))
        else:
            self.fdm = Fdm(spec, root)
        self.run: Callable[[], object] = self.fdm.run
        self.command_airspeed = self._setter(AIRSPEED_COMMAND)
        self.command_altitude = self._setter(ALTITUDE_COMMAND)
        self.command_heading_rate = self._setter(HEADING_RATE_COMMAND)
        self._faults = Faults(self.fdm) if failable else None
        self._weathered = False
        self._period = round(self.fdm.read(PERIOD))

    def _setter(self, command: str) -> Callable[[float], object]:
        setter: Callable[[float], object] = self.fdm.writable_node(command).set_double_value
        return setter

    def release(
        self,
        state: RigidBodyState,
        *,
        airspeed: float,
        altitude: float,
        weather: Weather | None = None,
    ) -> None:
        """Start a new flight in a straight and level equilibrium, with commands to stay there.

        Parameters
        ----------
        state : state of the equilibrium, relative to the air
        airspeed, altitude : commands [m/s, m]
        weather : weather of the flight; None for still air. The wind blows from the start;
            turbulence and the times of gusts begin at the release.
        """
        if self._weathered or (self._faults and self._faults.failed):
            end_weather(self.fdm)
        if self._faults:
            self._faults.clear()
        self._weathered = weather is not None
        self.command_airspeed(airspeed)
        self.command_altitude(altitude)
        self.command_heading_rate(0.0)
        self.fdm.write(ELEVATOR_HELD, 0.0)
        self.fdm.write(RESET, -1.0)
        wind = weather.wind.now(0.0, altitude) if weather else None
        # JSBSim continues to count the autopilot's steps from the last flight. The clock shows in
        # which step of a period that flight ended.
        remaining = -round(self.fdm.read(CLOCK) / self.fdm.time_step) % self._period
        if remaining:
            self.fdm.hold(state, remaining, wind)
        self.fdm.hold(state, hold_steps(self.fdm.spec, self._period), wind)
        self.fdm.write(RESET, 0.0)
        self.fdm.write(HELD_ELEVATOR, self.fdm.read(CONTROL_COMMAND.format("elevator")))
        if self._faults:
            self._faults.store_trim_positions()
        self.run = self.fdm.run
        if weather:
            self.run = begin_weather(self.fdm, weather)

    def hold_elevator(self) -> None:
        """Hold the elevator at its position at the release, after a failure.

        The aircraft's own stability then controls pitch, and the remaining controls do not have to
        serve conflicting aims.
        """
        self.fdm.write(ELEVATOR_HELD, 1.0)

    def fail(self, name: str) -> None:
        """Make a part fail from the next time step on.

        Parameters
        ----------
        name : one of ``aircraft.faults.fault_names``

        Raises
        ------
        AircraftError : there is no such part, or the aircraft is not ``failable``
        """
        if self._faults is None:
            raise AircraftError(
                f"aircraft '{self.fdm.spec.name}': '{name}' cannot fail; make it with failable=True"
            )
        self._faults.fail(name)
