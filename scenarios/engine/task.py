"""What a crew does, piece by piece, and what comes of it."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

Row = dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """A piece of work: mostly a flight.

    Attributes
    ----------
    number : in its study, from 0
    point : where in the unit cube of what is drawn, for a study that chooses it; otherwise what is drawn follows from the number
    recorded : whether a time history is wanted, come what may
    every_step : whether that is to have every step of the guidance
    """

    number: int
    point: tuple[float, ...] = ()
    recorded: bool = False
    every_step: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """What became of a piece of work.

    Attributes
    ----------
    task : that was done
    tables : rows by the table that they belong to
    files : contents of files by their paths in the run directory
    items : how many of what the study counts
    lost : whether its process was lost, so that it may be tried again
    """

    task: Task
    tables: dict[str, list[Row]]
    files: dict[str, bytes] = field(default_factory=dict)
    items: int = 1
    lost: bool = False


class Work(Protocol):
    """What a study does with each task. It is sent to every process once: it must be possible to pickle it.

    What it returns depends on itself and on the task alone, not on what the process did before.

    Attributes
    ----------
    model : directory of files that it needs, or none
    """

    @property
    def model(self) -> Path | None:
        """Return the directory of files that it needs."""

    def moved(self, model: Path) -> "Work":
        """Return the same work with its files in another directory."""

    def fly(self, task: Task) -> Result:
        """Do a task. Whatever goes wrong is a row with its reason, but for a lack of memory, which is raised."""

    def lost(self, task: Task, reason: str) -> Result:
        """Return the result of a task whose process was lost."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """What a flight may take before its process is ended and it is tried once more.

    Attributes
    ----------
    time : [s]
    memory : of the process [bytes], or none
    """

    time: float = 600.0
    memory: int | None = None
