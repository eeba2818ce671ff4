"""Corners of what scenarios declare in which the former keep-out guard let the aircraft in: each
was found by a search.

The guard kept off where the vessel was predicted; a report that moved the vessel, a long silence, gusts
and steep banks got the X8 in.
"""

import pytest
from study_runs import AT_THE_SHIP, flown, flown_once

pytestmark = pytest.mark.slow

SILENT_BRAKING = [
    "sea_faults", "draws=[]", "flights=2", "fault.kind=vessel_data", "fault.at_s=[200,200]", "flight.duration_max_s=250",
    "vessel.speed_mps=12", "vessel.manoeuvres=[{at_s=200,speed_mps=2,acceleration_mps2=0.25}]",
]  # fmt: skip
ORDINARY_REPORTS = [
    "sea_faults", "draws=[]", "flights=1", "fault.kind=none", "flight_seed=1121458970", "vessel.speed_mps=12.9",
    "vessel.manoeuvres=[{at_s=100.5,speed_mps=4.7,acceleration_mps2=0.25}]", "wind.speed_mps=0", "flight.duration_max_s=160",
    "start.aspect_deg=-13.3",
]  # fmt: skip
GUSTS = [
    "sea_wind", "flights=2", "turbulence.gusts=12", "turbulence.gust_speed_mps=8", "flight.duration_max_s=170",
    "flight.crossings=0",
]  # fmt: skip
WITHOUT_SATELLITES = [
    "sea_wind", "flights=2", "fault.kind=satellite_navigation", "flight.duration_max_s=251", "flight.crossings=0",
]  # fmt: skip
STEEP = [
    "sweep_nu", "sweep.nu=[0.1,0.6]", "start.spread_deg=180", "guidance.bank_deg=49.9", "flight.crossings=4",
    "flight.duration_max_s=130",
]  # fmt: skip

FAST = [
    "sea_wind", "guidance.law=constant_bearing", "flights=3", "speed_ratio=[0.3,0.7]", "flight.duration_max_s=130",
    "flight.crossings=0",
]  # fmt: skip
"""A law that does not track: the aircraft falls behind, and is commanded an airspeed at which it
cannot turn at omega_max.
"""


@pytest.mark.parametrize(
    "settings", [SILENT_BRAKING, ORDINARY_REPORTS, GUSTS, WITHOUT_SATELLITES, STEEP, FAST],
    ids=["silent braking", "ordinary reports", "gusts", "no satellites", "steep banks", "fast"],
)  # fmt: skip
def test_corners_that_a_search_has_found_are_kept_out_of(settings, tmp_path):
    name, *overrides = settings
    comparisons = ["comparison.variants=[]"] if name == "sweep_nu" else []
    rows = flown(tmp_path / "run", name, *overrides, *comparisons)
    # None of them was refused: every one has a closest approach.
    assert (rows["min_distance_m"] >= rows["keepout_radius_m"]).all()
    assert rows["guard_interventions"].sum() > 0
    assert rows["guard_lost_s"].sum() == 0.0


@pytest.mark.parametrize(
    ("place", "fails", "guarded"),
    [(421.05, 0.749, False), (463.85, 1.3425, False), (421.05, 4.5, True), (463.85, 5.5, True)],
)
def test_an_aircraft_whose_engine_fails_before_it_turns_away_keeps_out(
    place, fails, guarded, tmp_path
):
    # As long as the turn was predicted at the airspeed of the moment the first two came in, by 0.7
    # and 0.5 m. Now lost thrust is known after 0.7 s, and they retreat before they need the guard.
    # Later failures are met by a guard that has to reckon with an aircraft that slows down.
    keys = {
        "reference.standoff_radius_m": 9000,
        "vessel.speed_mps": 15, "start.range_m": place, "start.aspect_deg": 180, "start.course_deg": 180, "fault.kind": "engine",
        "fault.at_s": [fails, fails], "flight.duration_max_s": 15, "flight.crossings": 0,
    }  # fmt: skip
    row = flown_once(tmp_path / "run", "sea_wind", keys, *AT_THE_SHIP)
    assert row["airspeed_min_mps"] < 17.5
    assert (row["guard_time_s"] > 1.0) == guarded
    assert row["min_distance_m"] > row["keepout_radius_m"] + 0.5
    assert row["guard_lost_s"] == 0.0


def test_an_aircraft_whose_engine_fails_in_a_climb_keeps_out(tmp_path):
    # It slows down the faster, and came in by 0.86 m when it failed at a time of 0.5 to 8 s that the
    # seed gave. At 6 s its guard has to act.
    keys = {
        "reference.standoff_radius_m": 9000, "vessel.speed_mps": 15,
        "start.distance_m": [380, 520], "start.aspect_deg": 180, "start.course_deg": 180, "fault.kind": "engine",
        "fault.at_s": [6, 6], "flight.duration_max_s": 40, "flight.crossings": 0, "plume.elevation_deg": 20,
        "keepout.shape": "cylinder", "flight_seed": 3003838512,
    }  # fmt: skip
    row = flown_once(tmp_path / "run", "sea_wind", keys, *AT_THE_SHIP)
    assert row["guard_time_s"] > 1.0
    assert row["min_distance_m"] > row["keepout_radius_m"]


def test_an_aircraft_that_is_gaining_speed_turns_away_as_predicted(tmp_path):
    # Beside a vessel that is known exactly a search came within 0.05 m: the guard reckoned with the
    # airspeed of the moment, and the aircraft was commanded 1.2 m/s more. Of the 3.1 m by which a
    # reversal may deviate a steady turn is allowed a fifth.
    keys = {
        "guidance.law": "park_l1", "vessel.speed_mps": 12.546, "wind.speed_mps": 2.1341, "wind.from_deg": 351.656,
        "start.range_m": 320, "start.aspect_deg": 87.511, "start.course_deg": 60.313, "flight_seed": 598176553,
        "flight.duration_max_s": 150, "flight.crossings": 0,
    }  # fmt: skip
    row = flown_once(tmp_path / "run", "sea_wind", keys)
    assert row["guard_time_s"] > 1.0
    assert row["min_distance_m"] > row["keepout_radius_m"] + 0.5
    assert row["guard_lost_s"] == 0.0


@pytest.mark.parametrize(
    ("nu", "flight_seed", "keys"),
    [
        (0.6, 3657000729, "guidance.law=lyapunov"),
        (
            0.9,
            3988975038,
            "guidance.law=constant_bearing guidance.airspeed_trim_max_mps=5"
            " guidance.airspeed_gain_per_s=1",
        ),
    ],
)
def test_a_vehicle_that_takes_on_any_airspeed_at_once_keeps_out(tmp_path, nu, flight_seed, keys):
    # It has no deviation that the guard keeps. One came in by 2 cm, since airspeeds 0.5 m/s apart
    # were predicted as one, and one by 9 cm, since the slower pace commanded for a step was not
    # predicted.
    words = (
        f"fidelity=kinematic keepout.radius_m=50 start.distance_m=[70,300] start.spread_deg=180"
        f" sweep.nu=[{nu}] flights=1 flight_seed={flight_seed} flight.duration_max_s=200"
        f" flight.crossings=0 comparison.variants=[] guidance.approach=false {keys}"
    )
    rows = flown(tmp_path / "run", "sweep_nu", *words.split())
    assert rows["guard_interventions"].sum() > 0
    assert (rows["min_distance_m"] > rows["keepout_radius_m"]).all()
