"""What a search has found, from the results of its flights."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from common.run_layout import DRAWS, SUMMARY, WORST
from scenarios.engine.journal import Journal
from scenarios.search.method import Space
from scenarios.studies.chosen_flights import clearance

CONFIRMATION = "confirmation"
"""What stands for the method of a flight that repeats one of the worst with fresh noise."""

UNFLOWN = 1e6
"""Clearance of a flight that has none, because it was not flown [m]: no optimum, and finite, as the
search needs it.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchedFlight:
    """A flight of a search.

    Attributes
    ----------
    number, flight_id : of the flight
    method : that proposed it, or ``CONFIRMATION``
    confirms : flight that it repeats with fresh noise; empty for a flight of the search itself
    clearance : how far from the keep-out area it stayed at its closest [m]
    violates : whether it violated the keep-out area
    """

    number: int
    flight_id: str
    method: str
    confirms: str
    clearance: float
    violates: bool

    @property
    def measured(self) -> bool:
        """Return whether its clearance is known: it is of no flight that could not be planned, or
        was lost.
        """
        return self.clearance < UNFLOWN

    def entry(self) -> dict[str, Any]:
        """Return its entry in the manifest."""
        return {"flight_id": self.flight_id, "method": self.method, "clearance_m": self.clearance}


def nearest(flights: Sequence[SearchedFlight]) -> SearchedFlight | None:
    """Return the flight that came closest, or none where none was measured."""
    return min(
        (flight for flight in flights if flight.measured),
        key=lambda flight: flight.clearance,
        default=None,
    )


def searched_flights(journal: Journal) -> list[SearchedFlight]:
    """Return the flights that are done, by their numbers."""
    return [
        SearchedFlight(
            number=number,
            flight_id=row["flight_id"],
            method=(drawn := next(journal.rows(DRAWS, first=number, below=number + 1), {})).get(
                "search_method", ""
            ),
            confirms=drawn.get("confirms", ""),
            clearance=clearance(row, unmeasured=UNFLOWN),
            violates=bool(row.get("keepout_violations", 0)),
        )
        for number, row in journal.numbered(SUMMARY)
    ]


def worst_flights(
    flights: Sequence[SearchedFlight], space: Space, journal: Journal, kept: int
) -> list[SearchedFlight]:
    """Return the flights of a search that came closest, no two of them alike; the rest by clearance
    where too few differ.
    """
    searched = [flight for flight in flights if flight.measured and not flight.confirms]
    order = sorted(searched, key=lambda flight: (flight.clearance, flight.number))
    points: dict[int, np.ndarray] = {}
    chosen: list[SearchedFlight] = []
    for flight in order:
        if len(chosen) == kept:
            break
        point = np.array(journal.task(flight.number).point)
        if not any(space.alike(point, points[other.number]) for other in chosen):
            points[flight.number] = point
            chosen.append(flight)
    chosen += [flight for flight in order if flight.number not in points][: kept - len(chosen)]
    return sorted(chosen, key=lambda flight: (flight.clearance, flight.number))


def search_manifest(
    flights: Sequence[SearchedFlight], worst: Sequence[SearchedFlight]
) -> dict[str, Any]:
    """Return the entry of the manifest on a search: its methods, every violation, and the worst
    flights confirmed.
    """
    methods = dict.fromkeys(flight.method for flight in flights)
    return {
        "methods": {
            name: _of_method([flight for flight in flights if flight.method == name])
            for name in methods
        },
        "violations": [
            flight.entry()
            for flight in sorted(flights, key=lambda flight: flight.clearance)
            if flight.violates
        ],
        "worst": [
            flight.entry() | _confirmed([of for of in flights if of.confirms == flight.flight_id])
            for flight in worst
        ],
    }


def _of_method(flights: Sequence[SearchedFlight]) -> dict[str, Any]:
    return {
        "flights": len(flights),
        "measured": sum(flight.measured for flight in flights),
        "violations": sum(flight.violates for flight in flights),
        "worst_clearance_m": _least(flights),
    }


def _confirmed(repeats: Sequence[SearchedFlight]) -> dict[str, Any]:
    return {
        "confirmations": len(repeats),
        "confirmations_violating": sum(flight.violates for flight in repeats),
        "confirmations_nearest_m": _least(repeats),
    }


def _least(flights: Sequence[SearchedFlight]) -> float | None:
    return found.clearance if (found := nearest(flights)) else None


def _outside(least: float | None) -> str:
    return "none measured" if least is None else f"nearest {least:.2f} m outside of r_min"


def search_lines(found: dict[str, Any]) -> Iterator[str]:
    """Yield what a search has found in lines of text, from its entry in the manifest."""
    for name, of in found["methods"].items():
        flights = f"{of['flights']} flight{'s' * (of['flights'] != 1)}"
        flights += (
            f" ({of['measured']} could be flown and measured)"
            if 0 < of["measured"] < of["flights"]
            else ""
        )
        yield f"  {name or 'no method'}: {flights}, {of['violations']} violated, {_outside(of['worst_clearance_m'])}"
    for rank, flight in enumerate(found["worst"][:1], start=1):
        repeats = (
            f"; with fresh noise {flight['confirmations_violating']} of {flight['confirmations']} violated,"
            f" {_outside(flight['confirmations_nearest_m'])}"
            if flight["confirmations"]
            else ""
        )
        yield (
            f"number {rank}: {flight['flight_id']} by {flight['method']}, {flight['clearance_m']:.2f} m from the keep-out"
            f" area{repeats}; the worst are in {WORST}/, as scenario files"
        )
