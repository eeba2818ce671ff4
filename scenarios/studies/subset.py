"""Subset simulation: the probability of a keep-out violation where hardly any random flight has
one.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from common.intervals import upper_bound
from common.run_layout import SUMMARY
from gnc.errors import InfeasibleError
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, Progress, StudySummary
from scenarios.engine.task import Task
from scenarios.errors import InputError
from scenarios.experiment.draws import has_speed_ratio, value_at, values_at
from scenarios.scenario.files import with_values
from scenarios.scenario.scenario import Scenario
from scenarios.statistics.estimates import COLUMNS, count_violations
from scenarios.statistics.subset_simulation import (
    Array,
    Point,
    RareProbability,
    Simulating,
    Simulation,
    SubsetSimulation,
    input_shifts,
    near_event,
    pessimistic_upper,
    rare_probability,
    subset_statistics,
)
from scenarios.studies.base import ChosenFlightsStudy, clearance, frame


class SubsetStudy(ChosenFlightsStudy):
    """Repeated subset simulations of the distance kept beyond r_min. They run in parallel: each
    wave of all of them is flown at once.

    Points whose speed ratio leaves the declared range are not flown: the distribution is the
    declared one within that range, as in the plain study, which samples such flights again. A
    flight without a measurement passes no threshold.

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
        super().__init__(
            scenario, name, trials, numbers=scenario.subset.flights_max, overrides=overrides
        )
        self._statistics = scenario.statistics
        self._simulations: list[Simulation] = []

    def run(self, fly: Fly, run: RunDirectory, journal: Journal) -> None:
        """Fly wave after wave, until every simulation has ended."""
        running = self._begun()
        waiting = {repeat: next(simulating) for repeat, simulating in running.items()}
        ended: dict[int, Simulation] = {}
        while waiting:
            values = self._clearances(
                [point for points in waiting.values() for point in points], fly, journal
            )
            ends = np.cumsum([len(points) for points in waiting.values()])
            parts = dict(zip(waiting, np.split(values, ends[:-1]), strict=True))
            waiting = {}
            for repeat, part in parts.items():
                try:
                    waiting[repeat] = running[repeat].send(part)
                except StopIteration as end:
                    ended[repeat] = end.value
        self._simulations = [ended[repeat] for repeat in sorted(ended)]
        self.flights = dict.fromkeys(self.flights, len(self._tasks))
        fly(self.representative_flights(run, journal))

    def _begun(self) -> dict[int, Simulating]:
        scenario = self._scenario
        settings = scenario.subset
        simulation = SubsetSimulation(
            dimension=len(scenario.draws),
            noise=scenario.flight_seed is None
            and all(draw.key != "flight_seed" for draw in scenario.draws),
            flights=settings.flights_per_level,
            conditional_probability=settings.conditional_probability,
            levels_max=settings.levels_max,
            allowed=self._allowed,
            seeded=self._seeded,
        )
        seeds = np.random.SeedSequence(scenario.seed).spawn(settings.repeats)
        return {
            repeat: simulation.run(np.random.default_rng(seed)) for repeat, seed in enumerate(seeds)
        }

    def _allowed(self, inputs: Array) -> bool:
        """Return whether the plain study would fly at these inputs instead of sampling again.

        It also flies if values contradict each other, or if the vessel exceeds the declared limits.
        If such a flight cannot be planned, it has no measurement and its end is unknown.
        """
        try:
            return has_speed_ratio(
                with_values(self._scenario, values_at(self._scenario.draws, inputs.tolist()))
            )
        except (InputError, InfeasibleError):
            return True

    def _seeded(self, inputs: Array) -> bool:
        """Return whether a flight depends on its seed: turbulence, exhaust and payload cannot have
        blended noise.
        """
        drawn = values_at(self._scenario.draws, inputs.tolist())
        shaken = drawn.get("turbulence.level", self._scenario.turbulence.level) != "none"
        return (
            shaken
            or bool(self._scenario.payload.instruments)
            or any(key.startswith("payload.") for key in drawn)
        )

    def _clearances(self, points: Sequence[Point], fly: Fly, journal: Journal) -> Array:
        """Return the closest approaches of flights at these points to the keep-out area [m];
        infinite if not measured.
        """
        first = len(self._tasks)
        self._tasks += [Task(number=first + i, point=point) for i, point in enumerate(points)]
        if not self.depended_on(journal, below=self._scenario.subset.flights_max):
            fly(self._tasks[first:])
        values = np.full(len(points), np.inf)
        for number, row in journal.numbered(SUMMARY, first=first, below=len(self._tasks)):
            values[number - first] = clearance(row, unmeasured=np.inf)
        return values

    def postprocess(self, run: RunDirectory, journal: Journal, progress: Progress) -> None:
        """Write ``statistics.json``."""
        progress("estimating", self.planned, self.planned)
        first = np.concatenate([simulation.levels[0].points for simulation in self._simulations])
        near = np.concatenate(
            [
                simulation.levels[-1].points[chosen]
                for simulation, chosen in near_event(self._simulations)
            ]
        )
        shifts = input_shifts(self._values(first), self._values(near), (first, near))
        rows = frame(journal.rows(SUMMARY), COLUMNS)
        run.write_json(
            run.statistics,
            subset_statistics(
                rows, self._simulations, shifts, confidence=self._statistics.confidence
            ),
        )

    def _values(self, points: Array) -> pd.DataFrame:
        """Return the values of the random variables at points of the unit cube."""
        return pd.DataFrame(
            {
                draw.key: [value_at(draw, at) for at in points[:, i]]
                for i, draw in enumerate(self._scenario.draws)
            }
        )

    def summary(self, journal: Journal) -> StudySummary:
        """Return the result of the flights, and the probability if every simulation has ended."""
        found = super().summary(journal)
        if not self._simulations:
            return found
        probability = rare_probability(self._simulations, self._statistics.confidence)
        return replace(
            found,
            lines=[*found.lines, *self._first_lines(journal, probability), self._line(probability)],
        )

    def _first_lines(self, journal: Journal, found: RareProbability) -> list[str]:
        """Return, for the first levels, which are a plain sample, the number of points that were
        sampled again and of flights with an unknown end.
        """
        first = [simulation.levels[0] for simulation in self._simulations]
        flights, outside = (
            sum(len(level.values) for level in first),
            sum(level.counts.outside for level in first),
        )
        lines = []
        if outside:
            lines.append(
                f"{outside} of {flights + outside} points of the first levels were beyond"
                " speed_ratio and sampled again"
            )
        plain = count_violations(frame(journal.rows(SUMMARY, below=flights), COLUMNS))
        alone = upper_bound(plain.events_at_most, plain.flights, self._statistics.confidence)
        if alone < found.upper:
            lines.append(
                f"the first levels alone, a plain sample of {flights} flights, bound the"
                f" probability below by {alone:.2g}"
            )
        if unknown := plain.events_at_most - plain.events:
            upper = pessimistic_upper(
                self._simulations, found, unknown, flights, self._statistics.confidence
            )
            lines.append(
                f"of {flights} flights of the first levels {unknown}"
                f" {'is' if unknown == 1 else 'are'} of unknown end; if each were a violation,"
                f" the probability below would be at most {upper:.2g}"
            )
        return lines

    def _line(self, found: RareProbability) -> str:
        sure, repeats = (
            f"{100.0 * self._statistics.confidence:g} % confidence",
            len(self._simulations),
        )
        if not found.reached:
            return (
                f"none of {repeats} subset simulations reached a keep-out violation: its"
                f" probability in a flight is at most {found.upper:.2g} with {sure}, if chains"
                " find the way to it"
            )
        some = (
            ""
            if found.reached == repeats
            else f"; {repeats - found.reached} of {repeats} simulations reached none"
        )
        return (
            f"probability of a keep-out violation in a flight: {found.estimate:.2g},"
            f" {found.low:.2g} to {found.high:.2g} and at most {found.upper:.2g} with {sure}, by"
            f" {repeats} subset simulations{some}"
        )
