"""What guidance and record read from the aircraft, in SI, through cached property nodes."""

import math

from aircraft.fdm import Fdm
from aircraft.state import EquatorFrame
from common.physics import METRES_PER_FOOT
from gnc.estimation.navigation import EngineReadings, MeasuredMotion
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

    __slots__ = (
        "_airspeed", "_altitude", "_climb", "_controls", "_downward", "_east", "_forward", "_heading", "_heading_rate", "_incidence", "_latitude",
        "_longitude", "_north", "_pitch", "_roll", "_sideslip", "_throttle", "_to_local", "_weight",
    )  # fmt: skip

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
        # To unpack two names takes a third of the time of a star in a tuple, in each step of every
        # flight.
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
