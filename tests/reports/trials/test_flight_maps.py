"""Maps of flights: the guard's stretches, the ship, its plume and what was about them."""

import math

import numpy as np
import pandas as pd
import pytest

from reports.flights.single_flight import flight_charts
from reports.flights.tracks import GUARD, GUARD_LOST, FlightView, flight_view
from reports.run.surroundings import surroundings
from reports.run.time_history import about_the_plume, guard_stretches, vessel_heading
from reports.run.trials import read_trials


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
