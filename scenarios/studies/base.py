"""Studies of flights: the steps that every study has, single flights, lists of trials, flights that
are chosen during the study; and how the study of a scenario is found and run.
"""

import math
import sys
from array import array
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from aircraft.spec import AircraftError, Envelope
from common.columns import Column, Declared, Table, described
from common.errors import PluginError
from common.intervals import CONFIDENCE
from common.physics import bank_for_heading_rate
from common.provenance import without_folders
from common.registry import Registry, is_file_part
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
    TRAFFIC,
    time_history_path,
)
from common.text import from_json_cell
from common.verdict import Bound, Counts, RunVerdict
from scenarios.engine.journal import Journal
from scenarios.engine.processes import Executor
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import (
    ExecutorFactory,
    Fly,
    Launch,
    Progress,
    RunResult,
    Study,
    StudySummary,
    fly_study,
    write_columns,
    write_tables,
)
from scenarios.engine.task import Row, Task, Work
from scenarios.errors import InputError
from scenarios.experiment.requests import Experiment, table_of
from scenarios.experiment.sampling import (
    flights_per_sample,
    is_random_sample,
    random_numbers_of_points,
)
from scenarios.flight.time_history import UNFINISHED
from scenarios.flight_runner import FlightRunner, history_columns
from scenarios.instruments.instrument import declarations
from scenarios.instruments.sniffer import OTHERS_FIGURES
from scenarios.measures.columns import (
    ANY_KEY,
    CROSSING_COLUMNS,
    DERIVED_COLUMNS,
    FINDING_COLUMNS,
    FLIGHT_COLUMNS,
    HULL_COLUMNS,
    INPUT_COLUMNS,
    INTERVENTION_COLUMNS,
    SUMMARY_COLUMNS,
    TRAFFIC_COLUMNS,
    TRAFFIC_FIGURES,
    further_faults,
)
from scenarios.measures.verdict import Judge, Tally, bound_of
from scenarios.planning.limits import omega_max
from scenarios.planning.scaling import scaled
from scenarios.planning.spreads import predicted_spreads
from scenarios.scenario.effect import unused
from scenarios.scenario.files import AnyStudy, load_study
from scenarios.scenario.overrides import parse_override
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
    plugins,
    refuse_changed,
    trial_entries,
    vessel_files,
    wind_files,
    write_logo,
)
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
from scenarios.world.world import sized

STUDIES: Registry[Callable[..., Study]] = Registry(
    "study", folder="scenarios.studies", methods=("work", "run", "postprocess", "export", "summary")
)
"""Studies by the word that a scenario file has for them.

Each is called as ``FlightStudy`` is: with the scenario, its name, the scenarios to fly by name, and
the overrides; one of another kind of scenario without the scenarios to fly.
"""

study = STUDIES.register
"""Decorator that registers a study by a name."""


def frame(rows: Iterable[Row], columns: Sequence[str]) -> pd.DataFrame:
    """Return some columns of rows; a missing value is None."""
    return pd.DataFrame(
        [[row.get(name) for name in columns] for row in rows], columns=list(columns)
    )


def _has_hull(setting: Scenario) -> bool:
    """Return whether the size of the ship is known in flights of a scenario."""
    try:
        return sized(setting).vessel.hull is not None
    except InputError:
        # Errors of a file are raised when it is flown.
        return False


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
    """Columns of the summary that a study adds; its work fills them."""

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
        flown = self._make_flights(trials)
        if isinstance(scenario, Scenario):
            # The manifest describes the flights.
            scenario = flown[name]
        self.histories, self._report = scenario.histories, scenario.report
        self.flights = {trial: each.counted for trial, each in self.experiments.items()}
        self.tables = self._declared_tables(without_folders(scenario.study))
        self.plugins = plugins(self._settings_of_points())
        self.vessel_files = vessel_files(self._settings_of_points())
        self.wind_files = wind_files(self._settings_of_points())
        self.config_hash = config_hash(
            scenario, *self.trials.values(), files=self.plugins, names=list(self.trials)
        )
        self._manifest = {
            **initial_manifest(scenario, name, overrides),
            # A list of trials does not change with what it lists.
            "config_hash": self.config_hash,
            **trial_entries(self.trials, as_read={} if flown is trials else trials),
            "plugins": self.plugins,
            "vessel_files": {name: reports.record() for name, reports in self.vessel_files.items()},
            "wind_files": {name: wind.record() for name, wind in self.wind_files.items()},
        }

    def _make_flights(self, trials: Mapping[str, Scenario]) -> Mapping[str, Scenario]:
        """Make the flights of trials, check them, and design their autopilot; return the trials,
        scaled to the aircraft.
        """
        first = next(iter(trials.values()))
        spec = spec_of(first)
        envelope = spec.envelope if spec else None
        flown = self._take(trials, envelope)
        for scenario_of_point in self._settings_of_points():
            check_without_design(scenario_of_point)
        self._design, self._refusal = design_of(spec, first.altitude) if spec else (None, "")
        designed = self._design.design.schedule.envelope if self._design else None
        if designed and not (envelope and _same_scale(designed, envelope)):
            # The envelope was not published, and the design found it.
            envelope = designed
            flown = self._take(trials, envelope)
        check_flights(self.experiments.values(), designed)
        return flown

    def _take(
        self, trials: Mapping[str, Scenario], envelope: Envelope | None
    ) -> Mapping[str, Scenario]:
        """Make the flights of trials, and return the trials, scaled to an aircraft if there is
        one.
        """
        if envelope is not None:
            trials = {trial: scaled(of, envelope) for trial, of in trials.items()}
        self.trials = self.expanded(trials)
        self._make_experiments(alone=len(self.trials) == 1)
        return trials

    def _make_experiments(self, *, alone: bool) -> None:
        self.experiments = {
            trial: Experiment(trial, of, alone=alone) for trial, of in self.trials.items()
        }

    def _settings_of_points(self) -> list[Scenario]:
        """Return the scenario of each point of its experiments."""
        return [point.scenario for each in self.experiments.values() for point in each.points]

    def _declared_tables(self, part: str) -> dict[str, dict[str, Column]]:
        """Return the columns of each table; columns that the study itself declares have its name as
        ``part``.
        """
        settings = self._settings_of_points()
        declared = declarations(settings)
        figures = SUMMARY_COLUMNS | declared.figures | described(self.FIGURES, part=part)
        if any(setting.finds for setting in settings):
            figures |= FINDING_COLUMNS
        if any(_has_hull(setting) for setting in settings):
            figures |= HULL_COLUMNS
        figures |= further_faults(max(len(setting.faults) for setting in settings))
        with_traffic = any(setting.has_traffic for setting in settings)
        if with_traffic:
            figures |= TRAFFIC_FIGURES
        if any(ship.emission for setting in settings for ship in setting.traffic):
            figures |= OTHERS_FIGURES
        keys = dict.fromkeys(key for each in self.experiments.values() for key in each.keys)
        added = {file: described(columns, part=part) for file, columns in self.TABLES.items()}
        tables = {
            SUMMARY: figures,
            CROSSINGS: dict(CROSSING_COLUMNS),
            INTERVENTIONS: dict(INTERVENTION_COLUMNS),
            DRAWS: INPUT_COLUMNS | described(dict.fromkeys(keys, ANY_KEY)),
        }
        if with_traffic:
            tables[TRAFFIC] = dict(TRAFFIC_COLUMNS)
        for file, columns in (declared.tables | added).items():
            tables[file] = FLIGHT_COLUMNS | columns
        if self.comparisons:
            tables[COMPARISON] = figures
        return tables

    def expanded(self, trials: Mapping[str, Scenario]) -> dict[str, Scenario]:
        """Return the trials to fly, from those given, scaled to the aircraft.

        Raises
        ------
        InputError : the study cannot make its trials
        """
        return dict(trials)

    def name_by_trial(self) -> None:
        """Let the names of flights begin with the name of their trial, as in a run of several
        trials.
        """
        self._make_experiments(alone=False)

    @property
    def planned(self) -> int:
        """Number of flights, comparisons apart."""
        return sum(self.flights.values())

    @property
    def comparisons(self) -> int:
        """Number of flights of comparisons."""
        return sum(
            experiment.flights - experiment.counted for experiment in self.experiments.values()
        )

    @property
    def _numbers(self) -> int:
        """Number of flights, comparisons among them."""
        return self.planned + self.comparisons

    def initial_manifest(self) -> dict[str, Any]:
        """Return the manifest as written before the first flight."""
        return self._manifest | self._sizes()

    def _sizes(self) -> dict[str, Any]:
        """Return the manifest's entries on the number of flights, which some studies only know at
        their end.
        """
        trials = {trial: flown_config(scenario) for trial, scenario in self.trials.items()}
        return {"trials": trials, "trial_flights": self.flights, "flights_planned": self.planned}

    def work(self, run: RunDirectory) -> FlightRunner:
        """Return the work on its flights, after writing the logo and the aircraft's autopilot into
        the run directory.

        Raises
        ------
        InputError : the aircraft cannot fly so, or the margin cannot be predicted
        """
        write_logo(self._report, run)
        # The trial has been scaled to the aircraft: flights start at its airspeed.
        first = next(iter(self.trials.values()))
        settings = [each for of in self.experiments.values() for each in of.steepest()]
        steepest = max(
            bank_for_heading_rate(omega_max(each.guidance), each.guidance.airspeed_mps)
            for each in [first, *settings]
        )
        design = self._design if first.fidelity != "kinematic" else None
        try:
            setup = (
                aircraft_setup(design, first, run, bank=steepest, settings=settings)
                if design
                else None
            )
            with plugins_explained("the keep-out margin cannot be predicted", settings):
                spreads = predicted_spreads(settings, design, setup)
        except AircraftError as error:
            raise InputError(f"{first.aircraft}: {error}") from None
        lag = (setup or kinematic_setup(first)).lag
        self._manifest["guidance_lag_s"] = lag + 0.5 / first.guidance.rate_hz
        return FlightRunner(
            experiments=tuple(self.experiments.values()),
            histories=self.histories,
            setup=setup,
            spreads=spreads,
            refusal=self._refusal,
        )

    def run(self, fly: Fly, run: RunDirectory, journal: Journal) -> None:
        """Fly every flight; then repeat flights without a time history that the report shows."""
        fly(Task(number=i) for i in range(self._numbers))
        fly(self.representative_flights(run, journal))

    def representative_flights(self, run: RunDirectory, journal: Journal) -> list[Task]:
        """Return the flights to record for each trial: the closest, the median, the first
        unfinished mission, and those whose time history was deleted.
        """
        # Only figures are kept: a hundred thousand whole rows would take too much memory.
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
        """Return tasks to record the flights that have no time history yet, and those whose time
        history was deleted.
        """
        unwritten = {
            number
            for number in numbers
            for row in journal.rows(SUMMARY, first=number, below=number + 1)
            if not (run.path / time_history_path(row["flight_id"])).is_file()
        }
        if deleted := set(run.missing_files):
            for table in (SUMMARY, COMPARISON):
                unwritten |= {
                    number
                    for number, row in journal.numbered(table)
                    if time_history_path(row["flight_id"]) in deleted
                }
        missing = sorted(unwritten)
        return [replace(self.task(number), recorded=True) for number in missing]

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
        """Write the tables and the descriptions of their columns."""
        overrides = self._overrides(journal)
        write_tables(run, journal, {**self.tables, **overrides})
        write_columns(run, {**self.columns(), **overrides})

    def _overrides(self, journal: Journal) -> dict[str, Table]:
        """Return the columns of the table of differences between flights and their trial; a study
        whose rows are not flights has none.
        """
        if DRAWS not in self.tables:
            return {}
        keys = dict.fromkeys(key for row in journal.rows(OVERRIDES) for key in row)
        return {
            OVERRIDES: FLIGHT_COLUMNS
            | described({key: ANY_KEY for key in keys if key not in FLIGHT_COLUMNS})
        }

    def columns(self) -> Mapping[str, Table]:
        """Return the descriptions of its tables' columns, by file."""
        others = {DERIVED: DERIVED_COLUMNS, FLIGHTS: history_columns(self.experiments.values())}
        return {**self.tables, **others}

    def bound(self, counts: Counts, samples: int, _journal: Journal) -> Bound:
        """Return the bound on the probability of a keep-out violation, of flights that are a random
        sample; parameters are those of ``bound_of``.
        """
        return bound_of(counts, samples)

    def judged(self, journal: Journal) -> RunVerdict:
        """Return the verdict on the flights so far."""
        judge, criteria = Judge(self.flights), self._criteria_of_flights(journal)
        for number, row in journal.numbered(SUMMARY):
            judge.add(row, criteria.get(number) or self.trials[row["trial"]].criteria)
        return self._bounded(judge.verdict(comparisons=self._comparisons(journal)), journal)

    def _criteria_of_flights(self, journal: Journal) -> dict[int, CriteriaConfig]:
        """Return the criteria of flights by their numbers, if flights of a trial may differ in
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
        at_random = {trial: is_random_sample(of) for trial, of in self.trials.items()}
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
            *(line for reports in self.vessel_files.values() for line in reports.lines()),
            *(f"{Path(name).name}: {of.described()}" for name, of in self.wind_files.items()),
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
        """Return the speed ratios of comparisons at which the study has no flight."""
        return [
            nu for of in self.trials.values() if of.comparison.variants for nu in of.comparison.nu
        ]


def _same_scale(one: Envelope, other: Envelope) -> bool:
    """Return whether trials are scaled alike to two envelopes."""
    return (one.airspeed, one.bank) == (other.airspeed, other.bank)


def clearance(row: Row, *, unmeasured: float) -> float:
    """Return the closest approach of a flight to the keep-out area [m], or ``unmeasured`` if it is
    not known.
    """
    if "min_distance_m" not in row:
        return unmeasured
    beyond = float(row["min_distance_m"] - row["keepout_radius_m"])
    return min(beyond, float(row.get("others_clearance_min_m", math.inf)))


class ChosenFlightsStudy(FlightStudy):
    """Flights of one trial, at points of its draws that the study chooses. The study appends their
    tasks while it runs.

    Parameters
    ----------
    scenario, name : the scenario, and its name
    trials : the same by its name
    numbers : largest number of flights
    overrides : overrides that were applied, recorded in the manifest

    Raises
    ------
    InputError : same as ``FlightStudy``
    """

    chooses_flights = True

    def __init__(
        self,
        scenario: Scenario,
        name: str,
        trials: Mapping[str, Scenario],
        *,
        numbers: int,
        overrides: Sequence[str] = (),
    ) -> None:
        numbered = {
            trial: of.model_copy(update={"flights": numbers}) for trial, of in trials.items()
        }
        super().__init__(
            scenario.model_copy(update={"flights": numbers}), name, numbered, overrides=overrides
        )
        ((self._trial, self._scenario),) = self.trials.items()
        self._tasks: list[Task] = []

    def task(self, number: int) -> Task:
        """Return the task of a flight, at the point that was chosen for it."""
        return self._tasks[number]

    def depended_on(self, journal: Journal, *, below: int) -> bool:
        """Return whether the journal has flights with numbers below ``below`` that come after those
        chosen so far.

        Such flights were chosen from the results of the earlier ones. A lost earlier flight is
        therefore tried again only if there are no such flights: otherwise a resumed run would
        choose different ones.
        """
        return (
            next(journal.numbered(SUMMARY, first=len(self._tasks), below=below), None) is not None
        )

    def postprocess(self, run: RunDirectory, journal: Journal, progress: Progress) -> None:
        """Write nothing: flights that were chosen from the results of others are not a random
        sample, and cannot show how well sulphur is measured.
        """


_ROUNDING = 1e-12
"""Relative error of a product [-]."""


@study("trials")
class TrialStudy(FlightStudy):
    """The trials of a list, one after the other.

    Parameters
    ----------
    listed, name : the list, and its name
    overrides : overrides that were applied, recorded in the manifest

    Raises
    ------
    InputError : a listed trial does not exist or has no flights, or two have the same name; and
        same as ``FlightStudy``
    """

    def __init__(self, listed: TrialList, name: str, *, overrides: Sequence[str] = ()) -> None:
        super().__init__(listed, name, _trials(listed), overrides=overrides)


def _trials(listed: TrialList) -> dict[str, Scenario]:
    """Return the trials of a list by name, each with its share of flights."""
    seed = [] if listed.seed is None else [f"seed={listed.seed}"]
    trials: dict[str, Scenario] = {}
    for path in listed.trials:
        trial, name = load_study(path, [*listed.set, *seed], refusing=False), Path(path).stem
        if not isinstance(trial, Scenario) or trial.study != "flights":
            raise InputError(
                f"trials: '{path}' is a study of {trial.study}; list scenarios of flights"
            )
        if name in trials:
            raise InputError(
                f"trials: two are called '{name}'; list each once, and give files names of their"
                " own"
            )
        # A share of 0.07 of 100 flights is 7 flights; rounding errors must not make it 8.
        flights = math.ceil(listed.share * trial.flights * (1.0 - _ROUNDING))
        trials[name] = trial.model_copy(update={"flights": flights})
    for override in listed.set:
        key, _ = parse_override(override)
        users = [unused(trial, key) for trial in trials.values()]
        if all(users):
            raise InputError(f"key '{key}' has no effect in any trial: it is used by {users[0]}")
    return trials


class SingleFlight:
    """One flight of a study, as a study. Its row is in the summary, even if it is one of a
    comparison.

    Parameters
    ----------
    study : the study to which the flight belongs
    task : the flight
    flight_id, trial : its name, and that of its trial
    table : the file in which the study has its row
    """

    what = "flights"
    planned, comparisons = 1, 0

    def __init__(
        self, study: FlightStudy, task: Task, *, flight_id: str, trial: str, table: str
    ) -> None:
        self._study = study
        self.task = task
        self._flight_id = flight_id
        self._trial = trial
        self._table = table
        self.config_hash = f"{study.config_hash} {flight_id}"

    @classmethod
    def of(cls, study: FlightStudy, flight_id: str) -> "SingleFlight | None":
        """Return the flight of this name, or None if the study has none."""
        first = 0
        for name, experiment in study.experiments.items():
            for number in range(experiment.flights):
                found, variant = experiment.named(number)
                if found == flight_id:
                    task = study.task(first + number)
                    return cls(study, task, flight_id=found, trial=name, table=table_of(variant))
            first += experiment.flights
        return None

    def initial_manifest(self) -> dict[str, Any]:
        """Return the manifest as written before the flight."""
        # Chosen flights are not a random sample.
        one = {
            "trial_flights": {self._trial: 1},
            "flights_planned": 1,
            "sampled_at_random": {self._trial: False},
        }
        return self._study.initial_manifest() | one | {"config_hash": self.config_hash}

    def work(self, run: RunDirectory) -> Work:
        """Return the work of the study, which keeps every time history."""
        work = self._study.work(run)
        return replace(work, histories=sys.maxsize) if isinstance(work, FlightRunner) else work

    def run(self, fly: Fly, _run: RunDirectory, _journal: Journal) -> None:
        """Fly the flight; its time history is written."""
        fly([self.task])

    def postprocess(self, _run: RunDirectory, _journal: Journal, _progress: Progress) -> None:
        """Do nothing: one flight has only tables and its time history."""

    def export(self, run: RunDirectory, journal: Journal) -> None:
        """Write the tables; the row is in ``summary.csv`` even if the flight is one of a
        comparison.
        """
        self._study.export(run, journal)
        if self._table != SUMMARY:
            (run.path / self._table).replace(run.path / SUMMARY)

    def judged(self, journal: Journal) -> RunVerdict:
        """Return the verdict on the flight, alone or as a flight of a comparison."""
        judge = Judge({self._trial: 1})
        overrides = dict(journal.numbered(OVERRIDES))
        for number, row in journal.numbered(self._table):
            judge.add(row, self._study.criteria_of(row["trial"], overrides.get(number, {})))
        return judge.verdict()

    def summary(self, journal: Journal) -> StudySummary:
        """Return how the flight ended."""
        verdict, notes = self.judged(journal), FlightNotes.of(journal.rows(self._table))
        line = f"{self._flight_id}: {trial_line(verdict.whole)}"
        lines = [line, *notes.not_met_lines("  ")]
        return StudySummary(verdict=verdict, lines=lines, manifest={})


def study_of(scenario: AnyStudy, name: str, overrides: Sequence[str] = ()) -> Study:
    """Return the study that a scenario file describes.

    Parameters
    ----------
    scenario, name : the scenario and its name
    overrides : overrides that were applied to the scenario, recorded in the manifest

    Raises
    ------
    InputError : the scenario cannot be flown
    """
    try:
        made = STUDIES.get(scenario.study)
    except PluginError as error:
        raise InputError(str(error)) from None
    if not isinstance(scenario, Scenario):
        return made(scenario, name, overrides=overrides)
    with plugins_explained(f"study '{scenario.study}'", [scenario]):
        return made(scenario, name, {name: scenario}, overrides=overrides)


def run_study(
    scenario: AnyStudy,
    name: str,
    directory: Path,
    *,
    executor_factory: Callable[[Work], Executor] | None = None,
    resume: bool = False,
    progress: Progress = lambda *_: None,
    overrides: Sequence[str] = (),
    command: str = "",
    launched: Callable[[Launch], None] = lambda _: None,
) -> RunResult:
    """Fly a study into ``directory``.

    Parameters
    ----------
    scenario, name : the scenario and its name
    directory : the run directory
    executor_factory : makes the executor; the default is one process of this machine
    resume : continue the unfinished run in ``directory``
    progress : called as the study advances
    overrides : overrides that were applied to the scenario, recorded in the manifest
    command : the command line, for the manifest; none if a program runs the study
    launched : called once, before anything is flown

    Raises
    ------
    InputError : the scenario cannot be flown, or the directory cannot be used
    """
    if not resume:
        RunDirectory(directory).refuse_taken()
    elif isinstance(scenario, Scenario):
        # This check comes first, so that no autopilot is designed for flights that are then
        # refused.
        then, now = RunDirectory(directory).plugins(), plugins([scenario])
        refuse_changed(then, {name: digest for name, digest in now.items() if name in then})
    progress("preparing", 0, 1)
    study = study_of(scenario, name, overrides)
    factory = executor_factory or ExecutorFactory()
    own = [scenario] if isinstance(scenario, Scenario) and is_file_part(scenario.study) else []
    with plugins_explained(f"study '{scenario.study}'", own) if own else nullcontext():
        return fly_study(
            study,
            directory,
            executor_factory=factory,
            resume=resume,
            progress=progress,
            command=command,
            launched=launched,
        )
