"""Flying an aircraft under its autopilot through a list of commands, and what is read meanwhile."""

import numpy as np

from aircraft.state import EquatorFrame
from common.physics import METRES_PER_FOOT

TIME_STEP = 1.0 / 120.0
FRAME = EquatorFrame(100.0)

CHANNELS = {
    "airspeed": ("velocities/vt-fps", METRES_PER_FOOT),
    "altitude": ("position/h-sl-ft", METRES_PER_FOOT),
    "climb_rate": ("velocities/h-dot-fps", METRES_PER_FOOT),
    "heading_rate": ("autopilot/heading-rate-rad_sec", 1.0),
    "bank": ("attitude/phi-rad", 1.0),
    "bank_command": ("autopilot/bank-command-rad", 1.0),
    "alpha": ("aero/alpha-rad", 1.0),
    "elevator": ("fcs/elevator-cmd-norm", 1.0),
    "aileron": ("fcs/aileron-cmd-norm", 1.0),
    "throttle": ("fcs/throttle-cmd-norm", 1.0),
    "north_speed": ("velocities/v-north-fps", METRES_PER_FOOT),
    "east_speed": ("velocities/v-east-fps", METRES_PER_FOOT),
    "north": ("position/lat-geod-rad", FRAME.north_scale),
    "east": ("position/long-gc-rad", FRAME.east_scale),
}
"""JSBSim property and SI value of its unit."""


def fly(aircraft, start, duration, commands=(), *, yaw=0.0, weather=None):
    """Release at an equilibrium and record every channel at every step, and the time [s].

    ``commands`` are (time [s], one of airspeed, altitude, heading_rate, value [SI]).
    """
    aircraft.release(
        start.state(yaw=yaw), airspeed=start.airspeed, altitude=start.altitude, weather=weather
    )
    nodes = [(aircraft.fdm.node(name), scale) for name, scale in CHANNELS.values()]
    due = {}
    for time, command, value in commands:
        due.setdefault(round(time / TIME_STEP), []).append(
            (getattr(aircraft, f"command_{command}"), value)
        )
    log = np.empty((round(duration / TIME_STEP), len(nodes)))
    for i in range(len(log)):
        for setter, value in due.get(i, ()):
            setter(value)
        log[i] = [node.get_double_value() * scale for node, scale in nodes]
        aircraft.run()
    flight = dict(zip(CHANNELS, log.T, strict=True))
    flight["time"] = TIME_STEP * np.arange(len(log))
    return flight


def after(flight, time, channel):
    """Return a channel from ``time`` [s] on."""
    return flight[channel][round(time / TIME_STEP) :]
