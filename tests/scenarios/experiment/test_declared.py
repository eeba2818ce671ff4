"""What a search takes as declared: speed ratios, the vessel's acceleration, values that do not
contradict each other.
"""

import math

import numpy as np
import pytest

from scenarios.experiment.requests import Experiment
from scenarios.experiment.sampling import beyond_declared, search_space
from scenarios.scenario.files import load_study
from scenarios.scenario.scenario import Scenario


def scenario(**changes):
    """Return a kinematic scenario of a vessel at 8 m/s."""
    base = {"title": "test", "fidelity": "kinematic", "vessel": {"speed_mps": 8.0}}
    return Scenario.model_validate(base | {"guidance": {"mission": "follow"}} | changes)


def manoeuvring(at_s, **second):
    """Return a scenario whose vessel turns at 10 m/s and 1 deg/s, 0.175 m/s2, and brakes at 0.2
    m/s2.
    """
    turn = {"at_s": 50.0, "turn_deg": 90.0, "turn_rate_deg_s": 1.0}
    braking = {"at_s": at_s, "speed_mps": 2.0, "acceleration_mps2": 0.2} | second
    manoeuvres = [turn | braking] if at_s == turn["at_s"] else [turn, braking]
    return scenario(
        vessel={"speed_mps": 10.0, "manoeuvres": manoeuvres},
        following={"vessel_acceleration_mps2": 0.25},
        draws=[{"key": "wind.speed_mps", "uniform": [0.0, 1.0]}],
    )


def test_changes_of_speed_and_of_course_count_together():
    # One after the other they are within 0.25 m/s2; at one time they make hypot(0.175, 0.2) = 0.265
    # at most.
    assert beyond_declared(manoeuvring(200.0), [0.0]) == 0.0
    excess = math.hypot(10.0 * math.radians(1.0), 0.2) / 0.25 - 1.0
    # Of a table of 0.05 s, in which the speed has fallen by 0.01 m/s, and of what is allowed for
    # rounding, 0.001.
    assert beyond_declared(manoeuvring(50.0), [0.0]) == pytest.approx(excess, abs=2e-3)
    faster = beyond_declared(manoeuvring(200.0, acceleration_mps2=0.3), [0.0])
    assert faster == pytest.approx(0.2, abs=2e-3)


def test_the_space_knows_choices_times_directions_and_noise():
    draws = [
        {"key": "flight_seed", "choice": [1, 2]},
        {"key": "turbulence.level", "choice": ["none", "light"], "weights": [3, 1]},
        {"key": "fault.at_s", "uniform": [20.0, 280.0]},
        {"key": "wind.from_deg", "uniform": [0.0, 360.0]},
        {"key": "start.course_deg", "uniform": [0.0, 90.0]},
        {"key": "wind.speed_mps", "weibull": [2.0, 6.0]},
    ]
    space = search_space(scenario(fidelity="six_dof", draws=draws))
    noise, level, time, direction, quarter, speed = space.coordinates
    assert (noise.noise, level.noise) == (True, False)
    assert (noise.choices, level.choices) == ((0.0, 0.5, 1.0), (0.0, 0.75, 1.0))
    assert [of.time_range for of in (level, time, speed)] == [None, (20.0, 280.0), None]
    assert [of.circle for of in (direction, quarter, speed)] == [True, False, False]
    assert [of.has_ends for of in space.coordinates] == [False, False, False, False, True, True]


def test_falsify_searches_over_everything_that_its_scenario_declares():
    study = load_study("falsify")
    space = search_space(study)
    keys = [draw.key for draw in study.draws]
    # Two manoeuvres and a fault, any two at one time where their ranges overlap.
    assert {tuple(keys[i] for i in pair) for pair in space.time_pairs} == {
        ("vessel.manoeuvres.0.at_s", "fault.at_s"),
        ("vessel.manoeuvres.1.at_s", "fault.at_s"),
    }
    points = space.random(np.random.default_rng(1), 20)
    experiment = Experiment("falsify", study)
    for number, point in enumerate(points):
        assert space.beyond(point) == 0.0
        request = experiment.request(0, tuple(map(float, point)), seed=number)
        earliest, latest = request.scenario.fault.at_s
        assert earliest == latest == request.inputs["fault.at_s"]
        assert (request.seed, request.inputs["flight_seed"]) == (number, number)
