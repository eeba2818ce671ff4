"""Flight tracks as a table of text, for other programs to read."""

from pathlib import Path

import pandas as pd

from common.text import cell
from reports.errors import ReportError
from reports.export.exporter import EXPORTERS
from reports.run.run_data import RunData

COLUMNS = (
    "time_s", "north_m", "east_m", "altitude_m", "velocity_north_mps", "velocity_east_mps",
    "vessel_north_m", "vessel_east_m",
)  # fmt: skip
"""Columns beside the flight's name. Positions are from the flight's local origin."""


@EXPORTERS.register("tracks_csv")
class TracksCsv:
    """A row per recorded sample of each flight that has a time history."""

    suffix = ".tracks.csv"

    def write(self, run: RunData, path: Path) -> None:
        """Write one flight after the other, with a single head."""
        recorded = run.recorded()
        if not recorded:
            raise ReportError(
                f"'{run.path}' has no time histories of flights, which tracks are made of"
            )
        with path.open("w", encoding="utf-8", newline="") as file:
            for number, flight_id in enumerate(recorded):
                history = run.history(flight_id)
                rows = (
                    pd.DataFrame(columns=list(COLUMNS))
                    if history is None
                    else history.reindex(columns=list(COLUMNS))
                )
                rows.insert(0, "flight_id", str(cell(flight_id)))
                rows.to_csv(file, index=False, header=number == 0, float_format="%.3f")
