"""How a vehicle turns away from a moving disc, and how near it comes to it.

The one prediction of a turn: the keep-out guard decides by it, and innerloop's search over
reversals measures how far an aircraft strays from it. The vehicle's heading rate follows its
command after a dead time and with a first-order lag; a **turn away** is omega_max to one side until
the vehicle heads straight away from the disc, then straight on::

       straight away  <-----.
                             `.        .---.
                               |      (  *  )  disc, which moves and grows
                             .'        '---'
       vehicle  ---->------'

The **slack** is the least margin along the turn: the distance r from the disc's centre, less the
radius to keep, the disc's growth, errors of velocity, and the deviation of the vehicle from the
prediction.

All is relative to the disc's centre, in the air mass: x north, y east [m], courses clockwise from
north [rad]. Heading rate is the rate of that course. The side of a turn is 1 to the right and -1 to
the left. ``docs/keepout_guard.md`` derives what is used here.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from gnc.estimation.error_budget import Displacement
from gnc.numeric import limited

LEAST_CHANGE = 0.2
"""Least change of heading rate, over that of a full reversal, that a turn's deviation is computed
for [-]."""

PENDING_DECAY = 64.0
"""Time constant with which pending course is forgotten, over the lag [-]: a part of the course of a
turn at the largest bank is never flown. Heading rates oscillate after a reversal as well, for as
long as ``CHANGE_DECAY`` says."""

CHANGE_DECAY = 24.0
"""Time constant with which the effect of the largest change of command on the deviation of turns
decays, over the lag [-]."""

SLOW_LAG_ERROR = 0.025
"""Relative error of the lag behind slow commands [-]: it was measured at one airspeed, amplitude
and frequency."""

_POINT_SPACING = 0.125
"""Largest course between two points of a predicted turn; half of it where the lag is shorter than
the time that this course takes [rad]."""

_TURN_MAX = 2.5 * math.pi
"""Course after which a turn away is over [rad]: once round, and the course that is added by an
earlier turn to the other side and by the disc's motion."""

_ROLLING_TIMES = 3.0
"""The 3 of docs/keepout_guard.md, "Evaluating less often": commands may go on for this many times
the shortest time in which they can use up the slack by the course that they take [-]."""

SPEED_SWITCH_ERROR = 0.05
"""How much nearer than predicted a vehicle may come that slows down at any moment, over the
difference between its turn radii when fast and when slow [-]."""

_SPACING = 0.5
"""Spacing of the times at which displacements on straight ways are evaluated [s]."""

_NEWTON_STEPS = 3
"""Iterations that find the closest approach between two points: each squares the error of the one
before [-]."""

_WHOLE_STEP = 1e-6
"""Share of a step by which a delay may exceed a whole number of steps without counting as one more
[-]."""


class RelativeMotion:
    """A vehicle's motion relative to a disc, and how the disc grows.

    The classes of this module are plain classes: the guard makes many objects at each look, and
    compiled they take a sixth of the time of a NamedTuple.

    Attributes
    ----------
    x, y : vehicle north and east of the disc's centre [m]
    disc_north, disc_east : velocity of the disc in the air mass [m/s]
    course, heading_rate : of the vehicle in the air mass [rad, rad/s]
    fastest, slowest : airspeeds between which the vehicle stays [m/s]
    radius, growth, acceleration : radius to keep now [m], its rate [m/s] and the rate of that
        [m/s^2]
    pending_rate : change of heading rate that stands for the course still to come of earlier
        commands [rad/s]
    wind_error : part of the growth that is an error of the wind [m/s]
    displacement : by turbulence, kept beside the radius; None without turbulence
    """

    def __init__(
        self,
        *,
        x: float,
        y: float,
        disc_north: float,
        disc_east: float,
        course: float,
        heading_rate: float,
        fastest: float,
        slowest: float,
        radius: float,
        growth: float,
        acceleration: float,
        pending_rate: float,
        wind_error: float = 0.0,
        displacement: Displacement | None = None,
    ) -> None:
        self.x = x
        self.y = y
        self.disc_north = disc_north
        self.disc_east = disc_east
        self.course = course
        self.heading_rate = heading_rate
        self.fastest = fastest
        self.slowest = slowest
        self.radius = radius
        self.growth = growth
        self.acceleration = acceleration
        self.pending_rate = pending_rate
        self.wind_error = wind_error
        self.displacement = displacement

    def moved(self, x: float, y: float, course: float, heading_rate: float) -> "RelativeMotion":
        """Return the same disc and speeds with the vehicle elsewhere [m, m, rad, rad/s]."""
        return RelativeMotion(
            x=x,
            y=y,
            disc_north=self.disc_north,
            disc_east=self.disc_east,
            course=course,
            heading_rate=heading_rate,
            fastest=self.fastest,
            slowest=self.slowest,
            radius=self.radius,
            growth=self.growth,
            acceleration=self.acceleration,
            pending_rate=self.pending_rate,
            wind_error=self.wind_error,
            displacement=self.displacement,
        )

    def at_one_speed(self, speed: float) -> "RelativeMotion":
        """Return the same motion of a vehicle that keeps to one airspeed [m/s]."""
        same = self.moved(self.x, self.y, self.course, self.heading_rate)
        same.fastest = speed
        same.slowest = speed
        return same


class TurnStart:
    """Where a turn begins.

    Attributes
    ----------
    x, y : of the vehicle, relative to the disc's centre [m]
    course, heading_rate : [rad, rad/s]
    """

    def __init__(self, x: float, y: float, course: float, heading_rate: float) -> None:
        self.x = x
        self.y = y
        self.course = course
        self.heading_rate = heading_rate


class TurnAway:
    """A full turn away, and the limits within which commands before it cannot spoil it.

    Attributes
    ----------
    slack : its least margin [m]; negative if it does not keep off
    free_time : time for which other commands may be given before it [s]
    free_course : course that these may take from the turn in all [rad]
    change : share of a full reversal that its deviation counts, by rolling into it or by recent
        changes of command [-]
    ends : whether the disc falls behind in the end
    """

    def __init__(
        self,
        slack: float,
        free_time: float,
        free_course: float,
        change: float,
        ends: bool = True,
    ) -> None:
        self.slack = slack
        self.ends = ends
        self.free_time = free_time
        self.free_course = free_course
        self.change = change


class TurnPoint:
    """A point of a predicted turn.

    Attributes
    ----------
    x, y, course : relative to the disc's centre [m, m, rad]
    allowed : distance that is allowed for there [m]
    speed : airspeed on the way there [m/s]
    """

    def __init__(self, x: float, y: float, course: float, allowed: float, speed: float) -> None:
        self.x = x
        self.y = y
        self.course = course
        self.allowed = allowed
        self.speed = speed


class HeldResponse:
    """Coefficients of a first-order lag under a held command.

    From a heading rate r, under a command u that is held for ``duration``,

    course turned     = turned r + (duration - turned) u,
    its mean          = mean r + (duration/2 - mean) u,
    heading rate then = decay r + (1 - decay) u.

    Attributes
    ----------
    duration, turned, mean : [s]
    decay : [-]
    """

    def __init__(self, duration: float, turned: float, mean: float, decay: float) -> None:
        self.duration = duration
        self.turned = turned
        self.mean = mean
        self.decay = decay


class _Leg:
    """The flight between two points of a full turn at one airspeed.

    Attributes
    ----------
    way : chord [m]
    course_to_middle, course_turned, rate_gained : by the command; the heading rate at the start
        adds to them [rad, rad, rad/s]
    stretch : time that the turn takes, over that at omega_max [-]
    speed : airspeed [m/s]
    """

    def __init__(
        self,
        way: float,
        course_to_middle: float,
        course_turned: float,
        rate_gained: float,
        stretch: float,
        speed: float,
    ) -> None:
        self.way = way
        self.course_to_middle = course_to_middle
        self.course_turned = course_turned
        self.rate_gained = rate_gained
        self.stretch = stretch
        self.speed = speed


def held_response(duration: float, lag: float) -> HeldResponse:
    """Return the coefficients for a command that is held for ``duration`` [s] behind a lag [s]."""
    if lag == 0.0:
        return HeldResponse(duration, 0.0, 0.0, 0.0)
    turned = -lag * math.expm1(-duration / lag)
    return HeldResponse(
        duration, turned, lag * (1.0 - turned / duration), math.exp(-duration / lag)
    )


def commands_under_way(delay: float, time_step: float) -> tuple[int, float]:
    """Return the number of commands that act within a delay, and for how long the first one does
    [s].

    Parameters
    ----------
    delay : dead time of the vehicle [s]
    time_step : for which each command is held [s]
    """
    count = math.ceil(delay / time_step - _WHOLE_STEP)
    return count, delay - (count - 1) * time_step


def pending_turn_rate(lack: float, rate: float, slow_lag: float, lag: float) -> float:
    """Return the change of heading rate that turns through the course still to come [rad/s].

    Parameters
    ----------
    lack : commanded course that is neither turned yet nor under way behind the lag [rad]
    rate : heading rate now [rad/s]; its delay is known to ``SLOW_LAG_ERROR``, and course within
        that error does not count
    slow_lag, lag : delay behind slow commands, and lag over which the course is to be turned [s]
    """
    doubt = SLOW_LAG_ERROR * slow_lag * abs(rate)
    return (lack - math.copysign(doubt, lack)) / lag if abs(lack) > doubt else 0.0


def entry_rate(side: float, heading_rate: float, pending_rate: float) -> float:
    """Return the heading rate that a turn begins with [rad/s]; pending course counts only if it is
    against the turn.
    """
    return heading_rate + side * min(0.0, side * pending_rate)


def rolled_change(side: float, heading_rate: float, heading_rate_max: float) -> float:
    """Return how far the vehicle rolls into a full turn, as a share of a full reversal [-]."""
    return 0.5 - 0.5 * side * heading_rate / heading_rate_max


def nearer_side(x: float, y: float, course: float) -> float:
    """Return the side to which it is less far to head straight away from a disc."""
    return 1.0 if y * math.cos(course) >= x * math.sin(course) else -1.0


class TurnPrediction:
    """Predicts the turns of one vehicle.

    The prediction has the fastest airspeed while the vehicle flies towards the disc, and the
    slowest while it flies away from a disc that closes in nevertheless: so the vehicle comes
    nearest.

    Parameters
    ----------
    heading_rate_max, lag, delay, time_step, deviation, turn_speed : see ``GuardParameters``

    Attributes
    ----------
    overshoot : angle by which a turn that ends straight away goes beyond that course [rad]
    """

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
        self._rate = heading_rate_max
        self._lag = lag
        self._delay = delay
        self._deviation = deviation
        self._turn_speed = turn_speed
        self._step = held_response(time_step, lag)
        # The first of the commands under way acts for a part of its step, the others for a whole
        # step.
        self._first_step = held_response(commands_under_way(delay, time_step)[1], lag)
        spacing = max(
            min(_POINT_SPACING / heading_rate_max, lag), 0.5 * _POINT_SPACING / heading_rate_max
        )
        self._spacing = held_response(spacing, lag)
        self._points_max = math.ceil(_TURN_MAX / (heading_rate_max * spacing))
        half_turned = 0.5 * heading_rate_max * spacing
        self._chord_over_arc = math.sin(half_turned) / half_turned
        # A turn that ends straight away goes beyond it by its lag and by a step of held commands.
        self.overshoot = min(heading_rate_max * (lag + time_step), 0.5 * math.pi)
        self._overshoot_sine = math.sin(self.overshoot)

    def when_acting(self, motion: RelativeMotion, under_way: Sequence[float]) -> RelativeMotion:
        """Return the motion when a command given now begins to act.

        Parameters
        ----------
        motion : now
        under_way : commands [rad/s] that act until then, the first one perhaps for a part of its
            step; they cannot be taken back
        """
        if not under_way:
            return motion
        course, heading_rate = motion.course, motion.heading_rate
        mean_course_time = 0.0
        response = self._first_step
        for command in under_way:
            duration, turned, mean = response.duration, response.turned, response.mean
            mean_course_time += duration * (
                course + mean * heading_rate + (0.5 * duration - mean) * command
            )
            course += turned * heading_rate + (duration - turned) * command
            heading_rate = response.decay * heading_rate + (1.0 - response.decay) * command
            response = self._step
        # One chord is enough, with the sine over arc of half the course turned.
        mean_course, half_turned = mean_course_time / self._delay, 0.5 * (course - motion.course)
        cos, sin = math.cos(mean_course), math.sin(mean_course)
        receding = motion.x * cos + motion.y * sin > 0.0
        speed = motion.slowest if receding else motion.fastest
        chord_speed = speed * (1.0 - half_turned * half_turned / 6.0)
        return motion.moved(
            motion.x + (chord_speed * cos - motion.disc_north) * self._delay,
            motion.y + (chord_speed * sin - motion.disc_east) * self._delay,
            course,
            heading_rate,
        )

    def after(self, command: float, motion: RelativeMotion) -> TurnStart:
        """Return where a command [rad/s] leads that is held for one time step."""
        if motion.fastest > self._turn_speed:
            # At the largest bank a faster vehicle turns more slowly.
            command = limited(command, self._rate * self._turn_speed / motion.fastest)
        step = self._step
        duration, turned, mean = step.duration, step.turned, step.mean
        heading_rate = motion.heading_rate
        middle = motion.course + mean * heading_rate + (0.5 * duration - mean) * command
        cos, sin = math.cos(middle), math.sin(middle)
        receding = motion.x * cos + motion.y * sin > 0.0
        speed = motion.slowest if receding else motion.fastest
        return TurnStart(
            motion.x + (speed * cos - motion.disc_north) * duration,
            motion.y + (speed * sin - motion.disc_east) * duration,
            motion.course + turned * heading_rate + (duration - turned) * command,
            step.decay * heading_rate + (1.0 - step.decay) * command,
        )

    def turn_away(
        self,
        side: float,
        start: TurnStart,
        motion: RelativeMotion,
        *,
        change: float,
        time: float,
        floor: float,
        against: float = 1.0,
    ) -> TurnAway:
        """Return the slack of a full turn away, and the limits within which commands cannot spoil
        it.

        The turn is over once the vehicle recedes and the turn makes it recede faster: if it goes on
        until it heads straight away, and then flies straight on, it recedes for good. From a disc
        that is faster than the vehicle it turns no farther than that; the prediction then covers
        the time of a turn, and ``ends`` is False if the disc does not fall behind.

        Parameters
        ----------
        side : of the turn
        start : of the turn
        motion : when the judged command begins to act; its disc and speeds are used
        change : largest recent change of command, over a full reversal [-]
        time : from now to the start [s]
        floor : slack below which the search may end early [m]
        against : how far commands before the turn may be against it, over a full reversal [-]
        """
        turn = self.followed(side, start, motion, change=change, time=time, against=against)
        path = turn.path
        outward = self._outward(side, start)
        slack_per_lever, over = -1.0, False
        least = turn.slack
        for _ in range(math.ceil(self._points_max * turn.stretch)):
            if least < floor:
                break
            last_outward = outward
            turn.advance()
            outward, rise = path.outward, turn.rise
            if rise < 0.0:
                if slack_per_lever >= 0.0:
                    break
                least = turn.slack
                past_straight_away = last_outward >= 0.0 > outward and path.away
                if past_straight_away and side * path.heading_rate > 0.0:
                    # The disc gains on it nevertheless: flying straight on is best.
                    path.fly_straight_on()
                    outward = 0.0
                continue
            least = turn.slack
            # Passing the course straight away between two points counts as well: the turn would
            # have ended there.
            if side * path.heading_rate >= 0.0 and (outward >= 0.0 or last_outward >= 0.0):
                # The turn is over. One more point may allow more time until the next look.
                over = True
                last_best = slack_per_lever
                slack_per_lever = max(slack_per_lever, min(turn.rate, rise / turn.duration))
                if slack_per_lever == last_best or outward < 0.0:
                    break
        free_rate = max(slack_per_lever, 0.0)
        free_time = min(free_rate / turn.loss_rate, self.time_until_once_round(side, start, motion))
        return TurnAway(
            least,
            free_time,
            free_rate / motion.fastest,
            turn.counted,
            # A disc may gain on the vehicle for as long as a turn takes, and longer.
            ends=over or turn.rise + path.displaced_by >= 0.0,
        )

    def followed(
        self,
        side: float,
        start: TurnStart,
        motion: RelativeMotion,
        *,
        change: float,
        time: float,
        against: float = 1.0,
    ) -> "FollowedTurn":
        """Return a full turn that is followed point by point; parameters are those of
        ``turn_away``.
        """
        rate, lag, time_step = self._rate, self._lag, self._step.duration
        heading_rate = entry_rate(side, start.heading_rate, motion.pending_rate)
        counted = max(change, rolled_change(side, heading_rate, rate))
        deviation = self._deviation * counted
        leg = self._leg(side, motion.fastest)
        path = _TurnPath(side, start, heading_rate, motion, self._spacing, time, deviation, leg)
        if motion.slowest != motion.fastest:
            self._let_slow_down(path, side, motion, leg)
        loss_rate = 2.0 * motion.fastest * rate * against / _ROLLING_TIMES
        # Commands before the turn displace the vehicle by the course that they take from the turn,
        # times a lever; and they use up slack by rolling, which makes the turn deviate more.
        rolling = self._rolling_deviation(change, against, counted) / (
            loss_rate * max(lag, time_step)
        )
        return FollowedTurn(
            path,
            side,
            start.course,
            motion,
            lag=lag,
            rollout=motion.fastest * rate * lag * (lag + time_step),
            duration=self._spacing.duration,
            decay=self._spacing.decay,
            stretch=leg.stretch,
            acting=time - self._delay,
            fade=self._step.decay if time > self._delay else 1.0,
            on_leg=2.0 / rate,
            counted=counted,
            deviation=deviation,
            loss_rate=loss_rate,
            rolling=rolling,
        )

    def _let_slow_down(
        self, path: "_TurnPath", side: float, motion: RelativeMotion, leg: _Leg
    ) -> None:
        """Let the vehicle fly at its slowest airspeed along a path while it flies away."""
        radii_difference = (motion.fastest - motion.slowest) * leg.stretch / self._rate
        path.slow_down_while_receding(self._leg(side, motion.slowest), radii_difference)

    def _rolling_deviation(self, change: float, against: float, counted: float) -> float:
        """Return the additional deviation of a turn by commands against it [m]."""
        return max(0.0, self._deviation * max(change, against) - self._deviation * counted)

    def _leg(self, side: float, speed: float) -> _Leg:
        """Return the flight between two points of a full turn at an airspeed [m/s]."""
        spacing = self._spacing
        # At the largest bank a faster vehicle turns more slowly.
        stretch = max(1.0, speed / self._turn_speed)
        rate = side * self._rate / stretch
        return _Leg(
            way=speed * spacing.duration * self._chord_over_arc,
            course_to_middle=(0.5 * spacing.duration - spacing.mean) * rate,
            course_turned=(spacing.duration - spacing.turned) * rate,
            rate_gained=(1.0 - spacing.decay) * rate,
            stretch=stretch,
            speed=speed,
        )

    def _outward(self, side: float, start: TurnStart) -> float:
        """Return how far the course leads off the disc's direction on the side of the turn [m].

        It is 0 where the turn begins no farther beyond straight away than a turn that ends there
        overshoots.
        """
        x, y, course = start.x, start.y, start.course
        cos, sin = math.cos(course), math.sin(course)
        outward = side * (y * cos - x * sin)
        beyond = -self._overshoot_sine * math.sqrt(x * x + y * y) < outward < 0.0
        return 0.0 if beyond and x * cos + y * sin > 0.0 else outward

    def time_until_once_round(self, side: float, start: TurnStart, motion: RelativeMotion) -> float:
        """Return the time after which the turn would begin too far beyond straight away, and lead
        once round [s].

        The vehicle's course turns at omega_max at most. The direction in which the disc lies turns
        the other way, by the speed across it: all of the disc's speed, and the vehicle's speed
        across while it has that much course left to turn.
        """
        x, y, course = start.x, start.y, start.course
        to_turn = side * math.remainder(math.atan2(y, x) - course, 2.0 * math.pi) + self.overshoot
        if to_turn < 0.0:
            return math.inf
        speed, disc_speed = motion.fastest, math.hypot(motion.disc_north, motion.disc_east)
        until_away = min(max(to_turn - self.overshoot, 0.0), 0.5 * math.pi)
        across = speed * math.sin(until_away) + disc_speed
        nearest = max(motion.radius, math.hypot(x, y) - (speed + disc_speed) * to_turn / self._rate)
        return to_turn / (self._rate + across / nearest) if nearest > 0.0 else 0.0


class FollowedTurn:
    """A full turn that is followed point by point.

    Parameters
    ----------
    path : of the turn, at its start
    side, motion : of ``TurnPrediction.turn_away``
    course : at the start [rad]
    lag : of the heading rate behind its command [s]
    rollout : largest deviation of the end of a turn from one that ends at once [m]
    duration, decay : of a step from point to point [s, -]
    stretch : time that the turn takes, over that at omega_max [-]
    acting, fade : time since a command begins to act, and the share of its effect that the lag
        still holds back [s, -]
    on_leg : lever of commands before the turn on the straight way after it, added to that at its
        end [s]: the straight way begins later by the course that they take, over omega_max
    counted : share of a full reversal that its deviation counts [-]
    deviation : distance kept for it from the start on [m]
    loss_rate : rate at which commands against the turn reduce its slack, per lever [m/s^2]
    rolling : lever that stands for the slack used up by rolling [s]

    Attributes
    ----------
    path, duration, stretch, counted, loss_rate : as given
    rise : of the slack between the last two points [m]
    turned : course turned so far [rad]
    slack : least so far [m]
    rate : least slack per lever so far [m/s]
    fastest : airspeed [m/s]
    """

    def __init__(
        self,
        path: "_TurnPath",
        side: float,
        course: float,
        motion: RelativeMotion,
        *,
        lag: float,
        rollout: float,
        duration: float,
        decay: float,
        stretch: float,
        acting: float,
        fade: float,
        on_leg: float,
        counted: float,
        deviation: float,
        loss_rate: float,
        rolling: float,
    ) -> None:
        self.path = path
        self._side = side
        self._course = course
        self._motion = motion
        self._lag = lag
        self._rollout = rollout
        self.duration = duration
        self._decay = decay
        self.stretch = stretch
        self._acting = acting
        self._fade = fade
        self._on_leg = on_leg
        self._rolling = rolling
        self._first = True
        self.rise = 0.0
        self.turned = 0.0
        # At the start the vehicle has not deviated yet.
        self.slack = path.slack + deviation
        self.rate = math.inf
        self.counted = counted
        self.loss_rate = loss_rate
        self.fastest = motion.fastest

    def advance(self) -> None:
        """Go on to the next point."""
        path, last_rise = self.path, self.rise
        last_slack = path.slack
        path.advance()
        slack = path.slack
        rise = self.rise = slack - last_slack
        self._acting += self.duration
        self._fade *= self._decay
        lever = self._lever()
        self.rate = min(self.rate, slack / lever)
        if rise < 0.0:
            self.slack = min(self.slack, slack)
        elif last_rise < 0.0 or self._first:
            nearest = path.closest_about_last_point(first=self._first)
            self.slack = min(self.slack, nearest)
            self.rate = min(self.rate, nearest / lever)
        self._first = False

    def turn_to(self, angle: float, floor: float) -> None:
        """Go on until the course ``angle`` is turned [rad], or slack falls below ``floor`` [m]."""
        while self.turned < angle and self.slack >= floor:
            self.advance()
            self.turned = self._side * (self.path.place.course - self._course)

    def straight_on(self, duration: float, turn_time: float) -> "StraightOn":
        """Return the closest approach of the disc if the turn ends here.

        Parameters
        ----------
        duration : for which the vehicle flies straight on [s]
        turn_time : of a turn away, for which room has to be left at the end where the disc still
            closes in [s]
        """
        motion, path = self._motion, self.path
        place = path.place
        cos, sin = math.cos(place.course), math.sin(place.course)
        slack, ends = math.inf, True
        for speed in (motion.fastest, motion.slowest):
            north = speed * cos - motion.disc_north
            east = speed * sin - motion.disc_east
            square = north * north + east * east
            inwards = -(place.x * north + place.y * east)
            nearest_at = inwards / square if square > 0.0 else 0.0
            across = abs(place.x * east - place.y * north)
            least_at = self._later(nearest_at, across, square, duration)
            for time in (min(max(0.0, nearest_at), duration), least_at):
                distance = math.hypot(place.x + north * time, place.y + east * time)
                slack = min(slack, distance - path.allowed_after(time))
            x, y = place.x + north * duration, place.y + east * duration
            distance = math.hypot(x, y)
            left = distance - path.allowed_after(duration)
            slack = min(slack, left)
            growth = motion.growth + motion.acceleration * duration
            if x * north + y * east < growth * distance:
                reach = speed + math.hypot(motion.disc_north, motion.disc_east) + growth
                ends = ends and left >= reach * turn_time
            if motion.slowest == motion.fastest:
                break
        slack -= self._rollout
        return StraightOn(slack, slack / (self._lever() + self._on_leg), ends)

    def _later(self, nearest_at: float, across: float, square: float, duration: float) -> float:
        """Return the time at which slack is least, since the disc grows after its closest approach
        [s].

        With the distance m at the closest approach and the relative speed w, slack sqrt(m^2 + w^2
        t^2) - g t is least at t = g m / (w sqrt(w^2 - g^2)).

        Parameters
        ----------
        nearest_at : time of the closest approach; below 0 where the vehicle recedes already [s]
        across : m w [m^2/s]
        square : w^2 [m^2/s^2]
        duration : after which the straight way ends [s]
        """
        motion = self._motion
        growth = motion.growth + motion.acceleration * max(0.0, nearest_at)
        room = square - growth * growth
        if room <= 0.0:
            return duration
        later = nearest_at + growth * across / (square * math.sqrt(room))
        return min(max(0.0, later), duration)

    def _lever(self) -> float:
        """Return the lever of commands before the turn on the present place of the vehicle [s]."""
        return self._acting - self._lag * (1.0 - self._fade) + self._rolling


class StraightOn(NamedTuple):
    """Closest approach of a disc on a straight way after a turn: the least slack [m], the least
    slack per lever of commands before the turn [m/s], and whether the disc falls behind in the end
    or is still far.
    """

    slack: float
    rate: float
    ends: bool


class _TurnPath:
    """A full turn, point by point.

    Parameters
    ----------
    side, start, motion : see ``TurnPrediction.turn_away``
    heading_rate : at the start of the turn [rad/s]
    spacing : from point to point
    time : from now to the start [s]
    deviation : distance kept for it from the start on [m]
    leg : flight between two points

    Attributes
    ----------
    heading_rate : now [rad/s]
    slack : distance from the disc's centre less the distance to keep [m]
    displaced_by : growth of the displacement by turbulence on the last leg [m]
    outward : distance by which the last leg led off the disc's direction on the side of the turn
        [m]
    away : whether it led away from the disc's centre
    """

    def __init__(
        self,
        side: float,
        start: TurnStart,
        heading_rate: float,
        motion: RelativeMotion,
        spacing: HeldResponse,
        time: float,
        deviation: float,
        leg: _Leg,
    ) -> None:
        self.heading_rate = heading_rate
        self.outward = 0.0
        self.away = False
        self.displaced_by = 0.0
        self._displaced = 0.0
        self._side = side
        self._motion = motion
        self._spacing = spacing
        self._time = time
        self._kept = motion.radius + deviation
        self._disc_north = motion.disc_north * spacing.duration
        self._disc_east = motion.disc_east * spacing.duration
        x, y, course = start.x, start.y, start.course
        allowed = self._allowed()
        self.slack = math.sqrt(x * x + y * y) - allowed
        self._now = TurnPoint(x, y, course, allowed, leg.speed)
        self._last = self._before_last = self._now
        self._leg = leg
        # Where the vehicle flies away, it is slower.
        self._other_leg: _Leg | None = None
        self._slowed = False
        self._radii_difference = 0.0
        self._start_course = course
        self._switch, self._turned_at_switch = self._now, 0.0

    @property
    def place(self) -> TurnPoint:
        """The last point."""
        return self._now

    def allowed_after(self, time: float) -> float:
        """Return the distance from the disc's centre to keep some time after the last point [s, m].

        Times are rounded up to a few values, because the displacement of each is stored.
        """
        later, motion = self._time + time, self._motion
        allowed = self._kept + (motion.growth + 0.5 * motion.acceleration * later) * later
        if motion.displacement is not None:
            allowed += motion.displacement.after(_SPACING * math.ceil(later / _SPACING))
        return allowed

    def slow_down_while_receding(self, slow_leg: _Leg, radii_difference: float) -> None:
        """Fly a slower leg while the vehicle flies away; the radii differ by so much [m]."""
        self._other_leg = slow_leg
        self._radii_difference = radii_difference
        self._kept += SPEED_SWITCH_ERROR * radii_difference

    def advance(self) -> None:
        """Go on to the next point."""
        spacing = self._spacing
        point, leg, heading_rate = self._now, self._leg, self.heading_rate
        x, y, course = point.x, point.y, point.course
        north, east = self._disc_north, self._disc_east
        middle = course + spacing.mean * heading_rate + leg.course_to_middle
        cos, sin = math.cos(middle), math.sin(middle)
        if self._other_leg is not None:
            away = recedes(x, y, cos, sin, leg.way, north, east)
            if away != self._slowed:
                # The other leg is kept for when the vehicle flies towards the disc again.
                self._leg, self._other_leg = self._other_leg, leg
                leg = self._leg
                self._slowed = away
                self._switch = point
                self._turned_at_switch = self._side * (course - self._start_course)
        x += leg.way * cos - north
        y += leg.way * sin - east
        course += spacing.turned * heading_rate + leg.course_turned
        self.heading_rate = spacing.decay * heading_rate + leg.rate_gained
        self._time += spacing.duration
        allowed = self._allowed()
        if self._slowed:
            allowed += speed_switch_allowance(
                self._side,
                self._radii_difference,
                self._switch,
                self._turned_at_switch,
                x,
                y,
                course,
            )
        self.slack = math.sqrt(x * x + y * y) - allowed
        self.outward = self._side * (y * cos - x * sin)
        self.away = x * cos + y * sin > 0.0
        self._before_last, self._last = self._last, point
        self._now = TurnPoint(x, y, course, allowed, leg.speed)

    def fly_straight_on(self) -> None:
        """Keep to the course and to the airspeed from here on."""
        self.heading_rate = 0.0
        leg = self._leg
        self._leg = _Leg(leg.way, 0.0, 0.0, 0.0, leg.stretch, leg.speed)
        self._other_leg = None

    def closest_about_last_point(self, *, first: bool) -> float:
        """Return the least slack before or after the last point, after which slack rises [m].

        ``first`` says that the turn began at the last point.
        """
        return closest_between_samples(
            self._before_last,
            self._last,
            self._now,
            disc_north=self._motion.disc_north,
            disc_east=self._motion.disc_east,
            duration=self._spacing.duration,
            first=first,
        )

    def _allowed(self) -> float:
        """Return the distance from the disc's centre to keep now [m]."""
        time, motion = self._time, self._motion
        allowed = self._kept + (motion.growth + 0.5 * motion.acceleration * time) * time
        if motion.displacement is not None:
            displaced = motion.displacement.after(time)
            self.displaced_by = displaced - self._displaced
            self._displaced = displaced
            allowed += displaced
        return allowed


def recedes(
    x: float, y: float, cos: float, sin: float, way: float, disc_north: float, disc_east: float
) -> bool:
    """Return whether the vehicle flies away from the disc's centre, halfway between two points.

    Parameters
    ----------
    x, y : at the first point [m]
    cos, sin : of the course halfway
    way, disc_north, disc_east : of the vehicle and of the disc between the points [m]
    """
    return (x - 0.5 * disc_north) * cos + (y - 0.5 * disc_east) * sin + 0.5 * way > 0.0


def speed_switch_allowance(
    side: float,
    radii_difference: float,
    switch: TurnPoint,
    turned: float,
    x: float,
    y: float,
    course: float,
) -> float:
    """Return how much nearer a vehicle may come that slows down sooner or later than predicted [m].

    A vehicle is predicted to slow down where it begins to fly away from the disc's centre. Its
    closest approach lies in another direction. Along that direction it began to fly away sooner, or
    later, by the course between the two directions, if it turned as much.

    Parameters
    ----------
    side : of the turn
    radii_difference : between the turns, fast and slow [m]
    switch, turned : point at which it was predicted to slow down, and course turned until then
        [rad]
    x, y, course : place and course now
    """
    across, along = side * (switch.x * y - switch.y * x), x * switch.x + y * switch.y
    sooner = across < 0.0
    between = 0.5 * min(
        abs(math.atan2(across, along)),
        max(0.0, turned) if sooner else side * (course - switch.course),
    )
    # Over that course the chords of the two circles differ.
    chord = 2.0 * radii_difference * math.sin(between)
    middle = switch.course + side * (-between if sooner else between)
    shift = -chord if sooner else chord
    shifted = math.hypot(x + shift * math.cos(middle), y + shift * math.sin(middle))
    return max(0.0, math.hypot(x, y) - shifted)


def closest_between_samples(
    earlier: TurnPoint,
    late: TurnPoint,
    now: TurnPoint,
    *,
    disc_north: float,
    disc_east: float,
    duration: float,
    first: bool,
) -> float:
    """Return the least slack before or after a point after which slack rises [m].

    Parameters
    ----------
    earlier, late, now : the last points; slack rises from ``late`` to ``now``
    disc_north, disc_east : velocity of the disc [m/s]
    duration : between points [s]
    first : whether the turn began at ``late``, and there is no earlier point
    """
    x, y = late.x, late.y
    outwards = (now.speed * math.cos(late.course) - disc_north) * x + (
        now.speed * math.sin(late.course) - disc_east
    ) * y
    # Multiplied by the distance, which is 0 where the vehicle is at the disc's centre.
    if outwards <= math.hypot(x, y) * (now.allowed - late.allowed) / duration:
        return _least_slack_between(late, now, disc_north, disc_east, duration)
    if first:
        return math.hypot(x, y) - late.allowed
    return _least_slack_between(earlier, late, disc_north, disc_east, duration)


def _least_slack_between(
    begin: TurnPoint, end: TurnPoint, disc_north: float, disc_east: float, duration: float
) -> float:
    """Return the least slack between two points that are ``duration`` [s] apart [m].

    The path is the cubic through both places with the velocities there, which is true to 1e-6 turn
    radii. A disc may be smaller than the way between the points, so the distances at the points
    alone do not determine the closest approach.
    """
    x, y = begin.x, begin.y
    way = end.speed * duration
    north, east = duration * disc_north, duration * disc_east
    # Place at the share u of the way: x + u x_1 + u^2 x_2 + u^3 x_3.
    x_1, y_1 = way * math.cos(begin.course) - north, way * math.sin(begin.course) - east
    x_end_rate, y_end_rate = way * math.cos(end.course) - north, way * math.sin(end.course) - east
    x_far, y_far = end.x - x, end.y - y
    x_2, y_2 = 3.0 * x_far - 2.0 * x_1 - x_end_rate, 3.0 * y_far - 2.0 * y_1 - y_end_rate
    x_3, y_3 = x_1 + x_end_rate - 2.0 * x_far, y_1 + y_end_rate - 2.0 * y_far
    slope = end.allowed - begin.allowed
    u = 0.5
    for _ in range(_NEWTON_STEPS):
        x_u = x + u * (x_1 + u * (x_2 + u * x_3))
        y_u = y + u * (y_1 + u * (y_2 + u * y_3))
        x_rate = x_1 + u * (2.0 * x_2 + 3.0 * u * x_3)
        y_rate = y_1 + u * (2.0 * y_2 + 3.0 * u * y_3)
        # The square of the distance near this point is square + 2 tilt du + bend du^2.
        square = x_u * x_u + y_u * y_u
        tilt = x_u * x_rate + y_u * y_rate
        bend = (
            x_rate * x_rate
            + y_rate * y_rate
            + 2.0 * (x_u * (x_2 + 3.0 * u * x_3) + y_u * (y_2 + 3.0 * u * y_3))
        )
        room = bend - slope * slope
        if room <= 0.0:
            # The distance to keep grows faster than the distance ever will.
            return min(
                math.hypot(x, y) - begin.allowed,
                math.hypot(end.x, end.y) - end.allowed,
            )
        nearest_square = max(0.0, square - tilt * tilt / bend)
        u += slope * math.sqrt(nearest_square / (room * bend)) - tilt / bend
        u = min(max(u, 0.0), 1.0)
    x_u = x + u * (x_1 + u * (x_2 + u * x_3))
    y_u = y + u * (y_1 + u * (y_2 + u * y_3))
    return math.hypot(x_u, y_u) - begin.allowed - slope * u
