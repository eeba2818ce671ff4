"""Tasks, the work to be done on them, and their results."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol, Self

from scenarios.errors import InputError

Row = dict[str, Any]
"""A row of a table: values by column name."""

TIME_RANGE = 1.0, 1e6
"""Least and largest time limit of a task [s].

The largest is eleven days, so that a wait in milliseconds does not overflow.
"""

MEMORY_RANGE = 0.25, 1e6
"""Least and largest memory limit of a process [GiB].

The largest, about a pebibyte, is more than processors can address.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """A piece of work, usually one flight.

    Attributes
    ----------
    number : index in the study, from 0
    point : coordinates of the random variables in the unit cube, if the study chooses them;
        otherwise they follow from the number
    recorded : whether the time history is written in any case
    every_step : whether the time history has every step of the guidance
    seed : seed of the noise, if the study chooses it; otherwise it follows from the number and the
        random variables
    labels : columns and values that the study adds to the table of inputs
    """

    number: int
    point: tuple[float, ...] = ()
    recorded: bool = False
    every_step: bool = False
    seed: int | None = None
    labels: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """The result of a task.

    Attributes
    ----------
    task : the task
    tables : rows by file name of the table
    files : contents of files by path in the run directory
    items : number of the study's items in this result
    lost : whether the process was lost, so that ``--resume`` repeats the task
    """

    task: Task
    tables: dict[str, list[Row]]
    files: dict[str, bytes] = field(default_factory=dict)
    items: int = 1
    lost: bool = False


class Work(Protocol):
    """The work that a study does on each task.

    Work is sent to every process once, so it must be picklable. A result depends on the work and
    the task only, not on earlier tasks of the process.

    Attributes
    ----------
    model : directory of the files that the work needs, or None
    """

    @property
    def model(self) -> Path | None:
        """Return the directory of the files that the work needs, or None."""

    def moved(self, model: Path) -> "Work":
        """Return the same work with its files in another directory."""

    def run(self, task: Task) -> Result:
        """Do a task; a failure becomes a row with its reason, but MemoryError is raised."""

    def lost(self, task: Task, reason: str) -> Result:
        """Return the result of a task whose process was lost."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Limits of a task; if one is exceeded, the process is killed and the task is tried again.

    Attributes
    ----------
    time : time of a task [s]
    memory : data memory of a process [bytes], or None for no limit
    """

    time: float = 600.0
    memory: int | None = None

    @classmethod
    def given(cls, time_s: float, memory_gib: float | None) -> Self:
        """Return the limits from the options of a command line.

        Parameters
        ----------
        time_s, memory_gib : ``--time-limit`` [s] and ``--memory-limit`` [GiB]

        Raises
        ------
        InputError : a limit is out of range or NaN
        """
        _check("--time-limit", time_s, "s", TIME_RANGE)
        if memory_gib is None:
            return cls(time=time_s)
        _check("--memory-limit", memory_gib, "GiB", MEMORY_RANGE)
        return cls(time=time_s, memory=round(memory_gib * 2**30))


def _check(name: str, value: float, unit: str, limits: tuple[float, float]) -> None:
    # Both comparisons are false for NaN.
    if not limits[0] <= value <= limits[1]:
        raise InputError(
            f"{name} is {value:g} {unit}; it must lie between {limits[0]:g} and {limits[1]:g}"
            f" {unit}"
        )
