"""Which flights an environment has: those of the scenario's study, each as a run flies it."""

import math

import gymnasium
import numpy as np

from extensions.gym import ENVIRONMENT
from scenarios import fly


def test_flights_of_a_monte_carlo_study_have_the_points_that_the_run_has():
    draws = [
        {"key": "wind.speed_mps", "uniform": [1.0, 8.0]},
        {"key": "start.range_m", "uniform": [400.0, 800.0]},
    ]
    scenario = {
        "study": "monte_carlo", "title": "sampled", "fidelity": "kinematic", "flights": 4, "wind": {"speed_mps": 3.0},
        "vessel": {"speed_mps": 6.0}, "flight": {"duration_max_s": 20.0, "crossings": 0}, "draws": draws,
    }  # fmt: skip
    env = gymnasium.make(ENVIRONMENT, scenario=scenario)
    flight_id = env.unwrapped.flight_ids[2]
    _, info = env.reset(options={"flight_id": flight_id})
    over = False
    while not over:
        *_, terminated, truncated, info = env.step(info["guidance"])
        over = terminated or truncated
    flown = fly(scenario, flight_id=flight_id)
    start = env.unwrapped._episode.loop.plan.start
    assert math.hypot(start.north, start.east) == flown.row["start_distance_m"]
    assert np.array_equal(env.unwrapped.record.column("east_m"), flown.history["east_m"].to_numpy())
    # At random: at a point of the study, with a seed of its own.
    distances = {round(math.hypot(*env.reset(seed=seed)[0][:2]), 6) for seed in range(8)}
    assert 1 < len(distances) <= 4


def test_comparisons_of_a_trial_take_no_flight_away_from_those_after_it(tmp_path):
    kinds = {
        "one": "[comparison]\nvariants = [{ name = 'los', set = { 'guidance.law' = 'line_of_sight' } }]\n",
        "two": "",
    }
    for name, comparison in kinds.items():
        text = f"title = '{name}'\nfidelity = 'kinematic'\nflights = 2\nvessel = {{ speed_ratio = 0.4 }}\n{comparison}"
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
    trials = [str(tmp_path / f"{name}.toml") for name in kinds]
    env = gymnasium.make(
        ENVIRONMENT, scenario={"study": "trials", "title": "list", "trials": trials}
    )
    assert env.unwrapped.flight_ids == ("one_00000", "one_00001", "two_00000", "two_00001")
    _, info = env.reset(options={"flight_id": "two_00001"})
    assert info["flight_id"] == "two_00001"
