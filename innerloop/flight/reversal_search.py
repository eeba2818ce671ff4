"""How far an aircraft strays from its turn-reversal response: a search over reversals from whatever
it was doing before.

The guidance's keep-out guard predicts turns by a dead time, a lag and the course that is still to
come of earlier commands (docs/keepout_guard.md). Rolling, airspeed lost in the turn and integrators
of the autopilot make the aircraft's path another one. What counts is by how much it comes nearer to
what it turns away from: the deviation against the direction in which the turn leads, as long as the
guard may rely on it, in proportion to the change of heading rate, or of command of late if that is
larger. The aircraft is flown as modelled and perturbed.

A turn away from what is at rest comes closest to it within a quarter of a turn; from what closes in
as fast as the sine of an angle over the aircraft's own speed, later by that angle. So the
directions lean, and the turn is flown on by the largest.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.signal import lfilter

from aircraft.dynamics.equilibrium import Trim
from aircraft.simulation.fdm import TIME_STEP
from common.physics.coordinated_turn import heading_rate_for_bank
from common.physics.turn_tube import CHANGED, FORGOTTEN, LEAST_CHANGE, SLOW_LAG_ERROR
from common.physics.units import METRES_PER_FOOT
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.turn_reversal import TurnReversalResponse
from innerloop.jsbsim.system import HEADING_RATE

_SEARCHED = (20, 150)
"""Fewest and most reversals of the search that is part of every design [-]; the command's
``--reversals`` flies more.
"""

_SEARCHED_FOR = 1000.0
"""Flight time of that search, within those limits [s]."""

_NOT_CLIMBING = 0.5
"""Share of the reversals whose commands owe nothing to the worst so far [-]."""

_WORST = 2
"""Of the worst so far, any of which a reversal's commands may be near [-]."""

_CHANGE = 0.15
"""Standard deviation by which these are changed: of a command over omega_max, and of the logarithm
of its duration [-].
"""

_HELD = (0.1, 3.0)
"""Shortest and longest time for which a command is held before the turn, over 1/omega_max [-]."""

_BEFORE = 3
"""Commands before the turn [-]."""

_SETTLED = 3.0
"""Time for which the turn is held out of which those to the other side begin, over 1/omega_max [-].
"""

_ROLLING, _BACK = (1.0, 1.5, 2.0), (0.2, 2.0, 3.0, 4.0)
"""For how long the aircraft turns to the other side, and has turned back since, over dead time and
lag [-]: in the middle of a roll it turns on; and heading rates oscillate for as long after it."""

_LEANING = np.radians([0.0, 30.0, 60.0])
"""How far the direction away leans forward of abeam [rad]: more, the faster that moves from which
the aircraft turns away.
"""

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReversalSearch:
    """What a search over reversals found.

    Attributes
    ----------
    reversals : flown [-]
    deviation : largest, over the change of heading rate as a fraction of a full reversal [m]
    deviations : largest of each aircraft [m]; minus infinity of one that flew none
    unguided : of the reversals, those that did not follow the worst so far [-]
    usual : least deviation that at most one in a hundred of these exceeds [m]
    command_before : heading-rate command just before the worst, over omega_max to the side of the
        turn [-]
    airspeed_before : airspeed at its beginning [m/s]
    altitude_error : largest difference of the altitude from the one that is held, in all of the
        flight [m]
    """

    reversals: int
    deviation: float
    deviations: tuple[float, ...]
    unguided: int
    usual: float
    command_before: float
    airspeed_before: float
    altitude_error: float


def reversals_of_a_design(bank: float, airspeed: float) -> int:
    """Return how many reversals are flown for the record of a design, by its bank [rad] and
    airspeed [m/s].
    """
    quarter = 0.5 * math.pi / heading_rate_for_bank(bank, airspeed)
    return min(max(round(0.5 * _SEARCHED_FOR / quarter), _SEARCHED[0]), _SEARCHED[1])


def search_reversals(
    aircraft: Sequence[AutopilotedAircraft],
    start: Trim,
    bank: float,
    response: TurnReversalResponse,
    slow_lag: float,
    *,
    reversals: int,
    seed: int = 0,
    settled: bool = False,
) -> ReversalSearch:
    """Return the largest deviation of ``aircraft`` from their response in so many reversals, one
    after the other.

    The aircraft take turns. The first reversals begin after a roll to the other side, the next
    after a few full turns to random sides for random durations; before every second one of these, a
    command is less than full. Those of the second half climb: aircraft and commands are those of
    one of the worst so far, the commands changed at random.

    Parameters
    ----------
    aircraft : with their autopilot, as modelled and perturbed; their flight is ended
    start : straight and level equilibrium
    bank : whose coordinated turn is omega_max [rad]
    response : of the heading rate to a reversal
    slow_lag : by which it is behind slow commands [s]
    reversals, seed : how many are flown, and of their random numbers
    settled : whether each aircraft reverses a settled full turn as well, from either side
    """
    rate = heading_rate_for_bank(bank, start.airspeed)
    generator = np.random.default_rng(seed)
    duration = (0.5 * math.pi + float(_LEANING[-1])) / rate + response.delay + response.lag

    def reverse(which: int, before: _Before) -> None:
        flight = flights[which]
        for share, held in before.commands:
            flight.fly(share * rate, held / rate)
        turn, speed = before.side * rate, flight.speed
        predicted, change = flight.predicted(turn, duration, max(speed, start.airspeed), rate)
        deviation = _deviation(flight.fly(turn, duration), predicted, before.side) / change
        found.append(_Found(deviation, which, before, speed))

    flights = [_Flight(each, start, response, slow_lag) for each in aircraft]
    found: list[_Found] = []
    rolls = _rolls((response.delay + response.lag) * rate)
    first = math.ceil(_NOT_CLIMBING * reversals)
    for number in range(reversals):
        which = number % len(flights)
        if number >= first:
            worst = sorted(found, key=lambda entry: -entry.deviation)[:_WORST]
            near = worst[int(generator.integers(len(worst)))]
            which, before = near.which, _changed(near.before, generator)
        elif number < len(rolls) * len(flights):
            before = _changed(rolls[number % len(rolls)], generator)
        else:
            before = _random(generator, full=number % 2 == 0)
        reverse(which, before)
    for which in range(len(flights) if settled else 0):
        for before in _SETTLED_TURNS:
            reverse(which, before)
    worst_of_all = max(found, key=lambda entry: entry.deviation)
    unguided = [entry.deviation for entry in found[:first] + found[reversals:]]
    return ReversalSearch(
        reversals=len(found),
        deviation=max(0.0, worst_of_all.deviation),
        deviations=tuple(
            max((entry.deviation for entry in found if entry.which == which), default=-math.inf)
            for which in range(len(flights))
        ),
        unguided=len(unguided),
        usual=max(0.0, float(np.quantile(unguided, 0.99, method="higher"))),
        command_before=worst_of_all.before.side * worst_of_all.before.commands[-1][0],
        airspeed_before=worst_of_all.airspeed,
        altitude_error=max(flight.altitude_error for flight in flights),
    )


@dataclass(frozen=True, slots=True)
class _Before:
    """What is flown before a reversal: commands over omega_max, for how long over 1/omega_max each;
    and the side turned to.
    """

    commands: tuple[tuple[float, float], ...]
    side: float


_SETTLED_TURNS = tuple(_Before(((-side, _SETTLED),), side) for side in (1.0, -1.0))
"""Full turns to one side, out of which the aircraft turns to the other."""


@dataclass(frozen=True, slots=True)
class _Found:
    """A reversal: deviation over its change of heading rate [m], which aircraft flew it, what
    before, at what airspeed [m/s].
    """

    deviation: float
    which: int
    before: _Before
    airspeed: float


def _rolls(late: float) -> list[_Before]:
    """Return turns to the other side and back; ``late`` is dead time and lag over 1/omega_max [-]."""
    return [
        _Before(((1.0, _SETTLED), (-1.0, rolling * late), (1.0, back * late)), 1.0)
        for rolling in _ROLLING
        for back in _BACK
    ]


def _random(generator: np.random.Generator, *, full: bool) -> _Before:
    """Return random commands and a random side: full turns, of which one is a part of one unless
    all are ``full``.
    """
    shares = generator.choice([-1.0, 1.0], _BEFORE)
    if not full:
        shares[generator.integers(_BEFORE)] = generator.uniform(-1.0, 1.0)
    held = np.exp(generator.uniform(math.log(_HELD[0]), math.log(_HELD[1]), _BEFORE))
    return _Before(
        tuple(zip(shares.tolist(), held.tolist(), strict=True)),
        float(generator.choice([-1.0, 1.0])),
    )


def _changed(before: _Before, generator: np.random.Generator) -> _Before:
    """Return commands near others."""
    commands = []
    for share, held in before.commands:
        turn, longer = _CHANGE * generator.standard_normal(2)
        commands.append(
            (
                float(np.clip(share + turn, -1.0, 1.0)),
                float(np.clip(held * math.exp(longer), *_HELD)),
            )
        )
    return _Before(tuple(commands), before.side)


class _Flight:
    """An aircraft under way, the heading-rate commands that it was given at each time step, and
    what is to come of them.

    With it, the largest difference of its altitude from that of its release [m].
    """

    def __init__(
        self,
        aircraft: AutopilotedAircraft,
        start: Trim,
        response: TurnReversalResponse,
        slow_lag: float,
    ) -> None:
        aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
        self._aircraft, self._response, fdm = aircraft, response, aircraft.fdm
        self._slow, self._doubt = slow_lag - response.delay, SLOW_LAG_ERROR * slow_lag
        self._north = fdm.node("velocities/v-north-fps").get_double_value
        self._east = fdm.node("velocities/v-east-fps").get_double_value
        self._rate = fdm.node(HEADING_RATE).get_double_value
        self._height = fdm.node("position/h-sl-ft").get_double_value
        self._held, self.altitude_error = self._height(), 0.0
        self._late = max(1, round(response.delay / TIME_STEP))
        self._kept = math.exp(-TIME_STEP / (FORGOTTEN * response.lag))
        self._fading = math.exp(-TIME_STEP / (CHANGED * response.lag))
        self._lack, self._change = 0.0, 0.0
        self.commands: list[float] = [0.0] * self._late

    @property
    def speed(self) -> float:
        return math.hypot(self._north(), self._east()) * METRES_PER_FOOT

    def fly(self, heading_rate: float, duration: float) -> Array:
        """Return the path from here [m], shape (steps, 2), under a command that is held for
        ``duration`` [s].
        """
        self._aircraft.command_heading_rate(heading_rate)
        steps = max(1, round(duration / TIME_STEP))
        run, north, east, rate, height = (
            self._aircraft.run,
            self._north,
            self._east,
            self._rate,
            self._height,
        )
        values = [north(), east(), rate(), height()]
        for _ in range(steps):
            run()
            values += north(), east(), rate(), height()
        flown = np.array(values).reshape(-1, 4)
        self.altitude_error = max(
            self.altitude_error, METRES_PER_FOOT * float(np.abs(flown[:, 3] - self._held).max())
        )
        self._take_in(heading_rate, flown)
        return np.asarray(np.cumsum(flown[1:, :2], axis=0) * (TIME_STEP * METRES_PER_FOOT))

    def predicted(
        self, turn: float, duration: float, speed: float, rate: float
    ) -> tuple[Array, float]:
        """Return the path [m], shape (steps, 2), of a vehicle of that response that is commanded to
        turn from here on.

        With it, by how much its heading rate changes from when the command acts, over a full
        reversal.

        Parameters
        ----------
        turn, duration : the command [rad/s], held on [s]
        speed : of the vehicle [m/s]
        rate : omega_max [rad/s]
        """
        lag, steps = self._response.lag, max(1, round(duration / TIME_STEP))
        decay, side = math.exp(-TIME_STEP / lag), math.copysign(1.0, turn)
        rates: list[float] = []
        now = self._rate()
        to_come = (
            math.copysign(max(0.0, abs(self._lack) - self._doubt * abs(now)), self._lack) / lag
        )
        for command in self.commands[-self._late :]:
            now = command + (now - command) * decay
            rates.append(now)
        # What is to come counts where it is against the turn.
        now += side * min(0.0, side * to_come)
        change = 0.5 - 0.5 * side * now / rate
        for _ in range(steps - self._late):
            now = turn + (now - turn) * decay
            rates.append(now)
        courses = math.atan2(self._east(), self._north()) + np.cumsum(rates) * TIME_STEP
        path = (
            np.cumsum(np.column_stack([np.cos(courses), np.sin(courses)]), axis=0)
            * speed
            * TIME_STEP
        )
        return np.asarray(path), max(LEAST_CHANGE, self._change / (2.0 * rate), change)

    def _take_in(self, heading_rate: float, flown: Array) -> None:
        """Take in what was commanded and flown: the course that the aircraft has turned less than
        its response to the commands.
        """
        steps = len(flown) - 1
        self._change = (
            max(abs(heading_rate - self.commands[-1]), self._change) * self._fading**steps
        )
        self.commands = [*self.commands[-self._late :], *[heading_rate] * steps]
        acted = np.array(self.commands[:steps]) * TIME_STEP
        courses = np.unwrap(np.arctan2(flown[:, 1], flown[:, 0]))
        lacks = acted - np.diff(courses) - self._slow * np.diff(flown[:, 2])
        self._lack = float(
            lfilter([1.0], [1.0, -self._kept], lacks, zi=[self._kept * self._lack])[0][-1]
        )


def _deviation(flown: Array, predicted: Array, side: float) -> float:
    """Return the largest lack of distance from what is turned away from [m]."""
    heading = np.gradient(predicted, axis=0)
    course = np.arctan2(heading[:, 1], heading[:, 0])
    lack = predicted - flown
    away = course[:, None] + side * (0.5 * math.pi - _LEANING)
    return float(np.max(lack[:, :1] * np.cos(away) + lack[:, 1:] * np.sin(away)))
