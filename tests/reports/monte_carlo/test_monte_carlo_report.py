"""What a report shows of a Monte Carlo study: of a made-up one, with statistics as the study itself
writes them.
"""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from judged_runs import judged
from scipy.stats import beta
from snapshots import assert_reads_as_before

from reports.document.blocks import Table
from reports.document.chart import Chart
from reports.document.tables import minus
from reports.monte_carlo.content import monte_carlo_sections, percent, violation_table
from reports.monte_carlo.names import input_unit
from reports.registry import content
from reports.run.run_data import RunData
from scenarios.scenario.documentation import documented_keys
from scenarios.scenario.files import load_study
from scenarios.statistics.estimates import study_statistics
from scenarios.studies.manifest import initial_manifest, parameters
from tests.reports.run_columns import RUN_COLUMNS
from tests.scenarios.study_rows import RADIUS, study_rows

FLIGHTS = 250


def run_of(rows, inputs, **changes):
    """Return a run directory as read, with as much of a manifest as a report needs."""
    study = load_study("sea_wind", [])
    config = study.model_dump(mode="json")
    manifest = initial_manifest(study, "study", []) | {
        "study": "monte_carlo",
        "trials": {"study": config},
        "trial_parameters": {"study": json.loads(json.dumps(parameters(study)))},
        "flights_planned": len(rows),
        "trial_flights": {"study": len(rows)},
        "sampled_at_random": {"study": True},
        "flights_per_sample": {"study": 1},
        "modes": [],
        "state": "complete",
    }
    run = RunData(
        path=Path("nowhere"),
        manifest=manifest,
        summary=rows.assign(
            criteria_met=True,
            nu=0.5,
            wind_speed_mps=5.0,
            fault="none",
            message="",
            duration_s=np.where(rows["outcome"] == "failed", np.nan, 600.0),
        ),
        comparison=pd.DataFrame(),
        crossings=pd.DataFrame(),
        innerloop=None,
        statistics=study_statistics(rows, inputs, **{"confidence": 0.95, "seed": 1, **changes}),
        columns=RUN_COLUMNS,
        draws=inputs,
    )
    return judged(run)


@pytest.fixture(scope="module")
def run():
    rows, inputs = study_rows(FLIGHTS)
    # One that entered, one that never settled, and one without any figure.
    rows.loc[3, ["min_distance_m", "keepout_violations"]] = [RADIUS - 0.5, 1]
    rows.loc[5, "settling_time_s"] = np.nan
    rows.loc[7, ["outcome", "min_distance_m", "keepout_violations", "mode_at_end"]] = [
        "failed",
        np.nan,
        np.nan,
        None,
    ]
    return run_of(rows, inputs)


@pytest.fixture(scope="module")
def sections(run):
    return {section.anchor: section for section in monte_carlo_sections(run)}


def charts_of(section):
    return {block.name: block for block in section.blocks if isinstance(block, Chart)}


def lines_of(panel):
    return {line.label: line for line in panel.lines}


def headline_of(run):
    verdict = content(run).verdict
    words = verdict.headline
    # A unit belongs to its number.
    assert len(words.split(" ")) <= 25
    return words.replace("\N{NO-BREAK SPACE}", " "), verdict.tone


def test_page_1_answers_with_the_probability_of_a_violation_a_loss_and_of_not_finishing(run):
    words, tone = headline_of(replace(run, manifest=run.manifest | {"study": "monte_carlo"}))
    # Clopper and Pearson: of 250 one violated, 1 - 0.975^(1/250), and one is unknown, which may
    # have been a second; none was lost, 1 - 0.025^(1/250).
    assert re.fullmatch(
        r"Probability of violation 0\.4 % \(0\.0101 to 2\.86 %\), of loss 0 % \(0 to 1\.46 %\),"
        r" of not finishing [\d.]+ % \([\d.]+ to [\d.]+ %\), at 95 % confidence",
        words,
    )
    assert tone == "bad"


def test_flights_that_share_what_is_random_count_as_one_in_an_interval(run):
    manifest = run.manifest | {"study": "monte_carlo", "flights_per_sample": {"study": 2}}
    words, _ = headline_of(judged(replace(run, manifest=manifest)))
    # Of 125 samples none violated, and one may have, with the flight that is unknown.
    high = 100.0 * beta.ppf(0.975, 2, 124)
    assert words.startswith(f"Probability of violation 0.4 % (0 to {high:.3g} %), ")


def test_keys_that_name_their_unit_have_the_one_that_is_documented():
    # Those of a search or an arena are no inputs of flights; two keys of a plume name none.
    keys = [
        of for of in documented_keys() if of.unit and not of.key.startswith(("draws.", "arena."))
    ]
    other = {of.key for of in keys if input_unit(of.key) != of.unit}
    assert len(keys) > 150
    assert other == {"plume.age_max", "plume.parcel_interval"}


def test_the_table_of_violations_has_the_intervals_of_clopper_and_pearson(run):
    measured, pessimistic = violation_table(run.statistics).rows
    # One of 249, and two of 250 with the one that is unknown.
    for row, events, flights in ((measured, 1, 249), (pessimistic, 2, 250)):
        low = beta.ppf(0.025, events, flights - events + 1)
        high, upper = (beta.ppf(p, events + 1, flights - events) for p in (0.975, 0.95))
        assert row[1:3] == [f"{flights}", f"{events}"]
        assert row[3] == percent(events / flights)
        assert row[4:] == [f"{percent(low)} to {percent(high)}", percent(upper)]


def test_every_figure_has_its_quantiles_with_intervals_and_counts_who_has_none(run, sections):
    (table,) = (block for block in sections["spread"].blocks if isinstance(block, Table))
    rows = {row[0]: dict(zip(table.head, row, strict=True)) for row in table.rows}
    settling = rows["Settling time [s]"]
    assert settling["Flights"] == "249, 1 not settled"
    quantile = run.statistics["figures"]["settling_time_s"]["quantiles"][2]
    assert (
        settling[percent(0.5)]
        == f"{quantile['value']:.1f}\n({quantile['low']:.1f} to {quantile['high']:.1f})"
    )
    # The interval's error is shown in per cent, at two digits after the point.
    error = run.statistics["figures"]["crossing_interval_error"]["quantiles"][0]
    shown = rows["Mean crossing interval off π/ω₀ [%]"][percent(0.01)]
    assert shown.startswith(minus(f"{100.0 * error['value']:.2f}\n("))
    # None of 0.001, for which 250 flights are too few.
    assert table.head[2:] == [percent(p) for p in (0.01, 0.05, 0.5, 0.95, 0.99)]


def test_the_nearest_flight_is_in_the_histogram_and_at_the_foot_of_the_curve(run, sections):
    chart = charts_of(sections["spread"])["clearance"]
    counted, tail = chart.panels
    # The first edge of the first bar, and the first point of the curve: one flight in 249.
    assert lines_of(counted)["flights"].x[0] == pytest.approx(-0.5, abs=1e-9)
    curve = lines_of(tail)["flights"]
    assert (curve.x[0], curve.y[0]) == pytest.approx((-0.5, 100.0 / 249.0), abs=1e-9)
    # That of 1 % is open below, with so few flights, and not drawn: the first is that of 5 %.
    quantile = run.statistics["figures"]["clearance_m"]["quantiles"][1]
    intervals = lines_of(tail)["interval of a quantile"]
    assert list(intervals.x[:2]) == [quantile["low"], quantile["high"]]
    assert list(intervals.y[:2]) == [5.0, 5.0]


def test_bars_are_as_long_as_the_indices_and_coloured_by_the_noise_floor(run, sections):
    found = run.statistics["sensitivity"]["clearance_m"]
    bars = charts_of(sections["drivers"])["drivers-clearancem"].panels[0]
    names = [name for _, name in bars.y_names]
    assert names == ["Wind speed", "Turbulence level"]
    lines = lines_of(bars)
    # Four corners for each bar: from 0, out, up and back.
    first = found["inputs"][0]
    assert list(lines["above the noise floor"].x[:4]) == [0.0, first["delta"], first["delta"], 0.0]
    assert set(lines["noise floor"].x) == {found["delta_floor"]}
    assert list(lines["interval"].x[:2]) == [
        first["delta"] - first["delta_error"],
        first["delta"] + first["delta_error"],
    ]


def test_a_monte_carlo_study_reads_as_before(run):
    assert_reads_as_before("monte_carlo", content(run))
