"""The figures of a flight that looked at its verdict before its end."""

import pytest

from measurement.estimate.repeated import RepeatedVerdict
from scenarios.instruments.fuel_estimate import repeated_figures, with_verdict


def row(content, quality="B"):
    """Return the figures of a whole flight, with a standard uncertainty of 0.025 %."""
    return {
        "fsc_percent": content,
        "fsc_noise_percent": 0.015,
        "fsc_uncertainty_percent": 0.025,
        "sulphur_quality": quality,
        "sulphur_verdict": "open",
    }


def looked(*contents):
    """Return a verdict on 0.10 % after looks with a standard uncertainty of 0.04 %."""
    verdict = RepeatedVerdict(0.10)
    for content in contents:
        verdict.look(content, noise=0.035, total=0.04, admitted=True)
    return verdict


def test_the_end_of_a_flight_is_its_last_look_and_spends_what_is_left():
    early, late = looked(0.1), looked(0.1)
    # 2.0 standard uncertainties above the limit: as a further look it stays open, as the last one
    # it does not.
    assert early.look(0.15, noise=0.015, total=0.025, admitted=True) == "open"
    figures = repeated_figures(late, row(0.15))
    assert (figures["sulphur_verdict"], figures["verdict_looks"]) == ("above", 2)
    assert 1.645 < figures["verdict_guard"] < early.guard


@pytest.mark.parametrize("verdict", ["above", "open"])
def test_a_document_tells_the_verdict_of_the_row_and_leaves_the_rest(verdict):
    given = {"estimate": {"fsc_percent": 0.2, "verdicts": [{"verdict": "below"}]}, "carbon": 0.87}
    found = with_verdict(given, verdict)
    assert found["estimate"] == {"fsc_percent": 0.2, "verdicts": [{"verdict": verdict}]}
    assert given["estimate"]["verdicts"] == [{"verdict": "below"}]
    assert with_verdict(None, verdict) is None
