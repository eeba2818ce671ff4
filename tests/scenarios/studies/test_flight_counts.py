"""Counts of the flights of a study."""

import pytest

from scenarios.flight.outcome import Outcome
from scenarios.studies.summary import FlightCounts, comparison_lines


def row(number, outcome="completed", *, met=True, **figures):
    flown = (
        {"duration_s": 1800.0, "kept_out": True, "keepout_violations": 0}
        if outcome not in ("infeasible", "failed")
        else {}
    )
    return {
        "flight_id": f"f{number}",
        "outcome": outcome,
        "message": f"why {number}",
        "criteria_met": met,
        **flown,
        **figures,
    }


ROWS = [
    row(0, min_distance_m=230.0),
    row(1, met=False, min_distance_m=190.0, keepout_violations=2, kept_out=False),
    row(2, "infeasible", met=False),
    row(3, "aircraft_lost", met=False, min_distance_m=210.0),
]


def test_flights_are_counted_as_planned_flown_completed_and_met():
    counts = FlightCounts.of(ROWS, planned=6)
    assert (
        counts.planned,
        counts.done,
        counts.flown,
        counts.completed,
        counts.met,
        counts.lost,
    ) == (6, 4, 3, 2, 1, 1)
    assert (counts.kept_out, counts.keepout_violations, counts.nearest) == (2, 2, 190.0)
    assert counts.line() == (
        "6 planned, 3 flown, 2 completed, 1 met every criterion, 1 lost the aircraft; 2 of 3 kept out, 2 keep-out violations,"
        " closest approach 190.0 m"
    )
    # A distance says what it is measured from.
    for shape, words in (
        ("sphere", "190.0 m (from the centre of the keep-out sphere)"),
        ("cylinder", "190.0 m (horizontally, from"),
    ):
        assert (
            words
            in FlightCounts.of(
                ({**each, "keepout_shape": shape} for each in ROWS), planned=6
            ).line()
        )
    # A flight about a point, without a vessel, has nothing to keep out of; one that did not
    # complete may have had.
    alone = {
        "flight_id": "f4",
        "outcome": "completed",
        "message": "",
        "criteria_met": True,
        "duration_s": 100.0,
    }
    assert (
        "; 2 of 3 beside a vessel kept out, 2 " in FlightCounts.of([*ROWS, alone], planned=6).line()
    )
    assert (
        "; 2 of 4 kept out, 2 "
        in FlightCounts.of([*ROWS, alone | {"outcome": "diverged"}], planned=6).line()
    )
    assert counts.not_met_lines("  ") == [
        "  f1: completed: why 1",
        "  f2: infeasible: why 2",
        "  f3: aircraft_lost: why 3",
    ]
    # Every outcome is named, also those that no flight had.
    manifest = counts.manifest()
    assert set(manifest["outcomes"]) == {outcome.value for outcome in Outcome}
    assert (
        manifest["outcomes"]["infeasible"],
        manifest["flights_met_criteria"],
        manifest["flights_kept_out"],
    ) == (1, 1, 2)


def test_the_exit_status_is_about_every_criterion_unless_keeping_out_alone_is_required():
    every = FlightCounts.of(ROWS, planned=4)
    assert every.passed == 1
    assert (
        every.exit_line()
        == "exit status 1: 1 of 4 flights met every criterion, which is required of each"
    )
    alone = FlightCounts.of(({**each, "required": "keep_out"} for each in ROWS), planned=4)
    # The flight that lost its aircraft kept out; that which was never flown did not.
    assert alone.passed == alone.kept_out == 2
    assert alone.exit_line() == "exit status 1: 2 of 4 flights kept out, which is required of each"
    # What failed after its flight, as an instrument may, kept out, and is not done.
    failed = [
        {**each, "required": "keep_out", "outcome": "failed"}
        for each in ROWS
        if each.get("kept_out")
    ]
    assert FlightCounts.of(failed, planned=2).kept_out == 2
    assert FlightCounts.of(failed, planned=2).passed == 0
    # The status is 0 where every flight did it, and none while flights are missing.
    met = [row for row in ROWS if row["criteria_met"]]
    assert (
        FlightCounts.of(met, planned=1).exit_line()
        == "exit status 0: 1 of 1 flight met every criterion, which is required of it"
    )
    missing = FlightCounts.of(met, planned=2).exit_line()
    assert (
        missing
        == "so far 1 of 2 flights met every criterion, which is required of each for exit status 0"
    )
    # A run whose comparisons are still to be flown has not ended either.
    without_comparisons = FlightCounts.of(met, planned=1).exit_line(left=3)
    assert (
        without_comparisons
        == "so far 1 of 1 flight met every criterion, which is required of it for exit status 0"
    )


def test_a_bound_follows_from_the_flights_that_were_flown():
    counts = FlightCounts.of([row(i, min_distance_m=201.0) for i in range(64)], planned=200)
    # The rule of three: 1 - 0.05^(1/64) = 4.57 %.
    assert counts.bound_line(counts.beside) == (
        "keep-out violations: none known in 64 flights (32 h simulated); at most 4.57 % of flights sampled as these were,"
        " at 95 % confidence"
    )


def test_the_bound_counts_flights_that_are_not_known_to_their_end_as_violations_and_says_so():
    rows = [row(i, min_distance_m=201.0) for i in range(97)]
    rows += [
        row(97, met=False, keepout_violations=2, kept_out=False),
        row(98, "diverged", met=False, kept_out=False),
    ]
    # Flights about a point have nothing to keep out of.
    rows += [
        {
            "flight_id": "f99",
            "outcome": "completed",
            "message": "",
            "criteria_met": True,
            "duration_s": 100.0,
        }
    ]
    # 2 of 99: 1, 99 and 4,851 ways to none, one and two make 0.05 at p = 6.22 %.
    assert FlightCounts.of(rows, planned=100).bound_line(99) == (
        "keep-out violations: in 1 of 99 flights (49.5 h simulated), unknown in 1, which counts as violated; at most 6.22 % of"
        " flights sampled as these were, at 95 % confidence"
    )
    # One that could not be flown is as little known: 3 of 100 are at most 7.57 %.
    line = FlightCounts.of([*rows, row(100, "infeasible", met=False)], planned=101).bound_line(100)
    assert (
        "in 1 of 100 flights (49.5 h simulated), unknown in 2, which count as violated; at most 7.57 % of"
        in line
    )


def test_flights_that_share_what_is_random_bound_a_probability_as_one():
    counts = FlightCounts.of([row(i, min_distance_m=201.0) for i in range(64)], planned=64)
    # 32 radii, flown with two seeds: of two flights 1 - 0.05^(1/2) = 78 % could violate the area.
    assert counts.bound_line(2).endswith(
        "(32 h simulated); they share 2 random samples; too few to bound their probability"
    )
    assert "; they share 16 random samples; at most 17.1 % of flights" in counts.bound_line(16)


def test_comparisons_are_told_with_their_flights_or_why_none_was_flown():
    (line,) = comparison_lines({"no_guard": 2}, [row(0) | {"variant": "no_guard"}], [])
    assert line.startswith("  comparison no_guard, not counted above: 2 planned, 1 flown")
    assert comparison_lines({}, (), [0.15, 0.5]) == [
        "  comparisons: none flown, as no flight is at a speed ratio of comparison.nu, [0.15, 0.5]"
    ]


@pytest.mark.parametrize(
    ("unflown", "lines"), [({}, 0), ({"manoeuvres_unflown": 0}, 0), ({"manoeuvres_unflown": 2}, 1)]
)
def test_manoeuvres_that_were_never_flown_are_warned_of(unflown, lines):
    found = FlightCounts.of([row(0, **unflown)], planned=1).warnings()
    assert len(found) == lines
    assert all(
        line.startswith("warning: in 1 flight a manoeuvre of the vessel begins after the end")
        for line in found
    )


def test_flights_that_never_reached_the_smoke_are_warned_of():
    passes = [{"smoke_passes": 0, "axis_height_error_mean_m": height} for height in (-36.3, 12.0)]
    passes += [{"smoke_passes": 9, "axis_height_error_mean_m": -50.0}]
    (line,) = FlightCounts.of(
        [row(i, plume_axis_crossings=20, **of) for i, of in enumerate(passes)], planned=3
    ).warnings()
    assert line.startswith(
        "warning: in 2 flights the UAV never passed through the smoke, and crossed its axis up to 36 m below it"
    )
    assert (
        FlightCounts.of([row(0, plume_axis_crossings=0, smoke_passes=0)], planned=1).warnings()
        == []
    )


def test_of_many_flights_that_are_not_met_the_first_are_named_and_the_rest_counted():
    lines = FlightCounts.of(
        (row(i, met=False) for i in range(10_000)), planned=10_000
    ).not_met_lines("")
    assert len(lines) == 21
    assert lines[0] == "f0: completed: why 0"
    assert lines[-1] == "and 9980 more, see summary.csv"


def test_a_handful_of_flights_bounds_no_probability():
    row = {
        "outcome": "completed",
        "kept_out": True,
        "keepout_violations": 0,
        "criteria_met": True,
        "duration_s": 1800.0,
    }
    line = FlightCounts.of([row] * 4, planned=4).bound_line(4)
    # With none of four, 1 - 0.05^(1/4) = 0.53 is above a half; with none of five 0.45 is not.
    assert (
        line
        == "keep-out violations: none known in 4 flights (2 h simulated); too few flights to bound their probability"
    )
    assert "at most 45.1 %" in FlightCounts.of([row] * 5, planned=5).bound_line(5)


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
    (line,) = FlightCounts.of([row], planned=1).sulphur_lines()
    assert line == f"fuel sulphur 0.200 % m/m, 95 % interval 0.120 to 0.280 %: {words}"
    (line,) = FlightCounts.of([row] * 3, planned=3).sulphur_lines()
    sides = {
        "above": "3 above the limit",
        "below": "3 below the limit",
        "open": "3 with an open verdict",
    }
    called = sides[verdict] if quality != "C" else "3 without a verdict (quality C)"
    assert line.startswith("fuel sulphur of 3 flights: ")
    assert called in line
    assert FlightCounts.of([{**row, "fsc_percent": float("nan")}], planned=1).sulphur_lines() == []


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
    counts = FlightCounts.of(
        [row(i, fault=kind, fault_time_s=time) for i, (kind, time) in enumerate(begun)], planned=5
    )
    assert counts.sulphur_lines() == [
        "a fault of the sniffer began in 2 of 5 flights: sniffer_dead",
        "a fault of the sniffer began in 1 of 5 flights: sniffer_saturated",
    ]
    assert (
        FlightCounts.of(
            [row(0, fault="none", fault_time_s=float("nan"))], planned=1
        ).sulphur_lines()
        == []
    )


def test_a_flight_whose_sniffer_gave_nothing_says_why():
    row = {
        "outcome": "completed",
        "kept_out": True,
        "criteria_met": True,
        "sulphur_reason": "no pass through a plume",
    }
    (line,) = FlightCounts.of([row] * 2, planned=2).sulphur_lines()
    assert line == "no fuel sulphur content in 2 flights: no pass through a plume"


def test_premises_that_did_not_hold_are_counted_by_their_term():
    rows = [
        row(0, premises_exceeded="none"),
        row(1, premises_exceeded="wind, drift"),
        row(2, premises_exceeded="drift"),
        # Without a guard there are none.
        row(3),
    ]
    counts = FlightCounts.of(rows, planned=4)
    assert (counts.with_premises, counts.exceeding) == (3, 2)
    assert counts.exceeded == {"drift": 2, "wind": 1}
    (line,) = counts.premise_lines()
    assert "exceeded in 2 of 3 flights: drift of dead reckoning in 2, wind" in line
    assert counts.unexplained_lines() == []
    assert FlightCounts.of(rows[3:], planned=1).premise_lines() == []


def test_a_violation_that_no_premise_explains_is_said_loudly():
    inside = row(0, "unexplained_violation", met=False, keepout_violations=1, kept_out=False)
    counts = FlightCounts.of([inside], planned=1)
    (line,) = counts.unexplained_lines()
    assert line.startswith("THE KEEP-OUT GUARD IS WRONG: in 1 flight")
