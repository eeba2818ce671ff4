"""The verdict on flights claims what was flown, and the bound that follows: no more, and no less."""

import re

import pandas as pd
import pytest
from judged_runs import changed
from report_parts import flown
from trial_runs import rows_of, with_criterion, with_values

from reports.registry import content
from reports.run.run_data import read_run

pytestmark = pytest.mark.usefixtures("without_single_flights")


def test_one_keep_out_violation_decides_the_verdict_of_the_whole_run(run):
    verdict = content(run).verdict
    assert verdict.headline.startswith("4 of 4 flights kept out, 4 finished. Worst: ")
    assert verdict.tone == "good"
    judged = content(
        with_values(
            run,
            3,
            keepout_violations=2,
            keepout_depth_m=1.5,
            min_distance_m=198.5,
            criteria_met=False,
        )
    )
    assert judged.verdict.tone == "bad"
    assert judged.verdict.headline.startswith(
        "3 of 4 flights kept out, 4 finished, 1 violated. Worst: −1.5 m beyond r_min, "
    )
    assert (
        "Closest approach, from the keep-out sphere's centre",
        "198.5 m",
        "≥ 200 m",
        False,
        "turns_00001",
    ) in judged.verdict.figures
    assert judged.verdict.failures == ["turns_00001: completed"]
    # Keep-out violations and the closest approach, from r_min too, are in the trial's row.
    assert rows_of(judged, "Turns")[0][7:10] == ["2", "198.5", "−1.5"]


@pytest.mark.parametrize(
    ("distance", "radius", "shown", "required", "met"),
    [
        (202.3, 202.5, "202.3 m", "≥ 202.5 m", False),
        (199.97, 200.0, "199.9 m", "≥ 200 m", False),
        (202.56, 202.55, "202.6 m", "≥ 202.55 m", True),
        (202.53, 202.52, "202.53 m", "≥ 202.52 m", True),
        (200.06, 200.0, "200.1 m", "≥ 200 m", True),
    ],
)
def test_the_closest_approach_as_shown_agrees_with_its_judgement(
    run, distance, radius, shown, required, met
):
    closest = run
    for i in range(4):
        closest = with_values(closest, i, min_distance_m=distance, keepout_radius_m=radius)
    report = content(closest)
    name = "Closest approach, from the keep-out sphere's centre"
    assert (name, shown, required, met) in [card[:4] for card in report.verdict.figures]
    assert report.verdict.tone == ("good" if met else "bad")


LOST = {
    "outcome": "aircraft_lost",
    "mode_at_end": "ditched",
    "criteria_met": False,
    "message": "it came down on the sea",
}


@pytest.mark.parametrize(
    ("outcome", "words"),
    [
        ("aircraft_lost", "3 of 4 flights kept out, 3 finished, 1 lost. "),
        ("diverged", "3 of 4 flights kept out, 3 finished, 1 diverged. "),
        ("incomplete", "4 of 4 flights kept out, 3 finished. "),
    ],
)
def test_the_headline_counts_flights_that_did_not_finish_once(run, outcome, words):
    kept_out = outcome == "incomplete"
    report = content(with_values(run, 1, **{**LOST, "outcome": outcome, "kept_out": kept_out}))
    assert report.verdict.headline.startswith(words)
    assert report.verdict.tone == "bad"
    # Flights that are planned, flown, completed, met.
    assert rows_of(report, "Steady")[0][:4] == ["2", "2", "1", "1"]


def test_where_a_fault_is_flown_on_purpose_a_lost_aircraft_is_shown_and_keeping_out_judged(run):
    report = content(with_values(run, 1, required="keep_out", **LOST))
    # Amber: nothing that must never happen did, but not every flight is met.
    assert (report.verdict.tone, report.verdict.exit_status) == ("warn", 0)
    assert report.verdict.headline.startswith("3 of 4 flights kept out, 3 finished, 1 lost. ")
    assert report.verdict.detail == (
        "Of the flights, 1 had only to stay outside of the keep-out area: 1 did, and 0 also finished."
    )
    tiles = {card.name: card for card in report.verdict.cards}
    assert tiles["Kept out"][1:4] == ("3 of 4", "not required of every flight", None)
    assert tiles["Kept out"].note.startswith("1 lost or failed outside; ")
    # A loss is never green.
    assert (tiles["Aircraft lost"].value, tiles["Aircraft lost"].tone) == ("1", "open")
    assert rows_of(report, "Steady")[0][:6] == ["2", "2", "1", "1", "1", "1"]


NOT_FLOWN = {
    "outcome": "infeasible", "message": "too fast a vessel", "criteria_met": False, "kept_out": False,
    "duration_s": float("nan"), "min_distance_m": float("nan"), "tracking_error_rms_m": float("nan"),
    "keepout_violations": float("nan"),
}  # fmt: skip


def test_a_flight_that_could_not_be_flown_is_counted_and_makes_no_other_flights_figure_red(run):
    judged = with_criterion(
        with_values(run, 1, **NOT_FLOWN), "steady", "tracking_error_rms_m", 50.0
    )
    report = content(judged)
    figures = {card.name: card for card in report.verdict.figures}
    (worst,) = (
        card
        for name, card in figures.items()
        if name.startswith("Tracking error, rms after settling")
    )
    assert worst.met
    assert figures["Kept out"][1:4] == ("3 of 4", "all", False)
    assert figures["Kept out"].note.startswith("1 unknown; ")
    # Of all that were planned, not of those that were flown.
    assert figures["Finished"][1:4] == ("3 of 4", "all", False)
    (row,) = (row for row in rows_of(report, "Steady") if row[1] == "≤ 50 m")
    # As on page 1: it fails the mission, and is not judged by what could not be measured.
    assert row[-2:] == ["1 of 2", "0"]


def test_the_verdict_claims_what_was_flown_and_the_bound_that_follows(run):
    again = run.summary.assign(
        flight_id=[f"{flight_id}_again" for flight_id in run.summary["flight_id"]]
    )
    eight = changed(
        run,
        summary=pd.concat([run.summary, again], ignore_index=True),
        manifest=run.manifest | {"flights_planned": 8},
    )
    verdict = content(eight).verdict
    # Clopper and Pearson, none of eight: 1 - 0.05^(1/8). It is said once, where it belongs.
    bound = "rate of violations below 31.2 % at 95 %"
    texts = [
        verdict.headline,
        verdict.detail,
        *verdict.failures,
        *(text for figure in verdict.figures for text in (*figure[:3], figure.note)),
    ]
    said = [text for text in texts if bound in text.replace("\N{NO-BREAK SPACE}", " ")]
    assert said == [verdict.figures[0].note]
    assert not any(re.search(r"\bsafe", text, re.IGNORECASE) for text in texts)
    # Those of a search are no random sample: no bound follows from them.
    manifest = run.manifest | {"sampled_at_random": {"steady": False, "turns": True}}
    chosen = content(changed(run, manifest=manifest)).verdict
    assert chosen.figures[0].note == "no random sample, so no bound on the rate"


def test_a_flight_that_could_not_be_flown_counts_as_a_violation_in_the_bound(run):
    rows = with_values(run, 1, **NOT_FLOWN).summary
    others = [
        run.summary.assign(flight_id=[f"{name}_{i}" for name in run.summary["flight_id"]])
        for i in range(3)
    ]
    sixteen = changed(
        run,
        summary=pd.concat([rows, *others], ignore_index=True),
        manifest=run.manifest | {"flights_planned": 16},
    )
    verdict = content(sixteen).verdict
    assert verdict.headline.startswith(
        "15 of 16 flights kept out, 15 finished, 1 could not be flown. "
    )
    # Clopper and Pearson, one of sixteen: (1 - p)^16 + 16 p (1 - p)^15 = 0.05; none of fifteen
    # would be 18.1 %.
    assert verdict.figures[0].note.replace("\N{NO-BREAK SPACE}", " ") == (
        "1 unknown; rate of violations below 26.4 % at 95 %, with 1 unknown as violated"
    )


def test_a_premise_that_did_not_hold_is_named_with_its_largest_ratio(run):
    report = content(
        with_values(run, 0, premises_exceeded="drift, wind", premise_drift_ratio_max=2.5)
    )
    assert any(
        "drift of dead reckoning in 1, up to 2.50" in line for line in report.verdict.failures
    )
    assert ("Flights with a premise of the guard exceeded", "1 of 4") in [
        (figure.name, figure.value) for figure in report.verdict.figures
    ]


def test_a_violation_that_no_premise_explains_comes_before_anything_else(run):
    values = {
        "outcome": "unexplained_violation",
        "criteria_met": False,
        "kept_out": False,
        "keepout_violations": 1,
        "keepout_depth_m": 3.0,
    }
    report = content(with_values(run, 0, **values))
    assert report.verdict.headline.startswith("The keep-out guard is wrong in 1 of 4 flights: ")
    assert (report.verdict.tone, report.verdict.exit_status) == ("bad", 3)
    assert ("Violations with every premise of the guard held", "1", "0", False) in [
        (figure.name, figure.value, figure.limit, figure.met) for figure in report.verdict.figures
    ]


# The paper's circle on the paper's vehicle, long enough to settle from any start.
CIRCLE = (
    "cases=[]",
    "study=flights",
    "reference.path=circle",
    "fidelity=kinematic",
    "flight.duration_max_s=300",
    "flights=2",
)


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    return content(read_run(flown(tmp_path_factory, "paper", CIRCLE)))


def test_they_count_as_flown_and_have_no_area_to_keep_out_of(report):
    verdict = report.verdict
    assert verdict.headline.startswith(
        "2 flights about a circle, without a vessel, 2 finished. Worst: tracking "
    )
    assert verdict.tone == "good"
    # Two flights of 300 s.
    assert report.flown.startswith("2 flights (10 min simulated)")
    figures = {card.name: card for card in verdict.figures}
    assert figures["Finished"].value == "2 of 2"
    assert not [name for name in figures if "ept" in name or "approach" in name]
    assert not any("rate" in card.note for card in verdict.figures)
