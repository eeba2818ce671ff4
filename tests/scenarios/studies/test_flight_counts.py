"""Counts of the flights of a study."""

from scenarios.simulation.outcome import Outcome
from scenarios.studies.summary import FlightCounts


def row(number, outcome="completed", *, met=True, **figures):
    return {"flight_id": f"f{number}", "outcome": outcome, "message": f"why {number}", "criteria_met": met, **figures}


def test_flights_are_counted_by_their_outcome_and_whether_they_met_their_criteria():
    counts = FlightCounts.of(
        [
            row(0, min_distance_m=230.0, keepout_violations=0),
            row(1, met=False, min_distance_m=190.0, keepout_violations=2),
            row(2, "infeasible", met=False),
            row(3, min_distance_m=210.0, keepout_violations=1),
        ],
        planned=5,
    )
    assert (counts.planned, counts.done, counts.completed, counts.met) == (5, 4, 3, 2)
    assert (counts.keepout_violations, counts.nearest) == (3, 190.0)
    assert counts.failed_lines("  ") == ["  f1: completed: why 1", "  f2: infeasible: why 2"]
    # Every outcome is named, also those that no flight had.
    assert set(counts.manifest()["outcomes"]) == {outcome.value for outcome in Outcome}
    assert counts.manifest()["outcomes"]["infeasible"] == 1
    assert counts.manifest()["flights_met_criteria"] == 2


def test_of_many_failed_flights_the_first_are_named_and_the_rest_counted():
    lines = FlightCounts.of((row(i, met=False) for i in range(10_000)), planned=10_000).failed_lines("")
    assert len(lines) == 21
    assert lines[0] == "f0: completed: why 0"
    assert lines[-1] == "and 9980 more failed, see summary.csv"
