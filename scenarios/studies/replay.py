"""Replay of one flight of a run, from its manifest, with every step of the guidance recorded."""

import itertools
import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

from common.run_layout import COMPARISON, JOURNAL, MANIFEST, SUMMARY, flight_of, is_file_name
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory, differences
from scenarios.engine.runner import StudySummary
from scenarios.engine.task import Row, Task, Work
from scenarios.errors import InputError
from scenarios.experiment.requests import Experiment
from scenarios.flight.closed_loop import Viewer
from scenarios.flight_runner import FlightRunner
from scenarios.scenario.files import checked, folder_of
from scenarios.scenario.parts import names_folder
from scenarios.scenario.scenario import Scenario
from scenarios.studies.base import FlightStudy, SingleFlight
from scenarios.studies.manifest import plugins, refuse_changed

NOT_COMPARED = ("wall_time_s",)
"""Columns that differ between repetitions of the same flight."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OriginalFlight:
    """A flight of an earlier run, from the run's manifest and journal.

    Attributes
    ----------
    directory, manifest : of the run
    task, table, row : the flight's task, the name of the file with its row, and the row
    """

    directory: Path
    manifest: dict[str, Any]
    task: Task
    table: str
    row: Row

    @classmethod
    def read(cls, name: str) -> Self:
        """Return a flight by ``RUN_DIR/flights/ID``, with or without the suffix of a file of it.

        Raises
        ------
        InputError : there is no such flight, or it cannot be replayed, or the run cannot be read
        """
        directory = Path(name).parents[1]
        manifest = _manifest_of(directory)
        if "replayed" in manifest:
            raise InputError(
                f"'{directory}' is the run of a replay; give the flight as RUN_DIR/flights/ID of"
                " its original run"
            )
        task, table, row = _recorded(directory, flight_of(name))
        if "trial" not in row or "trials" not in manifest:
            if "study" not in manifest:
                raise InputError(
                    f"'{directory}': {MANIFEST} is not that of a run; give the directory of a"
                    " complete run"
                )
            raise InputError(
                f"'{directory}' is a study of {manifest['study']}; only single flights can be"
                " replayed"
            )
        return cls(directory=directory, manifest=manifest, task=task, table=table, row=row)

    def with_aircraft_in(self, folder: Path) -> Self:
        """Return the same trial with the aircraft in ``folder``, its present place."""
        then = str(self.manifest["trials"][self.row["trial"]]["aircraft"])
        if not names_folder("aircraft", then):
            raise InputError(
                f"'{self.directory}' flew the aircraft '{then}', which is of no directory; leave"
                " out --aircraft-dir"
            )
        now = folder_of(folder, Path(then).name)
        trials = {
            name: config | {"aircraft": now} for name, config in self.manifest["trials"].items()
        }
        parts = {
            now if name == then else name: digest
            for name, digest in self.manifest["plugins"].items()
        }
        row = self.row | {"aircraft": now} if self.row.get("aircraft") == then else self.row
        return replace(self, manifest=self.manifest | {"trials": trials, "plugins": parts}, row=row)

    def restored(self) -> tuple[FlightStudy, Task]:
        """Return the study of the one trial of the run that the flight belongs to, and its task in
        it.

        The trial comes from the manifest, scaled to its aircraft, and not from the catalog, which
        may have changed.
        """
        trial, trials = self.row["trial"], self.manifest["trials"]
        for name in (trial, *trials):
            # The name becomes part of file names.
            if not is_file_name(name) or name not in trials:
                raise InputError(
                    f"'{self.directory}' names a trial {name!r}, which cannot be the name of a"
                    " trial; do not use this run"
                )
        scenarios = {
            name: checked({**config, "study": "flights"}, Scenario)
            for name, config in trials.items()
        }
        flown = Experiment(trial, scenarios[trial]).points
        refuse_changed(self.manifest.get("plugins", {}), plugins(point.scenario for point in flown))
        study = FlightStudy(scenarios[trial], trial, {trial: scenarios[trial]})
        if len(scenarios) > 1:
            study.name_by_trial()
        flights = {name: Experiment(name, scenario).flights for name, scenario in scenarios.items()}
        before = itertools.takewhile(lambda name: name != trial, trials)
        number = self.task.number - sum(flights[name] for name in before)
        if not 0 <= number < flights[trial]:
            raise InputError(
                f"'{self.directory}': flight '{self.row['flight_id']}' has number"
                f" {self.task.number}; '{trial}' has no such flight"
            )
        # The study may have chosen the seed; it is in the row.
        return study, Task(
            number=number, point=self.task.point, seed=self.row.get("seed"), every_step=True
        )


def _manifest_of(directory: Path) -> dict[str, Any]:
    try:
        return dict(json.loads((directory / MANIFEST).read_text(encoding="utf-8")))
    except (ValueError, TypeError, OSError, RecursionError) as error:
        raise InputError(
            f"'{directory}': {MANIFEST} cannot be read: {error}; give the directory of a run"
        ) from None


def _recorded(directory: Path, flight_id: str) -> tuple[Task, str, Row]:
    """Return the task of a flight, the table that has its row, and the row."""
    path = directory / JOURNAL
    if not path.is_file():
        raise InputError(
            f"'{directory}' has no {path.name} with the results of its flights; give the"
            " directory of a complete run"
        )
    journal = Journal(path, reading=True)
    try:
        for table in (SUMMARY, COMPARISON):
            for number, row in journal.numbered(table):
                if row.get("flight_id") == flight_id:
                    return journal.task(number), table, row
    finally:
        journal.close()
    raise InputError(f"'{directory}' has no flight '{flight_id}'; its {SUMMARY} lists them")


class Replay(SingleFlight):
    """The replay of one flight, as a study.

    Parameters
    ----------
    name : ``RUN_DIR/flights/ID``, with or without the suffix of one of its files
    viewer : shows it in real time; by default there is no viewer
    aircraft_dir : directory with the folder of the user's own aircraft, if the folder was moved
        since the run

    Raises
    ------
    InputError : there is no such flight, or the run cannot be read
    """

    def __init__(
        self, name: str, viewer: Viewer | None = None, *, aircraft_dir: Path | None = None
    ) -> None:
        original = OriginalFlight.read(name)
        flight_id = original.row["flight_id"]
        if viewer and original.row.get("fidelity") != "six_dof":
            raise InputError(
                f"aircraft in six degrees of freedom can be shown, no others; '{flight_id}' is a"
                " kinematic flight"
            )
        try:
            if aircraft_dir:
                original = original.with_aircraft_in(aircraft_dir)
            study, task = original.restored()
        except InputError:
            raise
        except (LookupError, TypeError, AttributeError, ValueError) as error:
            raise InputError(
                f"'{original.directory}': {MANIFEST} is not that of a run"
                f" ({type(error).__name__}: {error})"
            ) from None
        self._original, self._viewer = original, viewer
        super().__init__(
            study, task, flight_id=flight_id, trial=original.row["trial"], table=original.table
        )

    def initial_manifest(self) -> dict[str, Any]:
        """Return the manifest as written before the flight."""
        manifest = super().initial_manifest()
        return manifest | {
            "title": f"{manifest['title']}: replay of {self._flight_id}",
            "replayed": self._flight_id,
        }

    def work(self, run: RunDirectory) -> Work:
        """Return the work of the original study, shown if there is a viewer."""
        work = super().work(run)
        return (
            replace(work, viewer=self._viewer)
            if self._viewer and isinstance(work, FlightRunner)
            else work
        )

    def summary(self, journal: Journal) -> StudySummary:
        """Return whether the row is identical to that of the original flight."""
        row, verdict = next(journal.rows(self._original.table), None), self.judged(journal)
        if row is None:
            verdict = replace(verdict, required_met=False)
            return StudySummary(verdict=verdict, lines=["not flown"], manifest={"identical": False})
        before, where = self._original.row, self._original.directory
        differing = [
            name
            for name in dict.fromkeys([*before, *row])
            if name not in NOT_COMPARED
            and json.dumps(before.get(name)) != json.dumps(row.get(name))
        ]
        message = row.get("message", "")
        lines = [f"{row['flight_id']}: {row['outcome']}{f': {message}' if message else ''}"]
        if not differing:
            lines.append(
                f"identical to the flight in {where}: every value of its row agrees to the last bit"
            )
        else:
            changes = ", ".join(
                f"{name} {before.get(name)} -> {row.get(name)}" for name in differing[:3]
            )
            lines.append(
                f"differs from the flight in {where} in {len(differing)} values: {changes};"
                f" {self._reason()}"
            )
        # The exit status says whether the repetition is identical, not whether the flight met its
        # criteria.
        verdict = replace(verdict, required_met=not differing)
        return StudySummary(verdict=verdict, lines=lines, manifest={"identical": not differing})

    def _reason(self) -> str:
        """Return a possible reason for a difference."""
        changed = differences(self._original.manifest.get("fingerprint", {}))
        if changed:
            return f"the original was flown with a different {', '.join(changed)}"
        return "software and source are unchanged"
