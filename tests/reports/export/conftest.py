"""A run of the flight that the tests of exports share."""

import math

import numpy as np
import pandas as pd
import pytest

from common.geodesy import LocalFrame
from tests.reports.export.placed_flight import PLACES, read, track
from tests.run_tables import write_manifest


@pytest.fixture(params=PLACES)
def run_path(request, tmp_path):
    latitude, longitude = PLACES[request.param]
    path = tmp_path / "run"
    (path / "flights").mkdir(parents=True)
    manifest = {
        "format": 1,
        "study": "flights",
        "name": "made",
        "title": "Made, <&> here",
        "config": {},
        "flights_planned": 1,
    }
    manifest |= {"begun_utc": "2026-06-02T08:00:00Z", "command": "plume-flight run made.toml"}
    write_manifest(path, manifest)
    row = {
        "flight_id": "a, <b>", "trial": "made", "place_latitude_deg": latitude, "place_longitude_deg": longitude,
        "start_utc": "2026-06-01T10:00:00Z", "keepout_radius_m": 200.0, "plume_elevation_deg": 0.0,
    }  # fmt: skip
    pd.DataFrame([row]).to_csv(path / "summary.csv", index=False)
    crossing = {"flight_id": "a, <b>", "time_s": 30.05, "distance_m": 250.0}
    pd.DataFrame([crossing]).to_csv(path / "crossings.csv", index=False)
    # NO2 is not on board, and so2_ppb is no reading.
    more = {"no2_reading_ppb": math.nan, "so2_ppb": 1.0}
    track().assign(**read(), **more).to_parquet(path / "flights" / "a, <b>.parquet")
    return path


@pytest.fixture
def truth(run_path):
    """Places of UAV and vessel on earth, shape (n, 2), latitude and longitude [deg], from the
    recorded metres alone.
    """
    row, history = pd.read_csv(run_path / "summary.csv").iloc[0], track()
    frame = LocalFrame(
        math.radians(row["place_latitude_deg"]), math.radians(row["place_longitude_deg"]), 60.0
    )
    return [
        np.degrees(
            np.column_stack(frame.to_geodetic(history[f"{of}north_m"], history[f"{of}east_m"]))
        )
        for of in ("", "vessel_")
    ]
