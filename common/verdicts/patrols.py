"""Sums over the patrols of a run, and how they are judged: the same for the study, its exit status
and the report.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

from common.physics.units import SECONDS_PER_HOUR


@dataclass(frozen=True, slots=True, kw_only=True)
class PatrolCounts:
    """Sums over patrols.

    Attributes
    ----------
    planned, done : patrols that are planned, and those that are done
    through, kept_out : patrols that kept out with their aircraft, those that kept out
    ships, served, verdicts, correct, wrong, open : ships, those flown beside, and how these flights
        ended
    oracle : verdicts of an oracle that knows everything
    violations : of keep-out areas
    hours : of all patrols [h]
    oracle_share_min, wrong_share_max : least share of correct verdicts in the oracle's, largest one
        of wrong ones in all [-]
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
        """Return the sums over the rows of a summary; what a row does not know counts as 0."""
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
        """Whether there is a ship that was served, and a verdict to judge: its own or an oracle's."""
        return self.served > 0 and self.verdicts + self.oracle > 0

    @property
    def enough(self) -> bool:
        """Whether the correct verdicts are as many as the oracle's ask for."""
        return self.correct >= self.oracle_share_min * self.oracle

    @property
    def right(self) -> bool:
        """Whether no more verdicts are wrong than may be."""
        return self.wrong <= self.wrong_share_max * self.verdicts

    @property
    def holds(self) -> bool:
        """Whether nothing happened that must not: some ship was served, and every patrol kept out
        and brought its aircraft back.
        """
        return self.served > 0 and self.through == self.done

    @property
    def met(self) -> bool:
        """Whether every planned patrol held, and the verdicts are enough and right."""
        return (
            self.holds and self.done == self.planned and self.judged and self.enough and self.right
        )

    @property
    def per_hour(self) -> float:
        """Return ships served an hour [1/h]."""
        return self.served / self.hours if self.hours else 0.0


def _known(row: Mapping[Any, Any], name: str) -> float:
    """Return a figure of a row; 0 where it has none: rows of a table have "not a number" there."""
    value = row.get(name)
    return 0.0 if value is None or math.isnan(value) else float(value)


def _total(rows: Sequence[Mapping[Any, Any]], name: str) -> int:
    return round(sum(_known(row, name) for row in rows))
