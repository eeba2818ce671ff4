"""The runs that are compared, each by a letter."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from common.run_layout import SUMMARY
from reports.errors import ReportError
from reports.run.files import damage_named
from reports.run.run_data import FLIGHT_ENTRIES, RunData, read_run, refuse_other_version
from reports.run.trials import Trial, read_trials

RUNS_MAX = 6
"""Runs that fit side by side."""

_NOT_COMPARED = {
    **dict.fromkeys(("design", "measurement"), "which has no flights to compare"),
}
"""Studies whose runs are not compared, and why; a study that others add says it in its manifest."""

_ENTRIES = (
    *FLIGHT_ENTRIES, "name", "overrides", "config_hash", "fingerprint", "packages", "git_revision",
    "python", "platform",
    "flights_planned",
)  # fmt: skip
_COLUMNS = (
    "flight_id", "trial", "seed", "outcome", "message", "criteria_met", "kept_out",
    "keepout_violations", "keepout_radius_m",
    "min_distance_m", "settling_time_s", "duration_s",
)  # fmt: skip
"""What a comparison needs of a manifest, and of a summary."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """A run of a comparison.

    Attributes
    ----------
    letter : "A" for the first
    data : as read from disk
    trials : of the run
    """

    letter: str
    data: RunData
    trials: Sequence[Trial]

    @property
    def name(self) -> str:
        """Name of its directory."""
        return self.data.path.resolve().name

    @property
    def title(self) -> str:
        """Its letter and the name of its directory."""
        return f"{self.letter}: {self.name}"

    @property
    def manifest(self) -> dict[str, Any]:
        """Its manifest."""
        return self.data.manifest

    @property
    def state(self) -> str:
        """How it ended, in words."""
        return "complete" if self.data.verdict.is_done else "interrupted"


def read_runs(paths: Sequence[Path]) -> list[Run]:
    """Read the runs to be compared.

    Raises
    ------
    ReportError : there are too few or too many, one is named twice, or one is none with flights of
        this version that has ended
    """
    if not 2 <= len(paths) <= RUNS_MAX:
        raise ReportError(
            f"{len(paths)} run{'s' if len(paths) != 1 else ''} given; 2 to {RUNS_MAX} can be"
            " compared: name so many"
        )
    resolved = [path.resolve() for path in paths]
    for i, path in enumerate(resolved):
        if path in resolved[:i]:
            raise ReportError(f"'{paths[i]}' is given twice; name another run")
    return [_read(chr(ord("A") + i), path) for i, path in enumerate(paths)]


def _read(letter: str, path: Path) -> Run:
    data = read_run(path)
    study = str(data.manifest.get("study"))
    if reason := data.manifest.get("not_compared") or _NOT_COMPARED.get(study):
        raise ReportError(f"'{path}' is of the study '{study}', {reason}; name a run of flights")
    refuse_other_version(data, _ENTRIES)
    if missing := [name for name in _COLUMNS if name not in data.summary]:
        raise ReportError(
            f"'{path}' was flown by another version: its {SUMMARY} has no '{missing[0]}'; run the"
            " scenario again in another --out"
        )
    # A run that did not end has no verdict, and is refused.
    _ = data.verdict
    with damage_named(path):
        return Run(letter=letter, data=data, trials=read_trials(data))
