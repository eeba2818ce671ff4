"""Flights that settled and then did not cross the plume for long, beside a vessel that still
manoeuvred.
"""

import math
from dataclasses import replace

import pytest
from trial_runs import with_values

from reports.flights.flight_view import flight_view
from reports.flights.single_flight import flight_charts
from reports.flights.trials.crossing_gaps import crossing_gap, gap_lines
from reports.flights.verdict import flight_verdict
from reports.run.trials import read_trials


def turning(run, *, crossings=(100.0, 110.0, 210.0), **values):
    """Return the trial whose vessel turns, with the first of its two flights crossing at times of
    one's own.
    """
    own = run.summary.iloc[2]["flight_id"]
    values = {
        "settling_time_s": 95.0,
        "manoeuvre_end_s": 190.0,
        "duration_s": 220.0,
        "crossing_interval_predicted_s": 10.0,
    } | values
    run = with_values(run, 2, **values)
    row = run.crossings.iloc[0]
    others = run.crossings[run.crossings["flight_id"] != own]
    made = [row.to_dict() | {"flight_id": own, "time_s": time} for time in crossings]
    table = type(others)([*others.to_dict("records"), *made])
    return read_trials(replace(run, crossings=table))[1]


def test_the_gap_of_a_flight_that_settled_before_the_last_manoeuvre_had_ended_is_told(run):
    trial = turning(run)
    assert crossing_gap(trial, trial.rows.iloc[0]) == (110.0, 210.0)
    (line,) = gap_lines(trial)
    assert line.startswith(
        "1 of 2 flights, once settled, did not cross the plume for more than 5 crossing intervals"
    )
    assert line.endswith("longest: turns_00000, 100 s from 110 s on.")
    assert gap_lines(trial, only=False) == [f"Turns: {line}"]
    assert f"Turns: {line}" in flight_verdict(trial.run, read_trials(trial.run)).failures
    histories = flight_charts(flight_view(trial, trial.rows.iloc[0]))[1]
    assert (
        "No crossing for 100 s from 110 s on, before the vessel's last manoeuvre had ended."
        in histories.caption
    )


@pytest.mark.parametrize(
    "change",
    [
        {"manoeuvre_end_s": 105.0},
        {"manoeuvre_end_s": math.nan},
        {"settling_time_s": math.nan},
        {"plume_axis_crossings": 0.0},
        {"crossings": (100.0, 140.0, 180.0, 210.0)},
        {"crossings": (100.0, 110.0), "mode_at_end": "gliding"},
    ],
)
def test_there_is_none_without_a_manoeuvre_after_it_with_smoke_or_where_it_is_short_or_the_flight_has_left(
    run, change
):
    trial = turning(run, **change)
    assert crossing_gap(trial, trial.rows.iloc[0]) is None
    assert gap_lines(trial) == []


def test_a_flight_that_does_not_cross_again_has_a_gap_to_its_end(run):
    trial = turning(run, crossings=(100.0, 110.0))
    assert crossing_gap(trial, trial.rows.iloc[0]) == (110.0, 220.0)
