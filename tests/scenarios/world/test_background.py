"""The CO2 of the air beside the exhaust: its size and its time are those of the scenario."""

import math

import numpy as np
import pytest

from scenarios.scenario.sections.world import AirConfig
from scenarios.world.plume import sampled_background

LONG = 40_000.0
"""So long that a mean over it has little scatter [s]."""


def sampled(kind, size, time, *, duration=LONG, seed=1):
    config = AirConfig(background=kind, background_ppm=size, background_s=time)
    return sampled_background(config, duration, np.random.default_rng(seed))


def test_haze_has_the_standard_deviation_and_the_correlation_time_that_are_given():
    size, correlation = 3.0, 25.0
    found = [sampled("haze", size, correlation, seed=seed) for seed in range(10)]
    values = np.array([haze.at(np.arange(0.0, LONG, 1.0)) for haze in found])
    # Over n = T/(2 L) = 800 independent values, ten times, the variance has a relative standard
    # deviation of sqrt(2/8000) = 1.6 %, and a correlation one of about 1 %: four of them.
    assert np.mean(values**2) == pytest.approx(size**2, rel=0.064)
    later = np.mean(values[:, :-25] * values[:, 25:]) / size**2
    assert later == pytest.approx(math.exp(-1.0), abs=0.05)


def test_a_sine_has_the_amplitude_and_the_period_that_are_given_and_any_phase():
    time = np.arange(0.0, 600.0, 0.5)
    one, other = (
        sampled("sine", 2.0, 120.0, duration=600.0, seed=seed).at(time) for seed in (1, 2)
    )
    for values in (one, other):
        assert np.max(values) == pytest.approx(2.0, rel=1e-3)
        assert values[:240] == pytest.approx(values[240:480], abs=1e-3)
    assert np.max(np.abs(one - other)) > 0.1


def test_steps_are_as_often_and_as_large_as_given_and_level_between():
    size, interval = 3.0, 80.0
    steps = sampled("steps", size, interval)
    jumps = np.diff(steps.co2)
    jumps = jumps[jumps != 0.0]
    # 500 jumps on average: sqrt(500) = 22, and sqrt(1/1000) = 3.2 % of their size; four of these.
    assert len(jumps) == pytest.approx(LONG / interval, abs=90)
    assert np.std(jumps) == pytest.approx(size, rel=0.13)
