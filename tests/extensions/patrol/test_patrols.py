"""How patrols are judged, by the sums over them."""

import pytest

from extensions.patrol.counts import PatrolCounts

# A patrol of six ships of which five were served, as the catalog's criteria have it: 80 % of the
# oracle's, 5 % wrong.
ROW = {
    "ships": 6,
    "served": 5,
    "verdicts": 5,
    "correct": 5,
    "wrong": 0,
    "open": 0,
    "oracle_verdicts": 6,
    "keepout_violations": 0,
    "kept_out": True,
    "criteria_met": True,
    "duration_s": 3600.0,
    "message": "",
}


def counts(*rows, planned=1):
    return PatrolCounts.of(
        [ROW | row for row in rows], planned=planned, oracle_share_min=0.8, wrong_share_max=0.05
    )


@pytest.mark.parametrize(
    ("served", "verdicts", "oracle", "judged"),
    [(0, 0, 2, False), (2, 0, 0, False), (2, 0, 1, True), (2, 1, 0, True)],
)
def test_patrols_are_judged_by_a_ship_that_was_served_and_a_verdict_of_the_patrol_or_an_oracle(
    served, verdicts, oracle, judged
):
    assert (
        counts({"served": served, "verdicts": verdicts, "oracle_verdicts": oracle}).judged is judged
    )


@pytest.mark.parametrize(
    ("change", "holds", "met"),
    [
        ({}, True, True),
        ({"correct": 4, "open": 1}, True, False),
        ({"correct": 4, "wrong": 1, "oracle_verdicts": 5}, True, False),
        ({"criteria_met": False}, False, False),
        ({"served": 0, "verdicts": 0, "correct": 0, "oracle_verdicts": 0}, False, False),
        ({"verdicts": 0, "correct": 0, "open": 5, "oracle_verdicts": 0}, True, False),
    ],
)
def test_patrols_hold_by_what_must_not_happen_and_are_met_by_their_verdicts_as_well(
    change, holds, met
):
    assert (counts(change).holds, counts(change).met) == (holds, met)
