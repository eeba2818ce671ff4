"""Telemetry log of ground stations, as Mission Planner and QGroundControl record it: MAVLink, each
with its time.
"""

import struct
from pathlib import Path

from reports.export.exporter import EXPORTERS
from reports.export.geographic import recorded_flights
from reports.export.mavlink import messages
from reports.run.run_data import RunData


@EXPORTERS.register("tlog")
class Tlog:
    """Messages of one flight, each after its time in microseconds since 1970."""

    suffix = ".tlog"
    one_flight = True

    def write(self, run: RunData, path: Path) -> None:
        """Write one flight."""
        flight = next(recorded_flights(run))
        with path.open("wb") as file:
            for time, message in messages(flight):
                file.write(struct.pack(">Q", round(1e6 * (flight.start + time))) + message)
