"""What the tests of the keep-out guard share: discs, vehicles with a lag, random starts and
commands.
"""

import math
from collections import deque

import pytest
from gnc.safety.guard_parameters import GuardParameters
from gnc.safety.keepout_guard import KeepoutGuard
from gnc_cases import HEADING_RATE_MAX, SPEED
from hypothesis import strategies as st

from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import Tube
from gnc.numeric import wrap
from gnc.unicycle import lagged_move, unicycle_move

RADIUS = 200.0
TIME_STEP = 0.05
TURN_RADIUS = SPEED / HEADING_RATE_MAX
LAGS = pytest.mark.parametrize(("lag", "delay"), [(0.0, 0.0), (0.4, 0.0), (0.25, 0.25)])

commands = st.floats(-HEADING_RATE_MAX, HEADING_RATE_MAX)
distances = st.floats(0.0, 700.0)


class DiscGuard:
    """A keep-out guard asked about one disc, whose velocity it is told anew at each step; it may
    accelerate from then on.
    """

    def __init__(self, acceleration=0.0, **parameters):
        self.guard = KeepoutGuard(GuardParameters(time_step=TIME_STEP, **parameters))
        self._acceleration, self._time, self._north, self._east = acceleration, 0.0, 0.0, 0.0

    @property
    def intervening(self):
        return self.guard.intervening

    @property
    def lost(self):
        return self.guard.lost

    @property
    def interventions(self):
        return self.guard.interventions

    def _own(
        self, x, y, velocity_north, velocity_east, course, speed, heading_rate, radius_inflation=0.0
    ):
        place = (self._time, self._north, self._east, velocity_north, velocity_east)
        self.guard.tubes = (Tube(*place, radius_inflation, 0.0, self._acceleration),)
        place = {"ground_north": self._north + x, "ground_east": self._east + y}
        return AirMotion(**place, course=course, heading_rate=heading_rate, speed=speed)

    def limit(
        self,
        command,
        x,
        y,
        velocity_north,
        velocity_east,
        course,
        speed,
        heading_rate,
        *,
        radius_inflation=0.0,
        slowest=math.inf,
    ):
        own = self._own(
            x, y, velocity_north, velocity_east, course, speed, heading_rate, radius_inflation
        )
        answer = self.guard.limit(command, self._time, own, speed, slowest)
        self._time += TIME_STEP
        self._north += TIME_STEP * velocity_north
        self._east += TIME_STEP * velocity_east
        return answer

    def allows(
        self,
        command,
        x,
        y,
        velocity_north,
        velocity_east,
        course,
        speed,
        heading_rate,
        *,
        slowest=math.inf,
    ):
        own = self._own(x, y, velocity_north, velocity_east, course, speed, heading_rate)
        return self.guard.allows(command, self._time, own, speed, slowest)

    def clearance(self, x, y, velocity_north, velocity_east, course, speed, heading_rate):
        own = self._own(x, y, velocity_north, velocity_east, course, speed, heading_rate)
        return self.guard.clearance(self._time, own, speed)


def make_guard(*, lag=0.4, delay=0.0, radius=RADIUS, heading_rate_max=HEADING_RATE_MAX, **changes):
    return DiscGuard(
        radius=radius, heading_rate_max=heading_rate_max, lag=lag, delay=delay, **changes
    )


def moved(state, command, lag, duration, speed=SPEED):
    """Return position in the air mass, course and heading rate after a held command: the project's
    own unicycle.
    """
    north, east, course, heading_rate = state
    if lag > 0.0:
        return lagged_move(north, east, course, heading_rate, speed, command, lag, duration)
    return (*unicycle_move(north, east, course, speed, command, duration), command)


class Steady:
    """A disc at constant velocity, whose velocity is known."""

    def __init__(self, velocity):
        self.velocity = self.told = velocity

    def step(self, x, y, duration):
        pass


class Hunter:
    """A disc that turns and speeds up towards the vehicle as hard as it may, and says its velocity
    with a constant error.
    """

    def __init__(self, velocity, *, acceleration, speed_max, error):
        self.velocity, self._acceleration, self._speed_max, self._error = (
            velocity,
            acceleration,
            speed_max,
            error,
        )

    @property
    def told(self):
        return self.velocity[0] + self._error[0], self.velocity[1] + self._error[1]

    def step(self, x, y, duration):
        distance = math.hypot(x, y)
        faster = [
            v + self._acceleration * duration * to / distance
            for v, to in zip(self.velocity, (x, y), strict=True)
        ]
        if math.hypot(*faster) <= self._speed_max:
            self.velocity = tuple(faster)


def fly_guarded(guard, start, want, disc, *, lag, delay=0.0, duration=45.0, speed=SPEED):
    """Return the closest approach to the disc's centre [m], and of each step whether the guard
    changed it and was lost.
    """
    x, y, course, heading_rate = start
    under_way = deque([heading_rate] * round(delay / TIME_STEP))
    closest, changed, lost = math.hypot(x, y), [], []
    pieces = 2
    for step in range(round(duration / TIME_STEP)):
        command = guard.limit(
            want(step, x, y, course), x, y, *disc.told, course, speed, heading_rate
        )
        changed.append(guard.intervening)
        lost.append(guard.lost)
        under_way.append(command)
        acting = under_way.popleft()
        for _ in range(pieces):
            piece = TIME_STEP / pieces
            x, y, course, heading_rate = moved(
                (x, y, course, heading_rate), acting, lag, piece, speed
            )
            x, y = x - disc.velocity[0] * piece, y - disc.velocity[1] * piece
            disc.step(x, y, piece)
            closest = min(closest, math.hypot(x, y))
    return closest, changed, lost


def aim_at_the_centre(_, x, y, course, heading_rate_max=HEADING_RATE_MAX):
    error = wrap(math.atan2(-y, -x) - course)
    return min(max(1.5 * error, -heading_rate_max), heading_rate_max)


def held_at_random(generator, heading_rate_max=HEADING_RATE_MAX):
    """Full turns and anything between, each for up to four seconds."""
    values = []
    while len(values) < 1300:
        turn = generator.choice([-1.0, 1.0, generator.uniform(-1.0, 1.0)]) * heading_rate_max
        values += [float(turn)] * int(generator.integers(1, 80))
    return lambda step, *_: values[step]


def random_start(generator, nearest=260.0):
    bearing, distance = generator.uniform(-math.pi, math.pi), generator.uniform(nearest, 600.0)
    course = generator.uniform(-math.pi, math.pi)
    turn = generator.uniform(-HEADING_RATE_MAX, HEADING_RATE_MAX)
    return distance * math.cos(bearing), distance * math.sin(bearing), course, turn


def random_velocity(generator, speed):
    course = generator.uniform(-math.pi, math.pi)
    return speed * math.cos(course), speed * math.sin(course)
