"""How far an aircraft strays from its turn-reversal response: a search over reversals from whatever it was doing before.

The guidance's keep-out guard predicts turns by a dead time and a lag (``innerloop.flight.turn_reversal``). Rolling,
airspeed lost in the turn and integrators of the autopilot make the aircraft's path another one. What counts is by how
much it comes nearer to what it turns away from: the deviation against the direction in which the turn leads, at any
time until a quarter of a turn is flown, in proportion to the change of heading rate.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aircraft.dynamics.equilibrium import Trim
from aircraft.simulation.fdm import TIME_STEP
from common.units import METRES_PER_FOOT, STANDARD_GRAVITY
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.turn_reversal import TurnReversalResponse
from innerloop.jsbsim.properties import HEADING_RATE

_SEARCHED = (20, 100)
"""Fewest and most reversals of the search that is part of every design [-]; the command's ``--reversals`` flies more."""

_SEARCHED_FOR = 1000.0
"""Flight time of that search, within those limits [s]."""

_LEAST_CHANGE = 0.25
"""Change of heading rate below which a turn is no reversal, over that of a full one [-]."""

_HELD = (0.1, 3.0)
"""Shortest and longest time for which a command is held before the turn, over 1/omega_max [-]."""

_BEFORE = 3
"""Commands before the turn [-]."""

_LEANING = np.radians([0.0, 30.0, 60.0])
"""How far the direction away leans forward of abeam [rad]: more, the faster that moves from which the aircraft turns away."""

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReversalSearch:
    """What a search over reversals found.

    Attributes
    ----------
    reversals : flown [-]
    deviation : largest, over the change of heading rate as a fraction of a full reversal [m]
    usual : that 99 of 100 reversals stay below [m]
    command_before : heading-rate command just before the worst, over omega_max to the side of the turn [-]
    airspeed_before : airspeed at its beginning [m/s]
    """

    reversals: int
    deviation: float
    usual: float
    command_before: float
    airspeed_before: float


def reversals_of_a_design(bank: float, airspeed: float) -> int:
    """Return how many reversals are flown for the record of a design, by its bank [rad] and airspeed [m/s]."""
    quarter = 0.5 * math.pi * airspeed / (STANDARD_GRAVITY * math.tan(bank))
    return min(max(round(0.5 * _SEARCHED_FOR / quarter), _SEARCHED[0]), _SEARCHED[1])


def search_reversals(
    aircraft: AutopilotedAircraft, start: Trim, bank: float, response: TurnReversalResponse, *, reversals: int, seed: int = 0
) -> ReversalSearch:
    """Return the largest deviation of ``aircraft`` from its response in so many reversals, one after the other.

    Each begins after a few commands of random size and duration: every second one is a full turn to one side.

    Parameters
    ----------
    aircraft : with its autopilot; its flight is ended
    start : straight and level equilibrium
    bank : whose coordinated turn is omega_max [rad]
    response : of the heading rate to a reversal
    reversals, seed : how many are flown, and of their random numbers
    """
    rate = STANDARD_GRAVITY * math.tan(bank) / start.airspeed
    generator = np.random.default_rng(seed)
    flight = _Flight(aircraft, start)
    late = max(1, round(response.delay / TIME_STEP))
    duration = 0.5 * math.pi / rate + response.delay + response.lag
    found: list[tuple[float, float, float]] = []
    for number in range(reversals):
        full = number % 2 == 0
        for _ in range(_BEFORE):
            share = float(generator.choice([-1.0, 1.0]) if full else generator.uniform(-1.0, 1.0))
            flight.fly(share * rate, float(generator.uniform(*_HELD)) / rate)
        side = -math.copysign(1.0, share) if full else float(generator.choice([-1.0, 1.0]))
        under_way = flight.commands[-late:]
        course, speed, heading_rate = flight.course, flight.speed, flight.heading_rate
        flown = flight.fly(side * rate, duration)
        predicted = _predicted(response, [*under_way, side * rate], course, max(speed, start.airspeed), heading_rate, len(flown))
        change = 0.5 - 0.5 * side * heading_rate / rate
        if change > _LEAST_CHANGE:
            found.append((_deviation(flown, predicted, side) / change, side * share, speed))
    deviation, command_before, airspeed_before = max(found)
    return ReversalSearch(
        reversals=reversals,
        deviation=max(0.0, deviation),
        usual=max(0.0, float(np.quantile([entry[0] for entry in found], 0.99))),
        command_before=command_before,
        airspeed_before=airspeed_before,
    )


class _Flight:
    """An aircraft under way, and the heading-rate commands that it was given at each time step."""

    def __init__(self, aircraft: AutopilotedAircraft, start: Trim) -> None:
        aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
        self._aircraft, fdm = aircraft, aircraft.fdm
        self._north = fdm.node("velocities/v-north-fps").get_double_value
        self._east = fdm.node("velocities/v-east-fps").get_double_value
        self._rate = fdm.node(HEADING_RATE).get_double_value
        self.commands: list[float] = [0.0] * round(10.0 / TIME_STEP)

    @property
    def course(self) -> float:
        return math.atan2(self._east(), self._north())

    @property
    def speed(self) -> float:
        return math.hypot(self._north(), self._east()) * METRES_PER_FOOT

    @property
    def heading_rate(self) -> float:
        return self._rate()

    def fly(self, heading_rate: float, duration: float) -> Array:
        """Return the path from here [m], shape (steps, 2), under a command that is held for ``duration`` [s]."""
        self._aircraft.command_heading_rate(heading_rate)
        steps = max(1, round(duration / TIME_STEP))
        self.commands += [heading_rate] * steps
        velocity = np.empty((steps, 2))
        run = self._aircraft.run
        for i in range(steps):
            run()
            velocity[i] = self._north(), self._east()
        return np.asarray(np.cumsum(velocity, axis=0) * (TIME_STEP * METRES_PER_FOOT))


def _predicted(
    response: TurnReversalResponse, commands: list[float], course: float, speed: float, heading_rate: float, steps: int
) -> Array:
    """Return the path [m], shape (steps, 2), of a vehicle of that response; the last command is held on."""
    acting = np.concatenate([commands[:-1], np.full(steps, commands[-1])])[:steps]
    decay = math.exp(-TIME_STEP / response.lag)
    rates, rate = np.empty(steps), heading_rate
    for i, command in enumerate(acting.tolist()):
        rate = command + (rate - command) * decay
        rates[i] = rate
    courses = course + np.cumsum(rates) * TIME_STEP
    return np.asarray(np.cumsum(np.column_stack([np.cos(courses), np.sin(courses)]), axis=0) * speed * TIME_STEP)


def _deviation(flown: Array, predicted: Array, side: float) -> float:
    """Return the largest lack of distance from what is turned away from [m]."""
    heading = np.gradient(predicted, axis=0)
    course = np.arctan2(heading[:, 1], heading[:, 0])
    lack = predicted - flown
    away = course[:, None] + side * (0.5 * math.pi - _LEANING)
    return float(np.max(lack[:, :1] * np.cos(away) + lack[:, 1:] * np.sin(away)))
