"""Results, verdicts and limits in words, same on consoles and in reports."""

import pytest

from measurement.estimate.verdict import content_words, judged, needed, next_step, verdict_words
from measurement.gases import limit_words


@pytest.mark.parametrize(
    ("limit", "words"),
    [(0.1, "0.10 %"), (0.5, "0.50 %"), (1.0, "1.00 %"), (0.001, "0.001 %"), (0.125, "0.125 %")],
)
def test_a_limit_is_printed_with_as_many_decimals_as_it_has(limit, words):
    assert limit_words(limit) == words
    assert f"above the limit of {words}; probability above it: 99.0 %" in verdict_words(
        "above", limit, 0.99
    )


def test_a_content_that_rounds_to_0_has_no_sign():
    assert content_words(-0.0004, 0.0, 0.0196) == "0.000 % m/m, 95 % interval 0.000 to 0.020 %"


def test_an_open_verdict_beyond_the_probability_names_the_guard_band():
    # The knowledge that no fuel has less than 0 lifts the probability, and "above" asks for the
    # guard band alone: the normal distribution's 0.9370 at 1.53, over its 0.9484 at 1.63.
    verdict = judged(0.01, 0.163, 0.1, admitted=True)
    assert verdict.verdict == "open"
    assert verdict.probability_above > 0.95
    assert verdict_words("open", 0.01, verdict.probability_above).endswith(": 98.8 %")
    assert needed(verdict.probability_above) == "the result is within the guard band"
    assert (
        needed(judged(0.1, 0.12, 0.1, admitted=True).probability_above) == "95 % or 5 % are needed"
    )


def test_an_open_verdict_says_which_part_of_the_uncertainty_to_lower():
    known = {
        "passes": 9,
        "undecided": True,
        "errors": {"correction for NO2": 0.02, "carbon content": 0.01},
    }
    assert "measure more passes" in next_step("B", noise=0.03, **known)
    assert "as by a calibration: correction for NO2." in next_step("B", noise=0.01, **known)
    assert next_step("B", noise=0.01, **{**known, "undecided": False}) == ""
    assert "measure again in the plume" in next_step(
        "C", noise=float("nan"), **{**known, "passes": 0}
    )
