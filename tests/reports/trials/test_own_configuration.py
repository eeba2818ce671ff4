"""Flights with different keep-out areas and funnels: each is drawn and measured with those it has."""

import json
import tomllib

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from report_parts import flown_text

from common.text import as_json_cell, cell, from_json_cell
from reports.export.geographic import recorded_flights
from reports.flights.single_flight import flight_charts
from reports.flights.tracks import flight_view
from reports.replay.flight_scene import flight_scene
from reports.run.flight_config import flight_config, with_value
from reports.run.run_data import RunData, read_overrides, read_run
from reports.run.trials import read_trials
from scenarios.experiment.requests import Experiment, differing_keys
from scenarios.scenario.files import load_study

pytestmark = pytest.mark.slow

APART = """
extends = "operational"
study = "flights"
title = "Apart"
description = "Flights for a test."
fidelity = "kinematic"
guidance.rate_hz = 10.0
flights = 1
flight = { crossings = 2, altitude_m = 100.0 }
start.distance_m = [300.0, 400.0]
plume.model = "fluctuating"
emission.ship = "container"
[sweep]
"keepout.shape" = ["sphere", "cylinder"]
"plume.source_height_m" = [20.0, 60.0]
[[draws]]
key = "emission.load"
uniform = [0.2, 0.9]
"""

OWN = [("sphere", 20.0), ("sphere", 60.0), ("cylinder", 20.0), ("cylinder", 60.0)]
"""Shape of the keep-out area and height of the funnel [m] of each flight."""


@pytest.fixture(scope="module")
def apart(tmp_path_factory):
    return read_run(flown_text(tmp_path_factory, "apart", APART))


@pytest.fixture(scope="module")
def trial(apart):
    return read_trials(apart)[0]


def flights_of(trial):
    return [row for _, row in trial.rows.iterrows()]


def panel_of(view, label):
    return next(panel for panel in flight_charts(view)[1].panels if panel.y_label.startswith(label))


def test_the_time_history_of_a_flight_has_the_closest_approach_of_its_row_and_its_own_funnel(trial):
    for row, (shape, height) in zip(flights_of(trial), OWN, strict=True):
        view = flight_view(trial, row)
        # Between samples, 0.1 s apart at 28 m/s at most, the summary interpolates. The shapes
        # differ by 2 m and more.
        assert np.nanmin(view.distance) == pytest.approx(row["min_distance_m"], abs=0.02)
        caption = flight_charts(view)[1].caption
        assert ("from the keep-out sphere's centre" in caption) == (shape == "sphere")
        assert ("from the keep-out cylinder's axis" in caption) == (shape == "cylinder")
        funnel = next(line for line in panel_of(view, "Height").lines if line.label == "stack")
        assert set(funnel.y) == {height}


def test_replay_map_and_export_have_the_flights_own_keep_out_area_and_funnel(apart, trial):
    rows = flights_of(trial)
    scenes = [flight_scene(trial, row, apart.history(row["flight_id"])) for row in rows]
    assert [(scene.keepout_shape, scene.source_height) for scene in scenes] == OWN
    maps = [flight_charts(flight_view(trial, row))[0].caption for row in rows]
    assert all(
        f"The keep-out {shape} is about" in caption
        for caption, (shape, _) in zip(maps, OWN, strict=True)
    )
    heights = {flight.flight_id: flight.source_height for flight in recorded_flights(apart)}
    assert [heights[row["flight_id"]] for row in rows] == [height for _, height in OWN]


VARIATION = {"sweep", "cases", "draws", "comparison", "report"}
"""Sections that make several flights of a scenario, and the report's: they are of no flight."""


def experiments():
    """Return experiments whose flights differ by case, vehicle, sweep, comparison and samples."""
    apart = load_study(tomllib.loads(APART))
    return [
        Experiment("apart", apart),
        Experiment("paper", load_study("paper")),
        Experiment("monte_carlo", load_study("monte_carlo")),
        Experiment("sea_manoeuvres", load_study("sea_manoeuvres")),
    ]


@pytest.mark.parametrize("experiment", experiments(), ids=lambda of: of.name)
def test_the_overrides_of_a_flight_make_its_whole_configuration_of_that_of_its_trial(
    experiment, tmp_path
):
    numbers = sorted({*range(min(12, experiment.flights)), experiment.flights - 1})
    requests = [experiment.request(number) for number in numbers]
    rows = [
        {"flight_id": request.flight_id, "trial": experiment.name}
        | {
            key: as_json_cell(value)
            for key, value in experiment.overrides(request.scenario).items()
        }
        for request in requests
    ]
    pd.DataFrame(rows, dtype=object).map(cell).to_csv(tmp_path / "overrides.csv", index=False)
    empty = pd.DataFrame({"flight_id": []})
    run = RunData(
        path=tmp_path,
        manifest={"trials": {experiment.name: experiment.scenario.model_dump(mode="json")}},
        summary=empty, comparison=empty, crossings=empty, innerloop=None, statistics=None, draws=empty,
        overrides=read_overrides(tmp_path / "overrides.csv", set()),
    )  # fmt: skip
    assert any(run.overrides.values())
    for request, row in zip(requests, rows, strict=True):
        flown = request.scenario.model_dump(mode="json", exclude=VARIATION)
        config = {key: of for key, of in flight_config(run, row).items() if key not in VARIATION}
        assert json.loads(json.dumps(config)) == json.loads(json.dumps(flown))


@given(
    before := st.recursive(
        st.dictionaries(st.sampled_from("abc"), st.integers(0, 2)),
        lambda tables: st.dictionaries(st.sampled_from("abc"), tables | st.integers(0, 2)),
    ),
    before,
)
def test_what_tables_have_otherwise_makes_the_ones_of_the_others(one, other):
    # A scenario has the same sections in every flight.
    made = {"s": one}
    for key, value in differing_keys({"s": one}, {"s": other}).items():
        made = with_value(made, key.split("."), value)
    assert made == {"s": other}


@given(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False)
    | st.text()
    | st.lists(st.text())
)
def test_a_value_in_a_cell_is_read_back_as_it_was(value):
    assert from_json_cell(str(cell(as_json_cell(value)))) == value
