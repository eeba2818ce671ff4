"""The record of an arena, for its report."""

import json
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import pandas as pd

from common.columns import Column
from common.files import is_file
from extensions.arena import ALL, ARENA, TRACKING, WINDOW_TABLE
from extensions.arena.paired_bootstrap import Estimate
from measurement.gases import MASS_PERCENT
from reports.run.columns import was_flown
from reports.run.run_data import RunData

ERROR, EFFORT, CROSSINGS = "error_rms_m", "effort_rms_rad_s", "crossings_per_minute"
PLUME_TIME, SULPHUR = "plume_s_per_minute", "sulphur_information_per_minute"

TRACKING_FIGURES = (ERROR, EFFORT, "excess_rms_rad_s", "saturated_share")
MEASURING_FIGURES = (CROSSINGS, PLUME_TIME, SULPHUR, "crossing_distance_mean_m")
"""Figures of merit, by their columns in ``window.csv``."""


def _error_of_a_minute(information: float) -> float:
    """Return the standard uncertainty of the information of a minute; infinite without any."""
    if math.isnan(information):
        return math.nan
    return 1.0 / math.sqrt(information) if information > 0.0 else math.inf


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """A figure of merit.

    Attributes
    ----------
    column : its name, unit and digits, as it is shown
    greater_first : whether more of the recorded value is better
    shown : displayed form of a recorded value
    """

    column: Column
    greater_first: bool
    shown: Callable[[float], float]

    def text(self, value: float) -> str:
        """Return a shown value as text; a dash where it is not a number."""
        if math.isnan(value):
            return "–"
        return f"{value:.{self.column.digits}f}" if math.isfinite(value) else "∞"


_SULPHUR_ERROR = Column(title="Sulphur error of a minute", unit=MASS_PERCENT, digits=4)

_WHOSE = ("figure", "condition", "entrant")
"""Keys of an entry of ``arena.json`` other than the estimate itself."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Entrant:
    """A law in a task.

    Attributes
    ----------
    number : its number in figures, from 1
    name, law, task, inputs : same as in ``arena.json``
    defaults, tuned : its parameters
    cost_default, cost_tuned : costs in the tuner; NaN if it was not tuned [m]
    rows : its flights
    """

    number: int
    name: str
    law: str
    task: str
    inputs: str
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

    def figure(self, name: str) -> Figure:
        """Return a figure of merit by its column."""
        column = self.run.column(name, WINDOW_TABLE)
        greater_first = column.worse == "lower"
        if name == SULPHUR:
            return Figure(
                column=_SULPHUR_ERROR, greater_first=greater_first, shown=_error_of_a_minute
            )
        return Figure(
            column=column, greater_first=greater_first, shown=lambda value: column.scale * value
        )

    def of(self, figure: str, entrant: Entrant, condition: str) -> Estimate:
        """Return the estimate of a figure, as it is shown."""
        found, shown = self._recorded(figure, entrant, condition), self.figure(figure).shown
        low, high = sorted((shown(found.low), shown(found.high)))
        return replace(found, mean=shown(found.mean), low=low, high=high)

    def _recorded(self, figure: str, entrant: Entrant, condition: str) -> Estimate:
        return self._estimates.get((figure, condition, entrant.name), Estimate())

    def text(self, figure: str, entrant: Entrant) -> str:
        """Return the mean of a figure over all conditions as text."""
        return self.figure(figure).text(self.of(figure, entrant, self.together).mean)

    def has(self, figure: str) -> bool:
        """Return whether any law has a figure: those of the exhaust need a sniffer."""
        means = (self._recorded(figure, each, self.together).mean for each in self.entrants)
        return not all(map(math.isnan, means))

    @property
    def together(self) -> str:
        """Return the name for all conditions together: the only condition, where there is just
        one.
        """
        return ALL if len(self.conditions) > 1 else next(iter(self.conditions))

    def in_task(self, *, tracking: bool) -> list[Entrant]:
        """Return the entrants of a task."""
        return [entrant for entrant in self.entrants if entrant.tracks == tracking]

    def ranked(self, figure: str, entrants: Iterable[Entrant]) -> list[Entrant]:
        """Return entrants by the mean of a figure over all conditions, the best first; last those
        not compared, or without one.
        """

        greater_first = self.figure(figure).greater_first

        def place(entrant: Entrant) -> tuple[bool, bool, float]:
            found = self._recorded(figure, entrant, self.together)
            return (
                math.isnan(found.mean),
                not found.whole,
                -found.mean if greater_first else found.mean,
            )

        return sorted(entrants, key=place)

    def alike(self, figure: str, entrants: Iterable[Entrant]) -> list[Entrant]:
        """Return the entrants that do not differ significantly from the best over all conditions,
        the best first; empty without a comparison.

        An entrant differs significantly from the best if the bootstrap shows that another is
        better, and if their 95 % intervals are apart. One flight in each condition shows no
        difference.
        """
        ranked = [each for each in self.ranked(figure, entrants) if self._is_compared(figure, each)]
        if not ranked:
            return []
        best = self.of(figure, ranked[0], self.together)
        others = ((each, self.of(figure, each, self.together)) for each in ranked[1:])
        return [
            ranked[0],
            *(each for each, of in others if self.flights == 1 or of.as_good or _overlap(best, of)),
        ]

    def compared(self, figure: str, entrants: Iterable[Entrant]) -> int:
        """Return how many entrants are compared on a figure."""
        return sum(self._is_compared(figure, each) for each in entrants)

    def _is_compared(self, figure: str, entrant: Entrant) -> bool:
        return self._recorded(figure, entrant, self.together).whole

    def flights_of(self, condition: str) -> int:
        """Return the number of flights of each entrant in a mean, where all were flown."""
        return self.flights * (len(self.conditions) if condition == ALL else 1)


def _overlap(one: Estimate, other: Estimate) -> bool:
    return one.low <= other.high and other.low <= one.high


def read_arena(run: RunData) -> Arena | None:
    """Return the arena of a run; None for a run that ended before its evaluation."""
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
            inputs=entry["inputs"],
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
    of: dict[str, Any] = {
        key: math.nan if value is None else value
        for key, value in entry.items()
        if key not in _WHOSE
    }
    return Estimate(**of)
