"""Flights of one scenario, or of a list of trials, as a study."""

from array import array
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from aircraft.spec import AircraftError
from common.columns import Declared, Table, described
from common.intervals import CONFIDENCE
from common.physics import bank_for_heading_rate
from common.provenance import without_folders
from common.run_layout import (
    COMPARISON,
    CROSSINGS,
    DERIVED,
    DRAWS,
    FLIGHTS,
    INTERVENTIONS,
    OVERRIDES,
    SULPHUR,
    SULPHUR_TABLE,
    SUMMARY,
    time_history_path,
)
from common.text import from_json_cell
from common.verdict import Bound, Counts, RunVerdict
from gnc.mission.mission import Mode
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, Progress, StudySummary, write_columns, write_tables
from scenarios.engine.task import Row, Task
from scenarios.errors import InputError
from scenarios.experiment.random_sample import (
    flights_per_sample,
    is_random_sample,
    random_numbers_of_points,
)
from scenarios.experiment.requests import Experiment
from scenarios.flight.time_history import UNFINISHED
from scenarios.flight_runner import FlightWork, history_columns
from scenarios.instruments.instrument import declarations
from scenarios.measures.columns import (
    ANY_KEY,
    CROSSING_COLUMNS,
    DERIVED_COLUMNS,
    FINDING_COLUMNS,
    FLIGHT_COLUMNS,
    INPUT_COLUMNS,
    INTERVENTION_COLUMNS,
    SUMMARY_COLUMNS,
)
from scenarios.measures.verdict import Judge, Tally, bound_of
from scenarios.planning.limits import omega_max
from scenarios.planning.scaling import scaled, scaled_keys
from scenarios.planning.spreads import predicted_spreads
from scenarios.planning.theory.speed_ratio import theory_over_speed_ratio
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.experiment import STUDY, TrialList
from scenarios.scenario.sections.flight import CriteriaConfig
from scenarios.statistics.sulphur import COLUMNS as SULPHUR_COLUMNS
from scenarios.statistics.sulphur import sulphur_statistics
from scenarios.studies.checks import check_flights, check_without_design, plugins_explained
from scenarios.studies.manifest import (
    config_hash,
    flown_config,
    initial_manifest,
    parameters,
    plugins,
    unused_parameters,
    vessel_files,
    write_logo,
)
from scenarios.studies.rows import frame
from scenarios.studies.study import study
from scenarios.studies.summary import (
    POINTS_OF_SWEEP,
    FlightNotes,
    bound_line,
    comparison_lines,
    exit_line,
    premise_lines,
    trial_line,
    unexplained_lines,
)
from scenarios.vehicles.vehicle_setup import aircraft_setup, design_of, kinematic_setup, spec_of


@study("flights")
class FlightStudy:
    """Flights of one scenario, or of several trials one after the other.

    Parameters
    ----------
    scenario, name : the scenario or the list of trials, and its name
    trials : the scenarios to fly, by name
    overrides : overrides that were applied, recorded in the manifest

    Raises
    ------
    InputError : an unknown aircraft or fault, a key that cannot be sampled, or flights that need
        different autopilots
    """

    what = "flights"

    FIGURES: Declared = ()
    """Columns of the summary that a study of a user's own adds; its work fills them."""

    TABLES: Mapping[str, Declared] = {}
    """Columns of tables that it adds, by file, beside those that name the flight."""

    chooses_flights = False
    """Whether what is flown depends on what was flown before, so that no flight can be flown
    without the others.
    """

    def __init__(
        self,
        scenario: Scenario | TrialList,
        name: str,
        trials: Mapping[str, Scenario],
        *,
        overrides: Sequence[str] = (),
    ) -> None:
        first = next(iter(trials.values()))
        spec = spec_of(first)
        for point in (
            point
            for trial, of in trials.items()
            for point in Experiment(trial, of, alone=len(trials) == 1).points
        ):
            check_without_design(point.scenario)
        self._design, self._refusal = design_of(spec, first.altitude) if spec else (None, "")
        envelope = (
            self._design.design.schedule.envelope
            if self._design
            else spec.envelope
            if spec
            else None
        )
        as_read = trials if envelope is not None else {}
        if envelope is not None:
            trials = {trial: scaled(of, envelope) for trial, of in trials.items()}
        if isinstance(scenario, Scenario):
            # What the manifest says of it is what is flown.
            scenario = trials[name]
        self.trials = self.expanded(trials)
        self.experiments = {
            trial: Experiment(trial, of, alone=len(self.trials) == 1)
            for trial, of in self.trials.items()
        }
        check_flights(
            self.experiments.values(),
            self._design.design.schedule.envelope if self._design else None,
        )
        self.histories, self._report = scenario.histories, scenario.report
        self.flights = {trial: experiment.counted for trial, experiment in self.experiments.items()}
        keys = dict.fromkeys(
            key for experiment in self.experiments.values() for key in experiment.keys
        )
        points = [
            point.scenario
            for experiment in self.experiments.values()
            for point in experiment.points
        ]
        declared = declarations(points)
        part = without_folders(scenario.study)
        figures = SUMMARY_COLUMNS | declared.figures | described(self.FIGURES, part=part)
        if any(point.finds for point in points):
            figures |= FINDING_COLUMNS
        self.tables = {
            SUMMARY: figures,
            CROSSINGS: dict(CROSSING_COLUMNS),
            INTERVENTIONS: dict(INTERVENTION_COLUMNS),
            DRAWS: INPUT_COLUMNS | described(dict.fromkeys(keys, ANY_KEY)),
        }
        added = {file: described(columns, part=part) for file, columns in self.TABLES.items()}
        self.tables |= {
            file: FLIGHT_COLUMNS | columns for file, columns in (declared.tables | added).items()
        }
        if self._numbers > self.planned:
            self.tables[COMPARISON] = figures
        self.plugins = plugins(points)
        self.vessel_files = vessel_files(points)
        self.config_hash = config_hash(
            scenario, *self.trials.values(), files=self.plugins, names=list(self.trials)
        )
        self._manifest = initial_manifest(scenario, name, overrides) | {
            # A list of trials does not change with what it lists.
            "config_hash": self.config_hash,
            "modes": [mode.value for mode in Mode],
            "trial_parameters": {trial: parameters(of) for trial, of in self.trials.items()},
            "unused_parameters": {
                trial: unused_parameters(of) for trial, of in self.trials.items()
            },
            "scaled_parameters": {trial: scaled_keys(of) for trial, of in as_read.items()},
            "sampled_at_random": self._sampled_at_random(),
            "flights_per_sample": {
                trial: flights_per_sample(of) for trial, of in self.trials.items()
            },
            "random_numbers_of_points": {
                trial: random_numbers_of_points(of) for trial, of in self.trials.items()
            },
            "theory": {trial: theory_over_speed_ratio(of) for trial, of in self.trials.items()},
            "plugins": self.plugins,
            "vessel_files": {
                name: {"rows": reports.rows, "used": len(reports.time), "dropped": reports.dropped}
                for name, reports in self.vessel_files.items()
            },
        }

    def expanded(self, trials: Mapping[str, Scenario]) -> dict[str, Scenario]:
        """Return the trials to fly, from those given, scaled to the aircraft.

        Raises
        ------
        InputError : a study that makes trials of its own cannot
        """
        return dict(trials)

    def name_by_trial(self) -> None:
        """Have the names of flights begin with that of their trial, as those of a run of several
        trials do.
        """
        self.experiments = {
            trial: Experiment(trial, of, alone=False) for trial, of in self.trials.items()
        }

    def _sampled_at_random(self) -> dict[str, bool]:
        """Return of which trials flights are a random sample, from which a bound on a probability
        follows.
        """
        return {trial: is_random_sample(scenario) for trial, scenario in self.trials.items()}

    @property
    def planned(self) -> int:
        """Number of flights, comparisons apart."""
        return sum(self.flights.values())

    @property
    def beside(self) -> int:
        """Number of flights of comparisons."""
        return sum(
            experiment.flights - experiment.counted for experiment in self.experiments.values()
        )

    @property
    def _numbers(self) -> int:
        """Number of flights, comparisons among them."""
        return self.planned + self.beside

    def initial_manifest(self) -> dict[str, Any]:
        """Return the manifest as written before the first flight."""
        return self._manifest | self._sizes()

    def _sizes(self) -> dict[str, Any]:
        """Return the entries of the manifest on how many flights there are, which a study may find
        out as it goes.
        """
        trials = {trial: flown_config(scenario) for trial, scenario in self.trials.items()}
        return {"trials": trials, "trial_flights": self.flights, "flights_planned": self.planned}

    def work(self, run: RunDirectory) -> FlightWork:
        """Return the work on its flights, after writing the logo and the aircraft's autopilot into
        the run directory.

        Raises
        ------
        InputError : the aircraft cannot fly as asked, or the margin cannot be predicted
        """
        write_logo(self._report, run)
        # Of a trial that has been scaled to the aircraft: its airspeed is where flights start.
        first = next(iter(self.trials.values()))
        flown = self._design if first.fidelity != "kinematic" else None
        settings = [
            setting for experiment in self.experiments.values() for setting in experiment.steepest()
        ]
        steepest = max(
            bank_for_heading_rate(omega_max(s.guidance), s.guidance.airspeed_mps)
            for s in [first, *settings]
        )
        try:
            setup = (
                aircraft_setup(flown, first, run, bank=steepest, settings=settings)
                if flown
                else None
            )
            with plugins_explained("the keep-out margin cannot be predicted", settings):
                spreads = predicted_spreads(settings, flown, setup)
        except AircraftError as error:
            raise InputError(f"{first.aircraft}: {error}") from None
        self._manifest["guidance_lag_s"] = (
            setup or kinematic_setup(first)
        ).lag + 0.5 / first.guidance.rate_hz
        return FlightWork(
            experiments=tuple(self.experiments.values()),
            histories=self.histories,
            setup=setup,
            spreads=spreads,
            refusal=self._refusal,
        )

    def run(self, fly: Fly, run: RunDirectory, journal: Journal) -> None:
        """Fly every flight; then those again that have no time history, but should be looked at."""
        fly(Task(number=i) for i in range(self._numbers))
        fly(self.representative_flights(run, journal))

    def representative_flights(self, run: RunDirectory, journal: Journal) -> list[Task]:
        """Return what is to be recorded of each trial: the closest flight, the median one, the
        first unfinished mission, and those whose time history was deleted."""
        # Figures alone: a hundred thousand rows would be too many.
        distances = {trial: (array("d"), array("q")) for trial in self.trials}
        unfinished: dict[str, int] = {}
        for number, row in journal.numbered(SUMMARY):
            if row["outcome"] in UNFINISHED:
                unfinished.setdefault(row["trial"], number)
            if "min_distance_m" in row:
                nearest, numbers = distances[row["trial"]]
                nearest.append(row["min_distance_m"])
                numbers.append(number)
        chosen = list(unfinished.values())
        for nearest, numbers in distances.values():
            order = np.argsort(nearest, kind="stable")
            chosen += [numbers[i] for i in (order[0], order[len(order) // 2])] if len(order) else []
        return self.unrecorded(chosen, run, journal)

    def unrecorded(self, numbers: Sequence[int], run: RunDirectory, journal: Journal) -> list[Task]:
        """Return the tasks of those flights that have no time history yet, and of those that had
        one, to be recorded.
        """
        gone = set(run.gone)
        missing = {
            number
            for number in numbers
            for row in journal.rows(SUMMARY, first=number, below=number + 1)
            if not (run.path / time_history_path(row["flight_id"])).is_file()
        }
        if gone:
            tables = (SUMMARY, COMPARISON)
            found = ((number, row) for table in tables for number, row in journal.numbered(table))
            missing |= {
                number for number, row in found if time_history_path(row["flight_id"]) in gone
            }
        return [replace(self.task(number), recorded=True) for number in sorted(missing)]

    def task(self, number: int) -> Task:
        """Return the task of a flight."""
        return Task(number=number)

    def postprocess(self, run: RunDirectory, journal: Journal, _progress: Progress) -> None:
        """Write ``sulphur.json`` where flights had a sniffer; everything else is in the tables."""
        if SULPHUR_TABLE in self.tables:
            rows = frame(
                (row for row in journal.rows(SUMMARY) if "sulphur_verdict" in row), SULPHUR_COLUMNS
            )
            run.write_json(run.path / SULPHUR, sulphur_statistics(rows, confidence=CONFIDENCE))

    def export(self, run: RunDirectory, journal: Journal) -> None:
        """Write its tables, and what their columns are."""
        overrides = self._overrides(journal)
        write_tables(run, journal, {**self.tables, **overrides})
        write_columns(run, {**self.columns(), **overrides})

    def _overrides(self, journal: Journal) -> dict[str, Table]:
        """Return the columns of the table of what flights have otherwise than their trial, of a
        study whose rows are flights.
        """
        if DRAWS not in self.tables:
            return {}
        keys = dict.fromkeys(key for row in journal.rows(OVERRIDES) for key in row)
        return {
            OVERRIDES: FLIGHT_COLUMNS
            | described({key: ANY_KEY for key in keys if key not in FLIGHT_COLUMNS})
        }

    def columns(self) -> Mapping[str, Table]:
        """Return what the columns of its tables are, by file."""
        others = {DERIVED: DERIVED_COLUMNS, FLIGHTS: history_columns(self.experiments.values())}
        return {**self.tables, **others}

    def bound(self, counts: Counts, samples: int, _journal: Journal) -> Bound:
        """Return the bound on the probability of a keep-out violation, of flights that are a random
        sample; parameters are those of ``bound_of``.
        """
        return bound_of(counts, samples)

    def judged(self, journal: Journal) -> RunVerdict:
        """Return what the flights so far have shown."""
        judge, criteria = Judge(self.flights), self._criteria_of_flights(journal)
        for number, row in journal.numbered(SUMMARY):
            judge.add(row, criteria.get(number) or self.trials[row["trial"]].criteria)
        return self._bounded(judge.verdict(comparisons=self._comparisons(journal)), journal)

    def _criteria_of_flights(self, journal: Journal) -> dict[int, CriteriaConfig]:
        """Return the criteria of flights by their numbers, where flights of a trial may differ in
        them.
        """
        differ = any(
            point.scenario.criteria != experiment.scenario.criteria
            or any(draw.key.startswith("criteria.") for draw in point.scenario.draws)
            for experiment in self.experiments.values()
            for point in experiment.points
        )
        return {
            number: self.criteria_of(row["trial"], row)
            for number, row in (journal.numbered(OVERRIDES) if differ else ())
        }

    def criteria_of(self, trial: str, overrides: Row) -> CriteriaConfig:
        """Return the criteria of a flight of a trial, by its row of ``overrides.csv``."""
        criteria = self.trials[trial].criteria
        own = {
            key.removeprefix("criteria."): from_json_cell(str(value))
            for key, value in overrides.items()
            if key.startswith("criteria.")
        }
        return CriteriaConfig(**(criteria.model_dump(mode="json") | own)) if own else criteria

    def _comparisons(self, journal: Journal) -> dict[str, Counts]:
        """Return the counts of the flights of each comparison."""
        planned = Counter[str]()
        for experiment in self.experiments.values():
            for point in experiment.points:
                if point.variant != STUDY:
                    planned[point.variant] += point.flights
        tallies = {variant: Tally(flights) for variant, flights in planned.items()}
        for row in journal.rows(COMPARISON) if tallies else ():
            tallies[row["variant"]].add(row)
        return {variant: tally.counts() for variant, tally in tallies.items()}

    def _bounded(self, verdict: RunVerdict, journal: Journal) -> RunVerdict:
        """Return a verdict with the bounds that follow from flights that are a random sample."""
        at_random = self._sampled_at_random()
        samples = {
            trial: of.counts.beside // flights_per_sample(self.trials[trial])
            for trial, of in verdict.trials.items()
        }
        trials = {
            trial: replace(of, bound=self.bound(of.counts, samples[trial], journal))
            if at_random[trial] and of.closest
            else of
            for trial, of in verdict.trials.items()
        }
        whole = verdict.whole
        if all(at_random.values()) and whole.closest:
            whole = replace(whole, bound=self.bound(whole.counts, sum(samples.values()), journal))
        return replace(verdict, whole=whole, trials=trials)

    def summary(self, journal: Journal) -> StudySummary:
        """Return the result so far."""
        verdict, notes = self.judged(journal), FlightNotes.of(journal.rows(SUMMARY))
        whole = verdict.whole
        lines = [
            *unexplained_lines(verdict),
            *(reports.described() for reports in self.vessel_files.values()),
            f"flights: {trial_line(whole)}",
        ]
        if len(verdict.trials) > 1:
            lines += [f"  {trial}: {trial_line(of)}" for trial, of in verdict.trials.items()]
        points = {*map(random_numbers_of_points, self.trials.values())}
        lines += [POINTS_OF_SWEEP[kind] for kind in sorted(points) if kind]
        left_out = () if verdict.comparisons else self._ratios_without_flights()
        lines += [
            *premise_lines(verdict),
            *comparison_lines(verdict, left_out),
            *notes.sulphur_lines(),
        ]
        if whole.bound:
            lines.append(bound_line(whole.bound, whole.counts.hours))
        lines += [exit_line(verdict), *notes.not_met_lines("    "), *notes.warnings()]
        guidance_lag = {"guidance_lag_s": self._manifest.get("guidance_lag_s")}
        return StudySummary(verdict=verdict, lines=lines, manifest=self._sizes() | guidance_lag)

    def _ratios_without_flights(self) -> list[float]:
        """Return the speed ratios of comparisons at none of which the study has a flight."""
        return [
            nu for of in self.trials.values() if of.comparison.variants for nu in of.comparison.nu
        ]
