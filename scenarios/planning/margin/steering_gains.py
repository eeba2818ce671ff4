"""The steering law as it is flown, linear about a turn: by differences on ``Tracker`` itself,
preview included.
"""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from gnc.airspeed import air_turn
from gnc.reference.reference import CirclingReference
from gnc.tracker import Tracker, TrackingParameters

STEERED_BY = ("along", "right", "course", "speed", "airspeed", "heading_rate", "last")
"""What the steering law depends on, as deviations from the reference's motion
[m, m, rad, m/s, m/s, rad/s, rad/s]: the error, the motion over the mean air, airspeed and heading
rate as measured against the gusty air, and the last command.
"""

_STEP = 1e-5
_STRAIGHT = 1e-6
"""Heading rate of a circle that is straight [rad/s]."""

Array = npt.NDArray[np.float64]


def steering_gains(guidance: TrackingParameters, turn: float, speed: float) -> Array:
    """Return the commanded turn [rad/s] per unit of each of ``STEERED_BY``, on a reference that
    turns at ``turn`` [rad/s].

    Parameters
    ----------
    guidance : its parameters; its limit does not count
    turn : omega_r, and heading rate of an aircraft that follows [rad/s]
    speed : V_r [m/s]
    """
    turn = turn if abs(turn) > _STRAIGHT else _STRAIGHT
    parameters = replace(guidance, heading_rate_max=np.inf)

    def command(
        along: float, right: float, course: float, over: float, air: float, rate: float, last: float
    ) -> float:
        reference = CirclingReference(speed=speed, heading_rate=turn, time_step=guidance.time_step)
        steered = Tracker(parameters, reference)
        steered.heading_rate_command = turn + last
        faster, airspeed = speed + over, speed + air
        turned = steered.step(
            -along, -right, course, faster, air_turn(turn + rate, speed=airspeed, airspeed=faster)
        )
        return air_turn(turned, speed=faster, airspeed=airspeed)

    steps = _STEP * np.eye(len(STEERED_BY))
    return np.array([(command(*step) - command(*(-step))) / (2.0 * _STEP) for step in steps])
