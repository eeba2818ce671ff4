"""A search for the flight that comes closest to the vessel, within the declared ranges, and its
results.
"""

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from common.errors import PluginError
from common.run_layout import DRAWS, SUMMARY, WORST
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, StudySummary
from scenarios.engine.task import Task
from scenarios.errors import InputError
from scenarios.experiment.requests import scenario_file
from scenarios.experiment.sampling import search_space
from scenarios.measures.columns import INPUT_COLUMNS, SEARCH_COLUMNS
from scenarios.scenario.scenario import Scenario
from scenarios.search.method import Array, SearchSettings, Space, methods_named, search_in_turns
from scenarios.studies.base import ChosenFlightsStudy, clearance, study

CONFIRMATION = "confirmation"
"""What stands for the method of a flight that repeats one of the worst with fresh noise."""

UNFLOWN = 1e6
"""Clearance of a flight that has none, because it was not flown [m]: no optimum, and finite, as the
search needs it.
"""

_SAME_POINT = 1e-9
"""Largest difference of a coordinate of one point that was worked out twice [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchedFlight:
    """A flight of a search.

    Attributes
    ----------
    number, flight_id : of the flight
    method : name of the method that proposed it, or ``CONFIRMATION``
    confirms : name of the flight that it repeats with new noise; empty for a flight of the search
        itself
    clearance : closest approach to the keep-out area [m]
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
        """Return whether its clearance is known; it is unknown if the flight could not be planned,
        or its process was lost.
        """
        return self.clearance < UNFLOWN

    def entry(self) -> dict[str, Any]:
        """Return its entry in the manifest."""
        return {"flight_id": self.flight_id, "method": self.method, "clearance_m": self.clearance}


@study("falsify")
class FalsificationStudy(ChosenFlightsStudy):
    """Batches of flights that search methods propose; the worst are repeated with other noise.

    Flights of the search are numbered from 0. Numbers above the largest possible number of the
    search belong to the confirmations, in the order of the flights that they repeat. A resumed run
    therefore finds each flight by its number.

    Parameters and ``InputError`` are the same as those of ``FlightStudy``.
    """

    def __init__(
        self,
        scenario: Scenario,
        name: str,
        trials: Mapping[str, Scenario],
        *,
        overrides: Sequence[str] = (),
    ) -> None:
        self._search, self._seed = scenario.search, scenario.seed
        numbers = self._search.flights_max * (1 + self._search.confirmations)
        super().__init__(scenario, name, trials, numbers=numbers, overrides=overrides)
        self._space = search_space(self._scenario)
        # Most numbers have no flight, and so no time history.
        self.histories *= 1 + self._search.confirmations
        self.tables[DRAWS] = INPUT_COLUMNS | SEARCH_COLUMNS | self.tables[DRAWS]
        self._proposed = 0
        self._plan(self._search.flights_max if self._search.time_s is None else 0)

    def _plan(self, searched: int) -> None:
        """Set the number of the search's flights, as far as it is known."""
        self.flights = {
            self._trial: searched + self._search.confirmations * min(self._search.kept, searched)
        }

    def run(self, fly: Fly, run: RunDirectory, journal: Journal) -> None:
        """Search; then keep the worst flights, and fly them again with fresh noise."""
        search, timer = self._search, _Timer(self._search.time_s, journal, self._search.flights_max)
        settings = SearchSettings(
            population=search.population,
            mutation=search.mutation,
            recombination=search.recombination,
            restarts=search.restarts,
        )

        def attempt(method: str, points: Array) -> Array:
            return self._clearances(method, points, fly, journal, timer)

        try:
            search_in_turns(
                methods_named(search.methods, self._space, settings, self._seed),
                self._space,
                attempt,
                population=search.population,
                turns=None if search.time_s else search.generations + 1,
                within_time=lambda: timer.left and self._has_room,
            )
        except PluginError as error:
            raise InputError(f"search.methods: {error}") from error
        if not self._tasks:
            raise self._without_flights()
        self.flights = {self._trial: len(self._tasks)}
        worst = worst_flights(searched_flights(journal), self._space, journal, search.kept)
        self._keep(worst, fly, run, journal)
        self._confirm(worst, fly, journal)

    def _without_flights(self) -> InputError:
        """Return the error to raise for a search that has nothing to fly."""
        if self._proposed:
            return InputError(
                f"none of the {self._proposed} points that the search proposed is within"
                " speed_ratio and following.vessel_acceleration_mps2, and none was flown: widen"
                " these, or change the draws"
            )
        return InputError(
            f"search.methods {list(self._search.methods)} proposed no flight (continuous draws:"
            f" {len(self._space.continuous)} of {self._space.dimension}, search.population:"
            f" {self._search.population}): add 'corners', which searches any draws"
        )

    @property
    def _has_room(self) -> bool:
        """Return whether there are numbers left for another batch of a search by time; a search by
        generations always has enough.
        """
        return (
            self._search.time_s is None
            or len(self._tasks) + self._search.population <= self._search.flights_max
        )

    def _clearances(
        self, method: str, points: Array, fly: Fly, journal: Journal, timer: "_Timer"
    ) -> Array:
        """Return the closest approaches of flights at these points to the keep-out area [m].

        Points outside of the declared ranges are not flown; their clearance is larger the farther
        outside they are.
        """
        chosen = [tuple(map(float, point)) for point in points]
        excesses = [self._space.beyond(np.array(point)) for point in chosen]
        within = [point for point, excess in zip(chosen, excesses, strict=True) if not excess]
        first, labels = len(self._tasks), (("search_method", method), ("confirms", ""))
        self._tasks += [
            Task(number=first + i, point=point, labels=labels) for i, point in enumerate(within)
        ]
        self._proposed += len(points)
        if self._search.time_s is not None:
            self._plan(len(self._tasks))
        batch = self._tasks[first:]
        # Confirmations, which have the numbers above, depend on no single flight.
        if not self.depended_on(journal, below=self._search.flights_max):
            timer.before(first, batch)
            fly(batch)
        for task in batch:
            self._check_point(task, journal)
        flown = (
            clearance(row, unmeasured=UNFLOWN)
            for row in journal.rows(SUMMARY, first=first, below=len(self._tasks))
        )
        return np.array(
            [UNFLOWN * (1.0 + excess) if excess else next(flown) for excess in excesses]
        )

    @staticmethod
    def _check_point(task: Task, journal: Journal) -> None:
        before = journal.task(task.number).point
        if len(before) != len(task.point) or not np.allclose(
            before, task.point, rtol=0.0, atol=_SAME_POINT
        ):
            raise InputError(
                f"flight {task.number} of the run to be resumed was not flown at the point that"
                " this search proposes: start a new run in another --out"
            )

    def _keep(
        self, worst: Sequence[SearchedFlight], fly: Fly, run: RunDirectory, journal: Journal
    ) -> None:
        """Write scenario files of the worst flights, and record those that have no time history."""
        experiment = self.experiments[self._trial]
        for path in (run.path / WORST).glob("*.toml"):
            # In a resumed run, a flight that was among the worst may no longer be.
            path.unlink()
        for rank, flight in enumerate(worst, start=1):
            request = experiment.request(flight.number, self._tasks[flight.number].point)
            title = (
                f"{self._scenario.title}: number {rank}, {flight.clearance:.2f} m from the"
                " keep-out area"
            )
            run.write_bytes(
                f"{WORST}/{rank:02d}_{flight.flight_id}.toml", scenario_file(request, title=title)
            )
        fly(self.unrecorded([flight.number for flight in worst], run, journal))

    def _confirm(self, worst: Sequence[SearchedFlight], fly: Fly, journal: Journal) -> None:
        """Fly the worst flights again with fresh noise."""
        repeats, first = self._search.confirmations, self._search.flights_max
        confirming = [
            Task(
                number=(number := first + flight.number * repeats + i),
                point=self._tasks[flight.number].point,
                seed=int(np.random.SeedSequence([self._seed, number]).generate_state(1)[0]),
                labels=(("search_method", CONFIRMATION), ("confirms", flight.flight_id)),
            )
            for flight in worst
            for i in range(repeats)
        ]
        # Earlier sessions may have repeated flights that are no longer among the worst.
        numbers = {task.number for task in confirming} | {
            number for number in journal.done() if number >= first
        }
        self.flights = {self._trial: len(self._tasks) + len(numbers)}
        fly(confirming)

    def summary(self, journal: Journal) -> StudySummary:
        """Return the result of the search."""
        found = super().summary(journal)
        flights = searched_flights(journal)
        if not flights:
            return found
        worst = worst_flights(flights, self._space, journal, self._search.kept)
        search = search_manifest(flights, worst) | {"proposed": self._proposed}
        manifest: dict[str, object] = {"search": search}
        if least := nearest(flights):
            manifest |= {"worst_flight": least.flight_id, "worst_clearance_m": least.clearance}
        return replace(
            found, lines=[*found.lines, *search_lines(search)], manifest=found.manifest | manifest
        )


class _Timer:
    """The time limit of a search. Its time begins with the first batch that is not completely in
    the journal.

    Parameters
    ----------
    limit : longest time; None for no limit [s]
    journal : journal with the flights of earlier sessions of the run
    flights_max : upper limit of the numbers of the search's flights, exclusive
    """

    def __init__(self, limit: float | None, journal: Journal, flights_max: int) -> None:
        self._limit, self._done = limit, journal.done()
        self._last = max((number for number in self._done if number < flights_max), default=-1)
        self._began: float | None = None

    def before(self, first: int, tasks: Sequence[Task]) -> None:
        """Set the tasks that are about to be flown, from number ``first`` on; there are none if no
        point can be flown.
        """
        if self._began is None and (
            first > self._last or any(task.number not in self._done for task in tasks)
        ):
            self._began = time.monotonic()

    @property
    def left(self) -> bool:
        """Return whether there is time left."""
        return (
            self._limit is None
            or self._began is None
            or time.monotonic() - self._began < self._limit
        )


def nearest(flights: Sequence[SearchedFlight]) -> SearchedFlight | None:
    """Return the flight that came closest; None if no flight was measured."""
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
    """Return the flights of a search that came closest and differ from each other. If too few
    differ, others are added in the order of their clearance.
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
    """Return the manifest's entry on a search: its methods, every violation, and the worst flights
    with their repeats.
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
    """Yield the results of a search in lines of text, from its entry in the manifest."""
    for name, of in found["methods"].items():
        flights = f"{of['flights']} flight{'s' * (of['flights'] != 1)}"
        flights += (
            f" ({of['measured']} could be flown and measured)"
            if 0 < of["measured"] < of["flights"]
            else ""
        )
        yield (
            f"  {name or 'no method'}: {flights}, {of['violations']} violated,"
            f" {_outside(of['worst_clearance_m'])}"
        )
    for rank, flight in enumerate(found["worst"][:1], start=1):
        repeats = (
            f"; with fresh noise {flight['confirmations_violating']} of {flight['confirmations']}"
            f" violated, {_outside(flight['confirmations_nearest_m'])}"
            if flight["confirmations"]
            else ""
        )
        yield (
            f"number {rank}: {flight['flight_id']} by {flight['method']},"
            f" {flight['clearance_m']:.2f} m from the keep-out area{repeats}; the worst are in"
            f" {WORST}/, as scenario files"
        )
