"""Record an aircraft's weaves with its sensors, to find the bias of the measured wind.

The wind follows from ground speed, airspeed and the course through the air. That course is
estimated as the heading plus the crab angle of a steady turn at V_r with the present bank. During a
roll the crab angle differs. A weave rolls at the same points of every period, so the error does not
average out. In a turn at another airspeed the angle of attack differs, and the crab angle is wrong
for the whole turn.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

from aircraft.fdm import TIME_STEP
from aircraft.trim import Trim
from common.physics import METRES_PER_FOOT, heading_rate_for_bank
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft

INTERVAL = 0.5
"""Time between the samples of a weave [s], equal to the guidance's interval of wind samples."""

_SWINGS = (0.4, 0.8, 1.57)
"""Amplitudes of the course in weaves [rad]."""


class WeaveSample(NamedTuple):
    """Sensor readings at one time of a weave.

    Attributes
    ----------
    airspeed : [m/s]
    heading, roll : attitude of the body [rad]
    velocity_north, velocity_east : velocity over the ground in still air [m/s]
    """

    airspeed: float
    heading: float
    roll: float
    velocity_north: float
    velocity_east: float


Samples = tuple[WeaveSample, ...]
"""Samples of a part of a flight, at every ``INTERVAL``."""


class Weave(NamedTuple):
    """A weave that begins in straight and level flight.

    Attributes
    ----------
    entry : samples of the first turn
    period : samples of the second period
    """

    entry: Samples
    period: Samples


class _Turn(NamedTuple):
    """A turn of a weave: commanded airspeed [m/s] and heading rate [rad/s]."""

    airspeed: float
    rate: float


def measure_weaves(
    aircraft: AutopilotedAircraft, start: Trim, bank: float, slowest: float, fastest: float
) -> tuple[Weave, ...]:
    """Return weaves of several amplitudes at V_r, at the slowest and the fastest airspeed.

    Further weaves turn slowly to the left and fast to the right.

    Parameters
    ----------
    aircraft : aircraft with its autopilot; its flight is ended
    start : straight and level equilibrium, at V_r
    bank : bank of the turns at V_r, and the largest bank at other airspeeds [rad]
    slowest, fastest : commanded airspeeds [m/s]
    """
    largest = heading_rate_for_bank(bank, start.airspeed)
    usual, slow, fast = (
        _Turn(airspeed, min(largest, heading_rate_for_bank(bank, airspeed)))
        for airspeed in (start.airspeed, slowest, fastest)
    )
    pairs = (usual, usual), (slow, slow), (fast, fast), (slow, fast)
    return tuple(
        _weave(aircraft, start, left, right, swing) for left, right in pairs for swing in _SWINGS
    )


def _weave(
    aircraft: AutopilotedAircraft, start: Trim, left: _Turn, right: _Turn, swing: float
) -> Weave:
    """Return a weave whose course has the amplitude ``swing`` [rad]."""
    aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)

    def turn(side: float, of: _Turn, course: float) -> list[WeaveSample]:
        aircraft.command_airspeed(of.airspeed)
        aircraft.command_heading_rate(side * of.rate)
        return list(_samples(aircraft, max(1, round(course / of.rate / INTERVAL))))

    entry = turn(1.0, right, swing)
    for _ in range(2):
        period = [*turn(-1.0, left, 2.0 * swing), *turn(1.0, right, 2.0 * swing)]
    return Weave(tuple(entry), tuple(period))


def _samples(aircraft: AutopilotedAircraft, number: int) -> Iterator[WeaveSample]:
    """Continue the flight; yield ``number`` samples."""
    read = aircraft.fdm.read
    for _ in range(number):
        aircraft.fdm.step(round(INTERVAL / TIME_STEP))
        yield WeaveSample(
            airspeed=METRES_PER_FOOT * read("velocities/vt-fps"),
            heading=math.remainder(read("attitude/psi-rad"), math.tau),
            roll=read("attitude/phi-rad"),
            velocity_north=METRES_PER_FOOT * read("velocities/v-north-fps"),
            velocity_east=METRES_PER_FOOT * read("velocities/v-east-fps"),
        )
