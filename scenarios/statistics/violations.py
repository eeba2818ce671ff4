"""Flights with keep-out violations, and flights for which that is unknown."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from scenarios.flight.outcome import Outcome


@dataclass(frozen=True, slots=True, kw_only=True)
class Violations:
    """Counts of flights by keep-out violation.

    Attributes
    ----------
    flights : number of all flights
    measured : number of flights with a measured distance
    events : number of measured flights with a keep-out violation
    unknown : names of the flights without a recorded violation that were not measured to their end,
        by outcome: flights without any measurement, and flights that went out of control
    """

    flights: int
    measured: int
    events: int
    unknown: dict[str, list[str]]

    @property
    def events_at_most(self) -> int:
        """Number of flights with a violation, if every unknown flight had one."""
        return self.events + sum(len(flights) for flights in self.unknown.values())


def count_violations(rows: pd.DataFrame) -> Violations:
    """Count the flights of a summary that violated the keep-out area at any time, each once.

    Parameters
    ----------
    rows : a row per flight with ``flight_id``, ``outcome``, ``min_distance_m`` and
        ``keepout_violations``
    """
    measured = np.isfinite(
        pd.to_numeric(rows["min_distance_m"], errors="coerce").to_numpy(dtype=np.float64)
    )
    entered = measured & (
        pd.to_numeric(rows["keepout_violations"], errors="coerce").to_numpy(dtype=np.float64) > 0.0
    )
    lost = rows[~entered & (~measured | (rows["outcome"] == Outcome.DIVERGED.value).to_numpy())]
    return Violations(
        flights=len(rows),
        measured=int(np.count_nonzero(measured)),
        events=int(np.count_nonzero(entered)),
        unknown={
            str(outcome): [str(i) for i in members["flight_id"]]
            for outcome, members in lost.groupby("outcome")
        },
    )
