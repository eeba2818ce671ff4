"""Flights beside a ship from a file of AIS reports, with the kinematic vehicle."""

import numpy as np
import pandas as pd
import pytest
from flight_cases import fly, plan, scenario

from gnc.errors import InfeasibleError
from scenarios.errors import InputError
from scenarios.scenario.files import CATALOG, load_study
from scenarios.scenario.scenario import Scenario
from scenarios.studies.base import FlightStudy
from scenarios.world.ais.reports import read_ais

DANISH = {"track": str(CATALOG / "ais" / "synthetic_danish.csv"), "mmsi": 219999001}
DECLARED = {"vessel_acceleration_mps2": 0.1, "vessel_speed_max_mps": 8.0, "speed_error_mps": 0.5}
LONG = {"crossings": 0, "duration_max_s": 2760.0}


@pytest.fixture(scope="module")
def flown():
    """Of the hour that the scenario of the catalog has: with its turn of 90 degrees, its slow-down,
    and some minutes more.
    """
    slow = {"guidance": {"rate_hz": 5.0}, "flight": LONG | {"log_rate_hz": 5.0}}
    return fly(vessel=DANISH, following=DECLARED, wind={"speed_mps": 5.0, "from_deg": 60.0}, **slow)


def test_beside_a_ship_from_a_file_it_keeps_out_and_crossings_resume(flown):
    assert (flown.row["outcome"], flown.row["keepout_violations"]) == ("completed", 0), flown.row[
        "message"
    ]
    assert flown.row["resume_periods"] <= 2.0
    crossings = pd.DataFrame(flown.tables["crossings.csv"])["time_s"].to_numpy()
    for ends in (1380.0, 2486.0):
        # The turn, 90 degrees at 0.5 deg/s from 1200 s on, and the slow-down, 2.57 m/s at 0.03
        # m/s^2 from 2400 s on. There are two crossings a period, so that the mean interval is half
        # of one.
        after = crossings[crossings >= ends]
        assert after[0] - ends < 2.0 * 2.0 * np.diff(after[:20]).mean()
    assert crossings[-1] > 2710.0


def test_the_vessel_is_received_at_the_times_of_the_file_alone(flown):
    flight = plan(
        scenario(
            vessel=DANISH,
            following=DECLARED,
            flight=LONG,
            wind={"speed_mps": 5.0, "from_deg": 60.0},
        )
    )
    times = np.array([when for when, _ in flight.sensing.received])
    assert [report.time for _, report in flight.sensing.received] == times.tolist()
    # The flight begins with the first report; rounding of seconds since 1970.
    said = read_ais(DANISH["track"], DANISH["mmsi"]).time
    duration = flown.row["duration_s"]
    assert times[times <= duration] == pytest.approx(
        (said - said[0])[said - said[0] <= duration], abs=1e-6
    )
    seen = np.hypot(
        *(
            flown.history[f"vessel_seen_{axis}_m"] - flown.history[f"vessel_{axis}_m"]
            for axis in ("north", "east")
        )
    )
    # Errors of the reports are 3 m, and reports up to 20 s old.
    assert 0.5 < np.sqrt(np.mean(seen**2)) < 10.0


def test_its_row_says_where_and_when_and_how_fast_the_ship_was(flown):
    # 57.2 N, 11.3 E at 10 o'clock, at 12 kn (scenarios.world.ais.synthetic); the smooth track begins
    # within its reports' errors.
    assert flown.row["place_latitude_deg"] == pytest.approx(57.2, abs=1e-4)
    assert flown.row["place_longitude_deg"] == pytest.approx(11.3, abs=2e-4)
    assert flown.row["start_utc"] == "2026-06-01T10:00:00Z"
    assert flown.row["vessel_speed_mps"] == pytest.approx(6.17, abs=0.1)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"vessel_acceleration_mps2": 0.03},
            [
                "accelerates by",
                "following.vessel_acceleration_mps2 = 0.03",
                "declare more, or fly another time or track",
            ],
        ),
        (
            {"vessel_speed_max_mps": 5.0},
            [
                "moves at up to",
                "following.vessel_speed_max_mps = 5",
                "more, or fly another time or track",
            ],
        ),
    ],
)
def test_a_ship_that_does_more_than_is_declared_is_a_row_with_that_reason(changes, words):
    row = fly(
        vessel=DANISH,
        following=DECLARED | changes,
        flight=LONG,
        wind={"speed_mps": 5.0, "from_deg": 60.0},
    ).row
    assert row["outcome"] == "infeasible"
    for word in words:
        assert word in row["message"]


def test_a_start_is_judged_by_the_report_that_the_guard_has_and_not_by_where_the_ship_is(tmp_path):
    lines = (
        (CATALOG / "ais" / "synthetic_marine_cadastre.csv")
        .read_text(encoding="utf-8")
        .splitlines(keepends=True)
    )
    (tmp_path / "sparse.csv").write_text("".join([lines[0], *lines[1:60:2]]), encoding="utf-8")
    sparse = {"track": str(tmp_path / "sparse.csv"), "gap_max_s": 180.0}
    near = {"distance_m": (320.0, 320.0), "aspect_deg": 0.0, "course_deg": 0.0}
    flight = {"crossings": 0, "duration_max_s": 60.0}

    def planned(utc):
        return plan(
            scenario(
                vessel=sparse, following=DECLARED, start=near, flight=flight, place={"utc": utc}
            )
        )

    # Reports come each 119 s. Just after one the ship is where it says; 100 s later she may be up
    # to 500 m from there.
    planned("2026-06-01T10:02:01Z")
    with pytest.raises(
        InfeasibleError, match=r"where the best turn away comes within 0\.0 m of where it may be"
    ):
        planned("2026-06-01T10:03:40Z")


def test_reports_that_are_farther_off_than_declared_are_a_row_with_that_reason():
    reports = {"position_sigma_m": 0.1, "velocity_sigma_mps": 0.01}
    row = fly(
        vessel=DANISH,
        following=DECLARED,
        reports=reports,
        flight=LONG,
        wind={"speed_mps": 5.0, "from_deg": 60.0},
    ).row
    assert row["outcome"] == "infeasible"
    assert "the report of 2026-06-01T10:" in row["message"]
    assert "reports.position_sigma_m" in row["message"]


def test_a_report_whose_velocity_is_wrong_is_refused_for_what_it_makes_of_a_silence_after_it(
    tmp_path,
):
    # Until the next one, 2 s later, it is within its disc; 21 s later, with all data of the vessel
    # lost, the ship is 41 m outside. Of 16 flights of a law that flies at her 6 had come in, by up
    # to 31 m.
    path, lines = tmp_path / "wrong.csv", ["time_utc,mmsi,lat_deg,lon_deg,sog_kn,cog_deg"]
    for time in range(0, 400, 2):
        wrong = time == 150
        north, east, speed, course = (
            (1788.6, -18.3, 13.47, 336.0) if wrong else (12.0 * time, 0.0, 12.0, 0.0)
        )
        place = f"{55.0 + north / 111320.0:.7f},{10.0 + east / 63851.0:.7f}"
        lines.append(
            f"2026-06-01T12:{time // 60:02d}:{time % 60:02d}Z,219999001,{place},{speed / 0.5144:.2f},{course:.1f}"
        )
    path.write_text("\n".join(lines))
    declared = {"vessel_acceleration_mps2": 0.25, "vessel_speed_max_mps": 20.0}
    with pytest.raises(InfeasibleError, match=r"report of 2026-06-01T12:02:30.*apart after 2\d"):
        plan(
            scenario(
                vessel={"track": str(path)},
                following=declared,
                flight={"crossings": 0, "duration_max_s": 300.0},
            )
        )


@pytest.mark.parametrize(
    ("slows_down", "silence", "fastest", "words"),
    [
        # From 15 to 8 m/s while nothing is received: 1035 m in the 90 s before the start, and 8.6
        # m/s are 774 m, and 5.6 * 5 m.
        (
            (-80.0, -10.0),
            (-85.0, 5.0),
            8.6,
            r"apart after 90\.0 s; 80\d\.\d m .* following.vessel_speed_max_mps = 8.6: declare more",
        ),
        ((-80.0, -10.0), (-85.0, 5.0), 15.1, None),
        # Of the reports before the start the guard keeps the newest three, of the last 20 s, and
        # those are of a slow ship.
        ((-55.0, -35.0), (0.5, 0.5), 8.6, None),
    ],
)
def test_a_ship_that_was_faster_than_declared_is_refused_where_the_guard_relies_on_it(
    tmp_path, slows_down, silence, fastest, words
):
    path, lines = tmp_path / "slower.csv", ["time_utc,mmsi,lat_deg,lon_deg,sog_kn,cog_deg"]
    for time in range(-200, 201, 10):
        if silence[0] < time < silence[1]:
            continue
        since = np.clip(time - slows_down[0], 0.0, (lasts := slows_down[1] - slows_down[0]))
        after = max(0.0, time - slows_down[1])
        north = (
            15.0 * min(time, slows_down[0])
            + 15.0 * since
            - 7.0 / lasts * since**2 / 2.0
            + 8.0 * after
        )
        utc = np.datetime64("2026-06-01T12:00:00") + np.timedelta64(time, "s")
        lines.append(
            f"{utc}Z,219999001,{55.0 + north / 111320.0:.7f},10.0,{(15.0 - 7.0 * since / lasts) / 0.514444:.2f},0.0"
        )
    path.write_text("\n".join(lines))
    declared = {"vessel_acceleration_mps2": 0.35, "vessel_speed_max_mps": fastest}
    changes = {
        "start": {"distance_m": (3000.0, 3000.0)},
        "flight": {"crossings": 0, "duration_max_s": 60.0},
    }
    changes |= {
        "place": {"utc": "2026-06-01T12:00:00Z"},
        "following": declared,
        "vessel": {"track": str(path)},
    }
    if words is None:
        plan(scenario(**changes))
        return
    with pytest.raises(InfeasibleError, match=words):
        plan(scenario(**changes))


def test_a_folder_of_files_may_have_an_equals_sign_in_its_name(tmp_path):
    # As archives that are parted by days have it.
    (tmp_path / "day=2026-06-01").mkdir()
    (tmp_path / "day=2026-06-01" / "ship.csv").write_bytes(
        (CATALOG / "ais" / "synthetic_danish.csv").read_bytes()
    )
    text = 'extends = "ship_from_ais"\ntitle = "mine"\nvessel.track = "day=2026-06-01/ship.csv"\n'
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    assert load_study(str(tmp_path / "mine.toml")).vessel.track == str(
        tmp_path / "day=2026-06-01" / "ship.csv"
    )


def test_a_track_file_is_relative_to_the_scenario_file_and_its_hash_is_in_the_manifest(tmp_path):
    (tmp_path / "ship.csv").write_bytes((CATALOG / "ais" / "synthetic_danish.csv").read_bytes())
    (tmp_path / "mine.toml").write_text(
        'extends = "ship_from_ais"\ntitle = "mine"\nfidelity = "kinematic"\nvessel.track = "ship.csv"\n',
        encoding="utf-8",
    )
    scenario = load_study(str(tmp_path / "mine.toml"))
    assert isinstance(scenario, Scenario)
    assert scenario.vessel.track == str(tmp_path / "ship.csv")
    study = FlightStudy(scenario, "mine", {"mine": scenario})
    manifest = study.initial_manifest()
    assert list(manifest["plugins"]) == [str(tmp_path / "ship.csv")]
    ((name, rows),) = manifest["vessel_files"].items()
    assert name.endswith("ship.csv 219999001")
    assert rows["rows"] - rows["used"] == sum(rows["dropped"].values()) > 0


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("vessel.speed_mps=8", "vessel whose track is not from a file"),
        (
            "sweep.nu=[0.3]",
            "sweep has the vessel's speed beside vessel.track, a file that it comes from",
        ),
        ("place.latitude_deg=57", "give both, or neither"),
        ("place.utc=2026-06-01T10:00:00", "without a zone"),
    ],
)
def test_keys_that_contradict_a_track_from_a_file_are_refused(override, words):
    with pytest.raises(InputError, match=words):
        load_study("ship_from_ais", [override])


def test_a_file_whose_name_does_not_end_as_those_of_reports_do_is_refused_with_how_they_end():
    with pytest.raises(
        InputError,
        match=r"vessel\.track: track is 'x\.log'; the name of a file of AIS reports ends in \.csv, \.nmea or",
    ):
        load_study("ship_from_ais", ["vessel.track=x.log"])


def test_a_track_from_a_file_that_is_not_there_is_refused_before_any_flight(tmp_path):
    scenario = load_study(
        "ship_from_ais", [f"vessel.track={tmp_path / 'none.csv'}", "fidelity=kinematic"]
    )
    with pytest.raises(InputError, match=r"none\.csv: cannot be read"):
        FlightStudy(scenario, "mine", {"mine": scenario})
