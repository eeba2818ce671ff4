"""What guidance and record read from the aircraft, in SI, through cached property nodes."""

import math

from aircraft.simulation.fdm import Fdm
from aircraft.simulation.local_frame import EquatorFrame
from common.physics.units import METRES_PER_FOOT
from innerloop.jsbsim.properties import CONTROL_COMMAND, HEADING_RATE

_SAMPLED = (
    ("position/h-sl-ft", METRES_PER_FOOT),
    ("velocities/vt-fps", METRES_PER_FOOT),
    ("attitude/phi-rad", 1.0),
    ("velocities/h-dot-fps", METRES_PER_FOOT),
    ("attitude/psi-rad", 1.0),
    ("attitude/theta-rad", 1.0),
    ("aero/alpha-rad", 1.0),
    ("aero/beta-rad", 1.0),
)


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
        "_airspeed", "_east", "_heading", "_heading_rate", "_latitude", "_longitude", "_north", "_roll", "_sampled", "_to_local",
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
        controls = {i.name for i in fdm.spec.inputs}
        self._sampled = [(fdm.node(name).get_double_value, scale) for name, scale in _SAMPLED]
        for name in ("elevator", "aileron", "throttle", "rudder"):
            read = fdm.node(CONTROL_COMMAND.format(name)).get_double_value if name in controls else _nothing
            self._sampled.append((read, 1.0))

    def motion(self) -> tuple[float, float, float, float, float]:
        """Return north, east [m], north and east velocity over the ground [m/s] and heading rate against the air [rad/s]."""
        return (
            *self._to_local(self._latitude(), self._longitude()),
            self._north() * METRES_PER_FOOT,
            self._east() * METRES_PER_FOOT,
            self._heading_rate(),
        )

    def air_data(self) -> tuple[float, float, float]:
        """Return true airspeed with turbulence and gusts [m/s], heading from 0 to 2 pi, and roll [rad]."""
        return self._airspeed() * METRES_PER_FOOT, self._heading(), self._roll()

    def sample(self) -> tuple[float, ...]:
        """Return ``SAMPLE_COLUMNS``."""
        return tuple([read() * scale for read, scale in self._sampled])
