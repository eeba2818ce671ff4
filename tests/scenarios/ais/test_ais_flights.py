"""Ships from files of AIS reports: their tracks, their antennas, and flights beside them."""

import contextlib
import math
from datetime import UTC, datetime

import numpy as np
import pandas as pd
import pytest
from flight_cases import fly, plan, scenario

from gnc.errors import InfeasibleError
from scenarios.errors import InputError
from scenarios.scenario.files import CATALOG
from scenarios.scenario.sections.world import VesselConfig
from scenarios.world.ais.reports import read_ais
from scenarios.world.ais.synthetic import SYNTHETIC
from scenarios.world.ais.track import (
    JERK_DENSITY,
    POSITION_SIGMA,
    VELOCITY_SIGMA,
    ais_vessel,
    smooth_motion,
)
from scenarios.world.vessel import largest_inconsistency

DANISH = {"track": str(CATALOG / "ais" / "synthetic_danish.csv"), "mmsi": 219999001}
DECLARED = {"vessel_acceleration_mps2": 0.1, "vessel_speed_max_mps": 8.0, "speed_error_mps": 0.5}
PLAIN = "time_utc,mmsi,lat_deg,lon_deg,sog_kn,cog_deg"
LONG = {"crossings": 0, "duration_max_s": 2760.0}
WIND = {"speed_mps": 5.0, "from_deg": 60.0}
BESIDE = {"vessel": DANISH, "following": DECLARED, "wind": WIND}


@pytest.mark.slow
def test_beside_a_ship_from_a_file_it_keeps_out_and_crossings_resume():
    # The hour of the catalog's scenario: with its turn of 90 degrees, its slow-down, and some
    # minutes more.
    flown = fly(**BESIDE, guidance={"rate_hz": 5.0}, flight=LONG | {"log_rate_hz": 5.0})
    row = flown.row
    assert (row["outcome"], row["keepout_violations"]) == ("completed", 0), row["message"]
    assert row["resume_periods"] <= 2.0
    crossings = pd.DataFrame(flown.tables["crossings.csv"])["time_s"].to_numpy()
    for ends in (1380.0, 2486.0):
        # The turn, 90 degrees at 0.5 deg/s from 1200 s on, and the slow-down, 2.57 m/s at 0.03
        # m/s^2 from 2400 s on. There are two crossings a period, so that the mean interval is half
        # of one.
        after = crossings[crossings >= ends]
        assert after[0] - ends < 2.0 * 2.0 * np.diff(after[:20]).mean()
    assert crossings[-1] > 2710.0
    # Reports are received at the times of the file; the flight begins with the first, and seconds
    # since 1970 are rounded.
    received = plan(scenario(**BESIDE, flight=LONG)).sensing.received
    times = np.array([when for when, _ in received])
    said = read_ais(DANISH["track"], DANISH["mmsi"]).time
    until = row["duration_s"]
    expected = (said - said[0])[said - said[0] <= until]
    assert times[times <= until] == pytest.approx(expected, abs=1e-6)
    off = [
        flown.history[f"vessel_seen_{a}_m"] - flown.history[f"vessel_{a}_m"]
        for a in ("north", "east")
    ]
    # Errors of the reports are 3 m, and reports up to 20 s old.
    assert 0.5 < np.sqrt(np.mean(np.hypot(*off) ** 2)) < 10.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"vessel_acceleration_mps2": 0.03}, "following.vessel_acceleration_mps2 = 0.03"),
        ({"vessel_speed_max_mps": 5.0}, "following.vessel_speed_max_mps = 5"),
    ],
)
def test_a_ship_that_does_more_than_is_declared_is_a_row_with_that_reason(changes, words):
    row = fly(**(BESIDE | {"following": DECLARED | changes}), flight=LONG).row
    assert row["outcome"] == "infeasible"
    assert words in row["message"]
    assert "fly another time or track" in row["message"]


def slowing_ship(slows_down, silence):
    """Return reports of a ship that slows from 15 to 8 m/s in some time, and is silent in another."""
    lines, begins, lasts = [PLAIN], slows_down[0], slows_down[1] - slows_down[0]
    for time in range(-200, 201, 10):
        since = np.clip(time - begins, 0.0, lasts)
        north = 15.0 * (min(time, begins) + since) - 3.5 / lasts * since**2
        north += 8.0 * max(0.0, time - slows_down[1])
        knots = (15.0 - 7.0 * since / lasts) / 0.514444
        utc = np.datetime64("2026-06-01T12:00:00") + np.timedelta64(time, "s")
        line = f"{utc}Z,219999001,{55.0 + north / 111320.0:.7f},10.0,{knots:.2f},0.0"
        lines += [] if silence[0] < time < silence[1] else [line]
    return "\n".join(lines)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("slows_down", "silence", "fastest", "words"),
    [
        # From 15 to 8 m/s while nothing is received: 1035 m in the 90 s before the start, and 8.6
        # m/s are 774 m, and 5.6 * 5 m.
        ((-80.0, -10.0), (-85.0, 5.0), 8.6, r"after 90\.0 s; 80\d\.\d m .* = 8.6: declare more"),
        ((-80.0, -10.0), (-85.0, 5.0), 15.1, None),
        # Of the reports before the start the guard keeps the newest three, of the last 20 s, and
        # those are of a slow ship.
        ((-55.0, -35.0), (0.5, 0.5), 8.6, None),
    ],
)
def test_a_ship_that_was_faster_than_declared_is_refused_where_the_guard_relies_on_it(
    tmp_path, slows_down, silence, fastest, words
):
    path = tmp_path / "slower.csv"
    path.write_text(slowing_ship(slows_down, silence))
    given = scenario(
        start={"distance_m": (3000.0, 3000.0)},
        flight={"crossings": 0, "duration_max_s": 60.0},
        place={"utc": "2026-06-01T12:00:00Z"},
        following={"vessel_acceleration_mps2": 0.35, "vessel_speed_max_mps": fastest},
        vessel={"track": str(path)},
    )
    with pytest.raises(InfeasibleError, match=words) if words else contextlib.nullcontext():
        plan(given)


HOUR = 3600.0
SWERVING = {"vessel_acceleration_mps2": 0.15, "vessel_speed_max_mps": 8.0, "speed_error_mps": 0.5}


FILE = CATALOG / "ais" / "synthetic_danish.csv"
BY_THE_BOW = {
    "length_m": 120.0,
    "beam_m": 18.0,
    "stack_from_bow_m": 96.0,
    "antenna_from_bow_m": 6.0,
}


def vessel(**given):
    config = VesselConfig(track=str(FILE), mmsi=SYNTHETIC[FILE.name], **given)
    return ais_vessel(config, altitude=60.0, utc=None, duration=HOUR, margin=5.0)


@pytest.fixture(scope="module")
def both():
    """The ship by its antenna, 90 m ahead of the funnel, and the same taken for the funnel."""
    return vessel(**BY_THE_BOW), vessel()


@pytest.mark.slow
def test_the_funnel_is_behind_the_antenna_all_along_the_track(both):
    funnel, antenna = both
    for time in np.arange(0.0, HOUR, 60.0).tolist():
        north, east, *_ = antenna.motion(time)
        # By latitude and longitude: the frames begin 90 m apart, where north differs.
        place = funnel.place.frame.to_geodetic(*funnel.motion(time)[:2])
        behind = np.array(antenna.place.frame.to_local(*place)).ravel() - (north, east)
        heading = antenna.course(time)
        assert math.hypot(*behind) == pytest.approx(90.0, abs=0.01)
        astern = -90.0 * np.array([math.cos(heading), math.sin(heading)])
        assert behind == pytest.approx(astern, abs=0.02)
        # Its bow points where the antenna goes.
        assert funnel.course(time) == pytest.approx(heading, abs=1e-4)
    assert funnel.motion(0.0)[:2] == (0.0, 0.0)
    assert largest_inconsistency(funnel, HOUR) == 0.0


@pytest.mark.slow
def test_reports_are_taken_to_the_funnel_by_the_course_that_they_say(both):
    def scatter(of):
        reports = [report for report in of.reports if report.time >= 0.0]
        found = [np.subtract(report[1:3], of.motion(report.time)[:2]) for report in reports]
        return np.sqrt(np.mean(np.sum(np.square(found), axis=1)))

    funnel, antenna = both
    # A course is wrong by 0.05 m/s over 6 m/s, half a degree, and as much by its rounding: over
    # 90 m by less than 2 m.
    assert len(funnel.reports) == len(antenna.reports)
    assert scatter(funnel) < math.hypot(scatter(antenna), 2.0)


@pytest.mark.slow
def test_a_ship_of_a_file_with_its_antenna_at_the_bow_is_followed_by_its_funnel(tmp_path):
    # The file with a size in every row: 120 m by 18 m, A to D 6, 114, 9 and 9 m.
    head, *rows = FILE.read_text(encoding="utf-8").splitlines()
    names = head.split(",")
    said = {"Length": "120", "Width": "18", "A": "6", "B": "114", "C": "9", "D": "9"}
    lines = [head]
    for row in rows:
        cells = dict(zip(names, row.split(","), strict=True))
        lines.append(",".join((cells | said).values()))
    (tmp_path / FILE.name).write_text("\n".join(lines), encoding="utf-8")
    track = {"track": str(tmp_path / FILE.name), "mmsi": SYNTHETIC[FILE.name]}
    # With the turn of 90 degrees, from 1200 s on.
    row = fly(
        vessel=track | {"stack_from_bow_m": 96.0},
        place={"utc": "2026-06-01T10:15:00Z"},
        flight={"crossings": 0, "duration_max_s": 600.0},
        following=SWERVING,
        wind=WIND,
    ).row
    assert row["outcome"] == "completed", row["message"]
    assert row["keepout_violations"] == 0
    assert row["premise_vessel_ratio_max"] < 1.0
    assert row["antenna_distance_m"] == 90.0
    # It crosses the plume behind the funnel, where reports of the antenna would have it 90 m ahead.
    assert row["vessel_error_rms_m"] < 8.0


def smooth_vessel(name="synthetic_danish.csv", *, utc=None, duration=HOUR, **changes):
    config = VesselConfig(track=str(CATALOG / "ais" / name), mmsi=SYNTHETIC[name], **changes)
    return ais_vessel(config, altitude=60.0, utc=utc, duration=duration, margin=5.0)


def residuals(of):
    """Return report minus smooth track within the flight: north, east, and their rates."""
    reports = [report for report in of.reports if report.time >= 0.0]
    return np.array([np.subtract(report[1:], of.motion(report.time)) for report in reports])


@pytest.mark.parametrize(
    ("name", "scatter"),
    # Errors of the made reports: 2.5 m and 0.8 m of each coordinate, and up to a second of their
    # time at 6 m/s, 1.8 m rms.
    [("synthetic_danish.csv", 4.1), ("synthetic_marine_cadastre.csv", 0.0)],
)
def test_the_track_keeps_to_the_reports_but_for_their_scatter(name, scatter):
    found = residuals(smooth_vessel(name))
    assert np.sqrt(np.mean(found[:, :2] ** 2) * 2.0) <= max(scatter, 1.0)
    assert np.hypot(found[:, 0], found[:, 1]).max() <= 5.0 + scatter
    # Speed and course as reported: 0.05 m/s of each component, and rounding of 0.1 kn and 0.1
    # degrees.
    assert np.sqrt(np.mean(found[:, 2:] ** 2)) < 0.08


def test_a_flight_may_begin_at_any_time_of_the_file_and_knows_the_reports_before():
    whole = smooth_vessel()
    later = smooth_vessel(utc=datetime(2026, 6, 1, 10, 30, tzinfo=UTC), duration=600.0)
    assert later.place.utc - whole.place.utc == pytest.approx(1800.0)
    assert -60.0 <= min(report.time for report in later.reports) <= 0.0
    # The same ship at the same time, seen from another origin; of the reports within 600 s of the
    # flight the track is made.
    apart = np.subtract(later.motion(300.0)[2:], whole.motion(2100.0)[2:])
    assert np.abs(apart).max() < 0.01
    north, east = whole.place.frame.to_local(later.place.latitude, later.place.longitude)
    assert (float(north), float(east)) == pytest.approx(whole.motion(1800.0)[:2], abs=0.05)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"duration": 5000.0}, "go from 2026-06-01T10:00:00Z (line 2) to 2026-06-01T11:"),
        ({"utc": datetime(2026, 6, 1, 9, 0, tzinfo=UTC)}, "goes from 2026-06-01T09:00:00Z"),
        ({"gap_max_s": 15.0}, "vessel.gap_max_s = 15 s"),
    ],
)
def test_a_file_that_does_not_cover_the_flight_is_refused(changes, words):
    with pytest.raises(InputError) as refusal:
        smooth_vessel(**changes)
    assert words in str(refusal.value)


def test_smoothing_is_the_least_squares_solution_of_its_model():
    generator = np.random.default_rng(5)
    time = np.cumsum(generator.uniform(1.0, 90.0, 12))
    place, velocity = generator.normal(0.0, 300.0, (12, 2)), generator.normal(0.0, 3.0, (12, 2))
    smooth = smooth_motion(time, place, velocity)
    # The mean given all reports, by solving all equations at once: reports, jerk, and what is known
    # of the first state.
    equations, wanted = [], []
    for i in range(12):
        for known, sigma, seen in ((0, POSITION_SIGMA, place[i]), (1, VELOCITY_SIGMA, velocity[i])):
            row = np.zeros(36)
            row[3 * i + known] = 1.0
            equations.append(row / sigma)
            wanted.append(seen / sigma)
        if i:
            t = time[i] - time[i - 1]
            ahead = np.array([[1.0, t, 0.5 * t * t], [0.0, 1.0, t], [0.0, 0.0, 1.0]])
            powers = [
                [t**5 / 20, t**4 / 8, t**3 / 6],
                [t**4 / 8, t**3 / 3, t**2 / 2],
                [t**3 / 6, t**2 / 2, t],
            ]
            noise = JERK_DENSITY * np.array(powers)
            root = np.linalg.inv(np.linalg.cholesky(noise))
            block = np.zeros((3, 36))
            block[:, 3 * i : 3 * i + 3] = root
            block[:, 3 * i - 3 : 3 * i] = -root @ ahead
            equations.extend(block)
            wanted.extend(np.zeros((3, 2)))
        else:
            row = np.zeros(36)
            row[2] = 1.0 / 0.1
            equations.append(row)
            wanted.append(np.zeros(2))
    states, *_ = np.linalg.lstsq(np.array(equations), np.array(wanted), rcond=None)
    # Conditioned by gaps of up to 90 s: 1e-8 of the places.
    np.testing.assert_allclose(smooth(time), states[::3], rtol=0.0, atol=1e-4)
    np.testing.assert_allclose(smooth.derivative()(time), states[1::3], rtol=0.0, atol=1e-5)
