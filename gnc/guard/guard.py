"""The keep-out guard: a filter of commands that keeps the vehicle out of a moving disc.

The guard is a safety filter with a backup manoeuvre (Gurriet et al., "An Online Approach to Active
Set Invariance", CDC 2018). The backup manoeuvre is a **turn away**: omega_max to the left or to the
right until the vehicle heads straight away from the disc, then straight on. The set that is kept
invariant holds the states from which a turn away keeps off. It takes the place of the safe set of a
control barrier function. It is not written down, but evaluated by prediction (``turn.py``)::

                         .--<-- turn away to the left
                       .'                                 .-----.
    vehicle --->----+-'                                  (   *   )  disc
        the demand,  `-.                                  '-----'
        for one step    `-<-- turn away to the right

A **look** predicts both turns that may follow the demand (the nominal command). If one keeps off,
the demand passes. If neither does, a fraction of the turn that was safe at the last look is mixed
in: bisection finds the fraction after which that turn keeps off. If no fraction does, that turn is
flown.

**Theorem.** Under the assumptions, the distance from the vessel never falls below r_min, for any
demand, and whether reports of the vessel arrive, arrive late or do not arrive. Proof by induction:
after every command that passes or is mixed, a turn away is left that keeps off. The vessel is in
the disc of that turn; later reports add discs and invalidate no disc. So that turn can still be
flown, and the guard flies it where it finds nothing better.

**Assumptions.**

1. Heading rate follows its command by a dead time and a lag, and in the end through all of the
   commanded course, to within the deviation that a search over the aircraft's reversals found.
2. Commands within omega_max are flown, up to the airspeed at which the largest bank limits the
   turn, and in proportion above it. The filter is called once per time step.
3. The vessel is in each of its discs.
4. Airspeed stays between the fastest and the slowest of the predictions. Errors of velocity, wind
   and turns are within the terms of the error budget, and without satellite navigation within its
   drift as well.
5. Flying straight away outruns the growth of the disc. Without reports that holds for a limited
   time, since discs grow ever faster.
6. A turn away keeps off at the start.

``docs/keepout_guard.md`` has the proof, what each assumption rests on, and what happens where one
fails. The guard plans no way round the disc; it only keeps the vehicle out.
"""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from gnc.estimation.error_budget import EXACT, ErrorBudget, WindErrorByGusts
from gnc.estimation.navigation import AirMotion
from gnc.estimation.traffic import KnownVessel
from gnc.estimation.vessel import Tube
from gnc.guard.common_turn import CommonTurn, CommonTurns
from gnc.guard.turn import (
    CHANGE_DECAY,
    LEAST_CHANGE,
    PENDING_DECAY,
    SPEED_SWITCH_ERROR,
    RelativeMotion,
    TurnAway,
    TurnPrediction,
    TurnStart,
    commands_under_way,
    nearer_side,
    pending_turn_rate,
)
from gnc.numeric import limited

_RESOLUTION = 1e-3
"""Distance kept beyond the radius, in turn radii, for errors that are not evaluated, such as that
of the predicted closest approach: 4 cm at a turn radius of 40 m [-]."""

_SAME_SPEED = 0.05
"""Largest difference of two airspeeds that count as one, the faster [m/s]. The slack of a turn away
is then wrong by some centimetres, at most 0.2 m at a turn radius of 40 m."""

_BISECTIONS = 5
"""Halvings of the fraction of the turn away that is mixed in: it is found to 1/32."""

_PACE_TOLERANCE = 0.05
"""Rise of the pace that the guard is not consulted about [m/s]; see ``_SAME_SPEED``."""

_SHORTFALL_MAX = 0.5
"""How far skipped commands may lie from the turn away, compared with the command of the look, over
omega_max [-]. A larger share keeps more slack for rolling; a smaller one brings the next look
sooner."""

_COMMON_REACH = 2.0
"""Duration, in turns away, within which a vessel is within reach of a common turn, and for which
the guard predicts whether areas of vessels come near each other [-]."""

_LEFT_OUT_MOST = 1.0
"""Longest time for which other vessels are left out of looks [s]: speeds and wind change."""

_FREE_ENOUGH, _FREE_LEAST = 0.5, 0.15
"""Time until the next look that is long enough to take a common turn without a look at the next
candidate, and without a search over all courses [s]."""

_PACE_DECAY = 2.0
"""Time constant with which former paces fade, over that of the airspeed [-]: an overshoot lasts
longer than a rise."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardParameters:
    """The parameters of the keep-out guard, known beforehand.

    Attributes
    ----------
    radius : distance that the vehicle's path must keep from the vessel: r_min, and the deviation
        from its turn that the failure of a part may cause [m]
    heading_rate_max : omega_max, the largest command [rad/s]
    lag : time constant of the heading rate behind its command; 0 if it follows at once [s]
    delay : dead time before that [s]
    slow_lag : delay behind slow commands; None if that is ``delay`` + ``lag`` [s]
    time_step : time for which a command is held [s]
    errors : error budget that is allowed for
    turn_speed : airspeed up to which it can turn at ``heading_rate_max``; faster it turns at the
        same acceleration across [m/s]
    """

    radius: float
    heading_rate_max: float
    lag: float
    delay: float = 0.0
    slow_lag: float | None = None
    time_step: float
    errors: ErrorBudget = EXACT
    turn_speed: float = math.inf


class GuardStatus(IntEnum):
    """What the guard did at a step.

    ``LOST``: the turn to be flown falls short by more than the declared errors explain.
    """

    FREE = 0
    INTERVENING = 1
    LOST = 2


class Demand:
    """What the guidance wants to fly next.

    This class and ``Guarded`` are made at each step: see ``RelativeMotion``.

    Attributes
    ----------
    time : now [s]
    heading_rate : [rad/s]
    pace : speed over the mean air [m/s]
    leaving : whether the vehicle leaves for good; its pace is not held then
    """

    def __init__(
        self, time: float, heading_rate: float, pace: float, leaving: bool = False
    ) -> None:
        self.time = time
        self.heading_rate = heading_rate
        self.pace = pace
        self.leaving = leaving


class Guarded:
    """What may be flown.

    Attributes
    ----------
    heading_rate : [rad/s]
    pace : speed over the mean air [m/s]
    pace_held : whether the guard chose the pace
    status : what the guard did
    """

    def __init__(
        self, heading_rate: float, pace: float, pace_held: bool, status: GuardStatus
    ) -> None:
        self.heading_rate = heading_rate
        self.pace = pace
        self.pace_held = pace_held
        self.status = status


class Reckoning(NamedTuple):
    """The values that turns away are predicted with, besides the error budget.

    Attributes
    ----------
    fastest, slowest : airspeeds between which the vehicle stays [m/s]
    change : largest recent change of command, over a full reversal [-]
    """

    fastest: float
    slowest: float
    change: float


class KeepoutGuard:
    """Filters the demands of a guidance. It keeps a memory and must be called once per time step.

    A faster pace is flown only where the faster vehicle can turn away as well: a safe turn must
    remain safe. A vehicle that catches up turns wider, so V_r is flown while the guard acts, and
    for a quarter of a turn after that. A faster pace would make the guard act again at once, and
    the two would alternate.

    Parameters
    ----------
    parameters : of the vehicle and of the guard
    speeds : range of speeds of the vehicle, and V_r
    """

    def __init__(self, parameters: GuardParameters, speeds: "SpeedRange") -> None:
        self._heading_rates = HeadingRateFilter(parameters)
        self._speeds = speeds
        self._speed = speeds.speed
        self._quarter_turn = 0.5 * math.pi / parameters.heading_rate_max
        self._hold_until = -math.inf

    @property
    def status(self) -> GuardStatus:
        """The guard's action at the last step."""
        return self._heading_rates.status

    @property
    def reckoning(self) -> Reckoning:
        """The values that turns away are predicted with, after the last step."""
        speeds, turns = self._speeds, self._heading_rates
        return Reckoning(
            fastest=speeds.fastest(speeds.highest),
            slowest=min(speeds.slowest(speeds.lowest), turns.slowest),
            change=turns.history.change,
        )

    def filter(
        self,
        demand: Demand,
        own: AirMotion,
        vessels: Sequence[Tube],
        others: Sequence[KnownVessel] = (),
    ) -> Guarded:
        """Return the commands that keep out and are nearest to the demand.

        Parameters
        ----------
        demand : of the guidance
        own : the vehicle's motion
        vessels : discs, at least one; each of them contains the vessel
        others : other vessels; those out of reach cost next to nothing
        """
        time, command, pace = demand.time, demand.heading_rate, demand.pace
        leaving = demand.leaving
        heading_rates, speeds = self._heading_rates, self._speeds
        pace_held = False
        if time < self._hold_until and not leaving:
            pace, pace_held = self._speed, True
        fastest, slowest = self._speeds_with(pace, own.speed)
        rises = pace > speeds.highest + _PACE_TOLERANCE and not leaving
        if rises and not heading_rates.allows(
            command, time, own, vessels, fastest, slowest, others
        ):
            pace, pace_held = speeds.highest, True
            fastest, slowest = self._speeds_with(pace, own.speed)
        command = heading_rates.limit(command, time, own, vessels, fastest, slowest, others)
        status = heading_rates.status
        if status is not GuardStatus.FREE and not leaving:
            pace, pace_held = self._speed, True
            self._hold_until = time + self._quarter_turn
        # A rise that the guard was not consulted about must not raise the speeds that it predicts.
        noted = pace if rises else min(pace, speeds.highest)
        speeds.note(noted)
        return Guarded(command, pace, pace_held, status)

    def _speeds_with(self, pace: float, measured: float) -> tuple[float, float]:
        """Return the fastest and the slowest speed if a pace is commanded now [m/s].

        A measured speed beyond those that were commanded counts as well.
        """
        fastest, slowest = self._speeds.fastest(pace), self._speeds.slowest(pace)
        return max(fastest, measured), min(slowest, measured)

    def replace(self, heading_rate: float, pace: float | None = None) -> None:
        """Take note of what is flown in place of the last commands [rad/s, m/s]."""
        self._heading_rates.replace(heading_rate)
        if pace is not None:
            self._speeds.include(pace)


class Encounter:
    """A disc and the vehicle's motions relative to it when a command begins to act.

    Attributes
    ----------
    disc : that contains the vessel
    motions : of a vehicle that is fast at first and slow then; and, where these differ, of one that
        is slow, and of one that is fast, all along
    """

    def __init__(self, disc: Tube, motions: tuple[RelativeMotion, ...]) -> None:
        self.disc = disc
        self.motions = motions


class Ship:
    """A vessel as the guard looks at it.

    Attributes
    ----------
    name : of another vessel; empty for the one that is measured
    radius : to keep from it [m]
    discs : at least one; each of them contains the vessel
    """

    def __init__(self, name: str, radius: float, discs: Sequence[Tube]) -> None:
        self.name = name
        self.radius = radius
        self.discs = discs


class _Surroundings:
    """How far the vehicle is from a vessel.

    Attributes
    ----------
    ship, motion : the vessel, and the motion relative to its disc
    room : distance beyond its radius within which a turn away from it is completed, from any course
        [m]
    free_for : time for which the vehicle stays farther off than that under any command [s]
    """

    def __init__(
        self,
        ship: Ship,
        motion: RelativeMotion,
        room: float,
        free_for: float,
    ) -> None:
        self.ship = ship
        self.motion = motion
        self.room = room
        self.free_for = free_for


class Several:
    """Several vessels that are near.

    Attributes
    ----------
    names, discs : of each of them
    motions : relative to all of these discs, when a command begins to act: one or three for each
        disc
    """

    def __init__(
        self, names: Sequence[str], discs: Sequence[Tube], motions: Sequence[RelativeMotion]
    ) -> None:
        self.names = names
        self.discs = discs
        self.motions = motions


class _Look:
    """What a look has found where a command may not pass.

    Attributes
    ----------
    ship, encounters : the only vessel that is near, and its discs
    several : vessels that are near, for each choice of discs to keep off; empty where only one is
        near
    """

    def __init__(
        self, ship: Ship, encounters: Sequence[Encounter], several: Sequence[Several]
    ) -> None:
        self.ship = ship
        self.encounters = encounters
        self.several = several


class _BackupTurn(NamedTuple):
    """A turn away that may be flown: its slack [m], whether the disc falls behind in the end, its
    side, and the disc and motion of its prediction.
    """

    slack: float
    ends: bool
    side: float
    encounter: Encounter


class HeadingRateFilter:
    """Passes heading rates after which a turn away keeps off, and mixes in that turn otherwise.

    It must be called once per time step.

    Parameters
    ----------
    parameters : of the vehicle and of the guard

    Attributes
    ----------
    status : action at the last step
    slowest : airspeed that the vehicle may fall to in any turn [m/s]
    prediction : of turns
    history : of commands
    budget : of commands that need no look
    """

    def __init__(self, parameters: GuardParameters) -> None:
        p = parameters
        self._p = p
        self._rate = p.heading_rate_max
        self._time_step = p.time_step
        self._turn_speed = p.turn_speed
        self.history = CommandHistory(
            lag=p.lag,
            delay=p.delay,
            slow_lag=p.delay + p.lag if p.slow_lag is None else p.slow_lag,
            time_step=p.time_step,
            heading_rate_max=p.heading_rate_max,
        )
        self.prediction = TurnPrediction(
            heading_rate_max=p.heading_rate_max,
            lag=p.lag,
            delay=p.delay,
            time_step=p.time_step,
            deviation=p.errors.response.size,
            turn_speed=p.turn_speed,
        )
        self.budget = SkipBudget(p.heading_rate_max, p.time_step)
        errors = p.errors
        self._drift_rate = errors.drift.rate
        self.slowest = errors.slowest
        # Satellite navigation may be lost at any moment, and dead reckoning go wrong from then on.
        self._speed_error = errors.steady_velocity + self._drift_rate
        self._exact_wind = WindErrorByGusts(errors.turbulence)
        self._displacement = errors.displacement(wind=self._exact_wind)
        self._gusty = errors.turbulence.sigma > 0.0
        # Half a turn to the nearer side, half as much again for the disc's motion, and the time
        # that the lag takes from any heading rate.
        self._turn_time = 1.5 * math.pi / p.heading_rate_max + 2.0 * p.lag + p.delay + p.time_step
        # Slack that the declared errors may take from a turn that was safe.
        self._explained = (
            errors.response.size
            + errors.failed_part.size
            + errors.wander(self._turn_time)
            + errors.k * errors.turning.at(self._turn_time)
        )
        # In one step the command may differ from the turn by 2 omega_max, which displaces the
        # vehicle by V omega_max dt^2. In turn radii:
        self._resolution = max(_RESOLUTION, (p.heading_rate_max * p.time_step) ** 2)
        # The safe turn: its side, its vessel and the vessel's disc.
        self._side = 0.0
        self._kept_off: dict[str, Tube] = {}
        # Where several vessels are near.
        self.common_turns = CommonTurns(
            self.prediction,
            heading_rate_max=p.heading_rate_max,
            lag=p.lag,
            time_step=p.time_step,
            delay=p.delay,
            turn_time=self._turn_time,
        )
        self._common: CommonTurn | None = None
        # Until when other vessels are left out of looks, and the first of them [s].
        self._far_until: dict[str, float] = {}
        self._left_out_until = -math.inf
        self.status = GuardStatus.FREE

    def limit(
        self,
        command: float,
        time: float,
        own: AirMotion,
        vessels: Sequence[Tube],
        fastest: float,
        slowest: float = math.inf,
        others: Sequence[KnownVessel] = (),
    ) -> float:
        """Return the command, or as much of a turn away as is needed [rad/s].

        Parameters
        ----------
        command : demanded heading rate [rad/s]
        time : now [s]
        own : the vehicle's motion
        vessels : discs, at least one; each of them contains the vessel
        fastest, slowest : airspeeds that the vehicle may come to; a turn away has to keep off at
            all speeds between them. The slowest counts where it is below the fastest [m/s]
        others : other vessels
        """
        skips = self.budget.may_skip(command, fastest, slowest)
        if skips and others and time >= self._left_out_until:
            # Commands cannot spoil the turn that was found; only the other vessels are due for a
            # look.
            skips = self._leaves_others_out(time, own, vessels, fastest, slowest, others)
        if not skips:
            found = self._look(command, time, own, vessels, fastest, slowest, others)
            if found is None:
                self.status = GuardStatus.FREE
            elif found.several:
                command = self._mix_common(command, found.several)
            else:
                command = self._mix(command, found.ship, found.encounters)
        # At the largest bank a command comes in part where the vehicle flies faster.
        flown = command
        if own.speed > self._turn_speed:
            flown = limited(command, self._rate * self._turn_speed / own.speed)
        self.history.append(flown, own.heading_rate)
        return command

    def allows(
        self,
        command: float,
        time: float,
        own: AirMotion,
        vessels: Sequence[Tube],
        fastest: float,
        slowest: float = math.inf,
        others: Sequence[KnownVessel] = (),
    ) -> bool:
        """Return whether ``limit``, called next with the same parameters, lets the command pass."""
        if self._look(command, time, own, vessels, fastest, slowest, others) is not None:
            return False
        self.status = GuardStatus.FREE
        self.budget.refund(command)
        return True

    def replace(self, command: float) -> None:
        """Take note of a heading rate that is flown in place of the last command [rad/s]."""
        self.budget.charge(self.history.newest, command)
        self.history.newest = command

    def clearance(
        self,
        time: float,
        own: AirMotion,
        vessels: Sequence[Tube],
        speed: float,
        enough: float = math.inf,
        radius: float | None = None,
    ) -> float:
        """Return the clearance of the better turn away that begins now [m]; negative if neither
        turn keeps off.

        At one airspeed, and from a disc that the vehicle outruns, no other commands do better
        (docs/keepout_guard.md). The result is reduced by the distance that the path may come nearer
        within a step.

        Parameters
        ----------
        time : now [s]
        own : the vehicle's motion
        vessels : discs, at least one; each of them contains the vessel
        speed : airspeed of the vehicle [m/s]
        enough : clearance above which the search may end early [m]
        radius : to keep; by default that of the parameters [m]
        """
        within_step = (self._resolution - _RESOLUTION) / self._rate * speed
        pending = self.history.take_in(own.heading_rate)
        best = -math.inf
        for disc in vessels:
            relative = self.relative_motion(disc, time, own, speed, speed, pending, radius)
            motions = self.motions_when_acting(relative)
            first = motions[0]
            nearer = nearer_side(first.x, first.y, first.course)
            for side in (nearer, -nearer):
                slack = math.inf
                for motion in motions:
                    start = TurnStart(motion.x, motion.y, motion.course, motion.heading_rate)
                    turn = self.prediction.turn_away(
                        side,
                        start,
                        motion,
                        change=self.history.change,
                        time=self._p.delay,
                        floor=best,
                    )
                    # In this order NaN propagates.
                    slack = min(turn.slack, slack)
                best = max(best, slack)
                if best >= enough + within_step:
                    return best - within_step
        return best - within_step

    def _look(
        self,
        command: float,
        time: float,
        own: AirMotion,
        vessels: Sequence[Tube],
        fastest: float,
        slowest: float,
        others: Sequence[KnownVessel],
    ) -> _Look | None:
        """Return None if a turn keeps off after the command, else the vessels that are near."""
        measured = Ship("", self._p.radius, vessels)
        ships = self._to_keep_off(measured, others, time, own, fastest, slowest)
        if len(ships) == 1:
            self._common = None
            return self._look_at(ships[0], command, time, own, fastest, slowest)
        return self._look_at_several(ships, command, time, own, fastest, slowest)

    def _leaves_others_out(
        self,
        time: float,
        own: AirMotion,
        vessels: Sequence[Tube],
        fastest: float,
        slowest: float,
        others: Sequence[KnownVessel],
    ) -> bool:
        """Return whether all vessels but the measured one stay left out of looks."""
        measured = Ship("", self._p.radius, vessels)
        ships = self._to_keep_off(measured, others, time, own, fastest, slowest)
        return len(ships) == 1 and ships[0] is measured

    def _to_keep_off(
        self,
        measured: Ship,
        others: Sequence[KnownVessel],
        time: float,
        own: AirMotion,
        fastest: float,
        slowest: float,
    ) -> list[Ship]:
        """Return the vessels that turns away have to keep off; the others need no look until
        ``_left_out_until``.
        """
        if others:
            ships, far_for = self._near_ships(measured, others, time, own, fastest, slowest)
        else:
            # One that appears is due for a look at once.
            ships, far_for = [measured], -math.inf
        self._left_out_until = time + far_for
        return ships

    def _near_ships(
        self,
        measured: Ship,
        others: Sequence[KnownVessel],
        time: float,
        own: AirMotion,
        fastest: float,
        slowest: float,
    ) -> tuple[list[Ship], float]:
        """Return the vessels that turns away have to keep off, and the time for which the others
        need no look [s].

        A vessel is left out while the vehicle can still turn away from it after any command, and no
        other vessel's area comes so near to its area that both might have to be kept off at once
        (docs/keepout_guard.md, "Several vessels").
        """
        far_for = math.inf
        due: list[bool] = []
        for other in others:
            until = self._far_until.get(other.name, -math.inf)
            due.append(until <= time)
            if until > time and until - time < far_for:
                far_for = until - time
        if True not in due:
            return [measured], far_for
        around = [self._surroundings(measured, time, own, fastest, slowest)]
        for other in others:
            radius = other.radius + self._p.errors.failed_part.size
            ship = Ship(other.name, radius, other.tubes)
            around.append(self._surroundings(ship, time, own, fastest, slowest))
        of_due = [found for found, is_due in zip(around[1:], due, strict=True) if is_due]
        ships: list[Ship] = []
        for found in of_due:
            free = min(found.free_for, _LEFT_OUT_MOST)
            if free > 0.0 and any(self._meet(found, other) for other in around):
                # These vessels are in each other's way, though not yet within reach of a turn.
                free = min(self._out_of_reach(found), _LEFT_OUT_MOST)
            if free > 0.0:
                self._far_until[found.ship.name] = time + free
                far_for = min(far_for, free)
            else:
                ships.append(found.ship)
        if not ships:
            return [measured], far_for
        first = around[0]
        in_the_way = any(self._meet(first, found) for found in of_due if found.ship in ships)
        if first.free_for <= 0.0 or (in_the_way and self._out_of_reach(first) <= 0.0):
            ships.append(measured)
        else:
            far_for = min(far_for, max(first.free_for, 0.0))
        return ships, far_for

    def _surroundings(
        self, ship: Ship, time: float, own: AirMotion, fastest: float, slowest: float
    ) -> "_Surroundings":
        """Return how far the vehicle is from a vessel, by the disc that reaches least far."""
        disc = self._least_reaching(ship.discs, time, own)
        motion = self.relative_motion(disc, time, own, fastest, slowest, 0.0, ship.radius)
        slower = max(1.0, fastest / self._turn_speed)
        half_turn = (math.pi / self._rate) * slower + self._p.lag + self._p.delay + self._time_step
        # A turn away that begins straight at the vessel comes nearer by the turn radius and by the
        # way before the turn. The vessel comes nearer for as long as half a turn takes.
        disc_speed = math.hypot(motion.disc_north, motion.disc_east)
        closing = disc_speed + motion.growth + 0.5 * motion.acceleration * half_turn
        room = (
            fastest * (self._p.delay + self._p.lag + self._time_step + slower / self._rate)
            + closing * half_turn
            + self._p.errors.response.size
            + self._displacement.after(2.0 * self._turn_time)
        )
        gap = math.hypot(motion.x, motion.y) - motion.radius
        return _Surroundings(
            ship,
            motion,
            room,
            (gap - room) / (fastest + closing),
        )

    def _out_of_reach(self, found: "_Surroundings") -> float:
        """Return for how long a vessel stays out of reach of a common turn [s]."""
        return self.time_until_near(found.motion, _COMMON_REACH)

    def _meet(self, one: "_Surroundings", other: "_Surroundings") -> bool:
        """Return whether the areas of two vessels soon leave less between them than the vehicle
        needs to turn away from either.
        """
        if one is other:
            return False
        duration = _COMMON_REACH * self._turn_time
        a, b = one.motion, other.motion
        x, y = a.x - b.x, a.y - b.y
        # The vehicle's place relative to a vessel moves against it.
        north, east = b.disc_north - a.disc_north, b.disc_east - a.disc_east
        square = north * north + east * east
        nearest_at = 0.0
        if square > 0.0:
            nearest_at = min(max(0.0, -(x * north + y * east) / square), duration)
        apart = math.hypot(x + north * nearest_at, y + east * nearest_at)
        radii = a.radius + b.radius + (a.growth + b.growth) * nearest_at
        return apart - radii < one.room + other.room

    def _look_at(
        self,
        ship: Ship,
        command: float,
        time: float,
        own: AirMotion,
        fastest: float,
        slowest: float,
    ) -> _Look | None:
        """Return None if a turn away keeps off some disc of a vessel after the command, or the
        encounters.
        """
        history = self.history
        pending = history.take_in(own.heading_rate)
        change = history.change_with(command)
        encounters: list[Encounter] = []
        side, turn = 0.0, None
        for disc in self._candidates(ship, time, own):
            motion = self.relative_motion(disc, time, own, fastest, slowest, pending, ship.radius)
            far_for = self.time_until_near(motion)
            if far_for > 0.0:
                side, turn = 0.0, TurnAway(math.inf, far_for, math.inf, change, True)
            else:
                motions = self.motions_when_acting(motion)
                side, turn = self._safe_turn_after(command, motions, change)
                if turn is None:
                    encounters.append(Encounter(disc, motions))
                else:
                    self._side = side
            if turn is not None:
                self._kept_off[ship.name] = disc
                break
        self._begin_skipping(turn, side, command, fastest, slowest)
        return _Look(ship, encounters, ()) if turn is None else None

    def _begin_skipping(
        self,
        turn: TurnAway | None,
        side: float,
        command: float,
        fastest: float,
        slowest: float,
    ) -> None:
        """Let commands that cannot spoil a turn pass without a look; without a turn, let no command
        pass.
        """
        self.budget.reset(
            turn,
            side,
            command=command,
            recent=self.history.range_with(command),
            slowest=min(slowest, fastest) - _SAME_SPEED,
            fastest=fastest + _SAME_SPEED,
        )

    def _look_at_several(
        self,
        ships: Sequence[Ship],
        command: float,
        time: float,
        own: AirMotion,
        fastest: float,
        slowest: float,
    ) -> _Look | None:
        """Return None if a common turn keeps off all of several vessels after the command."""
        history = self.history
        pending = history.take_in(own.heading_rate)
        change = history.change_with(command)
        floor = self._resolution * fastest / self._rate
        nearest = [self._least_reaching(ship.discs, time, own) for ship in ships]
        kept = [
            self._kept_off.get(ship.name, disc) for ship, disc in zip(ships, nearest, strict=True)
        ]
        several: list[Several] = []
        for discs in (nearest, kept):
            motions: list[RelativeMotion] = []
            for ship, disc in zip(ships, discs, strict=True):
                motion = self.relative_motion(
                    disc, time, own, fastest, slowest, pending, ship.radius
                )
                motions += self.motions_when_acting(motion)
            found = Several([ship.name for ship in ships], discs, motions)
            turn = self._common_turn_after(command, found, change, floor)
            if turn is not None:
                self._keep_to(turn, found)
                skipped = TurnAway(turn.slack, turn.free_time, turn.free_course, turn.change)
                # At the end of the turn, commands to its side spoil it, too.
                over = turn.to_turn <= self._rate * (self._p.lag + self._time_step)
                self._begin_skipping(skipped, 0.0 if over else turn.side, command, fastest, slowest)
                return None
            several.append(found)
            if kept == nearest:
                break
        self.budget.steps = 0
        return _Look(ships[0], (), several)

    def _common_turn_after(
        self, command: float, several: Several, change: float, floor: float
    ) -> CommonTurn | None:
        """Return a common turn that keeps off all vessels after a command, or None."""
        best: CommonTurn | None = None
        last = self._common
        away = self.common_turns.away(several.motions)
        to_away = math.remainder(away - several.motions[0].course, 2.0 * math.pi)
        candidates = [(math.copysign(1.0, to_away), away)]
        if last is not None:
            candidates.insert(0, (last.side, last.course))
        for side, course in candidates:
            against = 0.5 - 0.5 * self.budget.least_of_turn(side, command) / self._rate
            turn = self.common_turns.to_course(
                side,
                course,
                command,
                several.motions,
                change=change,
                against=against,
                floor=floor,
            )
            if turn.keeps_off(floor):
                if turn.free_time >= _FREE_ENOUGH:
                    return turn
                if best is None or turn.free_time > best.free_time:
                    best = turn
        if best is None or best.free_time < _FREE_LEAST:
            turn = self.common_turns.best(command, several.motions, change=change, floor=floor)
            if turn.keeps_off(floor) and (best is None or turn.free_time > best.free_time):
                best = turn
        return best

    def _keep_to(self, turn: CommonTurn, several: Several) -> None:
        """Take note of a common turn that is safe, and from which discs."""
        self._common = turn
        self._side = turn.side
        for name, disc in zip(several.names, several.discs, strict=True):
            self._kept_off[name] = disc

    def _mix_common(self, command: float, several: Sequence[Several]) -> float:
        """Return the command with the least of a common turn that keeps off, or that turn
        [rad/s].
        """
        turn, found, turned = self._backup_common_turn(several)
        first = found.motions[0]
        floor = self._resolution * first.fastest / self._rate
        lost = turn.slack < -self._explained_slack(first) - floor
        self.status = GuardStatus.LOST if lost else GuardStatus.INTERVENING
        self._common = turn
        self._side = turn.side
        if turn.slack < 0.0 or not turn.ends:
            return turned
        self._keep_to(turn, found)
        low, high, mixed = 0.0, 1.0, turned
        for _ in range(_BISECTIONS):
            fraction = 0.5 * (low + high)
            trial = command + fraction * (turned - command)
            tried = self._to_course_after(trial, turn, found, floor)
            if tried.slack >= floor:
                high, mixed = fraction, trial
            else:
                low = fraction
        return mixed

    def _to_course_after(
        self, command: float, turn: CommonTurn, several: Several, floor: float
    ) -> CommonTurn:
        """Return a common turn, after a command."""
        return self.common_turns.to_course(
            turn.side,
            turn.course,
            command,
            several.motions,
            change=self.history.change_with(command),
            against=1.0,
            floor=floor,
        )

    def _backup_common_turn(self, several: Sequence[Several]) -> tuple[CommonTurn, Several, float]:
        """Return the common turn to fly, the vessels that it keeps off, and its command [rad/s].

        The safe turn is continued as long as the declared errors explain the slack that it lacks.
        Beyond that, the turn with the most slack is flown.
        """
        last = self._common
        continued: tuple[CommonTurn, Several, float] | None = None
        if last is not None:
            for found in several:
                command = self.common_turns.command(last, found.motions[0])
                turn = self._to_course_after(command, last, found, -math.inf)
                if turn.slack >= 0.0 and turn.ends:
                    return turn, found, command
                if continued is None or turn.slack > continued[0].slack:
                    continued = turn, found, command
        best: tuple[CommonTurn, Several, float] | None = None
        for found in several:
            for command in (self._rate, -self._rate, 0.0):
                change = self.history.change_with(command)
                turn = self.common_turns.best(command, found.motions, change=change, floor=0.0)
                if (
                    best is None
                    or (turn.keeps_off(0.0) and not best[0].keeps_off(0.0))
                    or (
                        turn.keeps_off(0.0) == best[0].keeps_off(0.0) and turn.slack > best[0].slack
                    )
                ):
                    best = turn, found, command
        if best is None:
            raise ValueError("there is no vessel to keep off")
        if continued is not None and not best[0].keeps_off(0.0):
            explained = self._explained_slack(continued[1].motions[0])
            if continued[0].slack >= -explained:
                return continued
        return best

    def _candidates(self, ship: Ship, time: float, own: AirMotion) -> Sequence[Tube]:
        """Return the disc that reaches least far towards the vehicle, and the one kept off last."""
        least_reaching = self._least_reaching(ship.discs, time, own)
        last = self._kept_off.get(ship.name)
        return (
            (least_reaching,) if last is None or last is least_reaching else (least_reaching, last)
        )

    def _least_reaching(self, discs: Sequence[Tube], time: float, own: AirMotion) -> Tube:
        """Return the disc that reaches least far towards the vehicle."""
        if len(discs) == 1:
            return discs[0]
        gaps = [self._gap(disc, time, own) for disc in discs]
        return discs[gaps.index(max(gaps))]

    def _gap(self, disc: Tube, time: float, own: AirMotion) -> float:
        """Return the distance from a disc after a quarter of a turn, if the vehicle stayed where it
        is [m].
        """
        since = time - disc.time + 0.5 * math.pi / self._rate
        north = own.ground_north - disc.north - disc.velocity_north * since
        east = own.ground_east - disc.east - disc.velocity_east * since
        reach = (disc.growth + 0.5 * disc.acceleration * since) * since
        return math.hypot(north, east) - disc.radius - reach

    def relative_motion(
        self,
        disc: Tube,
        time: float,
        own: AirMotion,
        fastest: float,
        slowest: float,
        pending_rate: float,
        radius: float | None = None,
    ) -> RelativeMotion:
        """Return the motion relative to a disc, whose radius and growth contain all errors.

        By default the radius to keep is that of the parameters [m].
        """
        since = time - disc.time
        wind_error = own.wind_error
        drifted = (self._drift_rate + wind_error) * own.lost
        self._displacement.renew(own.lost, own.wind_by_gusts or self._exact_wind)
        slowest = min(slowest, self.slowest)
        return RelativeMotion(
            x=own.ground_north - (disc.north + disc.velocity_north * since),
            y=own.ground_east - (disc.east + disc.velocity_east * since),
            disc_north=disc.velocity_north - own.wind_north,
            disc_east=disc.velocity_east - own.wind_east,
            course=own.course,
            heading_rate=own.heading_rate,
            fastest=fastest,
            slowest=slowest if slowest < fastest - _SAME_SPEED else fastest,
            radius=(self._p.radius if radius is None else radius)
            + drifted
            + disc.radius
            + (disc.growth + 0.5 * disc.acceleration * since) * since,
            growth=self._speed_error + wind_error + disc.growth + disc.acceleration * since,
            acceleration=disc.acceleration,
            pending_rate=pending_rate,
            wind_error=wind_error,
            displacement=self._displacement if self._gusty else None,
        )

    def time_until_near(self, motion: RelativeMotion, turns: float = 1.0) -> float:
        """Return for how long the disc stays out of reach of a turn away [s]; below 0 if it is not.

        A disc is out of reach if disc and vehicle cannot close the distance during a turn, or
        several ``turns``.
        """
        duration = turns * self._turn_time * max(1.0, motion.fastest / self._turn_speed)
        acceleration = motion.acceleration
        disc_speed = math.hypot(motion.disc_north, motion.disc_east)
        closing = motion.fastest + disc_speed + motion.growth
        gap = (
            math.hypot(motion.x, motion.y)
            - motion.radius
            # The next look may come as late as a turn from now.
            - self._displacement.after(2.0 * duration)
            - (closing + 0.5 * acceleration * duration) * duration
        )
        return min(gap / (closing + 1.5 * acceleration * duration), duration)

    def motions_when_acting(self, motion: RelativeMotion) -> tuple[RelativeMotion, ...]:
        """Return the motions of an encounter, when a command given now begins to act."""
        acting, under_way = self.prediction.when_acting, self.history.under_way
        if motion.slowest == motion.fastest:
            return (acting(motion, under_way),)
        # Round a disc, or past a small one, a turn may come nearer at one speed all along.
        return (
            acting(motion, under_way),
            acting(motion.at_one_speed(motion.slowest), under_way),
            acting(motion.at_one_speed(motion.fastest), under_way),
        )

    def _safe_turn_after(
        self, command: float, motions: tuple[RelativeMotion, ...], change: float
    ) -> tuple[float, TurnAway | None]:
        """Return side and prediction of a turn away that keeps off after this command, or None."""
        first = motions[0]
        floor = self._resolution * first.fastest / self._rate
        start = self.prediction.after(command, first)
        nearer = nearer_side(start.x, start.y, start.course)
        for side in (nearer, -nearer):
            turn = self.turn_after(side, command, motions, change, floor)
            if turn.slack >= floor and turn.ends:
                return side, turn
        return 0.0, None

    def turn_after(
        self,
        side: float,
        command: float,
        motions: tuple[RelativeMotion, ...],
        change: float,
        floor: float,
    ) -> TurnAway:
        """Return the turn away to a side after a command: each of its values is the least over the
        motions.

        Below ``floor`` [m] of slack the search may end early.
        """
        prediction = self.prediction
        against = 0.5 - 0.5 * self.budget.least_of_turn(side, command) / self._rate
        slack = free_time = free_course = math.inf
        counted, ends = 1.0, True
        for motion in motions:
            turn = prediction.turn_away(
                side,
                prediction.after(command, motion),
                motion,
                change=change,
                time=self._p.delay + self._time_step,
                floor=floor,
                against=against,
            )
            # In this order NaN propagates.
            slack = min(turn.slack, slack)
            free_time = min(turn.free_time, free_time)
            free_course = min(turn.free_course, free_course)
            counted = min(counted, turn.change)
            ends = ends and turn.ends
            if slack < floor:
                break
        return TurnAway(slack, free_time, free_course, counted, ends)

    def _mix(self, command: float, ship: Ship, encounters: Sequence[Encounter]) -> float:
        """Return the command with the least of a turn away that keeps off, or that turn [rad/s]."""
        backup = self._backup_turn(encounters)
        self._side = backup.side
        motions = backup.encounter.motions
        first = motions[0]
        turn = self._turn_command(backup.side, first)
        floor = self._resolution * first.fastest / self._rate
        lost = backup.slack < -self._explained_slack(first) - floor
        self.status = GuardStatus.LOST if lost else GuardStatus.INTERVENING
        if backup.slack < 0.0 or not backup.ends:
            return turn
        self._kept_off[ship.name] = backup.encounter.disc
        low, high, mixed = 0.0, 1.0, turn
        for _ in range(_BISECTIONS):
            fraction = 0.5 * (low + high)
            trial = command + fraction * (turn - command)
            change = self.history.change_with(trial)
            if self.turn_after(backup.side, trial, motions, change, floor).slack >= floor:
                high, mixed = fraction, trial
            else:
                low = fraction
        return mixed

    def _backup_turn(self, encounters: Sequence[Encounter]) -> _BackupTurn:
        """Return the turn away to fly: one that keeps off, if such a turn exists.

        Otherwise the turn to the safe side is continued, as long as the declared errors explain the
        slack that it lacks. Beyond that, the turn with the most slack is flown.
        """
        safe_side = self._side
        turns: list[_BackupTurn] = []
        for encounter in encounters:
            first = encounter.motions[0]
            for side in (safe_side, -safe_side) if safe_side else (1.0, -1.0):
                command = self._turn_command(side, first)
                change = self.history.change_with(command)
                found = self.turn_after(side, command, encounter.motions, change, -math.inf)
                turn = _BackupTurn(found.slack, found.ends, side, encounter)
                if safe_side and turn.slack >= 0.0:
                    return turn
                turns.append(turn)
        to_safe_side = [turn for turn in turns if turn.side == safe_side]
        if to_safe_side:
            continued = max(to_safe_side, key=lambda turn: turn.slack)
            if continued.slack >= -self._explained_slack(continued.encounter.motions[0]):
                return continued
        return max(turns, key=lambda turn: (turn.slack, turn.side))

    def _explained_slack(self, motion: RelativeMotion) -> float:
        """Return the slack that declared errors may have taken from a safe turn since [m]."""
        turn_time = self._turn_time * max(1.0, motion.fastest / self._turn_speed)
        # All predictions contain the disc's growth already.
        error = self._speed_error + motion.wind_error
        # The distance kept for a change of speed along the turn depends on where the vehicle slows
        # down.
        switching = SPEED_SWITCH_ERROR * (motion.fastest - motion.slowest) / self._rate
        return self._explained + error * turn_time + switching

    def _turn_command(self, side: float, motion: RelativeMotion) -> float:
        """Return the command of a turn away [rad/s]: straight away from the disc and no farther."""
        to_turn = math.remainder(
            math.atan2(motion.y, motion.x) - motion.course - self._p.lag * motion.heading_rate,
            2.0 * math.pi,
        )
        if side * to_turn >= self._rate * self._time_step or abs(to_turn) >= 0.5 * math.pi:
            return side * self._rate
        # From less than a right angle beyond straight away it turns back: going on would lead once
        # round, towards the disc.
        return limited(to_turn / self._time_step, self._rate)


class CommandHistory:
    """Heading-rate commands, one per time step, and the course that they still bring.

    In the middle of a roll an aircraft will turn farther than its heading rate and a first-order
    lag predict. Its autopilot integrates, so in the end it turns through all the commanded course.
    The **lack** is the commanded course, less what was turned, less what the lag and the commands
    under way will still turn. It is 0 for a vehicle with just that dead time and lag
    (docs/keepout_guard.md, "Course that earlier commands still bring").

    Parameters
    ----------
    lag, delay : of the heading rate behind its command [s]
    slow_lag : delay behind slow commands [s]
    time_step : for which a command is held [s]
    heading_rate_max : omega_max [rad/s]

    Attributes
    ----------
    under_way : commands that act within the delay; the first one may act for a part of its step
        [rad/s]
    change : largest recent change of command, over a full reversal; it counts less the older it is
        [-]
    recent : commands within dead time and lag of the last one; any two of them make a change
        [rad/s]
    """

    def __init__(
        self,
        *,
        lag: float,
        delay: float,
        slow_lag: float,
        time_step: float,
        heading_rate_max: float,
    ) -> None:
        self._lag = lag
        self._slow_lag = slow_lag
        # Commands count from the time at which they act.
        self._slow_lag_after_delay = slow_lag - delay
        self._time_step = time_step
        self._reversal = 2.0 * heading_rate_max
        # The course of a full reversal that has not begun yet.
        self._lack_max = self._reversal * (delay + lag)
        count, self._first = commands_under_way(delay, time_step)
        # Course turned in a step in which a lag follows one command, from the heading rates r_0 and
        # r_1 at its ends: dt r_0 + (dt/(1 - exp(-dt/lag)) - lag) (r_1 - r_0). Where another command
        # begins to act within the step, a share of the change of command is added. So the lack is
        # exactly 0 for a vehicle with just that dead time and lag.
        self._kept = self._fading = self._course_at_end = self._course_of_change = 0.0
        if lag > 0.0:
            self._kept = math.exp(-time_step / (PENDING_DECAY * lag))
            self._fading = math.exp(-time_step / (CHANGE_DECAY * lag))
            turned = time_step / -math.expm1(-time_step / lag)
            self._course_at_end = turned - lag
            self._course_of_change = (
                time_step - self._first + turned * math.expm1((self._first - time_step) / lag)
            )
        self._lack = 0.0
        self._begun = False
        # Commands since the last look, and the heading rate at each [rad/s].
        self._commands: list[float] = []
        self._rates: list[float] = []
        self.under_way: deque[float] = deque(maxlen=count)
        self.change = LEAST_CHANGE
        # A reversal in steps counts as one at once, however often the guard looks.
        window = max(1, round((delay + lag) / time_step))
        self.recent: deque[float] = deque([0.0], maxlen=window)
        self._lowest = self._highest = 0.0

    @property
    def newest(self) -> float:
        """The command of the last step [rad/s]; it is set if another one is flown in its place."""
        return self._commands[-1]

    @newest.setter
    def newest(self, command: float) -> None:
        self._commands[-1] = command

    def append(self, command: float, rate: float) -> None:
        """Take note of the command of a step and of the heading rate at its beginning [rad/s]."""
        self._commands.append(command)
        self._rates.append(rate)

    def take_in(self, rate: float) -> float:
        """Take in the commands since the last look; return ``pending_turn_rate`` [rad/s].

        Parameters
        ----------
        rate : heading rate of the aircraft now [rad/s], not the rate of the course over the mean
            air: no autopilot corrects the change of that course by a gust or by a better estimate
            of the wind
        """
        if self._commands:
            self._begun = True
            self._take_in(rate)
        elif not self._begun:
            # A flight begins: the turn that is flown is under way.
            self.recent[0] = self._lowest = self._highest = rate
            self.under_way.extend([rate] * (self.under_way.maxlen or 0))
        if self._lag == 0.0:
            return 0.0
        return pending_turn_rate(self._lack, rate, self._slow_lag, self._lag)

    def change_with(self, command: float) -> float:
        """Return ``change`` if a command [rad/s] is given now."""
        lowest, highest = self.range_with(command)
        now = (highest - lowest) / self._reversal
        return now if now > self.change else self.change

    def range_with(self, command: float) -> tuple[float, float]:
        """Return the lowest and the highest recent command if one [rad/s] is given now [rad/s]."""
        lowest, highest = self._lowest, self._highest
        return (
            command if command < lowest else lowest,
            command if command > highest else highest,
        )

    def _take_in(self, rate: float) -> None:
        """Take in the commands and heading rates since the last look [rad/s]."""
        commands, rates, under_way = self._commands, self._rates, self.under_way
        acting = under_way[0] if under_way else 0.0
        acted = self._time_step * sum(commands) + self._course_under_way()
        under_way.extend(commands)
        acted -= self._course_under_way()
        rate_change = rate - rates[0]
        turned = self._time_step * sum(rates) + self._course_at_end * rate_change
        if under_way:
            turned += self._course_of_change * (under_way[0] - acting)
        remembered = self._lack * self._kept ** len(commands)
        lack = remembered + acted - turned - self._slow_lag_after_delay * rate_change
        self._lack = limited(lack, self._lack_max)
        self._take_in_changes(commands)
        commands.clear()
        rates.clear()

    def _take_in_changes(self, commands: list[float]) -> None:
        """Take in how much commands [rad/s] changed."""
        recent, change, fading = self.recent, self.change, self._fading
        lowest, highest = min(commands), max(commands)
        widest = max(highest, self._highest) - min(lowest, self._lowest)
        if widest / self._reversal <= LEAST_CHANGE:
            # No change exceeds the least that counts, as on an orbit.
            recent.extend(commands)
            for _ in commands:
                change *= fading
        else:
            for command in commands:
                recent.append(command)
                change = max(change * fading, (max(recent) - min(recent)) / self._reversal)
        self.change = max(change, LEAST_CHANGE)
        self._lowest, self._highest = min(recent), max(recent)

    def _course_under_way(self) -> float:
        """Return the course that the commands under way turn [rad]."""
        if not self.under_way:
            return 0.0
        all_of_them = self._time_step * sum(self.under_way)
        return all_of_them + (self._first - self._time_step) * self.under_way[0]


class SkipBudget:
    """Counts the commands that need no look, since they cannot spoil the last turn away that was
    found.

    A look says how much course that turn can lose, for how many steps, and at which commands and
    airspeeds. Each command that passes without a look withdraws a step, and the course by which it
    falls short of a step of the turn at omega_max. When less than two steps' course is left, or a
    command or an airspeed lies outside of its range, the guard looks again (docs/keepout_guard.md,
    "Evaluating less often").

    Parameters
    ----------
    heading_rate_max : omega_max [rad/s]
    time_step : for which a command is held [s]

    Attributes
    ----------
    steps : largest number of commands that may be skipped
    course_left : that the turn can still lose [rad]
    """

    def __init__(self, heading_rate_max: float, time_step: float) -> None:
        self._rate = heading_rate_max
        self._time_step = time_step
        self._step_course = heading_rate_max * time_step
        # A command may be cut after it has passed: this much course is kept for that.
        self._reserve = 2.0 * self._step_course
        self.steps = 0
        self.course_left = 0.0
        # Course that a command saves, per rad/s.
        self._course_per_rate = 0.0
        self._lowest = self._highest = 0.0
        self._slowest = self._fastest = 0.0

    def may_skip(self, command: float, fastest: float, slowest: float) -> bool:
        """Return whether a command [rad/s] at such airspeeds [m/s] needs no look; it is counted."""
        left = self.course_left + self._course_per_rate * command
        if (
            self.steps > 0
            and self._lowest <= command <= self._highest
            and fastest <= self._fastest
            and slowest >= self._slowest
            and left >= self._reserve
        ):
            self.steps -= 1
            self.course_left = left - self._step_course
            return True
        return False

    def reset(
        self,
        turn: TurnAway | None,
        side: float,
        *,
        command: float,
        recent: tuple[float, float],
        slowest: float,
        fastest: float,
    ) -> None:
        """Begin anew with what a look has found.

        Parameters
        ----------
        turn : turn away that keeps off; None without one: then no command may be skipped
        side : of the turn; 0 where the disc is out of reach
        command : command of the look [rad/s]
        recent : lowest and highest of it and the recent ones [rad/s]
        slowest, fastest : airspeeds at which the turn was predicted [m/s]
        """
        if turn is None:
            self.steps = 0
            return
        self.steps = max(0, int(turn.free_time / self._time_step) - 1)
        self.course_left = turn.free_course
        self._course_per_rate = side * self._time_step
        # Commands may change by no more than the turn's deviation allows for, and must not lie too
        # far from the turn.
        middle, half = 0.5 * (recent[0] + recent[1]), turn.change * self._rate
        least = self.least_of_turn(side, command) if side else -self._rate
        self._lowest = max(middle - half, least if side > 0.0 else -self._rate)
        self._highest = min(middle + half, -least if side < 0.0 else self._rate)
        self._slowest, self._fastest = slowest, fastest

    def least_of_turn(self, side: float, command: float) -> float:
        """Return the least later command, counted towards the side of the turn, after a command
        [rad/s].
        """
        return max(min(side * command, self._rate) - _SHORTFALL_MAX * self._rate, -self._rate)

    def refund(self, command: float) -> None:
        """Let the command [rad/s] of the last look pass once more."""
        self.steps += 1
        self.course_left += self._step_course - self._course_per_rate * command

    def charge(self, command: float, flown: float) -> None:
        """Count the command that is flown in place of one that has passed [rad/s]."""
        self.course_left -= max(0.0, self._course_per_rate * (command - flown))
        if not self._lowest <= flown <= self._highest:
            self.steps = 0


class SpeedRange:
    """The speeds between which a vehicle stays, from the commanded paces.

    Airspeed follows its commands with a lag and overshoots their changes. A pace is a speed over
    the mean air; former paces fade.

    Parameters
    ----------
    speed : V_r, to which a turn away returns [m/s]
    bandwidth : of the airspeed behind its command [rad/s]
    overshoot : of the airspeed over a rise of its command, and below a fall [-]
    time_step : between commands [s]

    Attributes
    ----------
    speed : V_r [m/s]
    highest, lowest : recent paces, the highest at least V_r [m/s]
    """

    def __init__(
        self, *, speed: float, bandwidth: float, overshoot: float, time_step: float
    ) -> None:
        self.speed = speed
        self._overshoot = overshoot
        self._kept = math.exp(-time_step * bandwidth / _PACE_DECAY)
        self.highest = speed
        self.lowest = speed
        # Speeds that may still follow from recent paces.
        self._crest = speed
        self._trough = speed

    def fastest(self, pace: float) -> float:
        """Return the highest speed that follows from a pace now and V_r after it [m/s]."""
        rise = pace if pace > self.speed else self.speed
        reached = rise + self._overshoot * (rise - (pace if pace < self.lowest else self.lowest))
        return reached if reached > self._crest else self._crest

    def slowest(self, pace: float) -> float:
        """Return the lowest speed that follows from a pace now and V_r after it [m/s]."""
        fall = pace if pace < self.speed else self.speed
        reached = fall - self._overshoot * ((pace if pace > self.highest else self.highest) - fall)
        return reached if reached < self._trough else self._trough

    def include(self, pace: float) -> None:
        """Take note of a pace that is flown in place of the last one [m/s]."""
        self._crest, self._trough = self.fastest(pace), self.slowest(pace)
        self.highest, self.lowest = max(self.highest, pace), min(self.lowest, pace)

    def note(self, pace: float) -> None:
        """Take note of the pace that is commanded for this step [m/s]."""
        kept, highest, lowest = self._kept, self.highest, self.lowest
        fastest, slowest = self.fastest(pace), self.slowest(pace)
        highest = pace if pace > highest else pace + kept * (highest - pace)
        self.highest = highest if highest > self.speed else self.speed
        self.lowest = pace if pace < lowest else pace + kept * (lowest - pace)
        # The crest and the trough fade towards the pace.
        self._crest = pace + kept * (fastest - pace)
        self._trough = pace + kept * (slowest - pace)
