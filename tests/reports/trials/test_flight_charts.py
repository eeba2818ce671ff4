"""Figures of flights: tracks, maps, time histories, and which flights have any."""

import json
import math
import shutil
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from report_parts import blocks_of, flown
from trial_runs import with_values

from common.physics import wind_velocity
from common.run_layout import time_history_path
from reports.document.blocks import FlightPicker
from reports.flights.selection import picked_flights
from reports.flights.single_flight import flight_charts
from reports.flights.tracks import GUARD, GUARD_LOST, FlightView, flight_view
from reports.flights.trials.charts import trial_charts
from reports.paper.content import sim_3_charts
from reports.registry import content
from reports.run.run_data import read_run
from reports.run.surroundings import surroundings
from reports.run.time_history import (
    about_the_plume,
    guard_stretches,
    keepout_distance,
    vessel_heading,
)
from reports.run.trials import read_trials


def test_a_missing_history_is_said_and_other_flights_are_looked_at_instead(small_run, tmp_path):
    path = shutil.copytree(small_run, tmp_path / "copy")
    (path / "flights" / "steady_00000.parquet").unlink()
    bare = read_run(path)
    shown = [str(row["flight_id"]) for _, row, _ in picked_flights(read_trials(bare))]
    assert sorted(shown) == ["steady_00001", "turns_00000", "turns_00001"]
    # A flight with a violation is shown even so; the page says that it has no time history.
    deep = content(
        with_values(bare, 0, keepout_violations=1, keepout_depth_m=0.5, criteria_met=False)
    )
    (picker,) = blocks_of(deep, FlightPicker, "flights")
    assert (picker.flights[0].flight_id, picker.flights[0].charts) == ("steady_00000", [])
    assert "violated the keep-out area" in picker.flights[0].title


def test_flights_are_drawn_about_the_plume_as_the_trial_measured_them(run):
    for trial in read_trials(run):
        for _, row in trial.rows.iterrows():
            tracks = flight_charts(flight_view(trial, row))[0]
            lines = {line.label: line for line in tracks.panels[0].lines}
            uav, closest = lines["flown"], lines["closest approach"]
            # The summary's bearing from the plume's axis counts clockwise, so that it is positive
            # to the right of the axis.
            aspect, distance = math.radians(row["start_aspect_deg"]), row["start_distance_m"]
            assert uav.x[0] == pytest.approx(distance * math.sin(aspect), abs=1e-6)
            assert uav.y[0] == pytest.approx(distance * math.cos(aspect), abs=1e-6)
            # The flight is level with the funnel. Between samples, 0.1 s apart at 28 m/s at most,
            # the summary interpolates.
            assert math.hypot(closest.x[0], closest.y[0]) == pytest.approx(
                row["min_distance_m"], abs=0.02
            )


def test_flights_cross_the_axis_where_the_trial_found_crossings(run):
    trial = read_trials(run)[0]
    row = trial.rows.iloc[0]
    tracks, histories = flight_charts(flight_view(trial, row))
    uav = next(line for line in tracks.panels[0].lines if line.label == "flown")
    time = next(line for line in histories.panels[0].lines if line.label == "flown").x
    crossings = run.crossings_of(str(row["flight_id"]))
    assert len(crossings) == 3
    # Interpolated over up to 0.2 s of turns of up to 1 g: 9.81 0.2^2 / 8, 0.05 m.
    assert np.interp(crossings["time_s"], time, uav.x) == pytest.approx(np.zeros(3), abs=0.05)
    assert np.interp(crossings["time_s"], time, uav.y) == pytest.approx(
        crossings["axis_distance_m"].to_numpy(), abs=0.05
    )


def test_manoeuvres_are_named_as_the_vessel_was_seen_to_turn(run):
    trial = read_trials(run)[1]
    (chart,) = trial_charts(trial)
    names = [name for _, name in chart.panels[1].y_names]
    assert names == ["", ""]
    assert [name for _, name in chart.panels[0].y_names] == [
        "20° to starboard at 0.5°/s",
        "10° to port at 0.5°/s",
    ]
    for flight_id, turned in zip(trial.rows["flight_id"], (20.0, -10.0), strict=True):
        history = run.history(str(flight_id))
        courses = [
            math.degrees(
                math.atan2(
                    history["vessel_velocity_east_mps"].iloc[i],
                    history["vessel_velocity_north_mps"].iloc[i],
                )
            )
            for i in (0, -1)
        ]
        assert courses[1] - courses[0] == pytest.approx(turned, abs=1e-6)
    # One marker per flight, in rows a unit apart; that of the first manoeuvre is above.
    marks = next(line for line in chart.panels[1].lines if line.style == "points")
    assert list(marks.y) == [1.0, 0.0]


@pytest.fixture(scope="module")
def flight(run):
    trial = read_trials(run)[0]
    return trial, trial.rows.iloc[0]


def guarded_view(flight, guard):
    """Return a flight with other values of the column ``guard``."""
    trial, row = flight
    history = trial.run.history(str(row["flight_id"]))
    states = np.zeros(len(history))
    states[: len(guard)] = guard
    return FlightView(trial, row, history.assign(guard=states))


def test_stretches_of_the_guard_are_where_its_column_says():
    history = pd.DataFrame({"guard": [0.0, 1.0, 1.0, 2.0, 0.0, 1.0]})
    assert guard_stretches(history) == [(1, 3, True), (3, 4, False), (5, 6, True)]
    assert guard_stretches(pd.DataFrame({"guard": [np.nan, 0.0]})) == []
    assert guard_stretches(pd.DataFrame({"time_s": [0.0, 1.0]})) == []


def test_stretches_of_the_guard_are_marked_in_the_track_and_over_time(flight):
    view = guarded_view(flight, np.repeat([0, 1, 2, 0, 1], 4))
    time = view.whole["time_s"].to_numpy()
    held, lost = view.guarded(about_the_plume)
    assert (held.label, lost.label) == (GUARD, GUARD_LOST)
    # Two stretches, each ended by a gap; the first from the sample before it to that after it.
    assert np.count_nonzero(np.isnan(held.x)) == 2
    first = np.flatnonzero(np.isnan(held.x))[0]
    x, y = about_the_plume(view.whole)
    assert (held.x[0], held.y[0]) == (x[3], y[3])
    assert (held.x[first - 1], held.y[first - 1]) == (x[8], y[8])
    bands = [(band.label, band.start, band.end) for band in view.bands()]
    assert bands == [
        (GUARD, time[4], time[8]),
        (GUARD, time[16], time[20]),
        (GUARD_LOST, time[8], time[12]),
    ]


def test_the_ship_on_the_map_heads_and_trails_its_plume_as_it_did(flight):
    trial, row = flight
    view = flight_view(trial, row)
    about = surroundings(trial.config, row, view.whole)
    # It goes north; the plume trails along the wind less the ship's velocity.
    north, east = (
        row["wind_speed_mps"] * f(math.radians(row["wind_from_deg"]) + math.pi)
        for f in (math.cos, math.sin)
    )
    assert about.heading == pytest.approx(0.0, abs=1e-9)
    trails = math.atan2(east, north - row["vessel_speed_mps"])
    assert math.cos(about.axis - trails) == pytest.approx(1.0, abs=1e-9)
    assert about.wind[0] == row["wind_speed_mps"]
    assert not about.plume.smoke


def test_a_ship_at_rest_heads_as_configured_and_one_that_stops_as_before():
    still = pd.DataFrame(
        {"vessel_velocity_north_mps": [0.0, 0.0], "vessel_velocity_east_mps": [0.0, 0.0]}
    )
    assert vessel_heading(still, 90.0) == pytest.approx(math.pi / 2)
    stops = pd.DataFrame(
        {"vessel_velocity_north_mps": [0.0, 0.0, 0.0], "vessel_velocity_east_mps": [0.0, 5.0, 0.0]}
    )
    assert vessel_heading(stops, 0.0) == pytest.approx(math.pi / 2)


def test_the_ground_lies_along_the_way_of_a_ship_that_goes_far(run):
    # The ship goes north at 5 to 14 m/s for some two minutes, and the track about it is some
    # hundred metres wide.
    trial = read_trials(run)[0]
    charts = [flight_charts(flight_view(trial, row))[0] for _, row in trial.rows.iterrows()]
    high = [chart for chart in charts if chart.last_height]
    for chart in high:
        panel = chart.panels[-1]
        # What would fill less than half of the width has a higher panel, of the same metres each
        # way.
        (left, right), (bottom, top) = panel.x_range, panel.y_range
        assert (right - left) / (top - bottom) == pytest.approx(4.8 * 0.19 / chart.last_height)
        assert chart.last_height in (0.19, pytest.approx(0.285))
        (way,) = (line for line in panel.lines if line.label == "ship's track")
        assert way.y == pytest.approx(np.zeros(len(way.y)), abs=1e-6)
        assert np.all(np.diff(way.x) >= 0.0)
    assert high


RISING = [(0.0, 2.0), (100.0, 6.0)]
"""Time [s] and speed [m/s] of a wind from the west."""


@pytest.fixture(scope="module")
def windy(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wind")
    rows = "\n".join(
        f"2026-06-01T12:{time // 60:02.0f}:{time % 60:02.0f}Z,{speed},270" for time, speed in RISING
    )
    (folder / "wind.csv").write_text(f"time_utc,speed_mps,from_deg\n{rows}\n", encoding="utf-8")
    keys = [
        "fidelity=kinematic",
        f"wind.table={folder / 'wind.csv'}",
        "sweep.nu=[0.4]",
        "comparison.variants=[]",
    ]
    keys += ["flight.duration_max_s=100", "flight.crossings=0"]
    trial = read_trials(read_run(flown(tmp_path_factory, "sweep_nu", keys)))[0]
    return trial, trial.rows.iloc[0]


def test_the_figure_over_time_shows_the_wind_as_it_changes(windy):
    view = flight_view(*windy)
    (panel,) = [panel for panel in flight_charts(view)[1].panels if panel.y_label == "Wind [m/s]"]
    (east,) = [line for line in panel.lines if line.label == "true wind, east"]
    assert (east.y[0], east.y[-1]) == (pytest.approx(2.0), pytest.approx(6.0, abs=0.05))
    # Both components look different, and each has its name.
    looks = {line.label: (line.colour, line.style) for line in panel.lines}
    assert len(looks) == len(set(looks.values())) == len(panel.lines) == 4


def test_a_map_has_the_wind_of_its_moment(windy):
    trial, row = windy
    history = trial.run.history(str(row["flight_id"]))
    config = trial.flight_config(row)
    for at in (0, len(history) // 2, len(history) - 1):
        about = surroundings(config, row, history, at)
        assert about.wind == pytest.approx((history["true_wind_east_mps"][at], 0.5 * math.pi))
        assert about.changing
    # Of a run in which it is not recorded it is that of the start.
    older = history.drop(columns=["true_wind_north_mps", "true_wind_east_mps"])
    assert surroundings(config, row, older).wind == pytest.approx(
        (2.0, math.atan2(*wind_velocity(2.0, 270.0)[::-1]))
    )


@pytest.fixture(scope="module")
def sim_3(small_run, tmp_path_factory):
    """Return a run whose only flight is called as the paper's third simulation."""
    run = read_run(shutil.copytree(small_run, tmp_path_factory.mktemp("paper") / "run"))
    config = json.loads(json.dumps(run.manifest["trials"]["steady"]))
    history = run.history("steady_00000")
    # Well above the funnel's mouth, so that a sphere's distance is another than a cylinder's.
    raised = history.assign(altitude_m=history["altitude_m"] + 60.0)
    raised.to_parquet(run.path / time_history_path("sim3_kinematic"))
    tables = {name: getattr(run, name) for name in ("summary", "crossings")}
    tables = {
        name: rows[rows["flight_id"] == "steady_00000"].assign(flight_id="sim3_kinematic")
        for name, rows in tables.items()
    }
    return replace(run, manifest=run.manifest | {"config": config}, **tables)


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["sphere", "cylinder"])
def test_figure_9_shows_the_distance_that_the_keep_out_area_is_about(sim_3, shape):
    sim_3 = replace(sim_3, overrides={"sim3_kinematic": {"keepout.shape": shape}})
    figure_9 = sim_3_charts(sim_3)[1]
    _, flown, crossed = figure_9.panels[0].lines
    history = sim_3.history("sim3_kinematic")
    config = sim_3.manifest["config"] | {"keepout": {"shape": shape}}
    expected = np.interp(flown.x, history["time_s"], keepout_distance(history, config))
    assert flown.y == pytest.approx(expected, abs=1e-9)
    # As the flight was flown it crossed at the height of the mouth, where both distances are one.
    table = sim_3.crossings_of("sim3_kinematic")["distance_m"].to_numpy()
    assert crossed.y == pytest.approx(table, abs=0.1)
    on_curve = np.interp(crossed.x, flown.x, flown.y)
    # 200 m and more away, and 60 m higher. Within 0.2 s it turns.
    assert (
        (np.abs(on_curve - crossed.y).max() < 0.5)
        if shape == "cylinder"
        else (on_curve - crossed.y).min() > 5.0
    )
