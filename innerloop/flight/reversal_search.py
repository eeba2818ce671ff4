"""How far an aircraft strays from the predicted turn: a search over reversals.

The keep-out guard predicts turns by a dead time, a lag and the course that is still to come of
earlier commands (``gnc/guard/turn.py``). Rolling, airspeed lost in the turn and integrators of the
autopilot make the aircraft's path another one. The deviation that counts is how much nearer it comes
to what it turns away from, over the change of heading rate in the turn, or over the largest recent
change of command if that is larger. The aircraft is flown as modelled and perturbed.

A turn away from a disc at rest comes closest to it within a quarter of a turn. From a disc that
closes in at the sine of an angle times the aircraft's speed, it comes closest later by that angle.
So deviations are taken in directions that lean forward, and the turn is flown on by the largest
lean.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.signal import lfilter

from aircraft.fdm import TIME_STEP
from aircraft.trim import Trim
from common.physics import METRES_PER_FOOT, heading_rate_for_bank
from gnc.guard.turn import (
    CHANGED,
    FORGOTTEN,
    LEAST_CHANGE,
    entry_rate,
    pending_turn_rate,
    rolled_change,
)
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.turn_reversal import TurnReversalResponse
from innerloop.jsbsim.system import HEADING_RATE

_REVERSALS_MIN, _REVERSALS_MAX = 20, 150
"""Fewest and most reversals of the search that is part of every design [-]; the command's
``--reversals`` flies more."""

_SEARCH_TIME = 1000.0
"""Flight time of that search, within those limits [s]."""

_RANDOM_SHARE = 0.5
"""Share of the reversals whose commands do not depend on the worst so far [-]."""

_WORST_KEPT = 2
"""Number of the worst reversals so far near which the search tries further ones [-]."""

_STEP_SIGMA = 0.15
"""Standard deviation of such a step: of a command over omega_max, and of the logarithm of its
duration [-]."""

_HOLD_MIN, _HOLD_MAX = 0.1, 3.0
"""Shortest and longest time for which a command is held before the turn, over 1/omega_max [-]."""

_COMMANDS_BEFORE = 3
"""Commands before the turn [-]."""

_SETTLED = 3.0
"""Time after which a turn is settled, over 1/omega_max [-]."""

_ROLL_TIMES, _BACK_TIMES = (1.0, 1.5, 2.0), (0.2, 2.0, 3.0, 4.0)
"""For how long the aircraft rolls to the other side, and has rolled back since, over dead time and
lag [-]: in the middle of a roll it turns on, and heading rates oscillate for as long after it."""

_LEANS = np.radians([0.0, 30.0, 60.0])
"""How far the direction away leans forward of abeam [rad]: the more, the faster the disc."""

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReversalSearch:
    """What a search over reversals found.

    Attributes
    ----------
    reversals : flown [-]
    deviation : largest, over the change of heading rate as a share of a full reversal [m]
    deviations : largest of each aircraft [m]; minus infinity for one that flew none
    random_reversals : reversals that did not follow the worst so far [-]
    p99_deviation : least deviation that at most one in a hundred of these exceeds [m]
    command_before : heading-rate command just before the worst, over omega_max to the side of the
        turn [-]
    airspeed_before : airspeed at its beginning [m/s]
    altitude_error : largest difference from the altitude that is held, in all of the flight [m]
    """

    reversals: int
    deviation: float
    deviations: tuple[float, ...]
    random_reversals: int
    p99_deviation: float
    command_before: float
    airspeed_before: float
    altitude_error: float


def reversals_of_a_design(bank: float, airspeed: float) -> int:
    """Return how many reversals a design flies at a bank [rad] and an airspeed [m/s]."""
    quarter_turn = 0.5 * math.pi / heading_rate_for_bank(bank, airspeed)
    return min(max(round(0.5 * _SEARCH_TIME / quarter_turn), _REVERSALS_MIN), _REVERSALS_MAX)


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
    """Return the largest deviation from the predicted turn in so many reversals.

    The aircraft take turns, each in one long flight. The first reversals begin after a roll to the
    other side, the next after a few full turns to random sides for random durations; before every
    second one of these, a command is less than full. Those of the second half climb: aircraft and
    commands are those of one of the worst so far, the commands changed at random.

    Parameters
    ----------
    aircraft : with their autopilot, as modelled and perturbed; their flight is ended
    start : straight and level equilibrium
    bank : whose coordinated turn is omega_max [rad]
    response : of the heading rate to a reversal
    slow_lag : delay behind slow commands [s]
    reversals, seed : how many are flown, and of their random numbers
    settled : whether each aircraft reverses a settled full turn as well, from either side
    """
    rate = heading_rate_for_bank(bank, start.airspeed)
    generator = np.random.default_rng(seed)
    duration = (0.5 * math.pi + float(_LEANS[-1])) / rate + response.delay + response.lag
    flights = [_Flight(each, start, response, slow_lag, rate) for each in aircraft]
    flown: list[_Reversal] = []

    def reverse(which: int, before: _Before) -> None:
        flight = flights[which]
        for share, held in before.commands:
            flight.fly(share * rate, held / rate)
        turn, speed = before.side * rate, flight.speed
        predicted, change = flight.predicted_turn(turn, duration, max(speed, start.airspeed))
        deviation = _deviation(flight.fly(turn, duration), predicted, before.side) / change
        flown.append(_Reversal(deviation, which, before, speed))

    rolls = _rolls((response.delay + response.lag) * rate)
    random_count = math.ceil(_RANDOM_SHARE * reversals)
    for number in range(reversals):
        which = number % len(flights)
        if number >= random_count:
            worst = sorted(flown, key=lambda reversal: -reversal.deviation)[:_WORST_KEPT]
            near = worst[int(generator.integers(len(worst)))]
            reverse(near.which, _changed(near.before, generator))
        elif number < len(rolls) * len(flights):
            reverse(which, _changed(rolls[number % len(rolls)], generator))
        else:
            reverse(which, _random(generator, full=number % 2 == 0))
    if settled:
        for which in range(len(flights)):
            for side in (1.0, -1.0):
                reverse(which, _Before(((-side, _SETTLED),), side))
    worst_of_all = max(flown, key=lambda reversal: reversal.deviation)
    random_ones = [reversal.deviation for reversal in flown[:random_count] + flown[reversals:]]
    return ReversalSearch(
        reversals=len(flown),
        deviation=max(0.0, worst_of_all.deviation),
        deviations=tuple(
            max((each.deviation for each in flown if each.which == which), default=-math.inf)
            for which in range(len(flights))
        ),
        random_reversals=len(random_ones),
        p99_deviation=max(0.0, float(np.quantile(random_ones, 0.99, method="higher"))),
        command_before=worst_of_all.before.side * worst_of_all.before.commands[-1][0],
        airspeed_before=worst_of_all.airspeed,
        altitude_error=max(flight.altitude_error for flight in flights),
    )


@dataclass(frozen=True, slots=True)
class _Before:
    """What is flown before a reversal.

    Attributes
    ----------
    commands : each over omega_max, and for how long it is held, over 1/omega_max
    side : to which the aircraft turns then
    """

    commands: tuple[tuple[float, float], ...]
    side: float


@dataclass(frozen=True, slots=True)
class _Reversal:
    """A reversal that was flown.

    Attributes
    ----------
    deviation : over its change of heading rate [m]
    which : number of the aircraft
    before : what was flown before
    airspeed : at its beginning [m/s]
    """

    deviation: float
    which: int
    before: _Before
    airspeed: float


def _rolls(late: float) -> list[_Before]:
    """Return turns to the other side and back; ``late`` is dead time and lag over 1/omega_max [-]."""
    return [
        _Before(((1.0, _SETTLED), (-1.0, rolling * late), (1.0, back * late)), 1.0)
        for rolling in _ROLL_TIMES
        for back in _BACK_TIMES
    ]


def _random(generator: np.random.Generator, *, full: bool) -> _Before:
    """Return random commands and a random side: full turns, or one of them less than ``full``."""
    shares = generator.choice([-1.0, 1.0], _COMMANDS_BEFORE)
    if not full:
        shares[generator.integers(_COMMANDS_BEFORE)] = generator.uniform(-1.0, 1.0)
    log_held = generator.uniform(math.log(_HOLD_MIN), math.log(_HOLD_MAX), _COMMANDS_BEFORE)
    held = np.exp(log_held)
    side = float(generator.choice([-1.0, 1.0]))
    return _Before(tuple(zip(shares.tolist(), held.tolist(), strict=True)), side)


def _changed(before: _Before, generator: np.random.Generator) -> _Before:
    """Return commands near others."""
    commands = []
    for share, held in before.commands:
        turn, longer = _STEP_SIGMA * generator.standard_normal(2)
        changed_share = float(np.clip(share + turn, -1.0, 1.0))
        changed_hold = float(np.clip(held * math.exp(longer), _HOLD_MIN, _HOLD_MAX))
        commands.append((changed_share, changed_hold))
    return _Before(tuple(commands), before.side)


class _Flight:
    """An aircraft under way, what it was commanded, and the course that is still to come of that.

    The model of the turn is the guard's (``gnc/guard/turn.py``), at the time step of the aircraft.

    Parameters
    ----------
    aircraft, start, response, slow_lag : see ``search_reversals``
    rate : omega_max [rad/s]

    Attributes
    ----------
    altitude_error : largest difference from the altitude at the release [m]
    lack : commanded course that has not been turned yet [rad]
    """

    def __init__(
        self,
        aircraft: AutopilotedAircraft,
        start: Trim,
        response: TurnReversalResponse,
        slow_lag: float,
        rate: float,
    ) -> None:
        aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
        self._aircraft = aircraft
        self._lag = response.lag
        self._slow_lag = slow_lag
        self._slow_lag_after_delay = slow_lag - response.delay
        self._rate_max = rate
        fdm = aircraft.fdm
        self._north = fdm.node("velocities/v-north-fps").get_double_value
        self._east = fdm.node("velocities/v-east-fps").get_double_value
        self._rate = fdm.node(HEADING_RATE).get_double_value
        self._height = fdm.node("position/h-sl-ft").get_double_value
        self._held_height_ft = self._height()
        self._delay_steps = max(1, round(response.delay / TIME_STEP))
        self._kept = math.exp(-TIME_STEP / (FORGOTTEN * response.lag))
        self._fading = math.exp(-TIME_STEP / (CHANGED * response.lag))
        self._largest_change = 0.0
        # Those that have not acted yet, and before them those of the last piece.
        self._commands: list[float] = [0.0] * self._delay_steps
        self.altitude_error = 0.0
        self.lack = 0.0

    @property
    def speed(self) -> float:
        """Ground speed, in still air [m/s]."""
        return math.hypot(self._north(), self._east()) * METRES_PER_FOOT

    @property
    def heading_rate(self) -> float:
        """Heading rate now [rad/s]."""
        return self._rate()

    @property
    def change(self) -> float:
        """Largest recent change of command, over a full reversal [-]."""
        return max(LEAST_CHANGE, self._largest_change / (2.0 * self._rate_max))

    def fly(self, heading_rate: float, duration: float) -> Array:
        """Return the path from here [m], shape (steps, 2), under a held command.

        Parameters
        ----------
        heading_rate, duration : of the command [rad/s, s]
        """
        self._aircraft.command_heading_rate(heading_rate)
        steps = max(1, round(duration / TIME_STEP))
        values = [self._north(), self._east(), self._rate(), self._height()]
        for _ in range(steps):
            self._aircraft.run()
            values += self._north(), self._east(), self._rate(), self._height()
        velocities_and_rates = np.array(values).reshape(-1, 4)
        heights = velocities_and_rates[:, 3]
        off = METRES_PER_FOOT * float(np.abs(heights - self._held_height_ft).max())
        self.altitude_error = max(self.altitude_error, off)
        self._take_in(heading_rate, velocities_and_rates)
        return np.asarray(
            np.cumsum(velocities_and_rates[1:, :2], axis=0) * (TIME_STEP * METRES_PER_FOOT)
        )

    def predicted_turn(self, turn: float, duration: float, speed: float) -> tuple[Array, float]:
        """Return the predicted path [m], shape (steps, 2), and the change of heading rate [-].

        That change is counted from when the command acts, over a full reversal.

        Parameters
        ----------
        turn, duration : the command [rad/s], held on [s]
        speed : of the vehicle [m/s]
        """
        steps = max(1, round(duration / TIME_STEP))
        decay, side = math.exp(-TIME_STEP / self._lag), math.copysign(1.0, turn)
        rate = self._rate()
        pending = pending_turn_rate(self.lack, rate, self._slow_lag, self._lag)
        rates: list[float] = []
        for command in self._commands[-self._delay_steps :]:
            rate = command + (rate - command) * decay
            rates.append(rate)
        rate = entry_rate(side, rate, pending)
        change = rolled_change(side, rate, self._rate_max)
        for _ in range(steps - self._delay_steps):
            rate = turn + (rate - turn) * decay
            rates.append(rate)
        courses = math.atan2(self._east(), self._north()) + np.cumsum(rates) * TIME_STEP
        directions = np.column_stack([np.cos(courses), np.sin(courses)])
        path = np.cumsum(directions, axis=0) * speed * TIME_STEP
        return np.asarray(path), max(self.change, change)

    def _take_in(self, heading_rate: float, velocities_and_rates: Array) -> None:
        """Take in a held command [rad/s] and what was flown under it."""
        steps = len(velocities_and_rates) - 1
        newest = abs(heading_rate - self._commands[-1])
        self._largest_change = max(newest, self._largest_change) * self._fading**steps
        self._commands = [*self._commands[-self._delay_steps :], *[heading_rate] * steps]
        acted = np.array(self._commands[:steps]) * TIME_STEP
        courses = np.unwrap(np.arctan2(velocities_and_rates[:, 1], velocities_and_rates[:, 0]))
        rate_changes = np.diff(velocities_and_rates[:, 2])
        lacks = acted - np.diff(courses) - self._slow_lag_after_delay * rate_changes
        # The lack of each step is added to the last one, which is forgotten little by little.
        sums, _ = lfilter([1.0], [1.0, -self._kept], lacks, zi=[self._kept * self.lack])
        self.lack = float(sums[-1])


def _deviation(flown: Array, predicted: Array, side: float) -> float:
    """Return the largest lack of distance from what is turned away from [m]."""
    heading = np.gradient(predicted, axis=0)
    course = np.arctan2(heading[:, 1], heading[:, 0])
    lack = predicted - flown
    away = course[:, None] + side * (0.5 * math.pi - _LEANS)
    return float(np.max(lack[:, :1] * np.cos(away) + lack[:, 1:] * np.sin(away)))
