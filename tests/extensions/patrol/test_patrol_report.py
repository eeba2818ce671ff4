"""What the report of patrols shows, of one of the kinematic vehicle with a ship that is served and
one that cannot be.
"""

from dataclasses import replace

import pytest
from snapshots import assert_reads_as_before

from extensions.patrol.report import patrol_content
from reports.document.blocks import CARDS_MAX
from reports.registry import content
from reports.run.run_data import read_run
from tests.reports.report_parts import flown

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


def test_patrols_read_as_before(run):
    assert_reads_as_before("patrol", content(run))
