"""Flights of the paper's study, by vehicle."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from reports.document.tables import kinematic
from reports.run.columns import Array
from reports.run.run_data import RunData
from reports.run.time_history import thinned, tracking_error

VEHICLES = ("kinematic", "six_dof")
"""Fidelities, in the order of panels and columns."""

_POINTS_MAX = 1500


@dataclass(frozen=True, slots=True)
class Flown:
    """A flight: its row and its time history."""

    row: "pd.Series[float]"
    history: pd.DataFrame

    def column(self, name: str) -> Array:
        """Return a column of the history."""
        return self.history[name].to_numpy(dtype=np.float64)

    @property
    def time(self) -> Array:
        """Time of every sample [s]."""
        return self.column("time_s")

    @property
    def distance(self) -> Array:
        """Distance to the reference [m]."""
        return tracking_error(self.history)

    def until(self, time: float) -> "Flown":
        """Return the flight up to ``time`` [s], thinned to what a figure shows."""
        return Flown(self.row, thinned(self.history[self.history["time_s"] <= time], _POINTS_MAX))


def vehicle_name(run: RunData, fidelity: str) -> str:
    """Return what the vehicle of a fidelity is called."""
    return (
        f"kinematic vehicle, {kinematic(run)}"
        if fidelity == "kinematic"
        else "aircraft, six degrees of freedom"
    )


def find_flight(run: RunData, flight_id: str) -> Flown | None:
    """Return a flight of the study or of its comparisons, or none if it has no record."""
    history = run.history(flight_id)
    rows = pd.concat(
        [frame[frame["flight_id"] == flight_id] for frame in (run.summary, run.comparison)]
    )
    if history is None or len(history) < 2 or not len(rows):
        return None
    return Flown(rows.iloc[0], history)
