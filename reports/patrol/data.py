"""Patrols of a run: their ships, and what the UAV did when."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from common.patrols import PatrolCounts
from common.physics import wind_towards
from common.run_layout import PHASES, SHIPS
from reports.run.columns import Array
from reports.run.run_data import RunData
from reports.run.table_file import read_table


@dataclass(frozen=True, slots=True, kw_only=True)
class Patrol:
    """A patrol.

    Attributes
    ----------
    name : of the patrol
    row : of ``summary.csv``
    ships, phases : its rows of the tables of these names; empty where it failed
    """

    name: str
    row: "pd.Series[Any]"
    ships: pd.DataFrame
    phases: pd.DataFrame

    @property
    def duration(self) -> float:
        """Return when it ended [s]."""
        return float(self.phases["ends_s"].max()) if len(self.phases) else 0.0

    @property
    def wind(self) -> tuple[float, float]:
        """Return the wind's speed [m/s] and the course that it blows to [rad]."""
        return float(self.row["wind_speed_mps"]), wind_towards(float(self.row["wind_from_deg"]))

    def track(self, ship: "pd.Series[Any]") -> tuple[Array, Array]:
        """Return north and east of a ship at the start, and when she was measured or the patrol
        ended, shape (2,) each [m].
        """
        ends = float(ship["ended_s"]) if pd.notna(ship["ended_s"]) else self.duration
        course, time = math.radians(float(ship["vessel_course_deg"])), np.array([0.0, ends])
        way = float(ship["vessel_speed_mps"]) * time
        return float(ship["north_m"]) + way * math.cos(course), float(
            ship["east_m"]
        ) + way * math.sin(course)


@dataclass(frozen=True, slots=True, kw_only=True)
class Patrols:
    """The patrols of a run.

    Attributes
    ----------
    run : the run
    patrols : in their order
    """

    run: RunData
    patrols: list[Patrol]

    @property
    def counts(self) -> PatrolCounts:
        """Return the sums over them, and how they are judged."""
        config = self.run.manifest["config"]["patrol"]
        return PatrolCounts.of(
            self.run.summary.to_dict("records"),
            planned=int(self.run.manifest["flights_planned"]),
            oracle_share_min=float(config["oracle_share_min"]),
            wrong_share_max=float(config["wrong_share_max"]),
        )


def read_patrols(run: RunData) -> Patrols:
    """Return the patrols of a run."""
    ships, phases = (
        read_table(run.path / name, run.columns.get(name), empty=("patrol",))
        for name in (SHIPS, PHASES)
    )
    return Patrols(
        run=run,
        patrols=[
            Patrol(
                name=str(row["flight_id"]),
                row=row,
                ships=ships[ships["patrol"] == row["flight_id"]],
                phases=phases[phases["patrol"] == row["flight_id"]],
            )
            for _, row in run.summary.iterrows()
        ],
    )
