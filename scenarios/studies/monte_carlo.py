"""Monte Carlo studies: probabilities, quantiles, sensitivities and their intervals."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from common.run_layout import DRAWS, SUMMARY
from common.verdict import Bound, Counts
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, Progress, StudySummary
from scenarios.engine.task import Task
from scenarios.errors import InputError
from scenarios.experiment.sampling import SamplingDesign, flights_per_sample, is_random_sample
from scenarios.scenario.scenario import Scenario
from scenarios.statistics.estimates import (
    COLUMNS,
    count_violations,
    interval_confidence,
    looks,
    pessimistic_share,
    study_statistics,
    tight_enough,
)
from scenarios.studies.base import FlightStudy, frame, study


class MonteCarloStudy(FlightStudy):
    """Flights sampled from declared distributions, until all are flown or every interval is as
    narrow as the scenario demands.

    Parameters
    ----------
    scenario, name : the scenario, and its name
    trials : the same by its name
    overrides : overrides that were applied, recorded in the manifest

    Raises
    ------
    InputError : same as ``FlightStudy``; a stopping rule in a study of several points, or flights
        that are not a random sample
    """

    def __init__(
        self,
        scenario: Scenario,
        name: str,
        trials: Mapping[str, Scenario],
        *,
        overrides: Sequence[str] = (),
    ) -> None:
        super().__init__(scenario, name, trials, overrides=overrides)
        self._scenario = scenario
        ((_, self._experiment),) = self.experiments.items()
        if scenario.statistics.stops and self.planned > scenario.flights:
            raise InputError(
                "statistics stops the study, which has several points (sweep, cases, fidelity);"
                " leave out statistics.violation_upper and statistics.distance_quantile_width_m,"
                " or give each point a run of its own"
            )
        if scenario.flights > 1 and not (scenario.several_points or is_random_sample(scenario)):
            raise InputError(
                f"flights is {scenario.flights}, and nothing random differs between them: seeds,"
                " start and choices are given, so some are copies, from which no probability"
                " follows; leave out flight_seed, or set study to 'flights'"
            )
        self._looks, self._stopped = 0, False

    def task(self, number: int) -> Task:
        """Return the task of a flight, at its point."""
        point, index = self._experiment.point_of(number)
        return Task(number=number, point=self._design_with(point.stream).at(index))

    def _design_with(self, stream: int) -> SamplingDesign:
        """Return the samples for points of a sweep with the random numbers ``stream``."""
        scenario, seed = self._scenario, self._scenario.seed
        if stream:
            seed = int(np.random.SeedSequence([seed, stream]).generate_state(1)[0])
        return SamplingDesign(
            scenario.sampling, dimension=len(scenario.draws), flights=scenario.flights, seed=seed
        )

    def run(self, fly: Fly, run: RunDirectory, journal: Journal) -> None:
        """Fly from look to look, until the intervals of a look are as narrow as demanded; then fly
        the comparisons.

        A resumed run does not stop before the flights that it already has: the repetition of a lost
        flight might otherwise stop it earlier.
        """
        first, study = 0, self.planned
        stops = self._scenario.statistics.stops
        flown = (
            max((number for number, _ in journal.numbered(SUMMARY, below=study)), default=-1)
            if stops
            else -1
        )
        for flights in looks(self.planned) if stops else [self.planned]:
            self._looks += 1
            fly(self.task(number) for number in range(first, flights))
            first = flights
            if stops and flights > flown and self._tight(journal, flights):
                self._stopped = flights < self.planned
                self.flights = dict.fromkeys(self.flights, flights)
                break
        fly(self.task(number) for number in range(study, self._experiment.flights))
        fly(self.representative_flights(run, journal))

    def _tight(self, journal: Journal, flights: int) -> bool:
        s = self._scenario.statistics
        rows = frame(journal.rows(SUMMARY, below=flights), COLUMNS)
        return tight_enough(
            rows,
            look_number=self._looks,
            confidence=s.confidence,
            violation_upper=s.violation_upper,
            distance_quantile_width_m=s.distance_quantile_width_m,
            distance_quantile=s.distance_quantile,
        )

    def postprocess(self, run: RunDirectory, journal: Journal, progress: Progress) -> None:
        """Write ``statistics.json``."""
        super().postprocess(run, journal, progress)
        progress("estimating", self.planned, self.planned)
        statistics = study_statistics(
            frame(journal.rows(SUMMARY), COLUMNS),
            frame(journal.rows(DRAWS), ("flight_id", *self._experiment.keys)),
            confidence=self._scenario.statistics.confidence,
            seed=self._scenario.seed,
            look_number=self._look_number,
            per_sample=flights_per_sample(self._scenario),
        )
        run.write_json(run.statistics, statistics)

    @property
    def _look_number(self) -> int | None:
        """Number of the look of the intervals, or of the first look before any was taken; None for
        a study without looks.
        """
        return max(1, self._looks) if self._scenario.statistics.stops else None

    def bound(self, _counts: Counts, _samples: int, journal: Journal) -> Bound:
        """Return the bound of ``statistics.json`` on the probability of a keep-out violation."""
        confidence = self._scenario.statistics.confidence
        found = count_violations(frame(journal.rows(SUMMARY), COLUMNS))
        level, per_sample = (
            interval_confidence(confidence, self._look_number),
            flights_per_sample(self._scenario),
        )
        return Bound(
            upper=pessimistic_share(found, level, per_sample=per_sample)["upper"],
            confidence=confidence,
            flights=found.flights,
            violated=found.events,
            unknown=found.events_at_most - found.events,
            samples=found.flights // per_sample,
        )

    def summary(self, journal: Journal) -> StudySummary:
        """Return the result of the flights, and whether the study stopped by itself."""
        found = super().summary(journal)
        if not self._stopped:
            return found
        demanded = self._scenario.flights
        line = (
            f"stopped after {self.planned} of {demanded} flights: the intervals are as narrow as"
            " demanded"
        )
        return replace(found, lines=[*found.lines, line])


@study("monte_carlo")
def monte_carlo_study(
    scenario: Scenario, name: str, trials: Mapping[str, Scenario], *, overrides: Sequence[str] = ()
) -> FlightStudy:
    """Return the study by the scenario's method; parameters and errors are those of
    ``MonteCarloStudy``.
    """
    if scenario.method == "subset":
        from scenarios.studies.subset import SubsetStudy

        return SubsetStudy(scenario, name, trials, overrides=overrides)
    return MonteCarloStudy(scenario, name, trials, overrides=overrides)
