"""How a vehicle with a lag turns away from a moving disc, and how near it comes to it:
docs/keepout_guard.md.
"""

import math
from collections import deque

from gnc.numeric import limited
from gnc.safety.closest_approach import leads_away, least_of_late, nearer_by_switch
from gnc.safety.given_commands import commands_under_way

_TURN = 0.125
"""Course turned between two points of a predicted turn, at most; half of it where the lag is
shorter than that takes [rad].
"""
_TURN_MAX = 2.5 * math.pi
"""Course after which a turn away is over [rad]: once round, and what a turn the other way before it
and the disc's motion add.
"""
_ROLLING = 3.0
"""For how many times as long as commands take that are as far against the turn as they may be, what
they add by rolling is kept.
"""

Motion = tuple[float, float, float, float, float, float, float, float, float, float, float, float]
"""A vehicle's motion relative to a disc, and how the disc grows.

North and east of the disc's centre [m]; the disc's velocity north and east in the air mass [m/s];
the vehicle's course and speed there, as fast as it may become, and its heading rate
[rad, m/s, rad/s]; radius of the disc now [m], rate of its growth [m/s] and of that [m/s^2]; what
the heading rate lacks for the course that is still to come of earlier commands [rad/s]; and the
vehicle's speed as slow as it may become [m/s].
"""
Start = tuple[float, float, float, float]
"""x, y, course and heading rate."""


class TurnPrediction:
    """Turns of a vehicle whose heading rate follows its command with a lag, relative to a moving
    disc.

    Its speed is somewhere between a fastest and a slowest. It is predicted at the fastest while it
    flies towards the disc, and at the slowest while it flies away from one that closes in all the
    same: so it comes nearest.

    Parameters
    ----------
    heading_rate_max, lag, delay, time_step, deviation, turn_speed : as of ``GuardParameters``
    """

    __slots__ = (
        "_beyond", "_chord", "_delay", "_deviation", "_first", "_hold", "_interval", "_lag", "_passed", "_points_max", "_rate",
        "_turn_speed",
    )  # fmt: skip

    def __init__(
        self,
        *,
        heading_rate_max: float,
        lag: float,
        delay: float,
        time_step: float,
        deviation: float = 0.0,
        turn_speed: float = math.inf,
    ) -> None:
        self._rate, self._deviation, self._turn_speed = heading_rate_max, deviation, turn_speed
        self._lag, self._delay = lag, delay
        self._hold = _held(time_step, lag)
        # Angle by which straight away is passed by a turn that ends there: by its lag, and a step
        # of holding commands.
        self._beyond = min(heading_rate_max * (lag + time_step), 0.5 * math.pi)
        self._passed = math.sin(self._beyond)
        # Of the commands under way the first acts only for what of it lies within the delay.
        self._first = _held(commands_under_way(delay, time_step)[1], lag)
        interval = max(min(_TURN / heading_rate_max, lag), 0.5 * _TURN / heading_rate_max)
        self._interval = _held(interval, lag)
        self._points_max = math.ceil(_TURN_MAX / (heading_rate_max * interval))
        half = 0.5 * heading_rate_max * interval
        self._chord = math.sin(half) / half

    def when_acting(self, motion: Motion, under_way: deque[float]) -> Motion:
        """Return the motion when a command given now begins to act: those before it cannot be taken
        back.

        ``under_way`` holds those [rad/s] that act within the delay, the first perhaps in part.
        """
        if not under_way:
            return motion
        x, y, velocity_north, velocity_east, course, speed, heading_rate, *others = motion
        radius, growth, acceleration, to_come, slowest = others
        held = self._first
        begun, middles = course, 0.0
        for command in under_way:
            duration, turned, mean, decay = held
            middles += duration * (course + mean * heading_rate + (0.5 * duration - mean) * command)
            course += turned * heading_rate + (duration - turned) * command
            heading_rate = decay * heading_rate + (1.0 - decay) * command
            held = self._hold
        middle, half = middles / self._delay, 0.5 * (course - begun)
        # One chord will do, with the sine over arc of half the course turned.
        cos, sin = math.cos(middle), math.sin(middle)
        chord = (slowest if x * cos + y * sin > 0.0 else speed) * (1.0 - half * half / 6.0)
        x += (chord * cos - velocity_north) * self._delay
        y += (chord * sin - velocity_east) * self._delay
        return (
            x, y, velocity_north, velocity_east, course, speed, heading_rate,
            radius, growth, acceleration, to_come, slowest,
        )  # fmt: skip

    def after(self, command: float, motion: Motion) -> Start:
        """Return where a command held for one time step leads."""
        x, y, velocity_north, velocity_east, course, speed, heading_rate, *_, slowest = motion
        if speed > self._turn_speed:
            # At the largest bank a turn is the slower the faster the vehicle flies.
            command = limited(command, self._rate * self._turn_speed / speed)
        duration, turned, mean, decay = self._hold
        middle = course + mean * heading_rate + (0.5 * duration - mean) * command
        cos, sin = math.cos(middle), math.sin(middle)
        if x * cos + y * sin > 0.0:
            speed = slowest
        return (
            x + (speed * cos - velocity_north) * duration,
            y + (speed * sin - velocity_east) * duration,
            course + turned * heading_rate + (duration - turned) * command,
            decay * heading_rate + (1.0 - decay) * command,
        )

    def turn_away(
        self,
        side: float,
        start: Start,
        motion: Motion,
        change: float,
        time: float,
        floor: float,
        against: float = 1.0,
    ) -> tuple[float, float, float, float]:
        """Return by how much a full turn away keeps the radius [m], and what commands before it
        cannot change that.

        For how long [s] they are given, what course they may take from the turn [rad], and the
        change that its deviation counts, of command or by rolling into it, over a full reversal
        [-].

        It is over once the vehicle recedes and its turn makes it recede faster: by going on until
        it heads straight away, and straight on then, it recedes for good. From a disc that closes
        in faster than it flies it turns no farther than that, and is followed for as long as a turn
        takes. The search ends early below ``floor``.

        Parameters
        ----------
        side : 1 to the right, -1 to the left
        start : of the turn
        motion : when the command that is judged begins to act
        change : largest change of command of late, over a full reversal [-]
        time : from now to the start [s]
        floor : [m]
        against : how far those commands may be against it, over a full reversal [-]
        """
        x, y, course, heading_rate = start
        (
            _,
            _,
            velocity_north,
            velocity_east,
            _,
            speed,
            _,
            fixed,
            error,
            acceleration,
            to_come,
            slowest,
        ) = motion
        # What is to come counts where it is against the turn.
        heading_rate += side * min(0.0, side * to_come)
        duration, turned, mean, decay = self._interval
        chord, ahead, gained, won, stretch, way_speed = fast = self._flown(side, speed)
        slow = self._flown(side, slowest) if (uneven := slowest != speed) else fast
        north, east, half, lag = (
            velocity_north * duration,
            velocity_east * duration,
            0.5 * acceleration,
            self._lag,
        )
        # The farther the vehicle has to roll into the turn, or rolled of late, the more it
        # deviates; where it is now not yet.
        fixed += (
            deviation := self._deviation
            * (counted := max(change, 0.5 - 0.5 * side * heading_rate / self._rate))
        )
        slack = math.sqrt(x * x + y * y) - (allowed := fixed + (error + half * time) * time)
        least, outward, slowed, now = (
            slack + deviation,
            self._outward(side, start),
            False,
            (x, y, course, allowed, speed),
        )
        late, then = now, (x, y, course, 0.0)
        # A command against the turn enlarges the deviation by 1/lag of what that of such a change
        # exceeds it by in each second.
        lost = 2.0 * speed * self._rate * against / _ROLLING
        rolling = max(0.0, self._deviation * max(change, against) - deviation) / (
            lost * max(lag, self._hold[0])
        )
        acting, gain, least_rate, rise, fade = (
            time - self._delay,
            -1.0,
            math.inf,
            0.0,
            self._hold[3] if time > self._delay else 1.0,
        )
        for point in range(math.ceil(self._points_max * stretch)):
            if least < floor:
                break
            middle = course + mean * heading_rate + ahead
            cos_m, sin_m = math.cos(middle), math.sin(middle)
            if uneven and leads_away(x, y, cos_m, sin_m, chord, north, east) != slowed:
                chord, ahead, gained, won, _, way_speed = fast if slowed else slow
                slowed = not slowed
                then = (x, y, course, side * (course - start[2]))
            x += chord * cos_m - north
            y += chord * sin_m - east
            course += turned * heading_rate + gained
            heading_rate = decay * heading_rate + won
            time, acting, fade = time + duration, acting + duration, fade * decay
            last, before, before_outward, outward = (
                slack,
                rise,
                outward,
                side * (y * cos_m - x * sin_m),
            )
            nearer = (
                nearer_by_switch(side, (speed - slowest) * stretch / self._rate, then, x, y, course)
                if slowed
                else 0.0
            )
            slack = math.sqrt(x * x + y * y) - (
                allowed := fixed + (error + half * time) * time + nearer
            )
            earlier, late, now = late, now, (x, y, course, allowed, way_speed)
            rise = slack - last
            slack_rate = slack / (acting - lag * (1.0 - fade) + rolling)
            least_rate = slack_rate if slack_rate < least_rate else least_rate
            if rise < 0.0:
                if gain >= 0.0:
                    break
                least = slack if slack < least else least
                if (
                    before_outward >= 0.0 > outward
                    and x * cos_m + y * sin_m > 0.0
                    and side * heading_rate > 0.0
                ):
                    # It heads straight away, and still the disc gains on it: nothing does better,
                    # and so it flies straight on.
                    heading_rate = ahead = gained = won = outward = 0.0
                    uneven = False
                continue
            if before < 0.0 or point == 0:
                nearest = least_of_late(
                    earlier, late, now, (velocity_north, velocity_east), duration, first=point == 0
                )
                least, least_rate = (
                    min(least, nearest),
                    min(least_rate, nearest / (acting - lag * (1.0 - fade) + rolling)),
                )
            # Also if it came past straight away between two points: it would have stopped there.
            if side * heading_rate >= 0.0 and (outward >= 0.0 or before_outward >= 0.0):
                # It is over. One point more may allow more time until the next prediction.
                best, gain = gain, max(gain, min(least_rate, rise / duration))
                if gain == best or outward < 0.0:
                    break
        return (
            least,
            min(max(gain, 0.0) / lost, self._until_beyond(side, start, motion)),
            max(gain, 0.0) / speed,
            counted,
        )

    def _flown(self, side: float, speed: float) -> tuple[float, float, float, float, float, float]:
        """Return what is flown between two points of a full turn.

        Way [m]; course to the middle, course turned [rad] and heading rate gained [rad/s] by the
        command, beside what the heading rate brings; by how much longer than at omega_max it takes,
        at the largest bank [-]; and the speed [m/s].
        """
        duration, turned, mean, decay = self._interval
        # At the largest bank a turn is the slower the faster the vehicle flies.
        stretch = max(1.0, speed / self._turn_speed)
        turn = side * self._rate / stretch
        way = speed * duration * self._chord
        return (
            way,
            (0.5 * duration - mean) * turn,
            (duration - turned) * turn,
            (1.0 - decay) * turn,
            stretch,
            speed,
        )

    def _outward(self, side: float, start: Start) -> float:
        """Return how far outwards a turn leads [m]; 0 where it begins beyond straight away by no
        more than one that ends there.
        """
        x, y, course, _ = start
        cos, sin = math.cos(course), math.sin(course)
        outward = side * (y * cos - x * sin)
        over = -self._passed * math.sqrt(x * x + y * y) < outward < 0.0 and x * cos + y * sin > 0.0
        return 0.0 if over else outward

    def _until_beyond(self, side: float, start: Start, motion: Motion) -> float:
        """Return how soon the vehicle may be so far beyond straight away that a turn away to that
        side leads once round [s].

        Its course turns at omega_max at most, and the direction in which the disc lies the other
        way, by what crosses it: all of the disc's speed, and of the vehicle's what lies across
        while it has so far left to turn.
        """
        x, y, course, _ = start
        left = side * math.remainder(math.atan2(y, x) - course, 2.0 * math.pi) + self._beyond
        if left < 0.0:
            return math.inf
        speed, disc = motion[5], math.hypot(motion[2], motion[3])
        across = speed * math.sin(min(max(left - self._beyond, 0.0), 0.5 * math.pi)) + disc
        nearest = max(motion[7], math.hypot(x, y) - (speed + disc) * left / self._rate)
        return left / (self._rate + across / nearest) if nearest > 0.0 else 0.0


def nearer_side(x: float, y: float, course: float) -> float:
    """Return the side to which it is less far to head straight away from a disc: 1 to the right, -1
    to the left.
    """
    return 1.0 if y * math.cos(course) >= x * math.sin(course) else -1.0


def _held(duration: float, lag: float) -> tuple[float, float, float, float]:
    """Return what a vehicle with a lag makes of a heading rate that it has, while a command is
    held.

    Returns
    -------
    duration : of the command [s]
    turned : course, per heading rate at the start [s]; the rest of the duration is course per
        command
    mean : course on the mean of the duration, per heading rate at the start [s]; the rest of its
        half is per command
    decay : heading rate at the end, per heading rate at the start [-]; the rest of 1 is per command
    """
    if lag == 0.0:
        return duration, 0.0, 0.0, 0.0
    turned = -lag * math.expm1(-duration / lag)
    return duration, turned, lag * (1.0 - turned / duration), math.exp(-duration / lag)
