"""A gust as strong as declared that begins at once: the turn that was safe is flown on, though it
seems no longer to be.
"""

import math
from dataclasses import dataclass

import pytest
from gnc.safety.guard_parameters import GuardParameters
from gnc.safety.keepout_guard import KeepoutGuard
from gnc_cases import HEADING_RATE_MAX, SPEED
from guard_cases import RADIUS, TIME_STEP

from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import Tube
from gnc.numeric import limited, wrap
from gnc.unicycle import lagged_move

LAG = 0.3


@dataclass(frozen=True)
class Gust:
    """Air that moves at once, from a time to a time [s], at a speed [m/s] in a direction [rad]."""

    speed: float
    direction: float
    begins: float
    ends: float

    def at(self, time: float) -> tuple[float, float]:
        """Return the velocity of the air, north and east [m/s]."""
        speed = self.speed if self.begins <= time < self.ends else 0.0
        return speed * math.cos(self.direction), speed * math.sin(self.direction)


def closest(
    gust: Gust, *, vessel: float, bearing: float, distance: float, course: float, weave: float
) -> tuple[float, int]:
    """Return how near a vehicle comes that aims at a vessel, weaving by some angle [rad], and how
    often the guard acts [m, -].
    """
    guard = KeepoutGuard(
        GuardParameters(
            radius=RADIUS,
            heading_rate_max=HEADING_RATE_MAX,
            lag=LAG,
            time_step=TIME_STEP,
            speed_error=gust.speed,
        )
    )
    guard.tubes = (Tube(0.0, 0.0, 0.0, vessel, 0.0),)
    x, y, heading, rate, nearest = (
        distance * math.cos(bearing),
        distance * math.sin(bearing),
        course,
        0.0,
        math.inf,
    )
    for step in range(1200):
        time = step * TIME_STEP
        north, east = gust.at(time)
        over_north, over_east = SPEED * math.cos(heading) + north, SPEED * math.sin(heading) + east
        speed = math.hypot(over_north, over_east)
        flown = math.atan2(over_east, over_north)
        own = AirMotion(
            ground_north=x, ground_east=y, course=flown, heading_rate=rate * SPEED / speed
        )
        aim = math.atan2(-y, vessel * time - x) + weave * math.sin(0.3 * time + 6.05)
        command = limited(2.0 * HEADING_RATE_MAX * wrap(aim - flown), HEADING_RATE_MAX)
        turned = guard.limit(command, time, own, max(speed, SPEED), min(speed, SPEED))
        full = guard.intervening and abs(turned) >= HEADING_RATE_MAX
        turned *= speed / SPEED
        # As the guidance does: what the gust slows is turned in full all the same.
        command = (
            math.copysign(HEADING_RATE_MAX, turned) if full else limited(turned, HEADING_RATE_MAX)
        )
        if command != turned:
            guard.overruled(command * SPEED / speed)
        to_north, to_east, heading, rate = lagged_move(
            x, y, heading, rate, SPEED, command, LAG, TIME_STEP
        )
        x, y = to_north + north * TIME_STEP, to_east + east * TIME_STEP
        nearest = min(nearest, math.hypot(x - vessel * (time + TIME_STEP), y))
        assert not guard.lost
    return nearest, guard.interventions


@pytest.mark.parametrize(
    ("gust", "start"),
    [
        (
            Gust(4.0, -2.0506, 6.18, 35.2),
            {"vessel": 13.0, "bearing": 0.0236, "distance": 383.3, "course": 0.404, "weave": 0.9},
        ),
        (
            Gust(5.0, -0.6857, 4.264, 17.5),
            {"vessel": 12.0, "bearing": 1.1370, "distance": 358.7, "course": -2.534, "weave": 0.0},
        ),
        (
            Gust(7.0, -2.2802, 5.355, 19.42),
            {"vessel": 10.65, "bearing": 0.1498, "distance": 375.4, "course": -2.387, "weave": 0.0},
        ),
        (
            Gust(7.0, 2.5628, 2.865, 17.21),
            {
                "vessel": 10.83,
                "bearing": -0.098,
                "distance": 369.14,
                "course": -2.882,
                "weave": 0.0,
            },
        ),
    ],
    ids=[
        "beside a fast vessel",
        "beside a slower one",
        "a gust that slows the turn",
        "one from the other side",
    ],
)
def test_a_gust_as_strong_as_declared_lets_nobody_in(gust, start):
    # With the better turn in place of the one that was safe 3 to 7 m inside: the gust makes the
    # other side seem the better one. With a turn away that was as slow through the air as the gust
    # made the vehicle over the mean air up to 0.7 m inside.
    nearest, interventions = closest(gust, **start)
    assert nearest >= RADIUS
    assert interventions > 0
