"""How an aircraft weaves, as its sensors see it: the wind that is measured then is a little wrong.

The wind is measured by the triangle of ground speed, airspeed and the course through the air. That
course is the heading and the crab angle of a steady turn at V_r, at the bank of the moment. While
an aircraft rolls, its crab angle is another one, and a weave rolls at the same places of each of
its periods, so that what is wrong does not average out. In a turn at another airspeed the angle of
attack is another one, and so is the crab angle, for as long as the turn lasts.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

from aircraft.fdm import TIME_STEP
from aircraft.trim import Trim
from common.physics import METRES_PER_FOOT, heading_rate_for_bank
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft

INTERVAL = 0.5
"""Time between the samples of a weave [s]: as often as the guidance measures the wind."""

_SWINGS = (0.4, 0.8, 1.57)
"""How far courses swing to either side of the middle [rad]."""


class WeaveSample(NamedTuple):
    """What sensors read in a weave.

    Attributes
    ----------
    airspeed : [m/s]
    heading, roll : of the body [rad]
    velocity_north, velocity_east : over the ground, in still air [m/s]
    """

    airspeed: float
    heading: float
    roll: float
    velocity_north: float
    velocity_east: float


Samples = tuple[WeaveSample, ...]
"""A stretch of a flight, every ``INTERVAL``."""


class Weave(NamedTuple):
    """A weave, from straight and level flight on.

    Attributes
    ----------
    entry : its first turn
    period : one period of it, once another one has been flown
    """

    entry: Samples
    period: Samples


class _Turn(NamedTuple):
    """A turn of a weave: airspeed that is commanded [m/s], and its heading rate [rad/s]."""

    airspeed: float
    rate: float


def measure_weaves(
    aircraft: AutopilotedAircraft, start: Trim, bank: float, slowest: float, fastest: float
) -> tuple[Weave, ...]:
    """Return weaves of several widths at its airspeed, at the slowest and the fastest one, and with
    slow turns to the left and fast ones to the right.

    Parameters
    ----------
    aircraft : with its autopilot; its flight is ended
    start : straight and level equilibrium
    bank : of the turns at its airspeed, and the largest at others [rad]
    slowest, fastest : airspeeds that are commanded [m/s]
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
    """Return a weave whose courses swing by an angle to either side of the middle [rad]."""
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
    """Yield samples of a flight that goes on."""
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
