"""What an arena left behind, as its report needs it."""

import json
import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import pandas as pd

from common.files import is_file
from common.run_layout import ARENA
from reports.arena.figures import Figure
from reports.run.columns import was_flown
from reports.run.run_data import RunData

ALL = "all"
"""Stands for all conditions together."""

TRACKING = "tracking"
"""The task of tracking the oscillating reference; the other is to circle the vessel."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """A mean over flights, with its interval; not a number where there is none.

    Attributes
    ----------
    mean, low, high : of the figure
    best, as_good : whether no other law's mean is better, and whether the flights do not show that
        another law is better
    whole : whether it is of every flight of which any law has the figure; otherwise it is not
        compared with the others
    flights : number of flights that it is of
    """

    mean: float = math.nan
    low: float = math.nan
    high: float = math.nan
    best: bool = False
    as_good: bool = False
    whole: bool = False
    flights: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Entrant:
    """A law in a task.

    Attributes
    ----------
    number : by which figures name it, from 1
    name, law, task, given : as of ``arena.json``
    defaults, tuned : its parameters
    cost_default, cost_tuned : to the tuner; not a number if it was not tuned [m]
    rows : its flights
    """

    number: int
    name: str
    law: str
    task: str
    given: str
    defaults: dict[str, float]
    tuned: dict[str, float]
    cost_default: float
    cost_tuned: float
    rows: pd.DataFrame

    @property
    def title(self) -> str:
        """Return the name of the law in words."""
        name = self.law.rpartition(":")[2].replace("_", " ")
        return (
            name
            if self.task == TRACKING or "orbit" in name or "loiter" in name or name == "lgvf"
            else f"{name} (circle)"
        )

    @property
    def tracks(self) -> bool:
        """Return whether it tracks the oscillating reference."""
        return self.task == TRACKING

    @property
    def unflown(self) -> pd.DataFrame:
        """Return its flights that could not be flown."""
        return self.rows[~was_flown(self.rows)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Arena:
    """An arena.

    Attributes
    ----------
    run : the run
    entrants : in the order in which they flew
    conditions : titles by name
    flights : of each entrant in each condition
    refused : laws that do not take part in a task: law, task, reason
    limits : most crossings per minute that any path allows, by condition, where they are known
        [1/min]
    """

    run: RunData
    entrants: list[Entrant]
    conditions: dict[str, str]
    flights: int
    refused: list[dict[str, str]]
    limits: dict[str, float]
    _estimates: dict[tuple[str, str, str], Estimate]

    def of(self, figure: Figure, entrant: Entrant, condition: str) -> Estimate:
        """Return the estimate of a figure, as it is shown."""
        found = self._estimates.get((figure.name, condition, entrant.name), Estimate())
        low, high = sorted((figure.shown(found.low), figure.shown(found.high)))
        return replace(found, mean=figure.shown(found.mean), low=low, high=high)

    def has(self, figure: Figure) -> bool:
        """Return whether any law has a figure: those of the exhaust need a sniffer."""
        return any(
            not math.isnan(self.of(figure, entrant, self.together).mean)
            for entrant in self.entrants
        )

    @property
    def together(self) -> str:
        """Return what stands for all conditions: the only one, where there is one alone."""
        return ALL if len(self.conditions) > 1 else next(iter(self.conditions))

    def in_task(self, *, tracking: bool) -> list[Entrant]:
        """Return the entrants of a task."""
        return [entrant for entrant in self.entrants if entrant.tracks == tracking]

    def ranked(self, figure: Figure, entrants: Iterable[Entrant]) -> list[Entrant]:
        """Return entrants by the mean of a figure over all conditions, the best first; last those
        not compared, or without one.
        """

        def place(entrant: Entrant) -> tuple[bool, bool, float]:
            found = self.of(figure, entrant, self.together)
            return (
                math.isnan(found.mean),
                not found.whole,
                -found.mean if figure.greater_first else found.mean,
            )

        return sorted(entrants, key=place)

    def best(self, figure: Figure, entrants: Iterable[Entrant]) -> Entrant | None:
        """Return the entrant with the best mean of a figure over all conditions, of those that are
        compared; none without one.
        """
        return next(
            (
                first
                for first in self.ranked(figure, entrants)[:1]
                if self.of(figure, first, self.together).whole
            ),
            None,
        )

    def flights_of(self, condition: str) -> int:
        """Return how many flights of each entrant a mean is of, where all were flown."""
        return self.flights * (len(self.conditions) if condition == ALL else 1)


def read_arena(run: RunData) -> Arena | None:
    """Return the arena of a run; none of one that ended before it was evaluated."""
    path = run.path / ARENA
    if not is_file(path):
        return None
    record = json.loads(path.read_text(encoding="utf-8"))
    rows = run.summary
    fidelity = str(run.manifest["config"]["fidelity"])
    entrants = [
        Entrant(
            number=i,
            name=entry["name"],
            law=entry["law"],
            task=entry["task"],
            given=entry["given"],
            defaults=entry["defaults"],
            tuned=entry["tuned"],
            cost_default=float(entry.get("cost_default_m", math.nan)),
            cost_tuned=float(entry.get("cost_tuned_m", math.nan)),
            rows=rows[
                [
                    _of_case(str(flight), str(trial), entry["name"], fidelity)
                    for flight, trial in _named(rows)
                ]
            ],
        )
        for i, entry in enumerate(record["entrants"], start=1)
    ]
    return Arena(
        run=run,
        entrants=entrants,
        conditions={condition["name"]: condition["title"] for condition in record["conditions"]},
        flights=int(record["flights"]),
        refused=record["refused"],
        limits=record["limits"],
        _estimates={
            (entry["figure"], entry["condition"], entry["entrant"]): _estimate(entry)
            for entry in record["estimates"]
        },
    )


def _named(rows: pd.DataFrame) -> Iterable[tuple[Any, Any]]:
    return zip(rows["flight_id"], rows["trial"], strict=True)


def _of_case(flight: str, trial: str, case: str, fidelity: str) -> bool:
    """Return whether a flight is one of a case: its name has the trial's, the case's and the
    vehicle's, and perhaps a number.
    """
    rest = flight.removeprefix(f"{trial}_")
    return rest == f"{case}_{fidelity}" or rest.rpartition("_")[0] == f"{case}_{fidelity}"


def _estimate(entry: dict[str, Any]) -> Estimate:
    mean, low, high = (
        math.nan if entry[key] is None else float(entry[key]) for key in ("mean", "low", "high")
    )
    return Estimate(
        mean,
        low,
        high,
        best=entry["best"],
        as_good=entry["as_good"],
        whole=entry["whole"],
        flights=entry["flights"],
    )
