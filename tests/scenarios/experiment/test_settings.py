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


@pytest.mark.parametrize(
    ("draw", "largest"),
    [
        ({"key": "guidance.bank_deg", "uniform": [30.0, 49.0]}, 49.0),
        ({"key": "guidance.bank_deg", "normal": [45.0, 2.0], "within": [40.0, 48.0]}, 48.0),
        ({"key": "guidance.bank_deg", "choice": [30.0, 47.0, 40.0]}, 47.0),
        ({"key": "following.climb_gradient", "uniform": [0.1, 0.3]}, 0.3),
    ],
)
def test_the_aircraft_is_measured_for_the_steepest_turn_and_climb_that_may_be_sampled(
    draw, largest
):
    follow = {"guidance": {"mission": "follow"}, "emission": {"ship": "container"}}
    experiment = Experiment("t", Scenario.model_validate({"title": "t", **follow, "draws": [draw]}))
    section, name = draw["key"].split(".")
    assert max(getattr(getattr(of, section), name) for of in experiment.steepest()) == largest
