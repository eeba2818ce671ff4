"""What the console says of the flights of a study."""

import pytest

from common.verdict import Counts
from scenarios.measures.verdict import Judge, bound_of, counts_of
from scenarios.scenario.sections.flight import CriteriaConfig
from scenarios.studies.summary import (
    FlightNotes,
    bound_line,
    comparison_lines,
    counts_line,
    exit_line,
    premise_lines,
    trial_line,
    unexplained_lines,
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


def test_the_exit_line_says_what_is_required_and_how_many_flights_did_it():
    assert exit_line(judged(ROWS)) == (
        "exit status 1: 1 of 4 flights did what is required: to meet every criterion"
    )
    alone = judged({**each, "required": "keep_out"} for each in ROWS)
    # The flight that lost its aircraft stayed outside; that which was never flown did not.
    assert exit_line(alone) == (
        "exit status 1: 2 of 4 flights did what is required: to stay outside of the keep-out area"
    )
    assert exit_line(judged(ROWS[:1], 2)).startswith("so far 1 of 2 flights did what")
    assert exit_line(judged(ROWS[:1]).once_interrupted(interrupted=True)).startswith("so far ")


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


def test_comparisons_are_told_with_their_flights_or_why_none_was_flown():
    judge = Judge({"t": 1})
    verdict = judge.verdict(comparisons={"no_guard": counts_of([row(0)], 2)})
    (line,) = comparison_lines(verdict, [])
    assert line.startswith("  comparison no_guard, not counted above: 2 planned, 1 flown")
    assert comparison_lines(judge.verdict(), [0.15, 0.5]) == [
        "  comparisons: none flown, as no flight is at a speed ratio of comparison.nu, [0.15, 0.5]"
    ]


@pytest.mark.parametrize(
    ("unflown", "lines"), [({}, 0), ({"manoeuvres_unflown": 0}, 0), ({"manoeuvres_unflown": 2}, 1)]
)
def test_manoeuvres_that_were_never_flown_are_warned_of(unflown, lines):
    found = FlightNotes.of([row(0, **unflown)]).warnings()
    assert len(found) == lines
    assert all(
        line.startswith("warning: in 1 flight a manoeuvre of the vessel begins after the end")
        for line in found
    )


def test_flights_that_never_reached_the_smoke_are_warned_of():
    passes = [{"smoke_passes": 0, "axis_height_error_mean_m": height} for height in (-36.3, 12.0)]
    passes += [{"smoke_passes": 9, "axis_height_error_mean_m": -50.0}]
    (line,) = FlightNotes.of(
        [row(i, plume_axis_crossings=20, **of) for i, of in enumerate(passes)]
    ).warnings()
    assert line.startswith(
        "warning: in 2 flights the UAV never passed through the smoke, and crossed its axis up to 36 m below it"
    )
    assert FlightNotes.of([row(0, plume_axis_crossings=0, smoke_passes=0)]).warnings() == []


def test_of_many_flights_that_are_not_met_the_first_are_named_and_the_rest_counted():
    lines = FlightNotes.of(row(i, met=False) for i in range(10_000)).not_met_lines("")
    assert len(lines) == 21
    assert lines[0] == "f0: completed: why 0"
    assert lines[-1] == "and 9980 more, see summary.csv"


@pytest.mark.parametrize(
    ("quality", "verdict", "words"),
    [
        ("A", "above", "above the limit of 0.10 %; probability above it: 99.0 %"),
        ("A", "below", "below the limit of 0.10 %; probability above it: 99.0 %"),
        (
            "B",
            "open",
            "not shown to be above or below the limit of 0.10 %; probability above it: 94.0 %",
        ),
        ("C", "open", "no verdict on the limit of 0.10 %: quality C gives none"),
    ],
)
def test_the_sulphur_of_one_flight_is_stated_with_its_interval_and_of_several_by_their_verdicts(
    quality, verdict, words
):
    row = {
        "outcome": "completed", "kept_out": True, "criteria_met": True, "fsc_percent": 0.2, "fsc_low_percent": 0.12,
        "fsc_high_percent": 0.28, "sulphur_limit_percent": 0.1, "probability_above": 0.94 if verdict == "open" else 0.99,
        "sulphur_quality": quality, "sulphur_verdict": verdict,
    }  # fmt: skip
    (line,) = FlightNotes.of([row]).sulphur_lines()
    assert line == f"fuel sulphur 0.200 % m/m, 95 % interval 0.120 to 0.280 %: {words}"
    (line,) = FlightNotes.of([row] * 3).sulphur_lines()
    sides = {
        "above": "3 above the limit",
        "below": "3 below the limit",
        "open": "3 with an open verdict",
    }
    called = sides[verdict] if quality != "C" else "3 without a verdict (quality C)"
    assert line.startswith("fuel sulphur of 3 flights: ")
    assert called in line
    assert FlightNotes.of([{**row, "fsc_percent": float("nan")}]).sulphur_lines() == []


def test_flights_whose_sniffer_failed_are_told_by_the_fault():
    # 1800 s long; one fault was to begin after that, and an engine's is told by how the flight
    # ended.
    begun = [
        ("sniffer_dead", 60.0),
        ("sniffer_dead", 90.0),
        ("sniffer_saturated", 60.0),
        ("sniffer_dead", 2e3),
        ("engine", 60.0),
    ]
    counts = FlightNotes.of(
        [row(i, fault=kind, fault_time_s=time) for i, (kind, time) in enumerate(begun)]
    )
    assert counts.sulphur_lines() == [
        "a fault of the sniffer began in 2 of 5 flights: sniffer_dead",
        "a fault of the sniffer began in 1 of 5 flights: sniffer_saturated",
    ]
    assert FlightNotes.of([row(0, fault="none", fault_time_s=float("nan"))]).sulphur_lines() == []


def test_a_flight_whose_sniffer_gave_nothing_says_why():
    row = {
        "outcome": "completed",
        "kept_out": True,
        "criteria_met": True,
        "sulphur_reason": "no pass through a plume",
    }
    (line,) = FlightNotes.of([row] * 2).sulphur_lines()
    assert line == "no fuel sulphur content in 2 flights: no pass through a plume"


def test_premises_that_did_not_hold_are_told_by_their_term():
    rows = [
        row(0, premises_exceeded="none"),
        row(1, premises_exceeded="wind, drift"),
        row(2, premises_exceeded="drift"),
        # Without a guard there are none.
        row(3),
    ]
    verdict = judged(rows)
    (line,) = premise_lines(verdict)
    assert "exceeded in 2 of 3 flights: drift of dead reckoning in 2, wind" in line
    assert unexplained_lines(verdict) == []
    assert premise_lines(judged(rows[3:])) == []


def test_a_violation_that_no_premise_explains_is_said_loudly():
    inside = row(0, "unexplained_violation", met=False, keepout_violations=1)
    (line,) = unexplained_lines(judged([inside]))
    assert line.startswith("THE KEEP-OUT GUARD IS WRONG: in 1 flight")
