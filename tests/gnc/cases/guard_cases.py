"""What the tests of the keep-out guard share: discs, vehicles with a lag, random starts and
commands.
"""

import math
from collections import deque
from typing import NamedTuple

import pytest
from gnc_cases import HEADING_RATE_MAX, SPEED
from hypothesis import strategies as st

from gnc.estimation.error_budget import Bias, ErrorBudget, Growth
from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import Tube
from gnc.guard.guard import GuardParameters, HeadingRateFilter
from gnc.guard.turn import RelativeMotion
from gnc.numeric import wrap
from gnc.unicycle import lagged_move, unicycle_move

RADIUS = 200.0
TIME_STEP = 0.05
TURN_RADIUS = SPEED / HEADING_RATE_MAX
AT_REST = Tube(0.0, 0.0, 0.0, 0.0, 0.0)
LAGS = pytest.mark.parametrize(("lag", "delay"), [(0.0, 0.0), (0.4, 0.0), (0.25, 0.25)])

commands = st.floats(-HEADING_RATE_MAX, HEADING_RATE_MAX)
distances = st.floats(0.0, 700.0)


def parameters_of(*, speed_error=0.0, deviation=0.0, drift_rate=0.0, slowest=math.inf, **changes):
    """Return the parameters of a guard of 200 m for a vehicle with a lag of 0.4 s."""
    errors = ErrorBudget(
        own_velocity=Bias(size=speed_error),
        response=Bias(size=deviation),
        drift=Growth(rate=drift_rate),
        slowest=slowest,
    )
    defaults = {"radius": RADIUS, "heading_rate_max": HEADING_RATE_MAX, "lag": 0.4}
    return GuardParameters(**(defaults | {"time_step": TIME_STEP, "errors": errors} | changes))


class State(NamedTuple):
    """State of a vehicle, relative to a disc's centre or to the origin [m, m, rad, rad/s]."""

    x: float
    y: float
    course: float
    heading_rate: float


def known_motion(state, **changes):
    """Return a state (north, east, course, heading rate) as the guard takes it."""
    north, east, course, heading_rate = state
    return AirMotion(
        ground_north=north, ground_east=east, course=course, heading_rate=heading_rate, **changes
    )


def polar(distance, bearing, course, heading_rate=0.0):
    """Return the state of a vehicle at a distance [m] and bearing [rad] from the origin."""
    return State(distance * math.cos(bearing), distance * math.sin(bearing), course, heading_rate)


def relative_motion(state, velocity=(0.0, 0.0), **changes):
    """Return a motion relative to a disc of 200 m that moves at a velocity [m/s]."""
    x, y, course, heading_rate = state
    defaults = {
        "fastest": SPEED,
        "slowest": changes.get("fastest", SPEED),
        "radius": RADIUS,
        "growth": 0.0,
        "acceleration": 0.0,
        "pending_rate": 0.0,
    }
    disc_north, disc_east = velocity
    return RelativeMotion(
        x=x,
        y=y,
        disc_north=disc_north,
        disc_east=disc_east,
        course=course,
        heading_rate=heading_rate,
        **(defaults | changes),
    )


class DiscGuard:
    """A filter of heading rates beside one disc, whose velocity is reported anew at each step.

    States (x, y, course, heading rate) are relative to the disc's centre.
    """

    def __init__(self, *, acceleration=0.0, **parameters):
        self.filter = HeadingRateFilter(parameters_of(**parameters))
        self._acceleration = acceleration
        self._time, self._north, self._east = 0.0, 0.0, 0.0

    @property
    def status(self):
        return self.filter.status

    def limit(
        self, command, state, velocity=(0.0, 0.0), *, speed=SPEED, slowest=math.inf, disc_radius=0.0
    ):
        own, discs = self._encounter(state, velocity, speed, disc_radius)
        answer = self.filter.limit(command, self._time, own, discs, speed, slowest)
        self._time += TIME_STEP
        self._north += TIME_STEP * velocity[0]
        self._east += TIME_STEP * velocity[1]
        return answer

    def allows(self, command, state, velocity=(0.0, 0.0)):
        own, discs = self._encounter(state, velocity, SPEED)
        return self.filter.allows(command, self._time, own, discs, SPEED)

    def clearance(self, state, velocity=(0.0, 0.0), *, speed=SPEED):
        own, discs = self._encounter(state, velocity, speed)
        return self.filter.clearance(self._time, own, discs, speed)

    def _encounter(self, state, velocity, speed, disc_radius=0.0):
        """Return the vehicle's motion over ground, and the disc."""
        x, y, course, heading_rate = state
        centre = (self._time, self._north, self._east)
        disc = Tube(*centre, *velocity, disc_radius, 0.0, self._acceleration)
        place = (self._north + x, self._east + y, course, heading_rate)
        return known_motion(place, speed=speed), (disc,)


def moved(state, command, lag, duration, speed=SPEED):
    """Return position in the air mass, course and heading rate after a held command: the project's
    own unicycle.
    """
    north, east, course, heading_rate = state
    if lag > 0.0:
        return lagged_move(north, east, course, heading_rate, speed, command, lag, duration)
    return (*unicycle_move(north, east, course, speed, command, duration), command)


class Hunter:
    """A disc that turns and speeds up towards the vehicle as hard as it may, by default not at all,
    and reports its velocity with a constant error.
    """

    def __init__(self, velocity, *, acceleration=0.0, speed_max=math.inf, error=(0.0, 0.0)):
        self.velocity, self._error = velocity, error
        self._acceleration, self._speed_max = acceleration, speed_max

    @property
    def reported(self):
        return self.velocity[0] + self._error[0], self.velocity[1] + self._error[1]

    def step(self, x, y, duration):
        distance = math.hypot(x, y)
        faster = [
            v + self._acceleration * duration * to / distance
            for v, to in zip(self.velocity, (x, y), strict=True)
        ]
        if math.hypot(*faster) <= self._speed_max:
            self.velocity = tuple(faster)


def fly_guarded(guard, start, want, disc, *, lag, delay=0.0, duration=45.0):
    """Return the closest approach to the disc's centre [m], and the guard's status at each step."""
    x, y, course, heading_rate = start
    under_way = deque([heading_rate] * round(delay / TIME_STEP))
    closest, statuses = math.hypot(x, y), []
    pieces = 2
    for step in range(round(duration / TIME_STEP)):
        demanded = want(step, x, y, course)
        command = guard.limit(demanded, (x, y, course, heading_rate), disc.reported)
        statuses.append(guard.status)
        under_way.append(command)
        acting = under_way.popleft()
        for _ in range(pieces):
            piece = TIME_STEP / pieces
            x, y, course, heading_rate = moved((x, y, course, heading_rate), acting, lag, piece)
            x, y = x - disc.velocity[0] * piece, y - disc.velocity[1] * piece
            disc.step(x, y, piece)
            closest = min(closest, math.hypot(x, y))
    return closest, statuses


def aim_at_the_centre(_, x, y, course, heading_rate_max=HEADING_RATE_MAX):
    error = wrap(math.atan2(-y, -x) - course)
    return min(max(1.5 * error, -heading_rate_max), heading_rate_max)


def held_at_random(generator):
    """Full turns and anything between, each for up to four seconds."""
    values = []
    while len(values) < 1300:
        turn = generator.choice([-1.0, 1.0, generator.uniform(-1.0, 1.0)]) * HEADING_RATE_MAX
        values += [float(turn)] * int(generator.integers(1, 80))
    return lambda step, *_: values[step]


def random_start(generator, nearest=260.0):
    bearing, distance = generator.uniform(-math.pi, math.pi), generator.uniform(nearest, 600.0)
    course = generator.uniform(-math.pi, math.pi)
    turn = generator.uniform(-HEADING_RATE_MAX, HEADING_RATE_MAX)
    return polar(distance, bearing, course, turn)


def random_velocity(generator, speed):
    return polar(speed, generator.uniform(-math.pi, math.pi), 0.0)[:2]
