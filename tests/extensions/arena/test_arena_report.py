"""What the report of an arena shows, of a quick one on the kinematic vehicle."""

from dataclasses import replace

import pytest
from snapshots import assert_reads_as_before

from extensions.arena.paired_bootstrap import Estimate
from extensions.arena.record import ERROR, read_arena
from extensions.arena.report import _headline
from reports.registry import content
from reports.run.run_data import read_run
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


def test_an_arena_reads_as_before(run):
    assert_reads_as_before("arena", content(run))
