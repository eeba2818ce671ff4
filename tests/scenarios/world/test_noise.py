"""Random numbers of a world: noise, the CO2 beside the exhaust, and reports as they are received."""

import math

import numpy as np
import pytest
from scipy.stats import kstest

from scenarios.scenario.sections.equipment import VesselReportsConfig
from scenarios.scenario.sections.world import AirConfig
from scenarios.world.ais.track import received_reports
from scenarios.world.noise import Noise, start_generator, streams
from scenarios.world.plume import sampled_background
from scenarios.world.vessel import SteadyVessel

STEP = 0.01
KEPT = math.sqrt(1.0 - STEP**2)


def normals(noise):
    return streams(noise).sensors.standard_normal(2000)


def test_from_one_seed_the_numbers_are_those_of_its_two_spawned_streams_one_after_the_other():
    first, second = (np.random.default_rng(s) for s in np.random.SeedSequence(9).spawn(2))
    found = streams(Noise(9))
    assert found.world.random() == first.random()
    assert (found.reports.random(), found.sensors.random()) == (second.random(), second.random())
    assert start_generator(Noise(9)).random() == np.random.default_rng(9).random()


def test_blended_numbers_are_distributed_as_those_of_one_seed():
    noise = Noise(1, ((2, 0.6), (3, 0.8)))
    # With fixed seeds a test at 1 % passes always or never; 0.6^2 + 0.8^2 = 1.
    assert kstest(normals(noise), "norm").pvalue > 0.01
    uniform = streams(noise).reports.uniform(2.0, 10.0, 2000)
    assert kstest(uniform, "uniform", args=(2.0, 8.0)).pvalue > 0.01
    normal = streams(noise).world.normal(5.0, 2.0, 2000)
    assert kstest(normal, "norm", args=(5.0, 2.0)).pvalue > 0.01


def test_a_small_step_of_the_blend_changes_every_number_by_little_and_a_new_seed_none_of_them():
    before = Noise(1, ((2, 1.0),))
    after = Noise(1, ((2, KEPT), (7, STEP)))
    # Differences have the standard deviation STEP to 1e-4 of it; that of 2,000 is good to 1.6 %,
    # and four times that is allowed.
    assert np.std(normals(after) - normals(before)) == pytest.approx(STEP, rel=0.07)
    assert np.array_equal(normals(Noise(99, before.blend)), normals(before))


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


VESSEL = SteadyVessel(8.0, 0.0)


def received(*, duration=4000.0, **changes):
    values = {"interval_s": (2.0, 10.0), "latency_max_s": 2.0, "missing": 0.0} | changes
    how = {"duration": duration, "outages": (), "generator": np.random.default_rng(3)}
    return received_reports(VesselReportsConfig(**values), VESSEL, **how)


def test_reports_come_within_their_interval_each_with_its_delay():
    arrivals = received()
    times = np.sort([report.time for _, report in arrivals])
    gaps = np.diff(times)
    assert gaps.min() >= 2.0
    assert gaps.max() <= 10.0
    # Even between 2 and 10 s: mean 6 s; of 667 gaps with a deviation of 8/sqrt(12) s, 4 sigma is
    # 0.36 s.
    assert gaps.mean() == pytest.approx(6.0, abs=0.36)
    late = np.array([when - report.time for when, report in arrivals])
    assert late.min() >= 0.0
    assert late.max() <= 2.0
    # 4 sigma of the mean of 667, each even over 2 s.
    assert late.mean() == pytest.approx(1.0, abs=0.09)


def test_reports_are_handed_on_in_the_order_in_which_they_are_received():
    # Shorter intervals than delays: some overtake others.
    arrivals = received(interval_s=(0.5, 1.0), latency_max_s=5.0, missing=0.1, duration=500.0)
    when = [arrival[0] for arrival in arrivals]
    assert when == sorted(when)
    said = [arrival[1].time for arrival in arrivals]
    assert said != sorted(said)


def test_their_errors_are_as_large_as_they_say():
    arrivals = received(interval_s=(2.0, 2.0))
    errors = [np.subtract(report[1:], VESSEL.motion(report.time)) for _, report in arrivals]
    # 2,000 of each component: the deviation is known to 1.6 %, the mean to 2.2 % of it; 4 sigma.
    sigmas = np.array([5.0, 5.0, 0.15, 0.15])
    np.testing.assert_allclose(np.std(errors, axis=0), sigmas, rtol=0.065)
    assert np.abs(np.mean(errors, axis=0) / sigmas).max() < 0.09
