"""Trials over the real sea as a study."""

import math
from array import array
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from aircraft.fleet.find import find_spec
from aircraft.simulation.faults import fault_names
from aircraft.spec import Envelope
from common.run_layout import DRAWS, SUMMARY, time_history_path
from gnc.sea_parameters import Mode
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, Progress, StudySummary, write_tables
from scenarios.engine.task import Task
from scenarios.errors import InputError
from scenarios.experiment.draws import check_draws
from scenarios.metrics.sea_figures import SEA_SUMMARY_COLUMNS
from scenarios.planning.limits import check_flyable
from scenarios.planning.scaling import fitted
from scenarios.planning.spreads import predicted_spreads
from scenarios.schema.load import load_study
from scenarios.schema.sea_config import SeaScenario, SeaTrial
from scenarios.sea_flights import DETAILS, SeaWork, Trial
from scenarios.studies.manifest import config_hash, initial_manifest, parameters
from scenarios.studies.summary import FlightCounts
from scenarios.vehicles.sea_airframe import airframe_of, design_for
from scenarios.world.weather import SATELLITES, VESSEL_DATA


class SeaStudy:
    """Trials over the real sea, one after the other.

    Parameters
    ----------
    study, name : what to fly, and what it is called
    overrides : how the study differs from the one of that name, for the record

    Raises
    ------
    InputError : an unknown trial, aircraft or fault, or a key that cannot be drawn
    """

    what = "flights"

    def __init__(self, study: SeaScenario | SeaTrial, name: str, *, overrides: Sequence[str] = ()) -> None:
        trials = _trials(study, name)
        self._design, self._refusal = design_for(next(iter(trials.values())))
        envelope = self._design.design.schedule.envelope if self._design else None
        if envelope is not None:
            trials = {trial: fitted(scenario, envelope) for trial, scenario in trials.items()}
        _check(trials, envelope)
        self.trials = trials
        self.histories = study.histories
        self.flights = {trial: scenario.flights for trial, scenario in trials.items()}
        keys = dict.fromkeys(draw.key for scenario in trials.values() for draw in scenario.draws)
        self.tables = {SUMMARY: SEA_SUMMARY_COLUMNS, DRAWS: ("flight_id", "trial", "nu", *keys), **DETAILS}
        self.config_hash = config_hash(study, *trials.values())
        self._manifest = initial_manifest(study, name, overrides) | {
            # A list of trials does not change with what it lists.
            "config_hash": self.config_hash,
            "study": "sea",
            "modes": [mode.value for mode in Mode],
            "trial_parameters": {trial: parameters(scenario) for trial, scenario in trials.items()},
        }

    @property
    def planned(self) -> int:
        """Number of flights."""
        return sum(self.flights.values())

    def initial_manifest(self) -> dict[str, Any]:
        """Return what the manifest says before anything has been flown."""
        return self._manifest | self._sizes()

    def _sizes(self) -> dict[str, Any]:
        """Return what the manifest says of how much there is to fly, which a study may find out as it goes."""
        trials = {
            trial: scenario.model_dump(mode="json") | {"flights": self.flights[trial]} for trial, scenario in self.trials.items()
        }
        return {"trials": trials, "flights_planned": self.planned}

    def work(self, run: RunDirectory) -> SeaWork:
        """Return the flying of its flights, with the aircraft's autopilot written into the run directory."""
        # Of a trial that has been fitted to the aircraft: its airspeed is where flights start.
        airframe = airframe_of(next(iter(self.trials.values())), self._design, run)
        trials = [
            Trial(name=name, scenario=scenario, spreads=predicted_spreads(scenario, self._design, airframe))
            for name, scenario in self.trials.items()
        ]
        return SeaWork(trials=tuple(trials), histories=self.histories, airframe=airframe, refusal=self._refusal)

    def run(self, fly: Fly, run: RunDirectory, journal: Journal) -> None:
        """Have every flight flown; then those again that have no time history, but should be looked at."""
        fly(Task(number=i) for i in range(self.planned))
        fly(self.representative_flights(run, journal))

    def representative_flights(self, run: RunDirectory, journal: Journal) -> list[Task]:
        """Return the closest flight of each trial, and the one whose closest approach is the median, to be recorded."""
        # Figures alone: a hundred thousand rows would be too many.
        distances = {trial: (array("d"), array("q")) for trial in self.trials}
        for number, row in journal.numbered(SUMMARY):
            if "min_distance_m" in row:
                nearest, numbers = distances[row["trial"]]
                nearest.append(row["min_distance_m"])
                numbers.append(number)
        chosen = []
        for nearest, numbers in distances.values():
            order = np.argsort(nearest, kind="stable")
            chosen += [numbers[i] for i in (order[0], order[len(order) // 2])] if len(order) else []
        return self.unrecorded(chosen, run, journal)

    def unrecorded(self, numbers: Sequence[int], run: RunDirectory, journal: Journal) -> list[Task]:
        """Return the tasks of those flights that have no time history yet, to be recorded."""
        return [
            replace(self.task(number), recorded=True)
            for number in numbers
            for row in journal.rows(SUMMARY, first=number, below=number + 1)
            if not (run.path / time_history_path(row["flight_id"])).is_file()
        ]

    def task(self, number: int) -> Task:
        """Return the task of a flight."""
        return Task(number=number)

    def postprocess(self, _run: RunDirectory, _journal: Journal, _progress: Progress) -> None:
        """Leave it at that."""

    def export(self, run: RunDirectory, journal: Journal) -> None:
        """Write its tables."""
        write_tables(run, journal, self.tables)

    def summary(self, journal: Journal) -> StudySummary:
        """Return what the flights have come to."""
        whole = FlightCounts(planned=self.planned)
        trial_counts = {trial: FlightCounts(planned=flights) for trial, flights in self.flights.items()}
        for row in journal.rows(SUMMARY):
            whole.add(row)
            trial_counts[row["trial"]].add(row)
        lines = [f"{whole.planned} flights planned, {whole.done} done"]
        for trial, counts in trial_counts.items():
            nearest = "" if math.isinf(counts.nearest) else f", nearest {counts.nearest:.1f} m"
            kept = f"{counts.keepout_violations} keep-out violations{nearest}"
            lines.append(f"  {trial}: {counts.met} of {counts.planned} met every criterion; {kept}")
        return StudySummary(
            done=whole.done,
            met=whole.met == whole.planned,
            lines=[*lines, *whole.failed_lines("    ")],
            manifest=whole.manifest() | self._sizes(),
        )


def _trials(study: SeaScenario | SeaTrial, name: str) -> dict[str, SeaScenario]:
    """Return the trials of a study by name.

    Raises
    ------
    InputError : a listed one does not exist, or is none, or two have one name
    """
    if isinstance(study, SeaScenario):
        return {name: study}
    seed = [] if study.seed is None else [f"seed={study.seed}"]
    trials = {}
    for listed in study.trials:
        trial = load_study(listed, [*study.set, *seed])
        if not isinstance(trial, SeaScenario):
            raise InputError(f"trials: '{listed}' is a study of {trial.study}; list trials over the real sea")
        if Path(listed).stem in trials:
            raise InputError(f"trials: two are called '{Path(listed).stem}'; list each once, and give files names of their own")
        flights = math.ceil(study.share * trial.flights)
        trials[Path(listed).stem] = trial.model_copy(update={"flights": flights})
    return trials


def _check(trials: dict[str, SeaScenario], envelope: Envelope | None) -> None:
    """Check what can be checked before anything is flown.

    Raises
    ------
    InputError : trials that differ in what the autopilot is designed for, an airspeed or a bank that the aircraft cannot fly, a
        fault that it cannot have, a key that cannot be drawn
    """
    apart = {(s.aircraft, s.fidelity, s.guidance.airspeed_mps, s.plume.source_height_m) for s in trials.values()}
    if len(apart) > 1:
        raise InputError(
            "trials differ in aircraft, fidelity, guidance.airspeed_mps or plume.source_height_m; give each a run of its own"
        )
    for trial, scenario in trials.items():
        if envelope is not None and scenario.fidelity == "six_dof":
            check_flyable(scenario.guidance, scenario.aircraft, envelope)
        kinds = {scenario.fault.kind}
        for draw in scenario.draws:
            kinds |= {str(kind) for kind in draw.choice or ()} if draw.key == "fault.kind" else set()
        known = {"none", VESSEL_DATA, SATELLITES}
        if scenario.fidelity == "six_dof":
            known |= set(fault_names(find_spec(scenario.aircraft)))
        for kind in sorted(kinds - known):
            raise InputError(f"fault.kind is '{kind}'; what can fail is {', '.join(sorted(known))}")
        check_draws(trial, scenario)
