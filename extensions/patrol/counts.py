"""Sums over the patrols of a run, and their verdict: for study, exit status and report alike."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

from common.physics import SECONDS_PER_HOUR


@dataclass(frozen=True, slots=True, kw_only=True)
class PatrolCounts:
    """Sums over patrols.

    Attributes
    ----------
    planned, done : patrols that were planned, and those that were flown
    through : patrols that met their criteria: they kept out and brought their aircraft back
    kept_out : patrols that kept out
    ships, served : ships, and those that were measured
    verdicts, correct, wrong, open : verdicts on ships, the correct and the wrong ones, and flights
        without a verdict
    oracle : verdicts of an oracle that knows everything
    violations : of keep-out areas
    hours : of all patrols [h]
    oracle_share_min : least number of correct verdicts over the oracle's verdicts [-]
    wrong_share_max : largest number of wrong verdicts over all verdicts [-]
    """

    planned: int
    done: int
    through: int
    kept_out: int
    ships: int
    served: int
    verdicts: int
    correct: int
    wrong: int
    open: int
    oracle: int
    violations: int
    hours: float
    oracle_share_min: float
    wrong_share_max: float

    @classmethod
    def of(
        cls,
        rows: Sequence[Mapping[Any, Any]],
        *,
        planned: int,
        oracle_share_min: float,
        wrong_share_max: float,
    ) -> Self:
        """Return the sums over the rows of a summary; missing figures count as 0."""
        return cls(
            planned=planned,
            done=len(rows),
            through=_total(rows, "criteria_met"),
            kept_out=_total(rows, "kept_out"),
            ships=_total(rows, "ships"),
            served=_total(rows, "served"),
            verdicts=_total(rows, "verdicts"),
            correct=_total(rows, "correct"),
            wrong=_total(rows, "wrong"),
            open=_total(rows, "open"),
            oracle=_total(rows, "oracle_verdicts"),
            violations=_total(rows, "keepout_violations"),
            hours=math.fsum(_known(row, "duration_s") for row in rows) / SECONDS_PER_HOUR,
            oracle_share_min=oracle_share_min,
            wrong_share_max=wrong_share_max,
        )

    @property
    def judged(self) -> bool:
        """Whether a ship was served and there is a verdict, of the patrol or of the oracle."""
        return self.served > 0 and self.verdicts + self.oracle > 0

    @property
    def enough(self) -> bool:
        """Whether there are enough correct verdicts, compared with the oracle's."""
        return self.correct >= self.oracle_share_min * self.oracle

    @property
    def right(self) -> bool:
        """Whether few enough verdicts are wrong."""
        return self.wrong <= self.wrong_share_max * self.verdicts

    @property
    def holds(self) -> bool:
        """Whether a ship was served, and every patrol kept out and brought its aircraft back."""
        return self.served > 0 and self.through == self.done

    @property
    def met(self) -> bool:
        """Whether every planned patrol held, with enough verdicts and few enough wrong ones."""
        return (
            self.holds and self.done == self.planned and self.judged and self.enough and self.right
        )

    @property
    def per_hour(self) -> float:
        """Ships served per hour [1/h]."""
        return self.served / self.hours if self.hours else 0.0


def _known(row: Mapping[Any, Any], name: str) -> float:
    """Return a figure of a row, or 0 if it is missing: None, or NaN in a table."""
    value = row.get(name)
    return 0.0 if value is None or math.isnan(value) else float(value)


def _total(rows: Sequence[Mapping[Any, Any]], name: str) -> int:
    return round(sum(_known(row, name) for row in rows))
