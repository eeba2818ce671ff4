"""Ships besides the measured one, which a companion comes to know by their AIS_VESSEL alone."""

import itertools

import numpy as np
import pandas as pd
import pytest

from extensions.companion.remote_vehicle import retreat
from extensions.companion.reported_ships import Seen
from extensions.companion.simulation import MMSI
from tests.extensions.companion.served import companion, served

pytestmark = pytest.mark.slow

LANE = ("reports.interval_s=[10,10]", "flight.crossings=12", "fidelity=kinematic", "flights=1",
        "vessel.speed_mps=5", "wind.speed_mps=5", "wind.from_deg=20", "draws=[]",
        "guidance.rate_hz=5", "flight.log_rate_hz=5")  # fmt: skip
SECOND = "traffic=[{place_m=[1800.0, -250.0], speed_mps=6.0, course_deg=180.0}]"
"""A ship that comes towards the measured one, and passes it 250 m to port."""

KEPT = 200.0
"""Radius that the scenario keeps from every ship [m]."""


def flown(out, change=lambda message: message, settings=LANE):
    with served("sea_wind", *LANE, SECOND, change=change) as vehicle:
        ended = companion(vehicle, "sea_wind", out, "--lockstep", "--no-report", "--mmsi", str(MMSI),
                          settings=settings)  # fmt: skip
    return ended, vehicle.simulation


def of_other(message):
    return message.get_type() == "AIS_VESSEL" and message.MMSI != MMSI


def test_a_ship_that_the_scenario_does_not_have_is_kept_off(tmp_path):
    ended, simulation = flown(tmp_path / "run")
    assert ended.status == 0, ended
    assert simulation.others["traffic_1"] > KEPT
    assert simulation.closest > KEPT
    (row,) = pd.read_csv(tmp_path / "run" / "traffic.csv").itertuples()
    assert (row.ship, row.violations) == (f"MMSI_{MMSI - 1}", 0)
    # In the record the ship is where its last report, up to 10 s old, leads on to, and reports are
    # wrong by 5 m and 0.15 m/s, one sigma of a coordinate.
    assert row.distance_min_m == pytest.approx(simulation.others["traffic_1"], abs=40.0)
    summary = pd.read_csv(tmp_path / "run" / "summary.csv").iloc[0]
    assert summary["others_violations"] == 0
    assert summary["yielded_s"] > 0.0


def test_without_its_reports_the_ship_is_not_kept_off(tmp_path):
    """The flight of the tests above and below does meet the ship."""
    _, simulation = flown(tmp_path / "run", lambda message: None if of_other(message) else message)
    assert simulation.others["traffic_1"] < KEPT


def test_a_ship_that_reports_itself_in_flight_is_kept_off_from_then_on(tmp_path):
    clock = {"now": 0.0}

    def change(message):
        if message.get_type() == "GLOBAL_POSITION_INT":
            clock["now"] = 1e-3 * message.time_boot_ms
        return None if of_other(message) and clock["now"] < 60.0 else message

    ended, simulation = flown(tmp_path / "run", change, (*LANE, SECOND))
    assert ended.status == 0, ended
    assert simulation.others["traffic_1"] > KEPT
    (row,) = pd.read_csv(tmp_path / "run" / "traffic.csv").itertuples()
    # The ship of the scenario is the one that reports itself, and no second one.
    assert row.ship == f"MMSI_{MMSI - 1}"


def test_a_start_beside_another_ship_is_refused(tmp_path):
    place = {}

    def change(message):
        if message.get_type() == "GLOBAL_POSITION_INT":
            place["lat"], place["lon"] = message.lat, message.lon
        if of_other(message):
            # 56 m north of the vehicle.
            message.lat, message.lon = place["lat"] + 5000, place["lon"]
        return message

    ended, _ = flown(tmp_path / "run", change)
    assert ended.status == 1, ended
    message = pd.read_csv(tmp_path / "run" / "summary.csv").iloc[0]["message"]
    assert f"MMSI_{MMSI - 1}" in message
    assert "the best turn away" in message


def test_other_ships_are_refused_where_the_guidance_takes_no_note_of_them(tmp_path):
    numbers = itertools.cycle((MMSI, MMSI - 1))

    def change(message):
        if message.get_type() == "AIS_VESSEL":
            message.MMSI = next(numbers)
        return message

    settings = ("comparison.nu=[]", "sweep.nu=[0.5]", "fidelity=kinematic")
    with served("sim3", *settings, change=change) as vehicle:
        vehicle.simulation.step()
        ended = companion(vehicle, "sim3", tmp_path / "run", "--lockstep", "--no-report", "--mmsi",
                          str(MMSI - 1), settings=settings)  # fmt: skip
    assert ended.status == 1, ended
    assert "keeps off none" in pd.read_csv(tmp_path / "run" / "summary.csv").iloc[0]["message"]
    assert vehicle.count("SET_ATTITUDE_TARGET") == 0


@pytest.mark.parametrize("velocity", [(0.0, 0.0), (6.0, 0.0), (-6.0, 0.0), (0.0, 6.0)])
@pytest.mark.parametrize("place", [(0.0, 500.0), (600.0, -300.0), (-700.0, 0.0)])
def test_a_retreat_is_not_in_the_way_of_another_ship(place, velocity):
    keep, spare, vessel = 360.0, 120.0, (5.0, 0.0)
    other = Seen(*place, *velocity, 200.0)
    found = retreat((250.0, 0.0), vessel, keep=keep, speed=19.0, others=[other], spare=spare)
    seconds = np.arange(3600.0)[:, None]
    for start, moving, radius in (((0.0, 0.0), vessel, keep), (place, velocity, 200.0 + spare)):
        away = np.array(found) - start - np.array(moving) * seconds
        # Beside a track the place is as far off as is kept, to within rounding.
        assert np.linalg.norm(away, axis=1).min() >= radius - 1e-3
