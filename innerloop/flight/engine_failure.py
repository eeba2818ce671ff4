"""How fast an aircraft loses airspeed when its engine fails in a turn that it goes on flying, level or in a climb."""

import math

import numpy as np

from aircraft.dynamics.equilibrium import Trim
from aircraft.simulation.faults import ENGINE
from aircraft.simulation.fdm import TIME_STEP
from common.physics.coordinated_turn import heading_rate_for_bank
from common.physics.units import METRES_PER_FOOT
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft

_AIRSPEED = "velocities/vt-fps"

_WATCHED, _OVER = 5.0, 1.0
"""For how long the fall is watched, an engine may run down for seconds, and time over which it is taken [s]."""

_CLIMBED, _STEP = 8.0, 0.5
"""For how long it climbs before, and time between commands of its altitude [s]."""


def measure_airspeed_fall(aircraft: AutopilotedAircraft, start: Trim, bank: float, gradient: float = 0.0) -> float:
    """Return the largest rate at which the airspeed falls [m/s2] when the engine fails in a settled turn.

    Until the failure is known the autopilot holds the turn, and its altitude or the climb.

    Parameters
    ----------
    aircraft : with its autopilot, and made ``failable``; its flight is ended
    start : straight and level equilibrium
    bank : of the turn [rad]
    gradient : of the commanded climb [-]
    """
    rate = heading_rate_for_bank(bank, start.airspeed)
    aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
    aircraft.command_heading_rate(rate)
    for _ in range(round(2.0 * math.pi / rate / TIME_STEP)):
        aircraft.run()
    read = aircraft.fdm.node(_AIRSPEED).get_double_value
    airspeeds, failing = [], round(_CLIMBED / TIME_STEP)
    for step in range(failing + round(_WATCHED / TIME_STEP)):
        if step == failing:
            aircraft.fail(ENGINE)
        if step % round(_STEP / TIME_STEP) == 0:
            aircraft.command_altitude(start.altitude + gradient * start.airspeed * step * TIME_STEP)
        airspeeds.append(read())
        aircraft.run()
    airspeeds.append(read())
    over = round(_OVER / TIME_STEP)
    flown = METRES_PER_FOOT * np.array(airspeeds[failing:])
    return float(np.max(flown[:-over] - flown[over:])) / (over * TIME_STEP)
