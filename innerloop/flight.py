"""An aircraft that flies under its autopilot in JSBSim."""

from collections.abc import Callable
from pathlib import Path

from aircraft.fdm import Fdm
from aircraft.spec import AircraftSpec
from aircraft.state import RigidBodyState
from innerloop.jsbsim_system import AIRSPEED_COMMAND, ALTITUDE_COMMAND, HEADING_RATE_COMMAND, RESET


class AutopilotedAircraft:
    """An aircraft and its autopilot, as ``innerloop.jsbsim_root.write_root`` wrote them.

    Parameters
    ----------
    spec : the aircraft
    root : JSBSim root with the autopilot

    Attributes
    ----------
    fdm : the simulation
    command_airspeed, command_altitude, command_heading_rate : setters of the commands [m/s, m, rad/s]
    """

    def __init__(self, spec: AircraftSpec, root: Path) -> None:
        self.fdm = Fdm(spec, root)
        self.command_airspeed: Callable[[float], object] = self.fdm.writable_node(AIRSPEED_COMMAND).set_double_value
        self.command_altitude: Callable[[float], object] = self.fdm.writable_node(ALTITUDE_COMMAND).set_double_value
        self.command_heading_rate: Callable[[float], object] = self.fdm.writable_node(HEADING_RATE_COMMAND).set_double_value

    def release(self, state: RigidBodyState, *, airspeed: float, altitude: float) -> None:
        """Start a flight from a straight and level equilibrium, commanded to stay in it, whatever was flown before.

        Parameters
        ----------
        state : the equilibrium's state
        airspeed, altitude : commands [m/s, m]
        """
        self.command_airspeed(airspeed)
        self.command_altitude(altitude)
        self.command_heading_rate(0.0)
        self.fdm.write(RESET, -1.0)
        self.fdm.hold(state, round(self.fdm.spec.settle_time / self.fdm.time_step))
        self.fdm.write(RESET, 0.0)
