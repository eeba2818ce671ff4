"""Counts of a study's flights, updated row by row."""

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Self

from common.run_layout import SUMMARY
from scenarios.engine.task import Row
from scenarios.simulation.outcome import Outcome

FAILED_SHOWN = 20
"""Failed flights that are named on the console, at most."""


@dataclass(slots=True, kw_only=True)
class FlightCounts:
    """Counts of flights.

    Attributes
    ----------
    planned : number of planned flights
    done, met : number of flights that are done, and of those that met every criterion
    outcomes : number of flights by their outcome
    keepout_violations : number of keep-out violations
    nearest : closest approach to the vessel, infinite if no flight is done [m]
    failed : rows of the first flights that failed a criterion
    """

    planned: int
    done: int = 0
    met: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    keepout_violations: int = 0
    nearest: float = math.inf
    failed: list[Row] = field(default_factory=list)

    @classmethod
    def of(cls, rows: Iterable[Row], planned: int) -> Self:
        """Return the counts of the rows of a summary."""
        counts = cls(planned=planned)
        for row in rows:
            counts.add(row)
        return counts

    def add(self, row: Row) -> None:
        """Count a row."""
        self.done += 1
        self.outcomes[row["outcome"]] += 1
        self.keepout_violations += int(row.get("keepout_violations", 0))
        self.nearest = min(self.nearest, row.get("min_distance_m", math.inf))
        if row["criteria_met"]:
            self.met += 1
        elif len(self.failed) < FAILED_SHOWN:
            self.failed.append(row)

    @property
    def completed(self) -> int:
        """Number of flights that completed."""
        return self.outcomes[Outcome.COMPLETED.value]

    def failed_lines(self, indent: str) -> list[str]:
        """Return a line for each of the first flights that failed, and one for the rest."""
        lines = [f"{indent}{row['flight_id']}: {row['outcome']}: {row['message']}" for row in self.failed]
        more = self.done - self.met - len(self.failed)
        return [*lines, f"{indent}and {more} more failed, see {SUMMARY}"] if more else lines

    def manifest(self) -> dict[str, Any]:
        """Return the entries of a manifest."""
        return {
            "outcomes": {outcome.value: self.outcomes[outcome.value] for outcome in Outcome},
            "flights_met_criteria": self.met,
        }
