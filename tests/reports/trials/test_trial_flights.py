"""Figures of the flights of trials, and which flights have any."""

import json
import math
import shutil
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from report_parts import blocks_of
from trial_runs import with_values

from reports.document.blocks import FlightPicker, Table
from reports.document.chart import Chart, Line, Panel
from reports.flights.flight_view import FlightView, flight_view
from reports.flights.selection import PICKED_MAX, flight_section, picked_flights
from reports.flights.single_flight import flight_charts
from reports.flights.trials.charts import trial_charts
from reports.flights.trials.panels_over import PanelsOver, by_violation
from reports.registry import content
from reports.render import matplotlib_charts, plotly_charts
from reports.run.flight_config import source_height
from reports.run.run_data import read_run
from reports.run.trials import Kind, Trial, read_trials


def test_a_missing_history_is_said_and_other_flights_are_looked_at_instead(run_path, tmp_path):
    path = shutil.copytree(run_path, tmp_path / "copy")
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


def test_still_air_has_no_wind_in_the_title_of_a_flight(run):
    picker = flight_section(read_trials(with_values(run, 0, wind_speed_mps=0.0))).blocks[1]
    titles = {flight.flight_id: flight.title for flight in picker.flights}
    assert " wind" not in titles["steady_00000"].replace("\N{NO-BREAK SPACE}", " ")
    assert " wind" in titles["steady_00001"].replace("\N{NO-BREAK SPACE}", " ")


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


def test_the_caption_says_what_the_error_of_the_vessel_is_where_she_is_not_known_exactly(run):
    shown = {}
    for trial in read_trials(run):
        histories = flight_charts(flight_view(trial, trial.rows.iloc[0]))[1]
        shown[trial.key] = any(panel.y_label == "Vessel error [m]" for panel in histories.panels)
        assert ("where the guidance takes her to be" in histories.caption) is shown[trial.key]
    assert shown == {"steady": False, "turns": True}


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


def test_manoeuvres_are_those_that_were_sampled_in_whatever_order(run):
    # As where the manoeuvre is the second choice, weighted, or of a search: a flight's number does
    # not tell it.
    manoeuvres = run.draws["vessel.manoeuvres"]
    swapped = replace(
        run, draws=run.draws.assign(**{"vessel.manoeuvres": manoeuvres.to_numpy()[[0, 1, 3, 2]]})
    )
    (chart,) = trial_charts(read_trials(swapped)[1])
    assert [name for _, name in chart.panels[0].y_names] == [
        "10° to port at 0.5°/s",
        "20° to starboard at 0.5°/s",
    ]


def test_a_part_of_a_manoeuvre_that_varies_is_no_kind_of_manoeuvre(run):
    manifest = json.loads(json.dumps(run.manifest))
    manifest["trials"]["turns"]["draws"] = [
        {"key": "vessel.manoeuvres.0.turn_deg", "uniform": [10.0, 90.0]}
    ]
    trial = read_trials(replace(run, manifest=manifest))[1]
    assert trial.kind is Kind.MANOEUVRES
    assert trial_charts(trial) == []


@pytest.mark.parametrize("kind", [kind for kind in Kind if kind is not Kind.SWEEP])
def test_every_kind_of_trial_has_figures_of_any_run(run, kind, monkeypatch):
    monkeypatch.setattr(Trial, "kind", kind)
    for trial in read_trials(run):
        charts = trial_charts(trial)
        # No vessel manoeuvres, and so no crossing resumes, but there is always a closest approach
        # to show: by itself, not counted.
        assert bool(charts) == (kind is not Kind.APPROACH)
        assert all(
            len(line.x) for chart in charts for panel in chart.panels for line in panel.lines
        )


def test_flights_that_never_settled_have_marks_of_their_own_and_no_panel_of_a_settling_time(
    run, monkeypatch
):
    monkeypatch.setattr(Trial, "kind", Kind.APPROACH)
    trial = read_trials(run)[0]
    rows = pd.concat([trial.rows] * 4, ignore_index=True)
    # Six of eight settle: that is a panel of their times; with two of eight there is none.
    for settled in (6, 2):
        times = np.where(np.arange(len(rows)) < settled, 80.0, np.nan)
        starts, distances = trial_charts(replace(trial, rows=rows.assign(settling_time_s=times)))
        (never,) = (line for line in starts.panels[0].lines if line.label == "never settled")
        assert never.style not in {
            line.style
            for line in starts.panels[0].lines
            if line.label.startswith(("above", "settled"))
        }
        assert len(never.x) == len(rows) - settled
        assert len(distances.panels) == 1 + (settled == 6)
        assert ("and settling time" in distances.caption) == (settled == 6)


def test_no_more_flights_are_shown_than_stated_and_every_trial_has_its_share(run):
    trials = [replace(trial, key=f"{trial.key}{i}") for i in range(5) for trial in read_trials(run)]
    picked = picked_flights(trials)
    assert len(picked) == PICKED_MAX
    assert {trial.key for trial, _, _ in picked} == {trial.key for trial in trials}


def test_an_ordinate_of_names_is_marked_alike_on_screen_and_in_print():
    line = Line(x=np.array([0.0, 1.0]), y=np.array([0.0, 1.0]), label="", colour="blue")
    names = [(0.0, "approach"), (1.0, "tracking")]
    chart = Chart(
        name="c", caption="", panels=[Panel(x_label="Time [s]", y_label="Mode", lines=[line], y_names=names)]
    )  # fmt: skip
    printed = matplotlib_charts.draw(chart).axes[0]
    assert [
        (tick, text.get_text())
        for tick, text in zip(printed.get_yticks(), printed.get_yticklabels(), strict=True)
    ] == names
    screen = plotly_charts.draw(chart)["layout"]["yaxis"]
    assert list(zip(screen["tickvals"], screen["ticktext"], strict=True)) == names


@pytest.mark.usefixtures("without_single_flights")
def test_any_key_that_was_swept_is_what_flights_are_named_and_drawn_by(run):
    manifest = json.loads(json.dumps(run.manifest))
    manifest["trials"]["steady"]["sweep"] = {"wind.speed_mps": [2.0, 4.0]}
    manifest["trials"]["turns"]["sweep"] = {"turbulence.level": ["none", "light"]}
    draws = run.draws.assign(
        **{
            "wind.speed_mps": [2.0, 4.0, 3.0, 3.0],
            "turbulence.level": ["none", "none", "none", "light"],
        }
    )
    report = content(replace(run, manifest=manifest, draws=draws))
    table = blocks_of(report, Table, "trial1")[0]
    assert [table.head[0], *(row[0] for row in table.rows)] == ["Wind speed", "2 m/s", "4 m/s"]
    charts = blocks_of(report, Chart, "trial1")
    assert {panel.x_label for chart in charts for panel in chart.panels} == {"Wind speed [m/s]"}
    (words,) = blocks_of(report, Chart, "trial2")
    assert [name for _, name in words.panels[0].y_names] == ["none", "light"]


@pytest.mark.parametrize(
    ("margins", "over"), [([90.0, 90.1], "Speed ratio ν [-]"), ([60.0, 90.0], "Planned margin [m]")]
)
def test_clearances_are_drawn_over_the_planned_margin_only_where_that_differs_by_much(
    run, margins, over
):
    for number, margin in enumerate(margins):
        run = with_values(run, number, keepout_margin_m=margin)
    trial = read_trials(run)[0]
    assert PanelsOver(trial, "nu", by_violation(trial)).margin().x_label == over


@pytest.mark.parametrize(("above", "drawn"), [(0.0, False), (0.1, False), (5.0, True)])
def test_the_level_of_the_funnel_is_drawn_where_the_flight_does_not_hide_it(run, above, drawn):
    trial = read_trials(run)[0]
    row = trial.rows.iloc[0]
    history = run.history(str(row["flight_id"]))
    history = history.assign(altitude_m=source_height(trial.config) + above)
    histories = flight_charts(FlightView(trial, row, history))[1]
    (height,) = [panel for panel in histories.panels if panel.y_label == "Height [m]"]
    assert ("funnel" in {line.label for line in height.lines}) == drawn


def test_tracking_errors_that_are_drawn_at_the_floor_of_their_axis_are_said(run):
    trial = read_trials(run)[0]
    row = trial.rows.iloc[0]
    history = run.history(str(row["flight_id"]))
    off = history.assign(
        reference_north_m=history["north_m"] + 0.2, reference_east_m=history["east_m"]
    )
    words = [
        flight_charts(FlightView(trial, row, of))[1].caption
        for of in (off, off.assign(reference_north_m=off["north_m"]))
    ]
    said = " Tracking errors below 0.1 m are drawn at 0.1 m."
    assert [said in caption for caption in words] == [False, True]


@pytest.mark.parametrize(
    ("flown", "words"),
    [(True, "The only flight; Figure 1 shows its track."), (False, "The only flight.")],
)
def test_of_an_only_flight_the_figure_of_its_track_is_named_where_it_has_one(run, flown, words):
    rows = run.summary.iloc[:1]
    unflown = {
        "duration_s": np.nan,
        "min_distance_m": np.nan,
        "criteria_met": False,
        "outcome": "infeasible",
        "message": "fast",
    }
    rows = rows if flown else rows.assign(**unflown)
    (trial,) = [trial for trial in read_trials(replace(run, summary=rows)) if len(trial.rows)]
    assert flight_section([trial]).blocks[0].text == words
