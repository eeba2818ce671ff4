"""Keys that a case, a comparison or a condition sets beside random variables: what is set wins, and
all others start alike.
"""

import pytest

from scenarios.experiment.requests import Experiment
from scenarios.scenario.scenario import Scenario

DRAWS = [
    {"key": "wind.speed_mps", "uniform": [3.0, 8.0]},
    {"key": "wind.from_deg", "choice": [0.0, 90.0, 180.0]},
    {"key": "vessel.manoeuvres.0.turn_deg", "uniform": [-90.0, 90.0]},
    {"key": "vessel.speed_mps", "uniform": [2.0, 8.0]},
]
BASE = {
    "title": "t", "fidelity": "kinematic", "flights": 6, "guidance": {"mission": "follow"}, "draws": DRAWS,
    "vessel": {"manoeuvres": [{"at_s": 50.0}]},
}  # fmt: skip


def requests_of(**keys):
    experiment = Experiment("t", Scenario.model_validate(BASE | keys))
    return [experiment.request(number) for number in range(experiment.flights)]


@pytest.mark.parametrize(
    ("values", "gone", "value_of", "expected"),
    [
        ({"wind.speed_mps": 0.0}, {"wind.speed_mps"}, lambda s: s.wind.speed_mps, 0.0),
        ({"wind.from_deg": 45.0}, {"wind.from_deg"}, lambda s: s.wind.from_deg, 45.0),
        (
            {"vessel.manoeuvres": []},
            {"vessel.manoeuvres.0.turn_deg"},
            lambda s: s.vessel.manoeuvres,
            (),
        ),
        ({"vessel.speed_ratio": 0.5}, {"vessel.speed_mps"}, lambda s: s.vessel_speed, 0.5 * 19.42),
        (
            {"wind": {"speed_mps": 2.0}},
            {"wind.speed_mps", "wind.from_deg"},
            lambda s: (s.wind.speed_mps, s.wind.from_deg),
            (2.0, 0.0),
        ),
    ],
)
def test_what_a_comparison_or_a_case_sets_wins_over_a_sample_and_others_keep_theirs(
    values, gone, value_of, expected
):
    plain = requests_of()
    compared = requests_of(comparison={"variants": [{"name": "own", "set": values}]})
    cases = requests_of(cases=[{"name": "own", "set": values}])
    for study, flight, of_case in zip(plain, compared[len(plain) :], cases, strict=True):
        kept = {key: value for key, value in study.inputs.items() if key not in gone}
        assert flight.inputs == of_case.inputs == kept
        assert flight.seed == of_case.seed == study.seed
        assert flight.scenario.vessel == of_case.scenario.vessel
        assert value_of(flight.scenario) == value_of(of_case.scenario) == expected


def test_a_flight_of_a_comparison_is_sampled_again_where_the_flight_beside_it_is():
    # In calm air other samples than the study's would have a speed ratio within these.
    narrow = {
        "speed_ratio": [0.2, 0.7],
        "comparison": {"variants": [{"name": "calm", "set": {"wind.speed_mps": 0.0}}]},
    }
    flights = requests_of(**narrow)
    for study, calm in zip(flights[:6], flights[6:], strict=True):
        assert calm.inputs == {
            key: value for key, value in study.inputs.items() if key != "wind.speed_mps"
        }
        assert calm.scenario.wind.speed_mps == 0.0
