"""The report of flights about a circle: they were flown, have every figure that needs no vessel,
and nothing to keep out of.
"""

import pytest
from report_parts import flown

from reports.registry import content
from reports.run.run_data import read_run

# The paper's circle on its own vehicle, long enough to settle from any start.
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
