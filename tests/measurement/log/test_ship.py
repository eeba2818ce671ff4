"""A log beside its ship, and logs that lie far from it: each is asked about in one line."""

import dataclasses
import re

import numpy as np
import pandas as pd
import pytest

from measurement.errors import MeasurementError
from measurement.log.config import LogConfig
from measurement.log.read import read_flight
from measurement.log.ship import ShipTrack

START = 1780308000.0
"""2026-06-01T10:00:00Z (date -u -d ... +%s)."""

LATITUDE, LONGITUDE = 56.1, 11.2

METRES_PER_DEGREE = 111_195.0
"""Of latitude, on a sphere of 6,371 km."""

KNOTS_12 = 12.0 * 1852.0 / 3600.0


@pytest.fixture
def ship():
    """A ship that goes north at 12 kn, with a report each minute for three hours."""
    time = START - 3600.0 + 60.0 * np.arange(180.0)
    return ShipTrack(
        name="MMSI 219999001 (ship.csv)",
        latitude=LATITUDE + KNOTS_12 * (time - START) / METRES_PER_DEGREE,
        longitude=np.full(len(time), LONGITUDE),
        time=time,
    )


@pytest.fixture
def table(logged):
    """The log of a flight that goes along 300 m beside that ship."""
    plain = pd.read_csv(logged).drop(columns=["north_m", "east_m"])
    since = plain["time_s"]
    plain["time_s"] = START + since
    plain["latitude_deg"] = LATITUDE + KNOTS_12 * since / METRES_PER_DEGREE
    plain["longitude_deg"] = LONGITUDE + 300.0 / (METRES_PER_DEGREE * np.cos(np.radians(LATITUDE)))
    return plain


def read(table, logged, ship, config=None):
    table.to_csv(logged, index=False)
    return read_flight(logged, config or LogConfig(), [ship]).about.ships


def test_a_log_beside_its_ship_says_how_far_it_is(table, logged, ship):
    # 300 m on a sphere are 301 m on the ellipsoid there.
    assert read(table, logged, ship) == ("0.3 km to 0.3 km from MMSI 219999001 (ship.csv)",)
    coming = table.assign(latitude_deg=table["latitude_deg"] - np.linspace(0.2, 0.0, len(table)))
    # 0.2 deg of latitude are 22.3 km.
    assert read(coming, logged, ship) == ("0.3 km to 22.3 km from MMSI 219999001 (ship.csv)",)


@pytest.mark.parametrize(
    ("mistaken", "words"),
    [
        (
            lambda of: of.assign(
                latitude_deg=of["longitude_deg"], longitude_deg=of["latitude_deg"]
            ),
            "with latitude and longitude exchanged it would be 0.3 km",
        ),
        (
            lambda of: of.assign(latitude_deg=-of["latitude_deg"]),
            "with the other sign of latitude it would be 0.3 km",
        ),
        # Local time of a clock that is taken for UTC: within the file, 22.2 km from the ship.
        (
            lambda of: of.assign(time_s=of["time_s"] + 3600.0),
            "with times 1 h earlier it would be 0.3 km",
        ),
        (lambda of: of.assign(latitude_deg=of["latitude_deg"] + 1.0), "no nearer than 111.4 km"),
    ],
)
def test_a_log_that_lies_far_from_its_ship_is_refused_with_what_explains_it(
    table, logged, ship, mistaken, words
):
    with pytest.raises(MeasurementError) as refusal:
        read(mistaken(table), logged, ship)
    said = str(refusal.value)
    assert words in said
    assert re.search(r"\(row \d+\)", said)
    assert ", and exhaust is measured within 20.0 km at most" in said
    assert "\n" not in said


def test_a_lost_sign_beside_the_meridian_of_greenwich_is_asked_about(logged, table, ship):
    # 7.1 km apart in the Channel, where exhaust might still be measured: 0.1 deg at 50.5 deg north.
    lying = dataclasses.replace(
        ship, latitude=0.0 * ship.time + 50.5, longitude=0.0 * ship.time - 0.05
    )
    beside = table.assign(latitude_deg=50.5, longitude_deg=0.0501)
    with pytest.raises(MeasurementError, match=r"7\.1 km to .* with the other sign of longitude"):
        read(beside, logged, lying)
    assert read(beside.assign(longitude_deg=-0.0501), logged, lying)


def test_a_log_of_another_time_than_the_ships_file_is_refused_with_both(table, logged, ship):
    with pytest.raises(
        MeasurementError,
        match="log goes from 2026-06-01T16:00:00Z to 2026-06-01T16:05:00Z, and the places of MMSI"
        r" 219999001 \(ship.csv\) from 2026-06-01T09:00:00Z to 2026-06-01T11:59:00Z; with times"
        " 6 h earlier it would come to 0.3 km",
    ):
        read(table.assign(time_s=table["time_s"] + 6 * 3600.0), logged, ship)


def test_a_log_of_no_date_is_compared_with_all_places_of_the_ship(table, logged, ship):
    (words,) = read(table.assign(time_s=table["time_s"] - START), logged, ship)
    # Between two reports, 370 m apart, the nearer one is up to 185 m ahead or astern: 353 m.
    assert words == "0.3 km to 0.4 km from MMSI 219999001 (ship.csv), whenever it was there"
    exchanged = table.assign(
        time_s=table["time_s"] - START,
        latitude_deg=table["longitude_deg"],
        longitude_deg=table["latitude_deg"],
    )
    with pytest.raises(MeasurementError, match="with latitude and longitude exchanged"):
        read(exchanged, logged, ship)
    with pytest.raises(MeasurementError, match="no latitude and longitude to compare with MMSI"):
        read(table.drop(columns=["latitude_deg"]), logged, ship)
