"""What the report of patrols shows, of one of the kinematic vehicle with a ship that is served and
one that cannot be.
"""

import math
from dataclasses import replace

import pandas as pd
import pytest
from snapshots import assert_reads_as_before

from extensions.patrol.report import counts_of, oracle_table, patrol_content, read_patrols
from reports.document.blocks import CARDS_MAX
from reports.registry import content
from reports.run.run_data import read_run
from tests.reports.report_parts import flown, numbers_on_page_1

pytestmark = pytest.mark.slow

QUICK = (
    "fidelity=kinematic", "guidance.rate_hz=5", "flight.log_rate_hz=5", "flights=1", "patrol.ships=2", "patrol.area_m=9000",
    "patrol.endurance_s=330", "patrol.separation_m=2000",
)  # fmt: skip


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return read_run(flown(tmp_path_factory, "patrol", QUICK))


def test_the_verdict_compares_with_the_oracle(run):
    found = patrol_content(run).verdict
    figures = {card.name: card for card in found.figures}
    (row,) = run.summary.to_dict("records")
    right = figures["Right verdicts"]
    # 80 % and 5 % are the catalog's.
    assert right[1:3] == (f"{row['correct']}", f"≥ 80 % of the oracle's {row['oracle_verdicts']}")
    assert figures["Keep-out violations"].value == "0"
    assert found.holds
    assert right.met == (row["correct"] >= 0.8 * row["oracle_verdicts"])
    assert 4 <= len(found.figures) <= CARDS_MAX


def of_row(run, **values):
    """Return the verdict on a run whose only row has other values."""
    return patrol_content(replace(run, summary=run.summary.assign(**values))).verdict


@pytest.mark.parametrize("oracle", [0, 2])
def test_patrols_that_served_no_ship_are_red_and_claim_no_share(run, oracle):
    none = dict.fromkeys(
        ("served", "verdicts", "correct", "wrong", "open", "keepout_violations"), 0
    )
    found = of_row(run, **none, oracle_verdicts=oracle, kept_out=True, criteria_met=True)
    words = f"No ship was served; an oracle reaches {oracle} right verdicts"
    assert (found.headline, found.tone) == (words, "bad")
    figures = {card.name: card.met for card in found.figures}
    assert figures["Ships served per hour"] is False
    assert figures["Keep-out violations"] is False
    assert figures["Right verdicts"] is (False if oracle else None)
    assert figures["Wrong verdicts"] is None


def test_a_violation_and_a_lost_aircraft_stand_on_page_1(run):
    found = of_row(run, keepout_violations=2, aircraft_lost=True, criteria_met=False)
    assert found.headline.startswith("2 keep-out violations. ")
    assert found.tone == "bad"
    assert {card.name: card.value for card in found.cards}["Aircraft lost"] == "1"


@pytest.mark.parametrize(
    ("name", "figure"),
    [
        ("Closest approach to a ship that was served", "min_distance_m"),
        ("Closest approach to any other ship", "others_distance_min_m"),
    ],
)
def test_the_closest_approach_to_each_ship_is_judged_by_the_keep_out_radius(run, name, figure):
    for distance, value, met in ((199.99, "199.9 m", False), (200.0, "200.0 m", True)):
        (card,) = [card for card in of_row(run, **{figure: distance}).figures if card.name == name]
        assert (card.value, card.limit, card.met) == (value, "≥ 200 m", met)


def test_a_patrol_that_failed_is_a_row_of_dashes_with_its_reason(run):
    failed = pd.DataFrame(
        [
            {
                "flight_id": "patrol_00001",
                "criteria_met": False,
                "outcome": "failed",
                "message": "no room",
            }
        ]
    )
    both = replace(run, summary=pd.concat([run.summary, failed], ignore_index=True))
    assert oracle_table(read_patrols(both)).rows[1][1:] == ["–"] * 13
    found = patrol_content(both)
    assert found.verdict.failures == ["patrol_00001: no room"]
    assert not found.verdict.complete


def test_the_report_is_judged_as_the_study_is(run):
    found = of_row(run, correct=1, wrong=0, verdicts=1, oracle_verdicts=1)
    assert "verdicts: 1 right, 0 wrong" in found.headline
    assert found.complete
    # The study's exit status is of the same sums: a patrol that did not come through fails both.
    fallen = replace(run, summary=run.summary.assign(criteria_met=False))
    assert (patrol_content(fallen).verdict.holds, counts_of(fallen).met) == (False, False)


def test_every_number_on_page_1_is_that_of_the_tables(run, tmp_path):
    rows = pd.read_csv(run.path / "summary.csv")
    sums = rows[["served", "correct", "wrong", "open", "verdicts", "oracle_verdicts"]].sum()
    nearest = rows[["min_distance_m", "others_distance_min_m"]].min()
    expected = {
        *(f"{number:.0f}" for number in sums),
        f"{sums['served'] / (rows['duration_s'].sum() / 3600.0):.1f}",
        f"{rows['keepout_violations'].sum():.0f}",
        *(f"{math.floor(10.0 * number) / 10.0:.1f}" for number in nearest.dropna()),
        *(f"{number:.1f}" for number in nearest.dropna()),
        # Required: more than 0 ships, 80 % and 5 % of the verdicts, and r_min of 200 m.
        *("0", "80", "5", "200"),
    }
    assert numbers_on_page_1(run.path, tmp_path) <= expected


def test_patrols_read_as_before(run):
    assert_reads_as_before("patrol", content(run))
