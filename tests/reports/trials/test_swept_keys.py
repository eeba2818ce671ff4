"""Figures of a sweep over several keys: a column for each in two figures, instead of four figures
for each.
"""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from report_parts import blocks_of, flown_text

from reports.document.blocks import FlightPicker, Table
from reports.errors import ReportError
from reports.flights.trials.charts import trial_charts
from reports.registry import content
from reports.run.columns import column
from reports.run.run_data import read_run
from reports.run.trials import read_trials

pytestmark = pytest.mark.slow

KINEMATIC = """
description = "Flights for a test."
fidelity = "kinematic"
guidance.rate_hz = 10.0
seed = 3
flight.crossings = 2
start.distance_m = [300.0, 400.0]
"""

SHORT = f"""
title = "Short"
{KINEMATIC}
[sweep]
nu = [0.2, 0.4]
"keepout.radius_m" = [150.0, 200.0]
"""


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    return read_trials(read_run(flown_text(tmp_path_factory, "short", SHORT)))[0]


def test_page_1_says_how_far_flights_with_different_radii_stayed_beyond_their_own(trial):
    found = content(trial.run)
    kept = column(trial.rows, "min_distance_m") - column(trial.rows, "keepout_radius_m")
    least = f"{kept.min():.1f} m"
    nearest = trial.rows.iloc[int(np.argmin(kept))]
    name = "Closest approach, beyond the flight's own r_min"
    (card,) = [card for card in found.verdict.figures if card.name == name]
    assert card[1:4] == (least, "≥ 0 m", True)
    assert card.note.endswith(
        f", {nearest['min_distance_m']:.1f} m where r_min is {nearest['keepout_radius_m']:g} m"
    )
    assert any(f"Closest: {least} beyond r_min" in panel.title for panel in found.picture.panels)
    assert "whose least distance beyond its own r_min is the median" in found.picture.caption
    table = next(
        table
        for section in found.sections
        for table in section.blocks
        if isinstance(table, Table) and "Outcome" in table.head
    )
    assert [row[table.head.index("beyond r_min [m]")] for row in table.rows] == [
        f"{value:+.1f}" for value in kept
    ]


WINDY = f"""
title = "Windy"
{KINEMATIC}
[criteria]
crossing_interval_error = 0.9
tracking_error_rms_m = 90.0
airspeed_error_rms_mps = 9.0
altitude_error_max_m = 90.0

[sweep]
nu = [0.3, 0.6]
"wind.speed_mps" = [0, 10]
"""
"""Of the four the last cannot be flown: the vessel is too fast through the air."""


@pytest.fixture(scope="module")
def windy(tmp_path_factory):
    return content(read_run(flown_text(tmp_path_factory, "windy", WINDY)))


NAMES = [f"ν = {nu}, wind speed {wind} m/s" for nu in ("0.30", "0.60") for wind in (0, 10)]


def test_each_swept_value_has_its_name_and_unit_and_a_flight_one_name_everywhere(windy):
    (trial,) = [section for section in windy.sections if section.anchor == "trial1"]
    flights = next(
        block for block in trial.blocks if isinstance(block, Table) and block.head[1] == "Outcome"
    )
    assert [row[0] for row in flights.rows] == NAMES
    (closest,) = [card for card in windy.verdict.figures if card.name.startswith("Closest")]
    assert closest.note in NAMES
    assert windy.verdict.failures[0].startswith(f"{NAMES[3]}: infeasible")
    (failed,) = blocks_of(windy, Table, "failed")
    assert failed.rows[0][0] == NAMES[3]
    titles = [panel.title for panel in windy.picture.panels]
    assert all(any(f": {name}, " in title for name in NAMES) for title in titles)
    (picker,) = blocks_of(windy, FlightPicker)
    assert [flight.title.partition(":")[0] for flight in picker.flights] == NAMES
    assert not any(
        "nu_0" in text for text in (windy.verdict.detail, *windy.verdict.failures, *titles)
    )


def test_a_sweep_whose_values_are_gone_names_the_table_that_had_them(trial):
    gone = replace(trial, run=replace(trial.run, draws=pd.DataFrame({"flight_id": []})))
    with pytest.raises(
        ReportError,
        match=r"draws\.csv' is gone or has no column 'keepout\.radius_m', .*; repeat the run's",
    ):
        trial_charts(gone)
