"""What a study's flights have come to, counted row by row."""

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Self

from scenarios.engine.task import Row
from scenarios.simulation.closed_loop import Outcome

_SHOWN = 20
"""Flights that are named on the console, at most."""


@dataclass(slots=True, kw_only=True)
class Tally:
    """Counts of flights.

    Attributes
    ----------
    planned : flights
    done, met : flights that are done, and that completed and met every criterion
    outcomes : flights by their outcome
    entries : into the keep-out area
    nearest : closest approach to the vessel, infinite if nothing was flown [m]
    unmet : flights that fell short, the first of them
    """

    planned: int
    done: int = 0
    met: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    entries: int = 0
    nearest: float = math.inf
    unmet: list[Row] = field(default_factory=list)

    @classmethod
    def of(cls, rows: Iterable[Row], planned: int) -> Self:
        """Return the counts of rows of a summary."""
        tally = cls(planned=planned)
        for row in rows:
            tally.add(row)
        return tally

    def add(self, row: Row) -> None:
        """Count a row."""
        self.done += 1
        self.outcomes[row["outcome"]] += 1
        self.entries += int(row.get("keepout_violations", 0))
        self.nearest = min(self.nearest, row.get("min_distance_m", math.inf))
        if row["criteria_met"]:
            self.met += 1
        elif len(self.unmet) < _SHOWN:
            self.unmet.append(row)

    @property
    def completed(self) -> int:
        """Number of flights that completed."""
        return self.outcomes[Outcome.COMPLETED.value]

    def unmet_lines(self, indent: str) -> list[str]:
        """Return a line for each flight that fell short, for the first of them."""
        lines = [f"{indent}{row['flight_id']}: {row['outcome']}: {row['message']}" for row in self.unmet]
        more = self.done - self.met - len(self.unmet)
        return [*lines, f"{indent}and {more} more, in summary.csv"] if more else lines

    def manifest(self) -> dict[str, Any]:
        """Return what the manifest of a run says of them."""
        return {
            "outcomes": {outcome.value: self.outcomes[outcome.value] for outcome in Outcome},
            "flights_met_criteria": self.met,
        }
