"""Ships besides the one that is measured: flights keep off each of them, and say so of each."""

import numpy as np
import pytest
from flight_cases import flown_study
from lane_files import MEASURED, file_of, lane

from common.run_layout import TRAFFIC
from common.verdict import KeepOut
from scenarios.errors import InputError
from scenarios.scenario.files import load_study

pytestmark = pytest.mark.slow

FLIGHT = {
    "title": "other ships",
    "fidelity": "kinematic",
    "kinematic": {"heading_rate_lag_s": 0.4},
    "vessel": {"speed_mps": 7.0},
    "wind": {"speed_mps": 5.0, "from_deg": 60.0},
    "start": {"place_m": [-350.0, 350.0], "course_deg": 0.0},
    "flight": {"duration_max_s": 60.0, "crossings": 0},
}


def flown(*overrides, **sections):
    found = flown_study(FLIGHT | sections, *overrides)
    return found.row, found.history, found.tables.get(TRAFFIC, [])


FAR = {"name": "far", "place_m": [5000.0, 6000.0]}


def test_a_ship_that_is_far_changes_nothing_of_a_flight():
    guidance = {"mission": "follow"}
    alone, beside = flown(guidance=guidance)[1], flown(guidance=guidance, traffic=[FAR])[1]
    assert list(alone) == [name for name in beside if name != "traffic_disc_ratio"]
    for name in alone:
        assert alone[name].to_numpy().tobytes() == beside[name].to_numpy().tobytes()


@pytest.mark.parametrize("exact", [True, False])
def test_a_ship_that_crosses_the_orbit_is_given_way_to(exact):
    crosser = {"name": "crosser", "place_m": [368.0, -900.0], "course_deg": 90.0, "speed_mps": 9.0}
    reports = {} if exact else {"reports": {"interval_s": [2.0, 10.0]}}
    sections = {
        "traffic": [crosser],
        "flight": {"duration_max_s": 200.0, "crossings": 0},
        "following": {"vessel_acceleration_mps2": 0.02},
        "keepout": {"other_radius_m": 120.0},
        **reports,
    }
    row, history, traffic = flown(**sections)
    time = history["time_s"].to_numpy()
    # Its place by its speed alone, as the scenario gives it.
    north, east = np.full_like(time, 368.0), -900.0 + 9.0 * time
    distance = np.hypot(history["north_m"] - north, history["east_m"] - east).min()
    (ship,) = traffic
    assert ship["ship"] == row["others_nearest"] == "crosser"
    # Between samples at 10 Hz it is nearer by (33 m/s 0.05 s)^2/(2 120 m) = 1.1 cm, and by less
    # than that again as it turns.
    assert ship["distance_min_m"] == pytest.approx(distance, abs=0.02)
    assert row["others_clearance_min_m"] == pytest.approx(distance - 120.0, abs=0.02)
    assert row["others_violations"] == row["keepout_violations"] == 0
    assert row["others_clearance_min_m"] > 0.0
    assert row["yielded_s"] > 10.0
    assert row["premises_exceeded"] == "none"
    if exact:
        # Without the guard and its way the two would have met.
        orbit = np.hypot(history["centre_north_m"] - north, history["centre_east_m"] - east).min()
        assert orbit < 120.0


def test_an_entry_into_the_area_of_another_ship_is_a_violation():
    # It begins in the area of the ship, which is not refused without a guard.
    crosser = {"name": "crosser", "place_m": [-350.0, 900.0], "course_deg": 90.0, "speed_mps": 9.0}
    row, *_ = flown(
        traffic=[crosser], guidance={"keepout_guard": False}, keepout={"other_radius_m": 600.0}
    )
    assert row["others_violations"] >= 1
    assert row["keepout_violations"] >= row["others_violations"]
    assert KeepOut.of(row) is KeepOut.VIOLATED
    assert "of crosser" in row["message"]


def test_in_a_busy_lane_of_an_ais_file_no_area_of_any_ship_is_entered(tmp_path):
    file, seed = tmp_path / "lane.csv", 2
    ships = lane(seed, duration=300.0)
    file.write_text(file_of(ships, seed=seed), encoding="utf-8")
    row, history, traffic = flown(
        vessel={"track": str(file), "mmsi": MEASURED},
        place={"utc": "2026-06-01T10:00:00Z"},
        following={"vessel_acceleration_mps2": 0.05, "vessel_speed_max_mps": 12.0},
        start={"distance_m": [450.0, 550.0], "spread_deg": 40.0},
        flight={"duration_max_s": 250.0, "crossings": 0},
    )
    assert row["keepout_violations"] == 0
    assert row["guard_lost_s"] == 0.0
    assert row["premises_exceeded"] == "none"
    # All ships within 10 km but the measured one; distances from where they really were, which the
    # smooth tracks know to the error of the antenna's position and to the place of the origin.
    known = {of["ship"]: of["distance_min_m"] for of in traffic}
    assert len(known) > 15
    time = history["time_s"].to_numpy()
    origin = np.array([history["vessel_north_m"].iloc[0], history["vessel_east_m"].iloc[0]])
    for ship in ships[1:]:
        name = f"MMSI_{ship.mmsi}"
        if name in known:
            north, east = np.array([ship.at(t) for t in time]).T
            north, east = north + origin[0], east + origin[1]
            off = np.hypot(history["north_m"] - north, history["east_m"] - east)
            assert known[name] == pytest.approx(off.min(), abs=15.0)
            assert off.min() > 200.0


ABEAM = {"name": "companion", "place_m": [-250.0, -150.0], "speed_mps": 7.0}
NEAR = {"name": "near", "place_m": [-300.0, 470.0], "speed_mps": 7.0}
TURNING = FAR | {"manoeuvres": [{"at_s": 5.0, "turn_deg": 90.0}]}
SOMEWHERE = {"latitude_deg": 57.0, "longitude_deg": 11.0}


@pytest.mark.parametrize(
    ("traffic", "words"),
    [
        ([ABEAM], "no room for the orbit: companion (traffic.0)"),
        ([NEAR], "from near (traffic.0)"),
        ([FAR, FAR | {"name": "same"}], "traffic.1 (same) is 0.0 m from traffic.0 (far)"),
        ([FAR | {"place_m": [3.0, 0.0]}], "traffic.0 (far) is 3.0 m from the measured ship"),
        ([FAR, FAR | {"place_m": [0.0, 900.0]}], "both called 'far'"),
        ([SOMEWHERE], "traffic.0.latitude_deg is given, and where the flight begins is not known"),
        ([{"track": "lane.csv"}], "where and when the flight begins is not known"),
        ([TURNING], "far (traffic.0) accelerates by"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line_with_the_ship_or_its_key(traffic, words):
    message = flown(traffic=traffic, keepout={"other_radius_m": 150.0})[0]["message"]
    assert words in message
    assert "\n" not in message


def test_a_ship_without_a_place_or_with_two_is_no_scenario():
    for given in ({}, {"place_m": [1.0, 2.0], "latitude_deg": 1.0, "longitude_deg": 2.0}):
        with pytest.raises(InputError, match="one place at the start: give place_m"):
            load_study(FLIGHT | {"traffic": [given]}, ())
