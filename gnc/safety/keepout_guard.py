"""Keeping out wherever the vessel may be, whatever the guidance demands: a filter of heading-rate
commands.

The guard predicts, at each step, the vehicle's path if it flew the demanded heading rate for that
step and then turned away at omega_max, to the left or to the right, with the vehicle's own lag.
While one of the two keeps off a disc that contains the vessel for certain, as it moves and grows,
the guidance is free. Otherwise as much of the turn that was safe at the last step is mixed in as is
needed. The disc of that turn stays true whatever is reported later, so that turn is still possible,
and so is staying out: docs/keepout_guard.md (a backup-manoeuvre safety filter: Gurriet et al., "An
Online Approach to Active Set Invariance", CDC 2018).

Predictions are posed in the air mass, relative to the disc: the vehicle's course and speed are
those of its motion through the air. The guard plans no way round; it keeps out and no more.
"""

import math
from collections.abc import Sequence

from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import Tube
from gnc.numeric import limited
from gnc.safety.free_commands import FreeCommands
from gnc.safety.given_commands import GivenCommands
from gnc.safety.guard_parameters import GuardParameters
from gnc.safety.turn_prediction import Motion, TurnPrediction, nearer_side

_RESOLUTION = 1e-3
"""Turn radii kept beyond the radius: the closest approach is predicted as well as that, 4 cm at a
turn radius of 40 m [-].
"""
_SAME_SPEED = 0.05
"""Speeds that differ by no more are taken for one, the faster: a turn away keeps off by the same to
2 cm [m/s].
"""
_UNSTEADY = 0.05
"""Of the difference between its turn radii when fast and slow, by which a vehicle may come nearer
than predicted [-].
"""
_BISECTIONS = 5
"""Halvings of the fraction of the turn away, which is found to 1/32."""

Free = tuple[float, float, float]
"""For how long commands are free [s], course that they may take from the turn away [rad], and the
change that is counted [-].
"""
Situation = tuple[tuple[Motion, ...], Tube]
"""A disc, and the motion relative to it when a command begins to act: fast first and slow then,
slow, fast; or at one speed.
"""


class KeepoutGuard:
    """A radius about a vessel that commands must not lead into. It keeps a memory and must be
    called once per time step.

    Parameters
    ----------
    parameters : of the vehicle, and what is to be kept

    Attributes
    ----------
    tubes : discs that contain the vessel; whoever knows of it sets them, the one known best first
    intervening : whether the last command was changed
    interventions : how often interventions began
    lost : whether, at the last step, no turn away kept off by more than deviation, speed error,
        allowance, wander and resolution explain; the best is flown
    """

    __slots__ = (
        "_cover", "_drift_rate", "_explained", "_fallen", "_free", "_given", "_kept_off", "_lag", "_note", "_note_rate",
        "_prediction", "_quarter_turn", "_radius", "_rate", "_resolution", "_side", "_speed_error", "_time_step", "_turn_speed",
        "_turn_time", "_until_acting", "_within_step", "intervening", "interventions", "lost", "tubes",
    )  # fmt: skip

    def __init__(self, parameters: GuardParameters) -> None:
        p = parameters
        self._radius, self._turn_speed, self._fallen = p.radius, p.turn_speed, p.slowest
        self._rate, self._time_step, self._quarter_turn = (
            p.heading_rate_max,
            p.time_step,
            0.5 * math.pi / p.heading_rate_max,
        )
        self._lag, self._until_acting = p.lag, p.delay
        self._given = GivenCommands(
            lag=p.lag,
            delay=p.delay,
            slow_lag=p.delay + p.lag if p.slow_lag is None else p.slow_lag,
            time_step=p.time_step,
            heading_rate_max=p.heading_rate_max,
        )
        self._note, self._note_rate = self._given.since.append, self._given.rates.append
        # Satellite navigation may be lost at any moment, and dead reckoning go wrong from then on.
        self._speed_error, self._drift_rate = p.speed_error + p.drift_rate, p.drift_rate
        self._prediction = TurnPrediction(
            heading_rate_max=p.heading_rate_max,
            lag=p.lag,
            delay=p.delay,
            time_step=p.time_step,
            deviation=p.deviation,
            turn_speed=p.turn_speed,
        )
        # Half a turn to the nearer side, half as much again for the disc's motion, and what the lag
        # takes from any heading rate.
        self._turn_time = 1.5 * math.pi / p.heading_rate_max + 2.0 * p.lag + p.delay + p.time_step
        # What the declared errors may take from the slack of a turn that was safe.
        self._explained = p.deviation + self._speed_error * self._turn_time + p.allowance + p.wander
        # Within a step a command may lead off the turn that was safe by all of a reversal: by V
        # omega_max dt^2, in turn radii.
        self._resolution = max(_RESOLUTION, (p.heading_rate_max * p.time_step) ** 2)
        self._within_step = (self._resolution - _RESOLUTION) / p.heading_rate_max
        self._side, self._free = 0.0, FreeCommands(p.heading_rate_max, p.time_step)
        self._cover = self._free.cover
        self._kept_off: Tube | None = None
        self.tubes: Sequence[Tube] = ()
        self.intervening = self.lost = False
        self.interventions = 0

    def limit(
        self, command: float, time: float, own: AirMotion, speed: float, slowest: float = math.inf
    ) -> float:
        """Return the command, or as much of a turn away as is needed [rad/s].

        Parameters
        ----------
        command : that the guidance demands [rad/s]
        time : now [s]
        own : the vehicle's motion
        speed : of the vehicle in the air mass, to reckon with: as fast as it may become [m/s]
        slowest : as slow as it may become [m/s]; a turn away has to keep off at all speeds between
        """
        if not self._cover(command, speed, slowest):
            free, situations = self._look(command, time, own, speed, slowest)
            if free >= 0.0:
                self.intervening = self.lost = False
            else:
                self.interventions += not self.intervening
                self.intervening = True
                command = self._mix(command, situations)
        # At the largest bank a command comes in part where the vehicle flies faster.
        self._note(
            command
            if own.speed <= self._turn_speed
            else limited(command, self._rate * self._turn_speed / own.speed)
        )
        self._note_rate(own.heading_rate)
        return command

    def allows(
        self, command: float, time: float, own: AirMotion, speed: float, slowest: float = math.inf
    ) -> bool:
        """Return whether ``limit``, which is to be called next, lets the command pass if it is
        given the same parameters.
        """
        free, _ = self._look(command, time, own, speed, slowest)
        if free < 0.0:
            return False
        self.intervening = self.lost = False
        self._free.repeat(command)
        return True

    def overruled(self, command: float) -> None:
        """Take note of a heading rate that is flown in place of the last command [rad/s]."""
        self._free.replace(self._given.since[-1], command)
        self._given.since[-1] = command

    def clearance(
        self, time: float, own: AirMotion, speed: float, enough: float = math.inf
    ) -> float:
        """Return by how much the better turn away, begun now, or one that does by ``enough``, keeps
        off [m]; negative if none can.

        It is less what the path may come nearer within a step. Parameters are those of ``limit``.
        That no other commands do better is argued in docs/keepout_guard.md.
        """
        best, within, to_come = (
            -math.inf,
            self._within_step * speed,
            self._given.still_to_come(own.heading_rate),
        )
        turn, since = self._prediction.turn_away, (self._given.change, self._until_acting)
        for tube in self.tubes:
            motions = self._when_acting(self._relative(tube, time, own, speed, speed, to_come))
            for side in (
                nearer := nearer_side(motions[0][0], motions[0][1], motions[0][4]),
                -nearer,
            ):
                best = max(
                    best,
                    min(turn(side, (*at[:2], at[4], at[6]), at, *since, best)[0] for at in motions),
                )
                if best >= enough + within:
                    return best - within
        return best - within

    def _look(
        self, command: float, time: float, own: AirMotion, speed: float, slowest: float
    ) -> tuple[float, list[Situation]]:
        """Return for how long [s] no command can spoil the turn away that follows this one,
        negative if no turn away keeps off.

        Then it is told of the situations, too: the motions relative to each disc when the command
        begins to act.
        """
        free, situations, to_come = -1.0, [], self._given.still_to_come(own.heading_rate)
        for tube in self._candidates(time, own):
            side, to_lose, change = 0.0, math.inf, self._given.changed_by(command)
            motion = self._relative(tube, time, own, speed, slowest, to_come)
            free = self._free_when_far(motion)
            motions: tuple[Motion, ...] = ()
            if free <= 0.0:
                motions = self._when_acting(motion)
                (free, to_lose, change), side = (
                    self._free_by_turning_away(command, motions),
                    self._side,
                )
            if free >= 0.0:
                self._kept_off = tube
                break
            situations.append((motions, tube))
        # Until the next look: commands that change by no more than is counted for the turn's
        # deviation, and speeds that it has.
        self._free.begin(free, side, to_lose, command, self._given.last, change)
        self._free.at_speeds(min(slowest, speed) - _SAME_SPEED, speed + _SAME_SPEED)
        return free, situations

    def _candidates(self, time: float, own: AirMotion) -> Sequence[Tube]:
        """Return the disc that reaches least far towards the vehicle, and the one that was kept off
        last.
        """
        tubes, last = self.tubes, self._kept_off
        gaps = [self._gap(tube, time, own) for tube in tubes] if len(tubes) > 1 else [0.0]
        nearest = tubes[gaps.index(max(gaps))]
        return (nearest,) if last is None or last is nearest else (nearest, last)

    def _gap(self, tube: Tube, time: float, own: AirMotion) -> float:
        """Return the distance from a disc at the end of a quarter of a turn, if the vehicle stayed
        where it is [m].
        """
        since = time - tube.time + self._quarter_turn
        north = own.ground_north - tube.north - tube.velocity_north * since
        east = own.ground_east - tube.east - tube.velocity_east * since
        return (
            math.hypot(north, east)
            - tube.radius
            - (tube.growth + 0.5 * tube.acceleration * since) * since
        )

    def _relative(
        self, tube: Tube, time: float, own: AirMotion, speed: float, slowest: float, to_come: float
    ) -> Motion:
        """Return the vehicle's motion relative to a disc, with all that is uncertain in the disc's
        radius and growth.
        """
        since, wrong, slowest = time - tube.time, own.wind_error, min(slowest, self._fallen)
        drifted = (self._drift_rate + wrong) * own.lost
        return (
            own.ground_north - (tube.north + tube.velocity_north * since),
            own.ground_east - (tube.east + tube.velocity_east * since),
            tube.velocity_north - own.wind_north,
            tube.velocity_east - own.wind_east,
            own.course,
            speed,
            own.heading_rate,
            self._radius
            + drifted
            + tube.radius
            + (tube.growth + 0.5 * tube.acceleration * since) * since,
            self._speed_error + wrong + tube.growth + tube.acceleration * since,
            tube.acceleration,
            to_come,
            slowest if slowest < speed - _SAME_SPEED else speed,
        )

    def _free_when_far(self, motion: Motion) -> float:
        """Return for how long [s] the disc stays beyond all that both can close during a turn away;
        negative if it is nearer.
        """
        x, y, velocity_north, velocity_east, _, speed, _, radius, growth, acceleration, *_ = motion
        duration = self._turn_time * max(1.0, speed / self._turn_speed)
        closing = speed + math.hypot(velocity_north, velocity_east) + growth
        gap = math.hypot(x, y) - radius - (closing + 0.5 * acceleration * duration) * duration
        return min(gap / (closing + 1.5 * acceleration * duration), duration)

    def _when_acting(self, motion: Motion) -> tuple[Motion, ...]:
        """Return the motions of a situation."""
        acting, under_way = self._prediction.when_acting, self._given.under_way
        if motion[11] == motion[5]:
            return (acting(motion, under_way),)
        # Round a disc, or past a small one, a turn may come nearer that is slow, or fast, from
        # beginning to end.
        steady = [(*motion[:5], speed, *motion[6:11], speed) for speed in (motion[11], motion[5])]
        return tuple(acting(each, under_way) for each in (motion, *steady))

    def _free_by_turning_away(self, command: float, motions: tuple[Motion, ...]) -> Free:
        """Return what cannot spoil the turn away that follows this command; for a negative time if
        there is none.
        """
        floor = self._resolution * motions[0][5] / self._rate
        for side in (
            nearer := nearer_side(*self._prediction.after(command, motions[0])[:3]),
            -nearer,
        ):
            slack, free = self._slack(side, command, motions, floor)
            if slack >= floor:
                self._side = side
                return free
        return -1.0, 0.0, 0.0

    def _slack(
        self, side: float, command: float, motions: tuple[Motion, ...], floor: float
    ) -> tuple[float, Free]:
        """Return slack [m] of a turn away after a command, and what cannot spoil it: the least of
        the motions.
        """
        begun, change, prediction = (
            self._until_acting + self._time_step,
            self._given.changed_by(command),
            self._prediction,
        )
        slack = free = to_lose = math.inf
        counted, against = 1.0, 0.5 - 0.5 * self._free.least(side, command) / self._rate
        for motion in motions:
            start = prediction.after(command, motion)
            kept, kept_free, kept_lost, kept_counted = prediction.turn_away(
                side, start, motion, change, begun, floor, against
            )
            # In this order what is not a number stays so.
            slack, free, to_lose = min(kept, slack), min(kept_free, free), min(kept_lost, to_lose)
            counted = min(counted, kept_counted)
            if slack < floor:
                break
        return slack, (free, to_lose, counted)

    def _mix(self, command: float, situations: Sequence[Situation]) -> float:
        """Return the command with the least of a turn away that keeps off, or the turn that was
        safe before [rad/s].
        """
        slack, side, motions, tube = self._best_turn(situations)
        self._side = side
        turn = self._turn(side, motions[0])
        floor = self._resolution * motions[0][5] / self._rate
        self.lost = slack < -self._explains(motions[0]) - floor
        if slack < 0.0:
            return turn
        self._kept_off = tube
        low, high, mixed = 0.0, 1.0, turn
        for _ in range(_BISECTIONS):
            fraction = 0.5 * (low + high)
            trial = command + fraction * (turn - command)
            slack, _ = self._slack(side, trial, motions, floor)
            if slack >= floor:
                high, mixed = fraction, trial
            else:
                low = fraction
        return mixed

    def _explains(self, motion: Motion) -> float:
        """Return what of the slack of a turn that was safe may be gone since [m]."""
        return self._explained + _UNSTEADY * (motion[5] - motion[11]) / self._rate

    def _turn(self, side: float, motion: Motion) -> float:
        """Return the command of a turn away [rad/s]: straight away from the disc and no farther."""
        x, y, _, _, course, _, heading_rate, *_ = motion
        left = math.remainder(math.atan2(y, x) - course - self._lag * heading_rate, 2.0 * math.pi)
        # From less than a right angle beyond it turns back: going on would lead once round, towards
        # the disc.
        if side * left >= self._rate * self._time_step or abs(left) >= 0.5 * math.pi:
            return side * self._rate
        return limited(left / self._time_step, self._rate)

    def _best_turn(
        self, situations: Sequence[Situation]
    ) -> tuple[float, float, tuple[Motion, ...], Tube]:
        """Return slack [m], side, motions and disc of the turn away to fly: one that keeps off, or
        that to the side that was safe.

        That one is flown as long as declared errors explain what it lacks, and the better one if
        they do not.
        """
        found: list[tuple[float, float, tuple[Motion, ...], Tube]] = []
        for motions, tube in situations:
            for side in (self._side, -self._side) if self._side else (1.0, -1.0):
                slack, _ = self._slack(side, self._turn(side, motions[0]), motions, -math.inf)
                found.append((slack, side, motions, tube))
                if self._side and slack >= 0.0:
                    return found[-1]
        was_safe = max(
            (entry for entry in found if entry[1] == self._side),
            key=lambda entry: entry[0],
            default=None,
        )
        if was_safe is not None and was_safe[0] >= -self._explains(was_safe[2][0]):
            return was_safe
        return max(found, key=lambda entry: entry[:2])
