"""Figures of the flights of trials, and which flights have any."""

import math
import shutil

import numpy as np
import pytest
from report_parts import blocks_of
from trial_runs import with_values

from reports.document.blocks import FlightPicker
from reports.flights.selection import picked_flights
from reports.flights.single_flight import flight_charts
from reports.flights.tracks import flight_view
from reports.flights.trials.charts import trial_charts
from reports.registry import content
from reports.run.run_data import read_run
from reports.run.trials import read_trials


def test_a_missing_history_is_said_and_other_flights_are_looked_at_instead(small_run, tmp_path):
    path = shutil.copytree(small_run, tmp_path / "copy")
    (path / "flights" / "steady_00000.parquet").unlink()
    bare = read_run(path)
    shown = [str(row["flight_id"]) for _, row, _ in picked_flights(read_trials(bare))]
    assert sorted(shown) == ["steady_00001", "turns_00000", "turns_00001"]
    # A flight with a violation is shown whatever is left of it; the page says that it has no time
    # history.
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
    # One marker per flight, in rows a unit apart of which the first manoeuvre's is the upper one.
    marks = next(line for line in chart.panels[1].lines if line.style == "points")
    assert list(marks.y) == [1.0, 0.0]
