"""What the report of an arena shows, of a quick one on the kinematic vehicle."""

import json
import math
from dataclasses import replace

import pytest

from extensions.arena.paired_bootstrap import Estimate
from extensions.arena.record import ERROR, read_arena
from extensions.arena.report import (
    _headline,
)
from reports.run.run_data import read_run
from tests.reports.report_parts import built, flown, numbers_on_page_1

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


def test_both_reports_are_built_with_a_place_for_each_part(path):
    text = built(path)
    for anchor in ("tracking", "standoff", "plume", "tuning"):
        assert f'id="{anchor}"' in text
    assert "<b>" in text.partition('id="tracking"')[2]


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


def test_every_number_on_page_1_is_that_of_the_evaluation(path, tmp_path):
    record = json.loads((path / "arena.json").read_text(encoding="utf-8"))
    counts = json.loads((path / "verdict.json").read_text(encoding="utf-8"))["whole"]["counts"]
    ends = [
        value
        for entry in record["estimates"]
        if entry["condition"] == "all"
        for value in (entry["mean"], entry["low"], entry["high"])
        if value is not None
    ]
    expected = {
        *(f"{value:.2f}" for value in ends),
        # The sulphur error of a minute is the inverse root of its mean information.
        *(f"{1.0 / math.sqrt(value):.4f}" for value in ends if value > 0.0),
        *(f"{counts[name]}" for name in ("keepout_violations", "lost", "violated", "flown")),
        *map(str, range(1, len(record["entrants"]))),
        # Confidence of the intervals, and what is required of violations and losses.
        *("95", "0"),
    }
    assert numbers_on_page_1(path, tmp_path) <= expected
