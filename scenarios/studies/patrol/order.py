"""The order in which ships are served: the largest expected number of verdicts within the endurance."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from scipy.special import ndtr

from scenarios.studies.patrol.legs import Air, Mover, straight_leg

_SOONER = 1e-3
"""Verdicts that an end sooner by the whole endurance is worth: of orders with as many verdicts the quickest is taken."""

_GAIN = 0.02
"""Least expected number of verdicts for which a ship is called on [-]."""


class _State(NamedTuple):
    """A part of a patrol: place [m] and time [s] at its end, ships served, and the verdicts that are expected of them."""

    place: complex
    time: float
    served: int
    verdicts: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Prospect:
    """What is expected of serving ships.

    Attributes
    ----------
    ships : where they are and go
    service : how long each takes from the end of the way to her to the verdict [s]
    deviation : of that time, of each ship by herself; 0 where it is known [s]
    chance : of a verdict, of each ship [-]
    radius : from a ship at which the way to her ends [m]
    air : wind and airspeed
    endurance : when everything has to be done [s]
    """

    ships: Sequence[Mover]
    service: Sequence[float]
    deviation: float
    chance: Sequence[float]
    radius: float
    air: Air
    endurance: float

    def after(self, state: _State, ship: int) -> _State:
        """Return what one more ship makes of a part of a patrol; its end is infinite where she cannot be reached."""
        leg = straight_leg(state.place, state.time, self.ships[ship], self.radius, self.air)
        if leg is None:
            return _State(state.place, math.inf, state.served + 1, state.verdicts)
        ends, served = leg.ends + self.service[ship], state.served + 1
        return _State(self.ships[ship].at(ends), ends, served, state.verdicts + self.chance[ship] * self._in_time(ends, served))

    def _in_time(self, ends: float, served: int) -> float:
        """Return the probability that a number of services, expected to end at a time [s], do so within the endurance."""
        left, spread = self.endurance - ends, self.deviation * math.sqrt(served)
        return float(ndtr(left / spread)) if spread > 0.0 else float(left >= 0.0)

    def score(self, state: _State) -> float:
        """Return what a patrol is worth: its expected verdicts, and a little for an early end."""
        return state.verdicts - _SOONER * min(state.time / self.endurance, 10.0)


class Order(NamedTuple):
    """Ships in the order in which they are served, the verdicts expected, and when the last one is done [s]."""

    ships: tuple[int, ...]
    verdicts: float
    ends: float


def inserted_order(prospect: Prospect, start: complex, time: float, ships: Sequence[int]) -> Order:
    """Return an order by insertion and improvement, from a place at a time [m, s].

    From each ship as the first, the ship and the place in the order that gain most are inserted, until none gains; then parts of up
    to three ships are moved, and parts turned round, as long as the order gets better. The best of these orders is taken.
    """
    best = _judged(prospect, start, time, ())
    for first in ships:
        found = _improved(prospect, start, time, _filled(prospect, start, time, (first,), ships))
        best = _better(prospect, best, found)
    return best


def exact_order(prospect: Prospect, start: complex, time: float, ships: Sequence[int]) -> Order:
    """Return the best of all orders, of some ships or of all of them; the effort grows as the factorial of their number."""
    begin = _State(start, time, 0, 0.0)
    best: tuple[_State, tuple[int, ...]] = begin, ()

    def extend(state: _State, order: tuple[int, ...], left: frozenset[int]) -> None:
        nonlocal best
        if prospect.score(state) > prospect.score(best[0]):
            best = state, order
        # Not even with a verdict of each ship that is left, at once.
        if prospect.score(state) + sum(prospect.chance[ship] for ship in left) <= prospect.score(best[0]):
            return
        for ship in sorted(left):
            extend(prospect.after(state, ship), (*order, ship), left - {ship})

    extend(begin, (), frozenset(ships))
    return Order(best[1], best[0].verdicts, best[0].time)


def ends_of(prospect: Prospect, start: complex, time: float, ships: Sequence[int]) -> list[float]:
    """Return when each ship of an order is done [s]."""
    state, ends = _State(start, time, 0, 0.0), []
    for ship in ships:
        state = prospect.after(state, ship)
        ends.append(state.time)
    return ends


def _judged(prospect: Prospect, start: complex, time: float, ships: Sequence[int]) -> Order:
    state = _State(start, time, 0, 0.0)
    for ship in ships:
        state = prospect.after(state, ship)
    return Order(tuple(ships), state.verdicts, state.time)


def _better(prospect: Prospect, one: Order, other: Order) -> Order:
    """Return the better one of two orders, the first where they are alike."""
    return other if _score(prospect, other) > _score(prospect, one) + 1e-12 else one


def _score(prospect: Prospect, order: Order) -> float:
    return prospect.score(_State(0j, order.ends, len(order.ships), order.verdicts))


def _filled(prospect: Prospect, start: complex, time: float, order: tuple[int, ...], ships: Sequence[int]) -> Order:
    best = _judged(prospect, start, time, order)
    while left := [ship for ship in ships if ship not in best.ships]:
        tried = best
        for ship in left:
            for i in range(len(best.ships) + 1):
                tried = _better(prospect, tried, _judged(prospect, start, time, (*best.ships[:i], ship, *best.ships[i:])))
        if tried is best or tried.verdicts < best.verdicts + _GAIN:
            break
        best = tried
    return best


def _improved(prospect: Prospect, start: complex, time: float, order: Order) -> Order:
    while True:
        best = order
        for ships in _neighbours(order.ships):
            best = _better(prospect, best, _judged(prospect, start, time, ships))
        if best is order:
            return order
        order = best


def _neighbours(ships: tuple[int, ...]) -> list[tuple[int, ...]]:
    """Return the orders in which a part of up to three ships stands elsewhere, or a part is turned round."""
    count = len(ships)
    found = [(*ships[:i], *ships[i:j][::-1], *ships[j:]) for i in range(count) for j in range(i + 2, count + 1)]
    for size in (1, 2, 3):
        for i in range(count - size + 1):
            part, rest = ships[i : i + size], (*ships[:i], *ships[i + size :])
            found += [(*rest[:k], *part, *rest[k:]) for k in range(len(rest) + 1) if k != i]
    return found
