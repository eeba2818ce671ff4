"""A search for the flight that comes closest to the vessel, within the declared ranges."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy.optimize import Bounds, differential_evolution
from scipy.stats import qmc

from common.run_layout import SUMMARY, WORST
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, StudySummary
from scenarios.engine.task import Row, Task
from scenarios.experiment.draws import speed_ratio_excess
from scenarios.experiment.scenario_file import scenario_file
from scenarios.schema.scenario import Scenario
from scenarios.studies.flight_study import FlightStudy
from scenarios.studies.study import study

UNFLOWN = 1e6
"""Clearance of a flight that has none, because it was not flown [m]: no optimum, and finite, as the search needs it."""

Array = npt.NDArray[np.float64]


@study("falsify")
class FalsificationStudy(FlightStudy):
    """Generations of flights, each from the worst of those before by differential evolution.

    Parameters
    ----------
    scenario, name : the scenario, and its name
    trials : the same by its name
    overrides : overrides that were applied, recorded in the manifest

    Raises
    ------
    InputError : as of ``FlightStudy``
    """

    def __init__(self, scenario: Scenario, name: str, trials: Mapping[str, Scenario], *, overrides: Sequence[str] = ()) -> None:
        flights = scenario.search.population * (scenario.search.generations + 1)
        searched = {trial: of.model_copy(update={"flights": flights}) for trial, of in trials.items()}
        super().__init__(scenario.model_copy(update={"flights": flights}), name, searched, overrides=overrides)
        self._search, self._seed = scenario.search, scenario.seed
        self._tasks: list[Task] = []

    def task(self, number: int) -> Task:
        """Return the task of a flight, at the point that the search gave it."""
        return self._tasks[number]

    def run(self, fly: Fly, run: RunDirectory, journal: Journal) -> None:
        """Have one generation flown after the other; keep the worst flights."""
        ((_, scenario),) = self.trials.items()
        dimension = len(scenario.draws)
        first: Array = qmc.Sobol(dimension, scramble=True, rng=self._seed).random(_power_of_two(self._search.population))

        def clearances(_: object, points: Iterable[Array]) -> list[float]:
            return self._clearances(points, fly, journal)

        differential_evolution(
            _not_called,
            Bounds(np.zeros(dimension), np.ones(dimension)),
            init=first[: self._search.population],
            maxiter=self._search.generations,
            mutation=self._search.mutation,
            recombination=self._search.recombination,
            rng=self._seed,
            # The search ends by its generations alone.
            tol=0.0,
            atol=-1.0,
            polish=False,
            updating="deferred",
            workers=clearances,
        )
        self.flights = dict.fromkeys(self.flights, len(self._tasks))
        self._keep_worst(fly, run, journal)

    def _clearances(self, points: Iterable[Array], fly: Fly, journal: Journal) -> list[float]:
        """Return how far from the keep-out area flights at these points stay at their closest [m].

        What leaves the declared range of speed ratios is not flown, and counts the worse the farther it does.
        """
        ((_, scenario),) = self.trials.items()
        first, chosen = len(self._tasks), [tuple(map(float, point)) for point in points]
        excesses = [speed_ratio_excess(scenario, point) for point in chosen]
        within = [point for point, excess in zip(chosen, excesses, strict=True) if not excess]
        self._tasks += [Task(number=first + i, point=point) for i, point in enumerate(within)]
        fly(self._tasks[first:])
        flown = (_clearance(row) for row in journal.rows(SUMMARY, first=first, below=len(self._tasks)))
        return [UNFLOWN * (1.0 + excess) if excess else next(flown) for excess in excesses]

    def _keep_worst(self, fly: Fly, run: RunDirectory, journal: Journal) -> None:
        """Write scenario files of the worst flights, and have those recorded that have no time history."""
        flown = [(_clearance(row), number, row) for number, row in journal.numbered(SUMMARY)]
        worst = sorted(flown, key=lambda entry: entry[:2])[: self._search.kept]
        ((trial, scenario),) = self.trials.items()
        experiment = self.experiments[trial]
        for rank, (clearance, number, row) in enumerate(worst, start=1):
            request = experiment.request(number, self._tasks[number].point)
            title = f"{scenario.title}: number {rank}, {clearance:.2f} m from the keep-out area"
            run.write_bytes(f"{WORST}/{rank:02d}_{row['flight_id']}.toml", scenario_file(request, title=title))
        fly(self.unrecorded([number for _, number, _ in worst], run, journal))

    def summary(self, journal: Journal) -> StudySummary:
        """Return what the search has found."""
        found = super().summary(journal)
        clearances = [(_clearance(row), row["flight_id"]) for row in journal.rows(SUMMARY)]
        if not clearances:
            return found
        least, flight_id = min(clearances)
        line = f"closest: {flight_id}, {least:.2f} m from the keep-out area; the worst are in {WORST}/, as scenarios to fly again"
        manifest = found.manifest | {"worst_flight": flight_id, "worst_clearance_m": least}
        return replace(found, lines=[*found.lines, line], manifest=manifest)


def _clearance(row: Row) -> float:
    """Return how far from the keep-out area a flight stayed at its closest [m]."""
    return float(row["min_distance_m"] - row["keepout_radius_m"]) if "min_distance_m" in row else UNFLOWN


def _power_of_two(least: int) -> int:
    return 1 << math.ceil(math.log2(least))


def _not_called(_: Array) -> float:
    """Stand for the figure that is searched: whole generations are flown at once, by ``workers``."""
    raise NotImplementedError
