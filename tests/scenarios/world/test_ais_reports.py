import numpy as np
import pytest

from scenarios.scenario.sections.equipment import VesselReportsConfig
from scenarios.world.ais.track import received_reports
from scenarios.world.vessel import SteadyVessel

DURATION = 4000.0
VESSEL = SteadyVessel(8.0, 0.0)


def received(*, outages=(), seed=3, duration=DURATION, **changes):
    values = {"interval_s": (2.0, 10.0), "latency_max_s": 2.0, "missing": 0.1} | changes
    return received_reports(
        VesselReportsConfig(**values),
        VESSEL,
        duration=duration,
        outages=outages,
        generator=np.random.default_rng(seed),
    )


def test_reports_come_within_their_interval_each_with_its_delay():
    arrivals = received(missing=0.0)
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
    arrivals = received(interval_s=(0.5, 1.0), latency_max_s=5.0, duration=500.0)
    when = [arrival[0] for arrival in arrivals]
    assert when == sorted(when)
    said = [arrival[1].time for arrival in arrivals]
    assert said != sorted(said)


def test_their_errors_are_as_large_as_they_say():
    arrivals = received(missing=0.0, interval_s=(2.0, 2.0))
    errors = np.array(
        [np.subtract(report[1:], VESSEL.motion(report.time)) for _, report in arrivals]
    )
    # 2,000 of each component: the deviation is known to 1.6 %, the mean to 2.2 % of it; 4 sigma.
    sigmas = np.array([5.0, 5.0, 0.15, 0.15])
    np.testing.assert_allclose(errors.std(axis=0), sigmas, rtol=0.065)
    assert np.abs(errors.mean(axis=0) / sigmas).max() < 0.09
