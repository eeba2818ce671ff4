"""The kinds of flights that autopilot and margins are worked out for before any flight."""

import pytest

from scenarios.experiment.requests import Experiment
from scenarios.scenario.scenario import Scenario


@pytest.mark.parametrize(
    ("key", "choices"),
    [
        ("reference.shape", ["sinusoid", "fastest"]),
        ("following.margin_law", ["cascade", "line_of_sight"]),
        ("guidance.law", ["cascade", "line_of_sight"]),
        ("turbulence.level", ["none", "light"]),
    ],
)
def test_each_choice_that_the_tracking_in_turbulence_depends_on_is_a_setting(key, choices):
    air = {"guidance": {"mission": "follow"}, "turbulence": {"level": "light"}, "flights": 2}
    experiment = Experiment(
        "t",
        Scenario.model_validate({"title": "t", **air, "draws": [{"key": key, "choice": choices}]}),
    )
    section, name = key.split(".")
    assert [getattr(getattr(of, section), name) for of in experiment.settings()] == choices
    flown = [experiment.request(number).scenario for number in range(2)]
    assert [getattr(getattr(of, section), name) for of in flown] == choices
