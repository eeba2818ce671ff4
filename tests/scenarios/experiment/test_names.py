"""What the flights of an experiment are called."""

import pytest

from scenarios.experiment.requests import Experiment
from scenarios.scenario.scenario import Scenario

SPEEDS = {"wind.speed_mps": [0.0, 5.0], "vessel.speed_mps": [3.0, 6.0]}
MANOEUVRES = [{"at_s": 100.0, "turn_deg": 20.0}, {"at_s": 200.0, "turn_deg": -20.0}]


def names(**keys):
    return Experiment(
        "own", Scenario.model_validate({"title": "own", "guidance": {"mission": "follow"}, **keys})
    ).names()


def test_swept_keys_that_end_alike_are_told_apart_by_as_many_of_their_last_parts_as_that_takes():
    assert names(sweep=SPEEDS) == [
        "wind_speed_mps_0_vessel_speed_mps_3",
        "wind_speed_mps_0_vessel_speed_mps_6",
        "wind_speed_mps_5_vessel_speed_mps_3",
        "wind_speed_mps_5_vessel_speed_mps_6",
    ]
    # A third key whose end is its own keeps its name.
    assert (
        names(sweep=SPEEDS | {"keepout.radius_m": [150.0]})[0]
        == "wind_speed_mps_0_vessel_speed_mps_3_radius_m_150"
    )


def test_entries_of_a_list_are_told_apart_by_the_number_and_the_name_of_the_list():
    sweep = {"vessel.manoeuvres.0.at_s": [90.0], "vessel.manoeuvres.1.at_s": [210.0]}
    found = names(vessel={"speed_mps": 5.0, "manoeuvres": MANOEUVRES}, sweep=sweep)
    assert found == ["manoeuvres_0_at_s_90_manoeuvres_1_at_s_210"]


@pytest.mark.parametrize(
    ("sweep", "expected"),
    [
        ({"nu": [0.3], "wind.speed_mps": [5.0]}, "nu_0.30_speed_mps_5"),
        ({"keepout.radius_m": [150.0], "guidance.law": ["cascade"]}, "radius_m_150_law_cascade"),
    ],
)
def test_names_of_swept_keys_that_end_differently_are_their_last_parts(sweep, expected):
    assert names(sweep=sweep) == [expected]
