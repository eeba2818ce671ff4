"""How many flights entered the keep-out area, and of how many that is not known."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from scenarios.simulation.outcome import Outcome


@dataclass(frozen=True, slots=True, kw_only=True)
class Violations:
    """Flights counted by whether they kept out.

    Attributes
    ----------
    flights : all
    measured : flights with a measured distance
    events : measured flights that entered
    unknown : flights not seen to enter and not measured to their end, by outcome: those without any measurement, and those
        that went out of control
    """

    flights: int
    measured: int
    events: int
    unknown: dict[str, list[str]]

    @property
    def events_at_most(self) -> int:
        """Flights that entered, if every flight did of which it is not known."""
        return self.events + sum(len(flights) for flights in self.unknown.values())


def count_violations(rows: pd.DataFrame) -> Violations:
    """Count the flights of a summary that entered the keep-out area at any time, each once.

    Parameters
    ----------
    rows : a row per flight with ``flight_id``, ``outcome``, ``min_distance_m`` and ``keepout_violations``
    """
    measured = np.isfinite(pd.to_numeric(rows["min_distance_m"], errors="coerce").to_numpy(dtype=np.float64))
    entered = measured & (pd.to_numeric(rows["keepout_violations"], errors="coerce").to_numpy(dtype=np.float64) > 0.0)
    lost = rows[~entered & (~measured | (rows["outcome"] == Outcome.DIVERGED.value).to_numpy())]
    return Violations(
        flights=len(rows),
        measured=int(np.count_nonzero(measured)),
        events=int(np.count_nonzero(entered)),
        unknown={str(outcome): [str(i) for i in members["flight_id"]] for outcome, members in lost.groupby("outcome")},
    )
