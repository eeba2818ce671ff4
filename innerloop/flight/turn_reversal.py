"""The turn-reversal response: how the heading rate follows the guidance's largest change of
command.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from aircraft.fdm import TIME_STEP
from aircraft.spec import AircraftError
from aircraft.trim import Trim
from common.physics import heading_rate_for_bank
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.jsbsim.system import HEADING_RATE

Array = npt.NDArray[np.float64]

_LEAD_FRACTION = 0.01
"""Largest lead of the model, over the aircraft's final displacement [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TurnReversalResponse:
    """A dead time followed by a first-order lag, which displace the aircraft as its own
    heading-rate response does.

    Attributes
    ----------
    delay : [s]
    lag : [s]
    """

    delay: float
    lag: float


def measure_turn_reversal(
    aircraft: AutopilotedAircraft, start: Trim, bank: float
) -> TurnReversalResponse:
    """Return the dead time and lag of a reversal from a settled turn at ``bank`` [rad] to the left
    to one to the right.

    The measure is the displacement of the aircraft, the integral of its course error. Dead time and
    lag are equal, and the shortest for which the model is nowhere ahead of the aircraft over a
    quarter of a turn, except for 1 % of the final displacement. The lag of slow commands,
    ``measure_lag``, is shorter: the aircraft rolls through twice the bank.

    Parameters
    ----------
    aircraft : with its autopilot; its flight is ended
    start : straight and level equilibrium
    bank : [rad]

    Raises
    ------
    AircraftError : it does not follow the reversal
    """
    rate = heading_rate_for_bank(bank, start.airspeed)
    aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
    node = aircraft.fdm.node(HEADING_RATE)
    aircraft.command_heading_rate(-rate)
    for _ in range(round(2.0 * math.pi / rate / TIME_STEP)):
        aircraft.fdm.run()
    aircraft.command_heading_rate(rate)
    time = TIME_STEP * np.arange(1.0, round(0.5 * math.pi / rate / TIME_STEP) + 1.0)
    behind = np.empty(time.size)
    for i in range(time.size):
        aircraft.fdm.run()
        behind[i] = 0.5 * (1.0 - node.get_double_value() / rate)
    flown = np.cumsum(np.cumsum(behind)) * TIME_STEP**2

    def least_lead(half: float) -> float:
        return float(
            np.min(displacement(time, TurnReversalResponse(delay=half, lag=half)) - flown)
        ) + _LEAD_FRACTION * float(flown[-1])

    shortest, longest = TIME_STEP, float(time[-1])
    if not least_lead(longest) >= 0.0:
        raise AircraftError(
            f"{aircraft.fdm.spec.name} at {start.airspeed:g} m/s does not turn right within {longest:.1f} s of the command in a"
            f" left turn at {math.degrees(bank):.0f} deg of bank; lower the bank"
        )
    half = (
        shortest
        if least_lead(shortest) >= 0.0
        else float(brentq(least_lead, shortest, longest, xtol=1e-4))
    )
    return TurnReversalResponse(delay=half, lag=half)


def displacement(time: Array, reversal: TurnReversalResponse) -> Array:
    """Return the integral of the course error [s2] per change of commanded heading rate, ``time``
    [s] after it.
    """
    after = np.maximum(time - reversal.delay, 0.0)
    lag = reversal.lag
    late = np.minimum(time, reversal.delay)
    return 0.5 * late**2 + reversal.delay * after + lag * after + lag**2 * np.expm1(-after / lag)
