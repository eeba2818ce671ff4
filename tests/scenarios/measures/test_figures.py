"""Figures of histories that are made up, so that every one of them is known."""

import math

import numpy as np
import pandas as pd
import pytest
from flight_cases import plan as planned
from flight_cases import record, scenario

from gnc.mission.mission import Mode
from scenarios.flight.record import COLUMNS
from scenarios.measures.figures import flight_figures
from scenarios.measures.finding import finding_figures
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.flight import FlightConfig

STEP = 0.1
INTERVAL = 10.0
"""Between crossings of ``weave`` [s]."""


@pytest.fixture(scope="module")
def plan():
    manoeuvre = {"at_s": 40.0, "turn_deg": 10.0, "turn_rate_deg_s": 1.0}
    vessel = {"speed_mps": 8.0, "manoeuvres": [manoeuvre]}
    return planned(scenario(vessel=vessel, following={"vessel_acceleration_mps2": 0.15}))


def column(history, name):
    return history[:, COLUMNS.index(name)]


def figures(plan, history, **changes):
    return flight_figures(plan, record(history, COLUMNS, **changes))


def weave(plan, *, duration=100.0, distance=230.0, **columns):
    """Return the history of a vehicle that swings across the axis astern, 60 m to either side: it
    crosses every ``INTERVAL``.
    """
    time = np.arange(0.0, duration + 0.5 * STEP, STEP)
    history = np.zeros((len(time), len(COLUMNS)))
    omega = math.pi / INTERVAL
    # From abeam: the first crossing is half an interval on.
    across = 60.0 * np.cos(omega * time)
    values = {
        "time_s": time,
        "vessel_velocity_north_mps": 8.0,
        "vessel_north_m": 8.0 * time,
        "plume_axis_rad": math.pi,
        "north_m": 8.0 * time - distance,
        # To the right of an axis that trails south is west.
        "east_m": -across,
        "velocity_north_mps": 8.0,
        "velocity_east_mps": 60.0 * omega * np.sin(omega * time),
        "altitude_m": plan.altitude,
        "airspeed_mps": 19.42,
        "speed_ratio": plan.nu,
    }
    values |= {"reference_north_m": values["north_m"], "reference_east_m": values["east_m"]}
    values |= {"vessel_seen_north_m": values["vessel_north_m"]}
    for name, value in (values | columns).items():
        history[:, COLUMNS.index(name)] = value
    return history


def test_crossings_are_counted_and_timed(plan):
    row, crossings = figures(plan, weave(plan))
    # At 5, 15, ..., 95 s; a cubic of a sine sampled at 10 Hz errs by 60 (0.031)^4/384 m.
    assert [crossing.time for crossing in crossings] == pytest.approx(
        np.arange(5.0, 100.0, INTERVAL), abs=1e-6
    )
    assert row["crossing_count"] == 10
    assert row["crossing_interval_mean_s"] == pytest.approx(INTERVAL, abs=1e-6)
    assert row["crossing_interval_std_s"] == pytest.approx(0.0, abs=1e-6)
    assert row["crossing_distance_mean_m"] == pytest.approx(230.0, abs=1e-6)


def test_a_crossing_keeps_out_of_a_sphere_by_its_distance_and_of_a_cylinder_by_that_seen_from_above():
    # 230 m off, and 161 m above the funnel's mouth: 35 degrees.
    for shape, to_centre in (("sphere", math.hypot(230.0, 161.0)), ("cylinder", 230.0)):
        plan = planned(scenario(vessel={"speed_mps": 8.0}, keepout={"shape": shape}))
        row, crossings = figures(plan, weave(plan, altitude_m=plan.source_height + 161.0))
        assert row["crossing_distance_min_m"] == pytest.approx(math.hypot(230.0, 161.0), abs=1e-3)
        assert row["crossing_clearance_min_m"] == pytest.approx(to_centre - 200.0, abs=1e-3)
        assert [crossing.horizontal_distance for crossing in crossings] == pytest.approx(
            len(crossings) * [230.0], abs=1e-3
        )


def test_mean_distance_of_crossings_that_alternate_is_over_whole_periods():
    # On a loiter, whose halves differ, near and far in turn: the distance from the vessel is a
    # cosine of twice the period.
    base = {"title": "test", "fidelity": "kinematic", "vessel": {"speed_mps": 8.0}}
    plan = planned(Scenario.model_validate(base | {"reference": {"shape": "loiter"}}))
    time = np.arange(0.0, 60.05, STEP)
    far = 250.0 + 40.0 * np.sin(math.pi / INTERVAL * time)
    for duration, count in ((20.0, 2), (30.0, 3), (60.0, 6)):
        kept = time <= duration + 0.5 * STEP
        row, _ = figures(plan, weave(plan, duration=duration, distance=far[kept]))
        assert row["crossing_count"] == count
        # At 5, 15, 25 s: 290, 210, 290 m.
        assert row["crossing_distance_mean_m"] == pytest.approx(250.0, abs=0.01)
        assert row["crossing_distance_min_m"] == pytest.approx(210.0, abs=0.01)


def test_an_axis_that_turns_is_crossed_where_it_is_by_then(plan):
    # The vehicle stands still 230 m astern, 20 m to the west of the vessel's wake; the axis sweeps
    # over it at 0.01 rad/s.
    time = np.arange(0.0, 100.05, STEP)
    axis = math.pi + 0.01 * (time - 50.0)
    history = weave(
        plan,
        plume_axis_rad=np.where(axis > math.pi, axis - 2.0 * math.pi, axis),
        velocity_east_mps=0.0,
        east_m=-20.0,
    )
    row, crossings = figures(plan, history)
    # South by west: pi + atan(20/230), later than 50 s by that over 0.01 rad/s. The axis is wrapped
    # on the way. Its rate by central differences is exact.
    assert [crossing.time for crossing in crossings] == pytest.approx(
        [50.0 + math.atan2(20.0, 230.0) / 0.01], abs=1e-4
    )
    assert row["crossing_distance_min_m"] == pytest.approx(math.hypot(230.0, 20.0), abs=1e-3)


def test_a_keep_out_violation_is_counted_from_the_first_second_on(plan):
    # 250 m off, and from 10 to 30 s down to 190 m; it settles only later.
    time = np.arange(0.0, 100.05, STEP)
    phase = np.pi * np.clip((time - 10.0) / 20.0, 0.0, 1.0)
    distance, closing = 250.0 - 60.0 * np.sin(phase) ** 2, 60.0 * np.sin(2.0 * phase) * np.pi / 20.0
    straight = {"velocity_north_mps": 8.0 + closing, "east_m": 0.0, "velocity_east_mps": 0.0}
    row, _ = figures(plan, weave(plan, distance=distance, **straight), settled_at=50.0)
    assert row["keepout_violations"] == 1
    # Inside while 60 sin^2 exceeds 50 m; the cubic errs by h^4/384 of the fourth derivative, 2e-9
    # m.
    inside = 20.0 * (1.0 - 2.0 * math.asin(math.sqrt(5.0 / 6.0)) / math.pi)
    assert row["keepout_time_s"] == pytest.approx(inside, abs=1e-6)
    assert row["keepout_depth_m"] == pytest.approx(10.0, abs=1e-6)


def test_errors_are_measured_from_the_history(plan):
    history = weave(plan)
    north = column(history, "reference_north_m").copy()
    half = column(history, "time_s") >= 50.0
    # 3 m short along the wake, towards and away from the vessel in turn; the vessel is seen 4 m
    # off, the wind 1 m/s.
    sign = np.where(np.arange(len(north)) % 2, 1.0, -1.0)
    wrong = {"reference_north_m": north + 3.0 * sign, "vessel_seen_east_m": 4.0 * half}
    row, _ = figures(plan, weave(plan, **wrong, wind_north_mps=0.6, wind_east_mps=0.8))
    assert row["tracking_error_rms_m"] == pytest.approx(3.0)
    assert row["tracking_error_max_m"] == pytest.approx(3.0)
    assert row["vessel_error_max_m"] == pytest.approx(4.0)
    # Half the samples, and one more.
    assert row["vessel_error_rms_m"] == pytest.approx(4.0 * math.sqrt(501 / 1001))
    assert row["wind_error_rms_mps"] == pytest.approx(1.0)
    # Towards the vessel: 3 m times the cosine of up to atan(60/230) from the wake.
    assert 3.0 * math.cos(math.atan2(60.0, 230.0)) < row["spread_m"] < 3.0


def test_the_guards_time_is_counted_and_its_losses_too(plan):
    guard = np.zeros(1001)
    guard[100:150], guard[120:125], guard[700:710] = 1.0, 2.0, 1.0
    row, _ = figures(plan, weave(plan, guard=guard), settled_at=50.0)
    assert row["guard_lost_s"] == pytest.approx(0.5)
    assert row["guard_after_settling_s"] == pytest.approx(1.0)


@pytest.mark.parametrize("mode", [Mode.DEPARTING, Mode.GLIDING, Mode.TERMINATING])
def test_a_vehicle_that_leaves_for_good_is_no_longer_off_its_reference(plan, mode):
    history = weave(plan)
    left = column(history, "time_s") > 60.0
    modes = np.where(left, mode.number, Mode.TRACKING.number)
    # 3 m off while it tracks, and 500 m while it leaves, which sinks and slows down meanwhile.
    off = np.where(left, 500.0, 3.0)
    columns = {
        "mode": modes, "reference_north_m": column(history, "north_m") + off,
        "airspeed_command_mps": np.where(left, 12.0, 19.42),
        "altitude_command_m": np.where(left, -1000.0, plan.altitude),
    }  # fmt: skip
    row, crossings = figures(plan, weave(plan, **columns))
    assert row["tracking_error_rms_m"] == row["tracking_error_max_m"] == pytest.approx(3.0)
    assert row["airspeed_error_max_mps"] == row["altitude_error_max_m"] == 0.0
    assert 0.0 < row["spread_m"] < 3.0
    # What it crosses on its way is counted, and the end is the end.
    assert (len(crossings), row["tracking_error_end_m"]) == (10, pytest.approx(500.0))


ORBIT = 40.0
"""Time until the orbit is reached [s]."""

NOISE = 0.5


def history(*, first=100.0, above=6.0, believed=80.0, deviation=4.0, duration=300.0, altitude=70.0):
    """Return a search that crosses the axis every interval, and detects the plume from ``first`` on
    [s].
    """
    time = STEP * np.arange(round(duration / STEP) + 1)
    across = 50.0 * np.sin(math.pi * time / INTERVAL)
    inside = (np.abs(across) < 5.0) & (time > first - 1.0)
    # Every second crossing misses the middle of the plume.
    fraction = np.where(inside, np.where((time / INTERVAL).round() % 2 == 0, 0.9, 0.3), 0.0)
    co2 = 420.0 + 100.0 * fraction
    frame = {
        "time_s": time,
        "altitude_m": altitude,
        "altitude_command_m": altitude,
        "mode": np.where(time < ORBIT, Mode.APPROACH.number, Mode.SEARCHING.number).astype(float),
        "plume_across_m": across,
        "plume_above_m": above,
        "plume_fraction": fraction,
        "co2_ppm": co2,
        "co2_background_ppm": 420.0,
        "co2_reading_ppm": np.roll(co2, 10),
    }
    if believed is not None:
        frame |= {
            "axis_height_estimated_m": believed,
            "axis_height_deviation_m": deviation,
            "axis_measurable": 0.9,
        }
    return pd.DataFrame(frame)


def finding(made, **limits):
    return finding_figures(made, FlightConfig(**limits), noise=NOISE, stop_reason="")


def test_the_time_to_find_counts_from_the_orbit_to_the_first_reading_of_the_plume():
    row = finding(history())
    assert row["orbit_at_s"] == ORBIT
    # Detected from 99 s on, where the crossing at 100 s begins; the reading is a second late. A
    # sample, and the width of the plume.
    assert row["time_to_find_s"] == pytest.approx(100.0 - ORBIT + 0.8, abs=0.5)
    assert row["found"]


def test_a_reading_of_clean_air_is_no_plume_however_large():
    made = history(first=1e9)
    made.loc[1500:1520, "co2_reading_ppm"] += 50.0
    assert finding(made)["found"] is False


def test_the_height_is_judged_at_the_crossing_nearest_to_three_minutes():
    row = finding(history())
    # Truth: 70 m flown, 6 m above the axis.
    assert row["axis_height_3min_m"] == 64.0
    assert (row["axis_height_error_3min_m"], row["axis_height_deviation_3min_m"]) == (16.0, 4.0)
    assert (row["axis_height_end_m"], row["axis_measurable_end"]) == (80.0, 0.9)
