"""The ship of a logged flight, from a file of AIS reports."""

from pathlib import Path

import numpy as np

from measurement.errors import MeasurementError
from measurement.log.ship import ShipTrack
from scenarios.errors import InputError
from scenarios.world.ais import read_ais


def read_ship(path: Path, mmsi: int | None) -> ShipTrack:
    """Return the track of a ship.

    Parameters
    ----------
    path : of a file of AIS reports
    mmsi : of the ship, or None where the file has one ship alone

    Raises
    ------
    MeasurementError : the file cannot be read, or has no track of that ship
    """
    try:
        reports = read_ais(path, mmsi)
    except InputError as error:
        raise MeasurementError(str(error)) from None
    return ShipTrack(
        name=f"MMSI {reports.mmsi} ({path.name})",
        latitude=np.degrees(reports.latitude),
        longitude=np.degrees(reports.longitude),
        time=reports.time,
    )
