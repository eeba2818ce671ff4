"""Reports of a flight in a wind that changes: what is shown is the wind of the time that it is
shown of.
"""

import math

import pytest
from report_parts import flown

from common.physics import wind_velocity
from reports.flights.single_flight import flight_charts
from reports.flights.tracks import flight_view
from reports.run.run_data import read_run
from reports.run.surroundings import surroundings
from reports.run.trials import read_trials

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
