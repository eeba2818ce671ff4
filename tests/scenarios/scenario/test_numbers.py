"""Numbers are numbers: truth values are refused in their place, and limits that would count as
another value.
"""

import pytest

from scenarios.errors import InputError
from scenarios.scenario.files import load_study, with_values
from scenarios.scenario.scenario import Scenario


@pytest.mark.parametrize(
    ("name", "override", "words"),
    [
        (
            "sea_wind",
            "wind.speed_mps=true",
            "wind.speed_mps is true; a truth value is no number: give a number",
        ),
        ("sweep_nu", "seed=true", "seed is true; a truth value is no number"),
        ("sweep_nu", "flights=false", "flights is false; a truth value is no number"),
        (
            "sweep_nu",
            "start.distance_m=[true, 500]",
            "start.distance_m is [true, 500]; a truth value is no number",
        ),
        (
            "sweep_nu",
            "arena.limits=[[0.5, true]]",
            "arena.limits is [[0.5, true]]; a truth value is no number",
        ),
        (
            "plume_search",
            "payload.limit_percent=true",
            "payload.limit_percent is true; a truth value is no number",
        ),
        (
            "convergence",
            "ensemble.distance_max_m=true",
            "ensemble.distance_max_m is true; a truth value is no number",
        ),
        (
            "sweep_nu",
            "criteria.tracking_error_rms_m=true",
            "tracking_error_rms_m is true; a truth value is no number: give a number",
        ),
        (
            "sweep_nu",
            "criteria.tracking_error_rms_m=0",
            "value is 0; give a limit above 0, or false where",
        ),
        (
            "sweep_nu",
            "criteria.crossing_distance_m=[300, 200]",
            "crossing_distance_m is [300.0, 200.0]; its first value must not",
        ),
        (
            "sweep_nu",
            'criteria.modes_at_end=["traking"]',
            "'traking' is not a mode; did you mean 'tracking'? modes are approach,",
        ),
    ],
)
def test_what_would_count_as_another_number_is_refused_in_one_line(name, override, words):
    with pytest.raises(InputError) as refusal:
        load_study(name, [override])
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_truth_values_are_taken_where_they_belong():
    words = [
        "criteria.tracking_error_rms_m=false",
        "guidance.preview=true",
        'criteria.modes_at_end=["tracking", "ditched"]',
    ]
    scenario = load_study("sweep_nu", words)
    assert scenario.criteria.tracking_error_rms_m is False
    assert scenario.guidance.preview is True


def test_a_swept_truth_value_is_no_number_either():
    with pytest.raises(InputError, match=r"wind\.speed_mps is true"):
        with_values(Scenario(title="t"), {"wind.speed_mps": True})


@pytest.mark.parametrize(
    "keys",
    [
        {"comparison": {"variants": [{"name": "study", "set": {"guidance.law": "lyapunov"}}]}},
        {"cases": [{"name": "study", "comparison": True}]},
    ],
)
def test_a_comparison_does_not_have_the_name_of_flights_that_count(keys):
    with pytest.raises(
        ValueError, match="a comparison is called 'study', as flights that count are"
    ):
        Scenario(title="t", **keys)
    assert Scenario(title="t", cases=[{"name": "study"}]).cases[0].name == "study"
