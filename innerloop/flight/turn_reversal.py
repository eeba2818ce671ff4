"""Turn reversals: the response of the heading rate, and the deviation from the predicted path.

The keep-out guard predicts turns with a dead time, a lag, and the pending course change of earlier
commands (``gnc/guard/turn.py``). Rolling, loss of airspeed and the autopilot's integrators change
the flown path. A search over reversals finds the largest deviation.

The deviation is the distance by which the aircraft comes closer to an obstacle than predicted. It
is divided by the change of heading rate in the turn, or by the largest recent change of command if
that is larger.

A turn away from a disc at rest comes closest to the disc within a quarter of a turn. If the disc
approaches at the aircraft's speed times the sine of an angle, the closest approach is later by that
angle. Deviations are therefore also measured in directions that lean forward from abeam, and the
turn is flown on by the largest lean.
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

REVERSAL_PERTURBATIONS = {name: case.by for name, case in CASES.items() if case.periods_late == 0}
"""Perturbations of the aircraft that fly reversals, by name; the aircraft as modelled is first."""

REVERSALS_PER_TASK = 200
"""Reversals in one task of a repeated search [-]: the most that an interruption loses."""

_PROCESSES = 2

_LEAD_FRACTION = 0.01
"""Largest lead of the model over the aircraft's final displacement [-]."""

_REVERSALS_MIN, _REVERSALS_MAX = 20, 150
"""Least and largest number of reversals in a design's search [-]; ``--reversals`` flies more."""

_SEARCH_TIME = 1000.0
"""Flight time of that search, which determines the number of reversals [s]."""

_RANDOM_SHARE = 0.5
"""Fraction of the reversals whose commands do not depend on earlier results [-]."""

_WORST_KEPT = 2
"""Number of worst reversals that the search varies [-]."""

_STEP_SIGMA = 0.15
"""Standard deviation of these variations, in command/omega_max and in log(duration) [-]."""

_HOLD_MIN, _HOLD_MAX = 0.1, 3.0
"""Shortest and longest duration of a command before the turn, over 1/omega_max [-]."""

_COMMANDS_BEFORE = 3
"""Number of commands before the turn [-]."""

_SETTLED = 3.0
"""Time until a turn is settled, over 1/omega_max [-]."""

_ROLL_TIMES, _BACK_TIMES = (1.0, 1.5, 2.0), (0.2, 2.0, 3.0, 4.0)
"""Durations of a roll to the other side and of the roll back, over dead time plus lag [-].

In the middle of a roll the aircraft still turns, and the heading rate oscillates afterwards.
"""

_LEANS = np.radians([0.0, 30.0, 60.0])
"""Angles forward of abeam at which deviations are measured [rad]: larger for faster discs."""

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class TurnReversalResponse:
    """Dead time [s] and first-order lag [s] that give the displacement of the flown reversal."""

    delay: float
    lag: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ReversalSearch:
    """Result of a search over reversals.

    Attributes
    ----------
    reversals : number of reversals flown [-]
    deviation : largest deviation, over the change of heading rate as a fraction of a full reversal
        [m]
    deviations : largest deviation of each aircraft [m]; minus infinity if it flew no reversal
    random_reversals : number of reversals whose commands did not depend on earlier results [-]
    p99_deviation : deviation that at most one in a hundred random reversals exceeds [m]
    command_before : heading-rate command just before the worst reversal, over omega_max, positive
        to the side of the turn [-]
    airspeed_before : airspeed at the beginning of the worst reversal [m/s]
    altitude_error : largest deviation from the commanded altitude in the whole flight [m]
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

    The displacement of the aircraft, the integral of its course error, is compared with the
    model's. Dead time and lag are equal. They are the shortest with which the model leads the
    aircraft by at most 1 % of the final displacement over a quarter of a turn. They are longer than
    the lag of slow commands, ``measure_lag``, because the aircraft rolls through twice the bank.

    Parameters
    ----------
    aircraft : aircraft with its autopilot; its flight is ended
    start : straight and level equilibrium
    bank : bank of the turn [rad]

    Raises
    ------
    AircraftError : the aircraft does not follow the reversal
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
    """Return the model's displacement ``time`` [s] after a unit step of the command [s2]."""
    after = np.maximum(time - reversal.delay, 0.0)
    lag = reversal.lag
    late = np.minimum(time, reversal.delay)
    return 0.5 * late**2 + reversal.delay * after + lag * after + lag**2 * np.expm1(-after / lag)


def perturbed_aircraft(spec: AircraftSpec, root: Path, by: Perturbation) -> AutopilotedAircraft:
    """Return a perturbed aircraft under the autopilot of a JSBSim root."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(shutil.copytree(root, Path(folder) / "root"))
        perturb(copy / "aircraft" / spec.model / f"{spec.model}.xml", by)
        remove_ground_contacts(spec, copy)
        return AutopilotedAircraft(spec, copy)


def reversal_record(
    spec: AircraftSpec, root: Path, start: Trim, bank: float, slow_lag: float
) -> dict[str, Any]:
    """Return the response to a turn reversal, and the largest deviations of a search, as a record.

    Parameters
    ----------
    spec, root : the aircraft, and a JSBSim root of its autopilot
    start : straight and level equilibrium
    bank : bank of the turns [rad]
    slow_lag : lag of the heading rate behind slow commands [s]
    """
    aircraft = [perturbed_aircraft(spec, root, by) for by in REVERSAL_PERTURBATIONS.values()]
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
    """Repeat the search for the largest deviation with new random numbers; return its record.

    An interrupted search returns the result of its finished tasks, if there are any.

    Parameters
    ----------
    schedule, record : the design and its record, which contains the response
    root : JSBSim root of its autopilot
    reversals : number of reversals
    done : called after each task with the number of reversals flown and the largest deviation so
        far [m]
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
            pool.submit(search, min(REVERSALS_PER_TASK, reversals - first), seed)
            # The design's own search has the seed 0.
            for seed, first in enumerate(range(0, reversals, REVERSALS_PER_TASK), start=1)
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
            print("interrupted; the finished reversals are recorded", file=sys.stderr)
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
    aircraft = [perturbed_aircraft(spec, root, by) for by in REVERSAL_PERTURBATIONS.values()]
    return search_reversals(
        aircraft, start, bank, response, slow_lag, reversals=reversals, seed=seed
    )


def _largest_deviations(searches: Sequence[ReversalSearch]) -> dict[str, float]:
    """Return the largest deviation [m] by name of each aircraft that flew a reversal."""
    found = {
        name: max(search.deviations[i] for search in searches)
        for i, name in enumerate(REVERSAL_PERTURBATIONS)
    }
    return {name: deviation for name, deviation in found.items() if math.isfinite(deviation)}


def reversals_of_a_design(bank: float, airspeed: float) -> int:
    """Return the number of reversals in a design's search, by bank [rad] and airspeed [m/s]."""
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
    """Search for the reversal with the largest deviation from the predicted turn.

    The aircraft take turns, each in one long flight. The first reversals begin after a roll to the
    other side. The next ones begin after full commands to random sides for random durations; in
    every second one a command is less than full. The second half is a random local search: it
    repeats one of the worst reversals so far with randomly varied commands.

    Parameters
    ----------
    aircraft : aircraft with their autopilot, as modelled and perturbed; their flight is ended
    start : straight and level equilibrium
    bank : bank of the coordinated turn at omega_max [rad]
    response : response of the heading rate to a reversal
    slow_lag : lag of the heading rate behind slow commands [s]
    reversals, seed : number of reversals, and seed of the random numbers
    settled : whether each aircraft also reverses a settled full turn from either side
    """
    rate = heading_rate_for_bank(bank, start.airspeed)
    generator = np.random.default_rng(seed)
    duration = (0.5 * math.pi + float(_LEANS[-1])) / rate + response.delay + response.lag
    flights = [_Flight(each, start, response, slow_lag, rate) for each in aircraft]
    flown: list[_Reversal] = []

    def reverse(which: int, before: _EntryCommands) -> None:
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
                reverse(which, _EntryCommands(((-side, _SETTLED),), side))
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


class _EntryCommands(NamedTuple):
    """Commands before a reversal: (command/omega_max, duration omega_max), and the turn's side."""

    commands: tuple[tuple[float, float], ...]
    side: float


class _Reversal(NamedTuple):
    """A flown reversal: deviation [m], index of the aircraft, commands before, airspeed [m/s]."""

    deviation: float
    which: int
    before: _EntryCommands
    airspeed: float


def _rolls(late: float) -> list[_EntryCommands]:
    """Return rolls to the other side and back; ``late`` is dead time plus lag, over 1/omega_max."""
    return [
        _EntryCommands(((1.0, _SETTLED), (-1.0, rolling * late), (1.0, back * late)), 1.0)
        for rolling in _ROLL_TIMES
        for back in _BACK_TIMES
    ]


def _random(generator: np.random.Generator, *, full: bool) -> _EntryCommands:
    """Return random commands and a random side; unless ``full``, one command is reduced."""
    shares = generator.choice([-1.0, 1.0], _COMMANDS_BEFORE)
    if not full:
        shares[generator.integers(_COMMANDS_BEFORE)] = generator.uniform(-1.0, 1.0)
    log_held = generator.uniform(math.log(_HOLD_MIN), math.log(_HOLD_MAX), _COMMANDS_BEFORE)
    held = np.exp(log_held)
    side = float(generator.choice([-1.0, 1.0]))
    return _EntryCommands(tuple(zip(shares.tolist(), held.tolist(), strict=True)), side)


def _changed(before: _EntryCommands, generator: np.random.Generator) -> _EntryCommands:
    """Return randomly varied commands."""
    commands = []
    for share, held in before.commands:
        turn, longer = _STEP_SIGMA * generator.standard_normal(2)
        changed_share = float(np.clip(share + turn, -1.0, 1.0))
        changed_hold = float(np.clip(held * math.exp(longer), _HOLD_MIN, _HOLD_MAX))
        commands.append((changed_share, changed_hold))
    return _EntryCommands(tuple(commands), before.side)


class _Flight:
    """An aircraft in flight, with its recent commands and their pending course change.

    The turn is predicted with the guard's model (``gnc/guard/turn.py``) at the aircraft's time
    step. Parameters are as in ``search_reversals``; ``rate_max`` is omega_max [rad/s].

    Attributes
    ----------
    altitude_error : largest deviation from the altitude at the release [m]
    lack : commanded course change that has not been flown yet [rad]
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
        # Commands of the last piece of the flight, then those that have not acted yet.
        self._commands: list[float] = [0.0] * self._delay_steps
        self.altitude_error = 0.0
        self.lack = 0.0

    @property
    def speed(self) -> float:
        """Ground speed [m/s]; the air is still."""
        return math.hypot(self._north(), self._east()) * METRES_PER_FOOT

    @property
    def change(self) -> float:
        """Largest recent change of command, over a full reversal [-]."""
        return max(LEAST_CHANGE, self._largest_change / (2.0 * self._rate_max))

    def fly(self, heading_rate: float, duration: float) -> Array:
        """Hold a heading-rate command [rad/s] for a time [s]; return the path [m], (steps, 2)."""
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

        The change is counted from the time at which the command acts, over a full reversal.

        Parameters
        ----------
        turn, duration : command [rad/s], and its duration [s]
        speed : speed of the vehicle [m/s]
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
        """Update the pending course change with a held command [rad/s] and the flown motion."""
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
    """Return the largest distance by which the flown path lies closer to the obstacle [m]."""
    heading = np.gradient(predicted, axis=0)
    course = np.arctan2(heading[:, 1], heading[:, 0])
    lack = predicted - flown
    away = course[:, None] + side * (0.5 * math.pi - _LEANS)
    return float(np.max(lack[:, :1] * np.cos(away) + lack[:, 1:] * np.sin(away)))
