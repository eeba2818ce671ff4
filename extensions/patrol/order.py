"""The order in which ships are served: the largest expected number of verdicts within the
endurance.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from scipy.special import ndtr

from extensions.patrol.route import Air, Mover, straight_leg

_SOONER = 1e-3
"""Value, in verdicts, of an end that is earlier by the whole endurance: among orders with equal
verdicts the fastest is chosen.
"""

_LATEST = 10.0
"""Largest end that counts, over the endurance: a ship out of reach has an infinite one."""

EXACT_MAX = 8
"""Largest number of ships for which every order is tried: it takes half a second at most, and for
fewer ships less than the insertion.
"""

_GAIN = 0.02
"""Least expected number of verdicts for which a ship is inserted [-]."""


class _State(NamedTuple):
    """A part of a patrol: place [m] and time [s] at its end, ships served, and the number of
    verdicts expected from them.
    """

    place: complex
    time: float
    served: int
    verdicts: float


class Order(NamedTuple):
    """Ships in the order in which they are served, the verdicts expected, and when the last one is
    done [s].
    """

    ships: tuple[int, ...]
    verdicts: float
    ends: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Prospect:
    """The expectations for serving ships.

    Attributes
    ----------
    ships : their places and motion
    service : time for each ship, from the end of the way to it until the verdict [s]
    deviation : standard deviation of that time for each ship; 0 where it is known [s]
    chance : probability of a verdict on each ship [-]
    radius : distance from a ship at which the way to it ends [m]
    air : wind and airspeed
    endurance : time by which the patrol has to end [s]
    """

    ships: Sequence[Mover]
    service: Sequence[float]
    deviation: float
    chance: Sequence[float]
    radius: float
    air: Air
    endurance: float

    def after(self, state: _State, ship: int) -> _State:
        """Return a part of a patrol with one more ship; its end is infinite if the ship cannot be
        reached.
        """
        leg = straight_leg(state.place, state.time, self.ships[ship], self.radius, self.air)
        if leg is None:
            return _State(state.place, math.inf, state.served + 1, state.verdicts)
        ends, served = leg.ends + self.service[ship], state.served + 1
        return _State(
            self.ships[ship].at(ends),
            ends,
            served,
            state.verdicts + self.chance[ship] * self._in_time(ends, served),
        )

    def _in_time(self, ends: float, served: int) -> float:
        """Return the probability that a number of services, expected to end at a time [s], do so
        within the endurance.
        """
        left, spread = self.endurance - ends, self.deviation * math.sqrt(served)
        return float(ndtr(left / spread)) if spread > 0.0 else float(left >= 0.0)

    def judged(self, start: complex, time: float, ships: Sequence[int]) -> Order:
        """Return the result of serving ships in an order, from a place at a time [m, s]."""
        state = _State(start, time, 0, 0.0)
        for ship in ships:
            state = self.after(state, ship)
        return Order(tuple(ships), state.verdicts, state.time)

    def score_of(self, order: Order) -> float:
        """Return the value of an order: its expected verdicts, and a little for an early end."""
        return self.score(order.verdicts, order.ends)

    def score(self, verdicts: float, ends: float) -> float:
        """Return the value of expected verdicts and an end [s]."""
        return verdicts - _SOONER * min(ends / self.endurance, _LATEST)


def best_order(prospect: Prospect, start: complex, time: float, ships: Sequence[int]) -> Order:
    """Return the best of all orders from a place at a time [m, s]; for many ships, a good order by
    insertion.
    """
    return (exact_order if len(ships) <= EXACT_MAX else inserted_order)(
        prospect, start, time, ships
    )


def inserted_order(prospect: Prospect, start: complex, time: float, ships: Sequence[int]) -> Order:
    """Return an order by insertion and improvement, from a place at a time [m, s].

    Each ship is tried as the first one. The ship that gains most is inserted at its best position,
    until no ship gains. Then parts of up to three ships are moved, parts are reversed, and ships
    are exchanged for others, as long as the order improves. The result is the best of these orders.
    """
    best = prospect.judged(start, time, ())
    for first in ships:
        found = prospect.judged(start, time, (first,))
        while True:
            filled = _improved(
                prospect, start, time, _filled(prospect, start, time, found, ships), ships
            )
            if filled == found:
                break
            found = filled
        best = _better(prospect, best, found)
    return best


def exact_order(prospect: Prospect, start: complex, time: float, ships: Sequence[int]) -> Order:
    """Return the best of all orders, of some ships or of all of them; the effort grows as the
    factorial of their number.
    """
    best = prospect.judged(start, time, ())

    def extend(state: _State, order: tuple[int, ...], left: frozenset[int]) -> None:
        nonlocal best
        score = prospect.score(state.verdicts, state.time)
        if score > prospect.score_of(best):
            best = Order(order, state.verdicts, state.time)
        # No improvement, even with an immediate verdict on each remaining ship.
        if score + sum(prospect.chance[ship] for ship in left) <= prospect.score_of(best):
            return
        for ship in sorted(left):
            extend(prospect.after(state, ship), (*order, ship), left - {ship})

    extend(_State(start, time, 0, 0.0), (), frozenset(ships))
    return best


def ends_of(prospect: Prospect, start: complex, time: float, ships: Sequence[int]) -> list[float]:
    """Return the time at which each ship of an order is done [s]."""
    state, ends = _State(start, time, 0, 0.0), []
    for ship in ships:
        state = prospect.after(state, ship)
        ends.append(state.time)
    return ends


def _better(prospect: Prospect, one: Order, other: Order) -> Order:
    """Return the better one of two orders; the first if they are equally good."""
    return other if prospect.score_of(other) > prospect.score_of(one) + 1e-12 else one


def _filled(
    prospect: Prospect, start: complex, time: float, best: Order, ships: Sequence[int]
) -> Order:
    while True:
        tried = best
        for ship in ships:
            if ship not in best.ships:
                for i in range(len(best.ships) + 1):
                    tried = _better(
                        prospect,
                        tried,
                        prospect.judged(start, time, (*best.ships[:i], ship, *best.ships[i:])),
                    )
        if tried.verdicts < best.verdicts + _GAIN:
            return best
        best = tried


def _improved(
    prospect: Prospect, start: complex, time: float, order: Order, ships: Sequence[int]
) -> Order:
    while True:
        best = order
        for neighbour in _neighbours(order.ships, ships):
            best = _better(prospect, best, prospect.judged(start, time, neighbour))
        if best is order:
            return order
        order = best


def _neighbours(order: tuple[int, ...], ships: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """Yield the orders with a part reversed, with up to three ships at another position, or with
    one ship exchanged for one left out.
    """
    count = len(order)
    for i in range(count):
        for j in range(i + 2, count + 1):
            yield (*order[:i], *order[i:j][::-1], *order[j:])
        for ship in ships:
            if ship not in order:
                yield (*order[:i], ship, *order[i + 1 :])
    for size in (1, 2, 3):
        for i in range(count - size + 1):
            part, rest = order[i : i + size], (*order[:i], *order[i + size :])
            for k in range(len(rest) + 1):
                if k != i:
                    yield (*rest[:k], *part, *rest[k:])
