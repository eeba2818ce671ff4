"""Replay of one flight of a run, from its manifest, with every step of the guidance recorded."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from common.run_layout import COMPARISON, JOURNAL, MANIFEST, SUMMARY, flight_of, is_file_name
from scenarios.engine.fingerprint import differences
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import StudySummary
from scenarios.engine.task import Row, Task, Work
from scenarios.errors import InputError
from scenarios.experiment.requests import Experiment
from scenarios.flight_runner import FlightWork
from scenarios.scenario.aircraft_folder import folder_of
from scenarios.scenario.load import checked
from scenarios.scenario.parts import names_folder
from scenarios.scenario.scenario import Scenario
from scenarios.studies.flight_study import FlightStudy
from scenarios.studies.manifest import plugins, refuse_changed
from scenarios.studies.single_flight import SingleFlight

_TABLES = (SUMMARY, COMPARISON)
"""Tables that may have the row of a flight."""

_ONLY_FLIGHTS = "only single flights can be replayed"

NOT_COMPARED = ("wall_time_s",)
"""Columns that differ between repetitions of the same flight."""


class Replay(SingleFlight):
    """The replay of one flight, as a study.

    Parameters
    ----------
    name : ``RUN_DIR/flights/ID``, with or without the suffix of one of its files
    viewer : host and port of a FlightGear that is to show it, in real time; none if not given
    aircraft_dir : directory in which the folder of the user's own aircraft is now, if it was moved
        since

    Raises
    ------
    InputError : there is no such flight, or the run cannot be read
    """

    def __init__(
        self, name: str, viewer: tuple[str, int] | None = None, *, aircraft_dir: Path | None = None
    ) -> None:
        self._viewer = viewer
        self._flight_id = flight_of(name)
        self._from = Path(name).parents[1]
        manifest = self._manifest()
        if "replayed" in manifest:
            raise InputError(
                f"'{self._from}' is the run of a replay; give the flight as RUN_DIR/flights/ID of its original run"
            )
        self._task, self._table, self._row = self._found()
        if "trial" not in self._row:
            raise InputError(
                f"'{self._from}' is a study of {manifest.get('study')}; {_ONLY_FLIGHTS}"
            )
        if viewer and self._row.get("fidelity") != "six_dof":
            raise InputError(
                f"--flightgear shows aircraft in six degrees of freedom; '{self._flight_id}' is a kinematic flight"
            )
        try:
            study = self._restored(
                self._moved(manifest, aircraft_dir) if aircraft_dir else manifest
            )
        except (LookupError, TypeError, AttributeError, ValueError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(
                f"'{self._from}': {MANIFEST} is not that of a run ({type(error).__name__}: {error})"
            ) from None
        self._original_fingerprint = manifest.get("fingerprint", {})
        task, trial = replace(self._task, every_step=True), self._row["trial"]
        super().__init__(study, task, flight_id=self._flight_id, trial=trial, table=self._table)

    def _manifest(self) -> dict[str, Any]:
        try:
            manifest = json.loads((self._from / MANIFEST).read_text(encoding="utf-8"))
            return dict(manifest)
        except (ValueError, TypeError, OSError, RecursionError) as error:
            raise InputError(
                f"'{self._from}': {MANIFEST} cannot be read: {error}; give the directory of a run"
            ) from None

    def _found(self) -> tuple[Task, str, Row]:
        """Return the task of the flight, the table that has its row, and the row."""
        path = self._from / JOURNAL
        if not path.is_file():
            raise InputError(
                f"'{self._from}' has no {path.name} with the results of its flights; give the directory of a complete run"
            )
        journal = Journal(path, reading=True)
        try:
            for table in _TABLES:
                for number, row in journal.numbered(table):
                    if row.get("flight_id") == self._flight_id:
                        return journal.task(number), table, row
        finally:
            journal.close()
        raise InputError(
            f"'{self._from}' has no flight '{self._flight_id}'; its {SUMMARY} lists them"
        )

    def _moved(self, manifest: dict[str, Any], directory: Path) -> dict[str, Any]:
        """Return the manifest with the aircraft of its flights where it is now, in ``directory``;
        the row says so, too.
        """
        then = str(manifest["trials"][self._row["trial"]]["aircraft"])
        if not names_folder("aircraft", then):
            raise InputError(
                f"'{self._from}' flew the aircraft '{then}', which is of no directory; leave out --aircraft-dir"
            )
        now = folder_of(directory, Path(then).name)
        if self._row.get("aircraft") == then:
            self._row = {**self._row, "aircraft": now}
        trials = {name: config | {"aircraft": now} for name, config in manifest["trials"].items()}
        plugins = {
            now if name == then else name: digest for name, digest in manifest["plugins"].items()
        }
        return manifest | {"trials": trials, "plugins": plugins}

    def _restored(self, manifest: dict[str, Any]) -> FlightStudy:
        """Return the study of the run, or of the one trial of it that the flight belongs to.

        The trial comes from the manifest, scaled to its aircraft, and not from the catalog, which
        may have changed.
        """
        if "study" not in manifest:
            raise InputError(
                f"'{self._from}': manifest.json is not that of a run; give the directory of a complete run"
            )
        if "trials" not in manifest:
            raise InputError(f"'{self._from}' is a study of {manifest['study']}; {_ONLY_FLIGHTS}")
        trial, task, trials = self._row["trial"], self._task, manifest["trials"]
        for name in (trial, *trials):
            # It becomes part of the names of files.
            if not is_file_name(name) or name not in trials:
                raise InputError(
                    f"'{self._from}' names a trial {name!r}, which cannot be the name of a trial; do not use this run"
                )
        scenarios = {
            name: checked({**config, "study": "flights"}, Scenario)
            for name, config in trials.items()
        }
        flown = Experiment(trial, scenarios[trial]).points
        refuse_changed(manifest.get("plugins", {}), plugins(point.scenario for point in flown))
        study = FlightStudy(scenarios[trial], trial, {trial: scenarios[trial]})
        if len(scenarios) > 1:
            study.name_by_trial()
        flights = {name: Experiment(name, scenario).flights for name, scenario in scenarios.items()}
        before = sum(flights[name] for name in list(trials)[: list(trials).index(trial)])
        # Of a flight that the study gave a seed of its own, the row has it.
        self._task = Task(number=task.number - before, point=task.point, seed=self._row.get("seed"))
        if not 0 <= self._task.number < flights[trial]:
            raise InputError(
                f"'{self._from}': flight '{self._flight_id}' has number {task.number}; '{trial}' has no such flight"
            )
        return study

    def initial_manifest(self) -> dict[str, Any]:
        """Return the manifest as written before the flight."""
        manifest = super().initial_manifest()
        return manifest | {
            "title": f"{manifest['title']}: replay of {self._flight_id}",
            "replayed": self._flight_id,
        }

    def work(self, run: RunDirectory) -> Work:
        """Return the work of the original study, shown where that is asked for."""
        work = super().work(run)
        return (
            replace(work, viewer=self._viewer)
            if self._viewer and isinstance(work, FlightWork)
            else work
        )

    def summary(self, journal: Journal) -> StudySummary:
        """Return whether the row is identical to that of the original flight."""
        rows, verdict = list(journal.rows(self._table)), self.judged(journal)
        if not rows:
            verdict = replace(verdict, required_met=False)
            return StudySummary(verdict=verdict, lines=["not flown"], manifest={"identical": False})
        differing = [
            name for name in dict.fromkeys([*self._row, *rows[0]])
            if name not in NOT_COMPARED and json.dumps(self._row.get(name)) != json.dumps(rows[0].get(name))
        ]  # fmt: skip
        message = rows[0].get("message", "")
        lines = [f"{self._flight_id}: {rows[0]['outcome']}{f': {message}' if message else ''}"]
        if not differing:
            lines.append(
                f"identical to the flight in {self._from}: every value of its row agrees to the last bit"
            )
        else:
            changes = ", ".join(
                f"{name} {self._row.get(name)} -> {rows[0].get(name)}" for name in differing[:3]
            )
            lines.append(
                f"differs from the flight in {self._from} in {len(differing)} values: {changes}; {self._reason()}"
            )
        # The exit status is about the repetition, and not about the flight.
        verdict = replace(verdict, required_met=not differing)
        return StudySummary(verdict=verdict, lines=lines, manifest={"identical": not differing})

    def _reason(self) -> str:
        """Return a possible reason."""
        changed = differences(self._original_fingerprint)
        return (
            f"the original was flown with a different {', '.join(changed)}"
            if changed
            else "software and source are unchanged"
        )
