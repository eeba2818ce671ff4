"""Turns that keep off several vessels at once.

A turn away heads straight away from one vessel, and may lead to another. Where several are near,
the backup manoeuvre is a **common turn**: omega_max to one side up to some course, then straight
on. This one path keeps off all vessels. The slack of each vessel is defined as in a turn away
(``turn.py``): the least distance from the centre of its disc, less the distance to keep there. The
slack of a common turn is the least over the vessels; so the nearest vessel decides. Courses are
tried at equal angles to both sides, and first of all the course of the last safe common turn.

After the turn the vehicle flies straight on for a **leg**. At the end of the leg each vessel has to
fall behind, or be so far away that a turn away is still possible.
"""

import math
from collections.abc import Sequence

from gnc.guard.turn import FollowedTurn, RelativeMotion, TurnPrediction, TurnStart

_ANGLE = 0.25
"""Angle between two courses on which a common turn may end [rad]."""

_ANGLES = 26
"""Number of such courses on each side [-]: once round."""

_BEYOND_MIN = 1.0
"""Least distance beyond its radius with which a vessel is weighted [m]."""

_TURNS_BACK = 0.5 * math.pi
"""Course beyond the end of a common turn up to which the vehicle turns back [rad]."""

_LEG = 2.0
"""Duration of the leg, over that of a turn away [-]."""


class CommonTurn:
    """A turn to one side up to some course, then straight on.

    Attributes
    ----------
    side : of the turn
    course : at its end [rad]
    slack : least margin over all vessels [m]
    ends : whether each of them falls behind in the end, or is still far then
    rate : least slack per lever of commands before it [m/s]
    free_time, free_course : for how long other commands may be given before it, and the course that
        these may take from it in all [s, rad]
    to_turn : course up to its end [rad]
    change : share of a full reversal that its deviation counts [-]
    """

    def __init__(
        self,
        *,
        side: float,
        course: float,
        slack: float,
        ends: bool,
        rate: float,
        free_time: float,
        free_course: float,
        to_turn: float,
        change: float,
    ) -> None:
        self.side = side
        self.course = course
        self.slack = slack
        self.ends = ends
        self.rate = rate
        self.free_time = free_time
        self.free_course = free_course
        self.to_turn = to_turn
        self.change = change

    def keeps_off(self, floor: float) -> bool:
        """Return whether its slack is at least ``floor`` [m] up to its end."""
        return self.slack >= floor and self.ends


def remaining(side: float, course: float, to: float) -> tuple[float, float]:
    """Return the side and the angle of a turn from a course to another one [rad].

    The turn to a side may be longer than half a turn. From a little beyond its end the vehicle
    turns back.
    """
    angle = math.fmod(side * (to - course), 2.0 * math.pi)
    if angle < 0.0:
        angle += 2.0 * math.pi
    if angle > 2.0 * math.pi - _TURNS_BACK:
        return -side, 2.0 * math.pi - angle
    return side, angle


class CommonTurns:
    """Finds common turns of one vehicle.

    Parameters
    ----------
    prediction : of its turns
    heading_rate_max, lag, time_step, delay : of ``GuardParameters``
    turn_time : of a turn away [s]
    """

    def __init__(
        self,
        prediction: TurnPrediction,
        *,
        heading_rate_max: float,
        lag: float,
        time_step: float,
        delay: float,
        turn_time: float,
    ) -> None:
        self._prediction = prediction
        self._rate = heading_rate_max
        self._lag = lag
        self._time_step = time_step
        self._delay = delay
        self._turn_time = turn_time

    def to_course(
        self,
        side: float,
        course: float,
        command: float,
        motions: Sequence[RelativeMotion],
        *,
        change: float,
        against: float,
        floor: float,
    ) -> CommonTurn:
        """Return the common turn to a side, up to a course, after a command.

        Parameters
        ----------
        side, course : of the turn [-, rad]
        command : for one time step before it [rad/s]
        motions : relative to all vessels, when the command begins to act
        change : largest recent change of command, over a full reversal [-]
        against : how far commands before the turn may be against it, over a full reversal [-]
        floor : slack below which the search may end early [m]
        """
        starts = [self._prediction.after(command, motion) for motion in motions]
        side, angle = remaining(side, starts[0].course, course)
        turns = self._followed(side, starts, motions, change, against)
        return self._ended(side, angle, course, turns, floor)

    def away(self, motions: Sequence[RelativeMotion]) -> float:
        """Return the course away from all vessels together [rad].

        Nearer vessels count more: by the inverse square of the distance beyond the radius.
        """
        north = east = 0.0
        for motion in motions:
            distance = math.hypot(motion.x, motion.y)
            beyond = max(distance - motion.radius, _BEYOND_MIN)
            weight = 1.0 / (distance * beyond * beyond)
            north += weight * motion.x
            east += weight * motion.y
        return math.atan2(east, north)

    def best(
        self,
        command: float,
        motions: Sequence[RelativeMotion],
        *,
        change: float,
        floor: float,
    ) -> CommonTurn:
        """Return the common turn, to any course, that earlier commands can spoil least.

        Parameters are those of ``to_course``.
        """
        starts = [self._prediction.after(command, motion) for motion in motions]
        best: CommonTurn | None = None
        for side in (1.0, -1.0):
            turns = self._followed(side, starts, motions, change, 1.0)
            for number in range(_ANGLES):
                angle = number * _ANGLE
                course = starts[0].course + side * angle
                least = -math.inf if best is None else min(floor, best.slack)
                found = self._ended(side, angle, course, turns, least)
                if best is None or _is_better(found, best, floor):
                    best = found
                if any(turn.slack < least for turn in turns):
                    break
        if best is None:
            raise ValueError("there is no vessel to keep off")
        return best

    def command(self, turn: CommonTurn, motion: RelativeMotion) -> float:
        """Return the command of a common turn [rad/s]: up to its course and no farther."""
        course = motion.course + self._lag * motion.heading_rate
        side, angle = remaining(turn.side, course, turn.course)
        return side * min(angle / self._time_step, self._rate)

    def _followed(
        self,
        side: float,
        starts: Sequence[TurnStart],
        motions: Sequence[RelativeMotion],
        change: float,
        against: float,
    ) -> list[FollowedTurn]:
        time = self._delay + self._time_step
        return [
            self._prediction.followed(
                side, start, motion, change=change, time=time, against=against
            )
            for start, motion in zip(starts, motions, strict=True)
        ]

    def _ended(
        self,
        side: float,
        angle: float,
        course: float,
        turns: Sequence[FollowedTurn],
        floor: float,
    ) -> CommonTurn:
        """Return the common turn whose full turns end after an angle [rad]."""
        slack = rate = free_time = math.inf
        counted, ends = 1.0, True
        for turn in turns:
            turn.turn_to(angle, floor)
            slack = min(turn.slack, slack)
            if slack < floor:
                # A more accurate value is not needed.
                return CommonTurn(
                    side=side,
                    course=course,
                    slack=slack,
                    ends=False,
                    rate=slack,
                    free_time=0.0,
                    free_course=0.0,
                    to_turn=angle,
                    change=counted,
                )
            leg = turn.straight_on(_LEG * self._turn_time, self._turn_time)
            slack = min(leg.slack, slack)
            ends = ends and leg.ends
            least = min(turn.rate, leg.rate)
            rate = min(least, rate)
            free_time = min(max(least, 0.0) / turn.loss_rate, free_time)
            counted = min(counted, turn.counted)
            if slack < floor:
                break
        fastest = max(turn.fastest for turn in turns)
        return CommonTurn(
            side=side,
            course=course,
            slack=slack,
            ends=ends,
            rate=rate,
            # Commands to the side of the turn lead beyond its end.
            free_time=min(free_time, max(angle / self._rate, self._lag)),
            free_course=max(rate, 0.0) / fastest,
            to_turn=angle,
            change=counted,
        )


def _is_better(one: CommonTurn, other: CommonTurn, floor: float) -> bool:
    """Return whether a common turn is better than another one: it keeps off and the other one does
    not, or commands before it can spoil it less.
    """
    keeps_off, other_keeps_off = one.keeps_off(floor), other.keeps_off(floor)
    if keeps_off != other_keeps_off:
        return keeps_off
    return one.rate > other.rate if keeps_off else one.slack > other.slack
