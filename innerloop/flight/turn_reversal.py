"""Turn reversals: how the heading rate follows them, and how far aircraft stray from that.

The keep-out guard predicts turns by a dead time, a lag and the course that is still to come of
earlier commands (``gnc/guard/turn.py``). Rolling, airspeed lost in the turn and integrators of the
autopilot make the aircraft's path another one. A search over reversals finds the largest deviation.
The deviation that counts is how much nearer the aircraft comes to what it turns away from, over the
change of heading rate in the turn, or over the largest recent change of command if that is larger.

A turn away from a disc at rest comes closest to it within a quarter of a turn. From a disc that
closes in at the sine of an angle times the aircraft's speed, it comes closest later by that angle.
So deviations are taken in directions that lean forward, and the turn is flown on by the largest
lean.
"""

import functools
import math
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from aircraft.fdm import TIME_STEP
from aircraft.model import Perturbation, perturb, remove_ground_contacts
from aircraft.spec import AircraftError, AircraftSpec
from aircraft.trim import Trim
from common.interrupt import follow_parent
from common.physics import METRES_PER_FOOT, heading_rate_for_bank
from gnc.guard.turn import (
    CHANGE_DECAY,
    LEAST_CHANGE,
    PENDING_DECAY,
    entry_rate,
    pending_turn_rate,
    rolled_change,
)
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.jsbsim.system import HEADING_RATE
from innerloop.robustness import CASES
from innerloop.schedule import Schedule

AIRCRAFT = {name: case.by for name, case in CASES.items() if case.periods_late == 0}
"""The aircraft that fly reversals: as modelled first, then perturbed, by name."""

PART = 200
"""Reversals of one task of a repeated search [-]: an interruption loses no more of each process."""

_PROCESSES = 2

_LEAD_FRACTION = 0.01
"""Largest lead of the model, over the aircraft's final displacement [-]."""

_REVERSALS_MIN, _REVERSALS_MAX = 20, 150
"""Fewest and most reversals of every design's search [-]; ``--reversals`` flies more."""

_SEARCH_TIME = 1000.0
"""Flight time of that search, within those limits [s]."""

_RANDOM_SHARE = 0.5
"""Share of the reversals whose commands do not depend on the worst so far [-]."""

_WORST_KEPT = 2
"""Number of the worst reversals so far near which the search tries further ones [-]."""

_STEP_SIGMA = 0.15
"""Standard deviation of a step to them, in command/omega_max and in log(duration) [-]."""

_HOLD_MIN, _HOLD_MAX = 0.1, 3.0
"""Shortest and longest time for which a command is held before the turn, over 1/omega_max [-]."""

_COMMANDS_BEFORE = 3
"""Commands before the turn [-]."""

_SETTLED = 3.0
"""Time after which a turn is settled, over 1/omega_max [-]."""

_ROLL_TIMES, _BACK_TIMES = (1.0, 1.5, 2.0), (0.2, 2.0, 3.0, 4.0)
"""Durations of rolling to the other side and of rolling back since, over dead time and lag [-].

In the middle of a roll the aircraft turns on, and heading rates oscillate for as long after it.
"""

_LEANS = np.radians([0.0, 30.0, 60.0])
"""How far the direction away leans forward of abeam [rad]: the more, the faster the disc."""

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class TurnReversalResponse:
    """A dead time [s] and a first-order lag [s] that displace the aircraft as it flies."""

    delay: float
    lag: float


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


def measure_turn_reversal(
    aircraft: AutopilotedAircraft, start: Trim, bank: float
) -> TurnReversalResponse:
    """Return the response to a reversal from a settled turn at ``bank`` [rad], left to right.

    The measure is the displacement of the aircraft, the integral of its course error. Dead time and
    lag are equal, and the shortest for which the model is nowhere ahead of the aircraft over a
    quarter of a turn, except for 1 % of the final displacement. The lag of slow commands,
    ``measure_lag``, is shorter: the aircraft rolls through twice the bank.

    Parameters
    ----------
    aircraft : with its autopilot; its flight is ended
    start : straight and level equilibrium
    bank : [rad]

    Raises
    ------
    AircraftError : it does not follow the reversal
    """
    rate = heading_rate_for_bank(bank, start.airspeed)
    aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
    node = aircraft.fdm.node(HEADING_RATE)
    aircraft.command_heading_rate(-rate)
    aircraft.fdm.step(round(2.0 * math.pi / rate / TIME_STEP))
    aircraft.command_heading_rate(rate)
    time = TIME_STEP * np.arange(1.0, round(0.5 * math.pi / rate / TIME_STEP) + 1.0)
    behind = np.empty(time.size)
    for i in range(time.size):
        aircraft.fdm.run()
        behind[i] = 0.5 * (1.0 - node.get_double_value() / rate)
    flown = np.cumsum(np.cumsum(behind)) * TIME_STEP**2

    def least_lead(half: float) -> float:
        response = TurnReversalResponse(delay=half, lag=half)
        lead = float(np.min(displacement(time, response) - flown))
        return lead + _LEAD_FRACTION * float(flown[-1])

    half, longest = TIME_STEP, float(time[-1])
    if not least_lead(longest) >= 0.0:
        raise AircraftError(
            f"{aircraft.fdm.spec.name} at {start.airspeed:g} m/s does not turn right within"
            f" {longest:.1f} s of the command in a left turn at {math.degrees(bank):.0f} deg of"
            " bank; lower the bank"
        )
    if least_lead(half) < 0.0:
        half = float(brentq(least_lead, half, longest, xtol=1e-4))
    return TurnReversalResponse(delay=half, lag=half)


def displacement(time: Array, reversal: TurnReversalResponse) -> Array:
    """Return the integral of the course error, ``time`` [s] after a unit step of command [s2]."""
    after = np.maximum(time - reversal.delay, 0.0)
    lag = reversal.lag
    late = np.minimum(time, reversal.delay)
    return 0.5 * late**2 + reversal.delay * after + lag * after + lag**2 * np.expm1(-after / lag)


def perturbed_aircraft(spec: AircraftSpec, root: Path, by: Perturbation) -> AutopilotedAircraft:
    """Return an aircraft under the autopilot of a JSBSim root, ``by`` factors off its model."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(shutil.copytree(root, Path(folder) / "root"))
        perturb(copy / "aircraft" / spec.model / f"{spec.model}.xml", by)
        remove_ground_contacts(spec, copy)
        return AutopilotedAircraft(spec, copy)


def reversal_record(
    spec: AircraftSpec, root: Path, start: Trim, bank: float, slow_lag: float
) -> dict[str, Any]:
    """Return the heading-rate response to a turn reversal, and the deviations that a search found.

    Parameters
    ----------
    spec, root : the aircraft, and a JSBSim root of its autopilot
    start : straight and level equilibrium
    bank : of the turns [rad]
    slow_lag : of the heading rate behind slow commands [s]
    """
    aircraft = [perturbed_aircraft(spec, root, by) for by in AIRCRAFT.values()]
    response = measure_turn_reversal(aircraft[0], start, bank)
    count = reversals_of_a_design(bank, start.airspeed)
    found = search_reversals(
        aircraft, start, bank, response, slow_lag, reversals=count, settled=True
    )
    return {
        "bank_deg": math.degrees(bank),
        "airspeed_mps": start.airspeed,
        "delay_s": response.delay,
        "lag_s": response.lag,
        "reversals": found.reversals,
        "unguided_reversals": found.random_reversals,
        "deviation_99_percent_m": found.p99_deviation,
        "deviation_max_m": found.deviation,
        "worst_command_before": found.command_before,
        "worst_airspeed_before_mps": found.airspeed_before,
        "altitude_error_max_m": found.altitude_error,
        "deviation_of_m": _largest_deviations([found]),
    }


def repeat_search(
    schedule: Schedule,
    record: dict[str, Any],
    root: Path,
    reversals: int,
    *,
    done: Callable[[int, float], None],
) -> dict[str, Any]:
    """Return the largest deviation in a search with other random numbers than the design's own.

    An interrupted search returns the result of its finished tasks, if there are any.

    Parameters
    ----------
    schedule, record : the design and its record, which contains the response
    root : JSBSim root of its autopilot
    reversals : how many are flown
    done : called after each task with the number of reversals flown, and the largest deviation
        so far [m]
    """
    recorded = record["turn_reversal"]
    search = functools.partial(
        _search_perturbed,
        schedule.spec,
        root,
        schedule.level(schedule.middle),
        schedule.envelope.bank,
        TurnReversalResponse(delay=recorded["delay_s"], lag=recorded["lag_s"]),
        record["heading_rate_lag_s"],
    )
    searches: list[ReversalSearch] = []
    with ProcessPoolExecutor(
        min(_PROCESSES, os.cpu_count() or 1), initializer=follow_parent
    ) as pool:
        running = [
            pool.submit(search, min(PART, reversals - first), seed)
            # The design's own search has the seed 0.
            for seed, first in enumerate(range(0, reversals, PART), start=1)
        ]
        try:
            for finished in as_completed(running):
                searches.append(finished.result())
                done(
                    sum(search.reversals for search in searches),
                    max(search.deviation for search in searches),
                )
        except KeyboardInterrupt:
            pool.shutdown(cancel_futures=True)
            if not searches:
                raise
            print("interrupted; what was found so far is recorded", file=sys.stderr)
    worst = max(searches, key=lambda search: search.deviation)
    return {
        "reversals": sum(search.reversals for search in searches),
        "deviation_max_m": worst.deviation,
        "worst_command_before": worst.command_before,
        "worst_airspeed_before_mps": worst.airspeed_before,
        "deviation_of_m": _largest_deviations(searches),
    }


def _search_perturbed(
    spec: AircraftSpec,
    root: Path,
    start: Trim,
    bank: float,
    response: TurnReversalResponse,
    slow_lag: float,
    reversals: int,
    seed: int,
) -> ReversalSearch:
    aircraft = [perturbed_aircraft(spec, root, by) for by in AIRCRAFT.values()]
    return search_reversals(
        aircraft, start, bank, response, slow_lag, reversals=reversals, seed=seed
    )


def _largest_deviations(searches: Sequence[ReversalSearch]) -> dict[str, float]:
    """Return the largest deviation [m] of each aircraft that flew a reversal, by its name."""
    found = {
        name: max(search.deviations[i] for search in searches) for i, name in enumerate(AIRCRAFT)
    }
    return {name: deviation for name, deviation in found.items() if math.isfinite(deviation)}


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


class _Before(NamedTuple):
    """Commands before a reversal, over omega_max and held over 1/omega_max; then to which side."""

    commands: tuple[tuple[float, float], ...]
    side: float


class _Reversal(NamedTuple):
    """Deviation [m] of a reversal of one of the aircraft, and airspeed at its beginning [m/s]."""

    deviation: float
    which: int
    before: _Before
    airspeed: float


def _rolls(late: float) -> list[_Before]:
    """Return turns to the other side and back; ``late`` is dead time and lag over 1/omega_max."""
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
    Parameters are those of ``search_reversals``, and omega_max [rad/s].

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
        rate_max: float,
    ) -> None:
        aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
        self._aircraft = aircraft
        self._response = response
        self._slow_lag = slow_lag
        self._rate_max = rate_max
        fdm = aircraft.fdm
        self._north = fdm.node("velocities/v-north-fps").get_double_value
        self._east = fdm.node("velocities/v-east-fps").get_double_value
        self._rate = fdm.node(HEADING_RATE).get_double_value
        self._height = fdm.node("position/h-sl-ft").get_double_value
        self._held_height_ft = self._height()
        self._delay_steps = max(1, round(response.delay / TIME_STEP))
        self._kept = math.exp(-TIME_STEP / (PENDING_DECAY * response.lag))
        self._fading = math.exp(-TIME_STEP / (CHANGE_DECAY * response.lag))
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
    def change(self) -> float:
        """Largest recent change of command, over a full reversal [-]."""
        return max(LEAST_CHANGE, self._largest_change / (2.0 * self._rate_max))

    def fly(self, heading_rate: float, duration: float) -> Array:
        """Return the path [m], shape (steps, 2), under a command [rad/s] held for a time [s]."""
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
        lag = self._response.lag
        decay, side = math.exp(-TIME_STEP / lag), math.copysign(1.0, turn)
        rate = self._rate()
        pending = pending_turn_rate(self.lack, rate, self._slow_lag, lag)
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
        slow_lag_after_delay = self._slow_lag - self._response.delay
        lacks = acted - np.diff(courses) - slow_lag_after_delay * rate_changes
        for lack in lacks.tolist():
            self.lack = lack + self._kept * self.lack


def _deviation(flown: Array, predicted: Array, side: float) -> float:
    """Return the largest lack of distance from what is turned away from [m]."""
    heading = np.gradient(predicted, axis=0)
    course = np.arctan2(heading[:, 1], heading[:, 0])
    lack = predicted - flown
    away = course[:, None] + side * (0.5 * math.pi - _LEANS)
    return float(np.max(lack[:, :1] * np.cos(away) + lack[:, 1:] * np.sin(away)))
