"""One flight of a run, flown again from its manifest with every step of the guidance recorded."""

import json
from pathlib import Path
from typing import Any

from scenarios.engine.fingerprint import differences
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, Progress, Study, Summary
from scenarios.engine.task import Row, Task, Work
from scenarios.errors import InputError
from scenarios.flights import STUDY
from scenarios.schema.config import Scenario
from scenarios.schema.load import checked
from scenarios.schema.sea_config import SeaScenario
from scenarios.studies.registry import study_of

_TABLES = ("summary.csv", "comparison.csv")
"""Where the row of a flight may be."""

_OWN = ("wall_time_s",)
"""Figures that differ from one flying to the next."""


class Replay:
    """One flight as a study.

    Parameters
    ----------
    name : ``RUN_DIR/flights/ID``, with or without the ending of its time history

    Raises
    ------
    InputError : there is no such flight, or the run cannot be read
    """

    what = "flights"
    planned = 1

    def __init__(self, name: str) -> None:
        self._flight_id = Path(name).name.removesuffix(".parquet")
        self._from = Path(name).parents[1]
        manifest = self._manifest()
        if "replayed" in manifest:
            raise InputError(
                f"'{self._from}' holds a flight that was flown again already; give it as RUN_DIR/flights/ID of its first run"
            )
        self._task, self._table, self._row = self._found()
        self._study = self._restored(manifest)
        self._begun_with = manifest.get("fingerprint", {})
        self.config_hash = f"{self._study.config_hash} {self._flight_id}"

    def _manifest(self) -> dict[str, Any]:
        try:
            manifest = json.loads((self._from / "manifest.json").read_text(encoding="utf-8"))
            return dict(manifest)
        except (ValueError, TypeError, OSError) as error:
            raise InputError(f"'{self._from}': manifest.json cannot be read: {error}; give the directory of a run") from None

    def _found(self) -> tuple[Task, str, Row]:
        """Return the task of the flight, and its row and what table that is in."""
        path = RunDirectory(self._from).journal
        if not path.is_file():
            raise InputError(f"'{self._from}' has no {path.name}, in which its flights are; give the directory of a whole run")
        journal = Journal(path)
        try:
            for table in _TABLES:
                for number, row in journal.numbered(table):
                    if row.get("flight_id") == self._flight_id:
                        return journal.task(number), table, row
        finally:
            journal.close()
        raise InputError(f"'{self._from}' has no flight '{self._flight_id}'; its summary.csv lists them")

    def _restored(self, manifest: dict[str, Any]) -> Study:
        """Return the study of the run, or of the one trial of it that the flight belongs to.

        A trial is taken as it was flown, fitted to its aircraft, and not from the catalog, which may have changed.
        """
        if "trials" in manifest:
            trial = self._row["trial"]
            first = next(i for i, name in enumerate(manifest["trials"]) if name == trial)
            before = sum(scenario["flights"] for scenario in list(manifest["trials"].values())[:first])
            self._task = Task(number=self._task.number - before, point=self._task.point)
            config = {key: value for key, value in manifest["trials"][trial].items() if key in SeaScenario.model_fields}
            return study_of(checked(config | {"study": "sea"}, SeaScenario), trial)
        if manifest.get("study") in ("flights", "paper"):
            return study_of(checked(manifest["config"], Scenario), str(manifest["name"]))
        raise InputError(f"'{self._from}' is a study of {manifest.get('study')}; what can be flown again are flights")

    def opening(self) -> dict[str, Any]:
        """Return what the manifest says before anything has been flown."""
        manifest = self._study.opening()
        again: dict[str, Any] = {"title": f"{manifest['title']}: {self._flight_id}, flown again", "replayed": self._flight_id}
        if "trials" in manifest:
            again["trials"] = {trial: config | {"flights": 1} for trial, config in manifest["trials"].items()}
        else:
            again["variants"] = {self._flight_id: STUDY}
        return manifest | again | {"config_hash": self.config_hash, "flights_planned": 1}

    def work(self, run: RunDirectory) -> Work:
        """Return the flying of the flight."""
        return self._study.work(run)

    def conduct(self, fly: Fly, _run: RunDirectory, _journal: Journal) -> None:
        """Have the flight flown."""
        fly([Task(number=self._task.number, point=self._task.point, every_step=True)])

    def finish(self, _run: RunDirectory, _journal: Journal, _progress: Progress) -> None:
        """Leave it at that."""

    def export(self, run: RunDirectory, journal: Journal) -> None:
        """Write its tables; the flight is what it is about, also if it was a comparison."""
        self._study.export(run, journal)
        if self._table != _TABLES[0]:
            (run.path / self._table).replace(run.path / _TABLES[0])

    def summary(self, journal: Journal) -> Summary:
        """Return whether it went as it did the first time."""
        rows = list(journal.rows(self._table))
        if not rows:
            return Summary(done=0, met=False, lines=["not flown"], manifest={"identical": False})
        differing = [
            name for name in dict.fromkeys([*self._row, *rows[0]])
            if name not in _OWN and json.dumps(self._row.get(name)) != json.dumps(rows[0].get(name))
        ]  # fmt: skip
        lines = [f"{self._flight_id}: {rows[0]['outcome']} {rows[0].get('message', '')}".rstrip()]
        if not differing:
            lines.append(f"identical to the flight in {self._from}, in every figure of its row to the last bit")
        else:
            was = ", ".join(f"{name} {self._row.get(name)} -> {rows[0].get(name)}" for name in differing[:3])
            lines.append(f"differs from the flight in {self._from} in {len(differing)} figures: {was}; {self._why()}")
        return Summary(done=1, met=not differing, lines=lines, manifest={"identical": not differing})

    def _why(self) -> str:
        """Return what may be the reason."""
        changed = differences(self._begun_with)
        return f"it was flown with another {', '.join(changed)}" if changed else "nothing that results depend on has changed"
