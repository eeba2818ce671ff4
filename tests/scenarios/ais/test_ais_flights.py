"""Flights beside a ship from a file of AIS reports, with the kinematic vehicle."""

import numpy as np
import pandas as pd
import pytest
from flight_cases import fly, plan, scenario

from gnc.errors import InfeasibleError
from scenarios.scenario.files import CATALOG
from scenarios.world.ais.reports import read_ais

pytestmark = pytest.mark.slow

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
