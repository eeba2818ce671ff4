"""What the report of an arena shows, of a quick one on the kinematic vehicle."""

import json
import math
from dataclasses import replace

import pandas as pd
import pytest
from judged_runs import changed
from snapshots import assert_reads_as_before

from extensions.arena.entrants import Entrant
from extensions.arena.paired_bootstrap import Estimate
from extensions.arena.record import ERROR, read_arena
from extensions.arena.report import _headline, arena_content, by_condition_table, tracking_table
from extensions.arena.results import estimates
from reports.registry import content
from reports.run.run_data import read_run
from scenarios.scenario.files import load_study
from tests.reports.report_parts import flown

pytestmark = pytest.mark.slow

QUICK = (
    "fidelity=kinematic", "guidance.rate_hz=5", "flight.log_rate_hz=5",
    "flights=2", "flight.duration_max_s=60", "arena.window_s=30", "arena.tuning_duration_s=30",
    "arena.evaluations=2", "arena.tuning_flights=1", "arena.resamples=100", "start.distance_m=[300,350]", "start.spread_deg=20",
    'arena.tracking=["npfg","pure_pursuit"]', 'arena.standoff=["npfg"]', "arena.limits=[[0.0,5.0],[1.0,9.0]]",
    'arena.conditions=[{name="calm",title="Calm air"},{name="wind",title="Wind",set={"wind.speed_mps"=4.0}}]',
)  # fmt: skip


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return flown(tmp_path_factory, "arena", QUICK)


@pytest.fixture(scope="module")
def run(path):
    return read_run(path)


@pytest.fixture(scope="module")
def arena(run):
    return read_arena(run)


def with_errors(arena, *errors):
    """Return the arena with other errors of its laws: mean, half-width of the interval, and whether
    the bootstrap lets the law be the best; None for a law that is not compared.
    """
    estimates = dict(arena._estimates)
    for entrant, error in zip(arena.entrants, errors, strict=True):
        if error is None:
            found = Estimate(mean=1.0, flights=1)
        else:
            mean, half, as_good = error
            found = Estimate(
                mean=mean, low=mean - half, high=mean + half, flights=4, whole=True, as_good=as_good
            )
        estimates[ERROR, arena.together, entrant.name] = found
    return replace(arena, _estimates=estimates)


@pytest.mark.parametrize(
    ("errors", "words"),
    [
        (((1.0, 0.1, True), (2.0, 0.1, False)), "npfg is best, 1.00 m rms"),
        (
            ((1.0, 0.1, True), (1.1, 0.1, True)),
            "npfg and pure pursuit cannot be told apart, 1.00 to 1.10 m rms",
        ),
        # The bootstrap tells them apart, but a reader sees intervals that overlap.
        (
            ((1.0, 0.1, True), (1.1, 0.1, False)),
            "npfg and pure pursuit cannot be told apart, 1.00 to 1.10 m rms",
        ),
        (((1.0, 0.1, True), None), "only npfg is compared, 1.00 m rms"),
        ((None, None), "no law is compared, as each lacks flights"),
    ],
)
def test_the_headline_says_which_laws_cannot_be_told_from_the_best(arena, errors, words):
    found = with_errors(arena, *errors, (3.0, 0.1, True))
    assert (
        _headline(found)
        == f"Tracking: {words}; Circling: only npfg (circle) is compared, 3.00 m rms"
    )


def of_a_few_flights(run, path, missing):
    """Return the report of a copy of an arena of which the flights that are named by what they
    contain could not be flown.
    """
    rows, record = (
        run.summary.copy(),
        json.loads((run.path / "arena.json").read_text(encoding="utf-8")),
    )
    gone = rows["flight_id"].str.contains(missing)
    rows["keepout_violations"] = rows["keepout_violations"].astype(float)
    figures = ["duration_s", "min_distance_m", "keepout_violations"]
    rows.loc[gone, [*figures, "criteria_met", "kept_out"]] = [
        math.nan,
        math.nan,
        math.nan,
        False,
        False,
    ]
    rows.loc[gone, ["outcome", "message"]] = ["infeasible", "too near"]
    windows = pd.read_csv(run.path / "window.csv").set_index("flight_id")
    figures = {
        name: [
            {} if gone[i] else windows.loc[row["flight_id"]].dropna().to_dict()
            for i, row in of.iterrows()
        ]
        for name, of in rows.groupby("trial")
    }
    named = ("name", "law", "task", "inputs", "defaults")
    entrants = [Entrant(**{key: entry[key] for key in named}) for entry in record["entrants"]]
    record["estimates"] = estimates(entrants, figures, load_study("arena", QUICK).arena, 1)
    (path / "arena.json").write_text(json.dumps(record), encoding="utf-8")
    return arena_content(changed(run, path=path, summary=rows))


def test_a_law_that_lacks_flights_is_named_and_not_called_best(run, tmp_path):
    found = of_a_few_flights(run, tmp_path, "wind_npfg_kinematic_00001")
    assert "Tracking: only pure pursuit is compared, " in found.verdict.headline
    assert found.verdict.tone == "warn"
    assert found.verdict.failures == [
        "npfg: 1 of 4 flights could not be flown, and it is not compared: infeasible: too near"
    ]
    table = tracking_table(read_arena(replace(run, path=tmp_path)), tracking=True)
    # Its mean is by far the better one, of the flights that it has.
    assert [row[1] for row in table.rows] == ["pure pursuit", "npfg"]
    assert [row[2].endswith(", 3 of 4") for row in table.rows] == [False, True]
    assert {row for row, _ in table.bold} == {0}
    each = by_condition_table(read_arena(replace(run, path=tmp_path)), ERROR, tracking=True)
    assert [" of " in cell for cell in each.rows[1][2:]] == [False, True, True]


def test_an_arena_of_which_nothing_was_flown_is_red(run, tmp_path):
    verdict = of_a_few_flights(run, tmp_path, "kinematic").verdict
    assert verdict.headline.endswith(". Nothing was flown")
    assert verdict.tone == "bad"
    assert "npfg: 4 of 4 flights could not be flown: infeasible: too near" in verdict.failures
    assert not any("best" in card.name.lower() for card in verdict.figures)
    assert {card.name: card.met for card in verdict.figures}["Keep-out violations"] is False


def test_an_arena_reads_as_before(run):
    assert_reads_as_before("arena", content(run))
