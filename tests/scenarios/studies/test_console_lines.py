"""What the console says of the flights of a study."""

import pytest

from common.verdict import Counts
from scenarios.measures.verdict import Judge, bound_of
from scenarios.scenario.sections.flight import CriteriaConfig
from scenarios.studies.summary import (
    bound_line,
    counts_line,
    trial_line,
)


def row(number, outcome="completed", *, met=True, **figures):
    flown = (
        {
            "duration_s": 1800.0,
            "keepout_violations": 0,
            "min_distance_m": 230.0,
            "keepout_shape": "sphere",
            "heading_rate_limit_rad_s": 0.5,
            "heading_rate_demand_max_rad_s": 0.4,
            "heading_rate_command_max_rad_s": 0.4,
            "crossing_interval_predicted_s": 9.0,
        }
        if outcome not in ("infeasible", "failed")
        else {}
    )
    return {
        "flight_id": f"f{number}",
        "trial": "t",
        "outcome": outcome,
        "message": f"why {number}",
        "criteria_met": met,
        "required": "criteria",
        "keepout_radius_m": 200.0,
        "fault": "none",
        "fault_time_s": float("nan"),
        **flown,
        **figures,
    }


def judged(rows, planned=None):
    rows = list(rows)
    judge = Judge({"t": planned or len(rows)})
    for each in rows:
        judge.add(each, CriteriaConfig(settles=False, crossing_interval_error=False))
    return judge.verdict()


ROWS = [
    row(0),
    row(1, met=False, min_distance_m=190.0, keepout_violations=2),
    row(2, "infeasible", met=False),
    row(3, "aircraft_lost", met=False, min_distance_m=210.0),
]


def test_the_line_of_flights_says_of_none_that_it_kept_out_unless_it_came_back():
    assert trial_line(judged(ROWS, 6).whole) == (
        "6 planned, 3 flown, 2 completed, 1 met every criterion, 1 lost the aircraft, 1 could not be flown; 1 of 4 kept out,"
        " 1 ended outside, lost or failed, 1 violated the area, 1 unknown; 2 keep-out violations,"
        " closest approach 190.0 m (from the centre of the keep-out sphere)"
    )
    diverged = counts_line(judged([row(0, "diverged", met=False)]).counts)
    assert "1 diverged; 0 of 1 kept out, 1 unknown" in diverged
    # Nothing was flown.
    assert counts_line(judged([], 2).counts) == (
        "2 planned, 0 flown, 0 completed, 0 met every criterion"
    )


@pytest.mark.parametrize(
    ("flights", "violated", "unknown", "samples", "words"),
    [
        # The rule of three: 1 - 0.05^(1/64) = 4.57 %.
        (64, 0, 0, 64, "none known in 64 flights (32 h simulated); at most 4.57 % of flights sampled as these were, at 95 %"),
        # 2 of 99: 1, 99 and 4,851 ways to none, one and two make 0.05 at p = 6.22 %.
        (99, 1, 1, 99, "in 1 of 99 flights (49.5 h simulated), unknown in 1, which counts as violated; at most 6.22 % of"),
        # 32 radii, flown with two seeds: of two flights 1 - 0.05^(1/2) = 78 % could violate the area.
        (64, 0, 0, 2, "(32 h simulated); they share 2 random samples; too few to bound their probability"),
        (64, 0, 0, 16, "; they share 16 random samples; at most 17.1 % of flights"),
        # With none of four, 1 - 0.05^(1/4) = 0.53 is above a half; with none of five 0.45 is not.
        (4, 0, 0, 4, "none known in 4 flights (2 h simulated); too few flights to bound their probability"),
        (5, 0, 0, 5, "at most 45.1 % of"),
    ],
)  # fmt: skip
def test_the_bound_follows_from_the_flights_and_counts_unknown_ones_as_violations(
    flights, violated, unknown, samples, words
):
    counts = Counts(
        planned=flights, done=flights, violated=violated, unknown=unknown, hours=0.5 * flights
    )
    assert words in bound_line(bound_of(counts, samples), counts.hours)
