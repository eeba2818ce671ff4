"""What the report of patrols shows, of one of the kinematic vehicle with a ship that is served and
one that cannot be.
"""

import math

import pandas as pd
import pytest

from extensions.patrol.report import (
    patrol_content,
)
from reports.document.blocks import CARDS_MAX
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
