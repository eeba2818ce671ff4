"""What a flight's row fails of its criteria, and the judge of a run."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.verdict import (
    INTERRUPTED,
    MET,
    NOT_MET,
    UNEXPLAINED,
    KeepOut,
    did_what_is_required,
    read_verdict,
)
from scenarios.flight.outcome import Outcome
from scenarios.measures.criteria import failed_criteria
from scenarios.measures.verdict import Judge, counts_of
from scenarios.scenario.sections.flight import CriteriaConfig

GOOD = {
    "outcome": "completed", "message": "", "mode_at_end": "tracking", "fault": "none",
    "fault_time_s": math.nan, "duration_s": 300.0, "settling_time_s": 80.0, "resume_periods": 1.5,
    "tracking_error_end_m": 1.0, "keepout_violations": 0, "keepout_depth_m": 0.0,
    "keepout_radius_m": 200.0, "crossing_clearance_min_m": 0.0, "tracking_error_rms_m": 1.5,
    "airspeed_error_rms_mps": 0.3, "altitude_error_max_m": 1.5, "crossing_interval_mean_s": 10.0,
    "crossing_interval_predicted_s": 10.0, "crossing_distance_mean_m": 215.0,
    "heading_rate_command_max_rad_s": 0.5, "heading_rate_limit_rad_s": 0.5,
    "heading_rate_demand_max_rad_s": 0.6,
}  # fmt: skip
"""A row at every limit of the criteria that there are unless a scenario says otherwise."""


def failed(changed, **criteria):
    return failed_criteria({**GOOD, **changed}, CriteriaConfig(**criteria))


def test_a_flight_at_every_limit_has_met_them():
    assert failed({}) == []


DIVERGED = {"outcome": "diverged", "message": "it rolled over"}
INCOMPLETE = {"outcome": "incomplete", "message": "flew 12 of 30 crossings"}
FREE = {"settles": False}

FAILED = [
    ({"keepout_violations": 1, "keepout_depth_m": 10.0}, {}, "1 keep-out violation, the deepest"),
    ({"outcome": "not_settled"}, {}, "did not complete"),
    (DIVERGED, FREE, "it rolled over"),
    (INCOMPLETE, FREE, "flew 12 of 30 crossings"),
    ({"settling_time_s": math.nan}, {}, "did not settle"),
    ({"crossing_clearance_min_m": -0.01}, {}, "crossed at 199.99 m"),
    ({"tracking_error_rms_m": 1.51}, {}, "rms tracking error 1.51 m, above the limit of 1.5 m"),
    ({"tracking_error_rms_m": math.nan}, {}, "tracking error"),
    ({"airspeed_error_rms_mps": 0.31}, {}, "airspeed error"),
    ({"altitude_error_max_m": 1.6}, {}, "altitude error"),
    ({"tracking_error_end_m": 1.1}, {"tracking_error_end_m": 1.0}, "tracking error at the end"),
    ({"crossing_interval_mean_s": 10.11}, {}, "mean crossing interval 10.110 s"),
    ({"crossing_interval_mean_s": 12.0}, {"crossing_interval_error": 0.02}, "interval 12.000 s"),
    (
        {"crossing_interval_mean_s": 10.05},
        {"crossing_interval_s": (9.0, 10.0)},
        "outside 9 to 10 s",
    ),
    ({}, {"crossing_distance_m": (210.0, 214.0)}, "215.000 m outside 210 to 214 m"),
    ({"heading_rate_command_max_rad_s": 0.5001}, {}, "commanded 0.5001 rad/s, above omega_max"),
    ({"heading_rate_demand_max_rad_s": 0.51}, {"law_within_heading_rate_max": True}, "above omega"),
    ({"heading_rate_demand_max_rad_s": 0.5}, {"law_beyond_heading_rate_max": True}, "within omega"),
    ({"resume_periods": 2.1}, {"resumes_within_periods": 2.0}, "crossings resumed 2.10 periods"),
    ({"mode_at_end": "outrun"}, {"modes_at_end": ("tracking", "holding off")}, "ended outrun"),
    ({"time_to_find_s": 301.0}, {"time_to_find_s": 300.0}, "above the limit of 300 s"),
    # A plume that was never detected has no time.
    ({}, {"time_to_find_s": 300.0}, "time to find the plume nan s"),
    ({"altitude_outside_s": 0.1}, {"within_altitudes": True}, "0.1 s outside"),
]


@pytest.mark.parametrize(("changed", "criteria", "words"), FAILED)
def test_every_criterion_can_fail_and_says_so_in_a_short_sentence(changed, criteria, words):
    (found,) = failed(changed, **criteria)
    assert words in found


NOT_FLOWN = ("infeasible", "trim_failed", "failed")
"""Outcomes of flights that may never have been flown."""


def row(number=0, outcome="completed", *, met=None, trial="t", flown=None, **figures):
    """Return a row of a flight beside a vessel, which stayed outside unless figures say otherwise."""
    measured = {
        "duration_s": 1800.0, "keepout_violations": 0, "min_distance_m": 230.0,
        "keepout_shape": "sphere", "settling_time_s": 80.0, "tracking_error_rms_m": 1.0,
        "airspeed_error_rms_mps": 0.1, "altitude_error_max_m": 0.5,
        "crossing_interval_mean_s": 10.0, "crossing_interval_predicted_s": 10.0,
        "heading_rate_limit_rad_s": 0.5, "heading_rate_demand_max_rad_s": 0.4,
        "heading_rate_command_max_rad_s": 0.4, "tracking_error_end_m": 1.0,
    }  # fmt: skip
    begun = outcome not in NOT_FLOWN if flown is None else flown
    return {
        "flight_id": f"f{number}", "trial": trial, "outcome": outcome, "message": f"why {number}",
        "required": "criteria", "keepout_radius_m": 200.0, "fault": "none",
        "fault_time_s": math.nan, "criteria_met": outcome == "completed" if met is None else met,
        **(measured if begun else {}), **figures,
    }  # fmt: skip


def judged(rows, planned=None, criteria=None):
    rows = list(rows)
    judge = Judge({"t": planned or len(rows)})
    for each in rows:
        judge.add(each, criteria or CriteriaConfig())
    return judge.verdict()


ROWS = [
    row(0),
    row(1, met=False, min_distance_m=190.0, keepout_violations=2, keepout_depth_m=10.0),
    row(2, "infeasible"),
    row(3, "aircraft_lost", min_distance_m=210.0),
    row(4, "diverged", min_distance_m=300.0),
    row(5, "failed", flown=True),
]


def test_each_flight_is_counted_once_by_how_it_kept_out():
    counts = judged(ROWS, planned=8).counts
    begun = (counts.planned, counts.done, counts.flown, counts.left, counts.not_flown)
    assert begun == (8, 6, 5, 2, 1)
    ended = (counts.completed, counts.met, counts.lost, counts.diverged, counts.failed)
    assert ended == (2, 1, 2, 1, 1)
    # The lost one and the failed one were outside to their end, and did not keep out.
    assert (counts.kept_out, counts.outside, counts.violated, counts.unknown) == (1, 2, 1, 2)
    assert (counts.keepout_violations, counts.no_area) == (2, 0)


FLIGHTS = st.builds(
    lambda outcome, violations, flown, required: row(
        outcome=outcome,
        flown=flown or outcome not in NOT_FLOWN,
        required=required,
        **({"keepout_violations": violations, "keepout_depth_m": 1.0} if flown else {}),
        met=outcome == "completed" and not (violations and flown),
    ),
    st.sampled_from([outcome.value for outcome in Outcome]),
    st.sampled_from([0, 0, 1, 3]),
    st.booleans(),
    st.sampled_from(["criteria", "keep_out"]),
)


@given(st.lists(FLIGHTS, min_size=1, max_size=8))
def test_a_run_meets_its_requirement_only_where_every_flight_does(rows):
    verdict = judged(each | {"flight_id": f"f{i}"} for i, each in enumerate(rows))
    counts = verdict.counts
    parts = (counts.kept_out, counts.outside, counts.violated, counts.unknown, counts.no_area)
    assert sum(parts) == counts.done == len(rows)
    assert counts.kept_out + counts.lost + counts.failed <= counts.done + counts.violated
    if verdict.exit_status == MET:
        assert counts.violated == counts.unknown == counts.diverged == counts.failed == 0
        assert not verdict.flights["not_passed"]
    # "No keep-out violation" may be said of no run with a flight that was lost, failed or is unknown.
    if verdict.all_kept_out:
        assert counts.violated == counts.unknown == counts.lost == counts.failed == 0
    assert not verdict.once_interrupted(interrupted=True).all_kept_out


def test_a_verdict_is_read_back_as_it_was_written(tmp_path):
    text = json.dumps(judged(ROWS, planned=8).to_json(), allow_nan=False)
    (tmp_path / "verdict.json").write_text(text, encoding="utf-8")
    assert read_verdict(tmp_path / "verdict.json").to_json() == json.loads(text)


def test_a_flight_kept_out_only_if_it_is_known_to_its_end_and_came_back():
    assert KeepOut.of(row()) is KeepOut.KEPT_OUT
    assert KeepOut.of(row(outcome="not_settled")) is KeepOut.KEPT_OUT
    assert KeepOut.of(row(outcome="aircraft_lost")) is KeepOut.OUTSIDE
    assert KeepOut.of(row(outcome="diverged")) is KeepOut.UNKNOWN
    assert KeepOut.of(row(outcome="diverged", keepout_violations=1)) is KeepOut.VIOLATED
    assert KeepOut.of(row(outcome="infeasible")) is KeepOut.UNKNOWN
    # One whose process was lost before anything was planned may have had an area.
    assert KeepOut.of({"outcome": "failed"}) is KeepOut.UNKNOWN
    circling = {"outcome": "completed", "required": "criteria", "duration_s": 100.0}
    assert KeepOut.of(circling) is KeepOut.NO_AREA
    assert KeepOut.of(circling | {"keepout_violations": math.nan}) is KeepOut.NO_AREA


def test_where_keeping_out_is_required_an_aircraft_may_be_lost_outside_and_nothing_else():
    alone = {"required": "keep_out", "met": False}
    assert did_what_is_required(row(outcome="aircraft_lost", **alone))
    assert did_what_is_required(row(outcome="not_settled", **alone))
    assert not did_what_is_required(row(outcome="aircraft_lost", met=False))
    for outcome in ("diverged", "failed"):
        assert not did_what_is_required(row(outcome=outcome, flown=True, **alone))
    assert not did_what_is_required(row(outcome="infeasible", **alone))
    assert not did_what_is_required(row(keepout_violations=1, **alone))


def test_the_exit_status_is_that_of_the_worst_that_happened():
    assert judged([row(0)]).exit_status == MET
    assert judged([row(0)], planned=2).exit_status == NOT_MET
    assert judged(ROWS).exit_status == NOT_MET
    wrong = row(1, "unexplained_violation", keepout_violations=1, keepout_depth_m=1.0)
    assert judged([row(0), wrong]).exit_status == UNEXPLAINED
    assert judged([row(0)]).once_interrupted(interrupted=True).exit_status == INTERRUPTED
    # A run whose comparisons are still to be flown has not ended.
    judge = Judge({"t": 1})
    judge.add(row(0), CriteriaConfig())
    left = judge.verdict(comparisons={"no_guard": counts_of([row(1)], planned=3)})
    assert (left.comparisons_left, left.exit_status, left.is_done) == (2, NOT_MET, False)


def test_a_criterion_has_the_worst_flight_of_all_beside_the_worst_of_those_that_it_judges():
    rows = [
        row(0, tracking_error_rms_m=2.0, met=False),
        row(1, tracking_error_rms_m=1.2),
        # It did not complete, so that no criterion judges it.
        row(2, "incomplete", tracking_error_rms_m=50.0),
        row(3, "infeasible"),
    ]
    verdict = judged(rows)
    found = verdict.whole.criterion("tracking_error_rms_m")
    assert (found.judged, found.failed, found.met, list(found.limits)) == (2, 1, False, [1.5])
    assert (found.worst.value, found.worst.flight) == (2.0, "f0")
    assert (found.worst_of_all.value, found.worst_of_all.flight) == (50.0, "f2")
    # Where no flight is required to settle it judges none, and the worst is known all the same.
    free = judged(rows, criteria=CriteriaConfig(settles=False))
    unjudged = free.whole.criterion("tracking_error_rms_m")
    assert (unjudged.judged, unjudged.met, unjudged.worst) == (0, None, None)
    assert unjudged.worst_of_all.flight == "f2"
    keep_out = verdict.whole.criterion("keep_out")
    assert (keep_out.judged, keep_out.worst.value) == (3, 30.0)


def test_flights_of_different_limits_are_each_judged_by_their_own():
    judge = Judge({"t": 2})
    judge.add(row(0, tracking_error_rms_m=2.9), CriteriaConfig(tracking_error_rms_m=3.0))
    judge.add(row(1, tracking_error_rms_m=1.4), CriteriaConfig(tracking_error_rms_m=1.0))
    found = judge.verdict().whole.criterion("tracking_error_rms_m")
    assert (list(found.limits), found.failed) == ([3.0, 1.0], 1)
    # 1.4 m is worse for its limit than 2.9 m is.
    assert (found.worst.flight, found.worst.limit) == ("f1", 1.0)
    assert found.worst_of_all.flight == "f0"
