"""Figures of a sweep over several keys: a column for each in two figures, instead of four figures for each."""

import pytest

from reports.flights.names import flight_name
from reports.flights.trials.charts import trial_charts
from reports.run.run_data import read_run
from reports.run.trials import read_trials
from tests.in_process import run_command

SHORT = """
title = "Short"
description = "Flights for a test."
fidelity = "kinematic"
seed = 3
flight.crossings = 2
start.distance_m = [300.0, 400.0]

[sweep]
nu = [0.2, 0.4]
"keepout.radius_m" = [150.0, 200.0]
"guidance.law" = ["cascade", "line_of_sight"]
"""


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    folder = tmp_path_factory.mktemp("swept")
    (folder / "short.toml").write_text(SHORT, encoding="utf-8")
    run_command("scenarios.run", folder / "short.toml", "--out", folder / "run", "--no-report", "--jobs", 1)
    return read_trials(read_run(folder / "run"))[0]


def test_several_numbers_have_a_column_each_in_two_figures_and_words_have_one_of_their_own(trial):
    charts = trial_charts(trial)
    assert [chart.name.rpartition("-")[2] for chart in charts] == ["crossings", "errors", "law3"]
    for chart in charts[:2]:
        assert chart.columns == 2
        # Speed ratio and radius side by side, twice.
        assert [panel.x_label for panel in chart.panels] == ["Speed ratio ν [-]", "Keep-out radius [m]"] * 2
    assert [panel.y_label for panel in charts[1].panels[::2]] == ["Tracking error, rms [m]", "Settling time [s]"]


def test_a_flight_is_called_by_all_that_was_swept(trial):
    assert flight_name(trial, trial.rows.iloc[0]) == "ν = 0.20, keep-out radius 150 m, cascade"
