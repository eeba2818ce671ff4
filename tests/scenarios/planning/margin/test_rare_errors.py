"""Errors exceed the k standard deviations that the guard keeps no oftener than is declared, counted
in simulated errors.
"""

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from scenarios.planning.margin.keepout_margin import vessel_limits
from scenarios.scenario.files import load_study, with_values
from scenarios.vehicles.sensors import NAVIGATION_TIME

pytestmark = pytest.mark.slow

TOUCHES = 0.5
"""Declared [1/h]: often enough to be counted."""


def deviations(touches=TOUCHES, **values):
    """Return k of flights of a day, so long that it hardly matters how each begins."""
    values = {"following.touches_per_hour": touches, "flight.duration_max_s": 86_400.0} | values
    return vessel_limits(with_values(load_study("sea_wind"), values), 9.0).deviations


@pytest.mark.parametrize(
    ("values", "per_hour", "wandering"),
    [
        ({"reports.interval_s": [2.0, 10.0]}, 600.0, 0.0),
        ({"reports.interval_s": [2.0, 10.0], "sensors.position_sigma_m": 1.5}, 600.0, 60.0),
        # However rare reports are, a flight begins with one: here one every 240 s in flights of 200
        # s.
        ({"reports.interval_s": [180.0, 300.0], "flight.duration_max_s": 200.0}, 15.0 + 18.0, 0.0),
    ],
)
def test_k_is_as_rare_as_the_area_may_be_touched(values, per_hour, wandering):
    k = deviations(1e-3, **({"flight.duration_max_s": 1e5} | values))
    expected = math.exp(-0.5 * k * k) * (
        per_hour * (1.0 + math.sqrt(math.pi / 8.0) * k) + wandering * k * k
    )
    # A flight of 1e5 s begins 0.036 times an hour.
    assert expected == pytest.approx(1e-3, rel=2e-4)


def test_the_wandering_error_of_the_own_place_comes_to_exceed_it_no_oftener():
    generator, time_step, hours = np.random.default_rng(20261126), 0.25, 400.0
    kept = math.exp(-time_step / NAVIGATION_TIME)
    kicks = math.sqrt(1.0 - kept**2) * generator.standard_normal(
        (2, round(hours * 3600.0 / time_step))
    )
    beyond = np.hypot(*lfilter([1.0], [1.0, -kept], kicks)) > deviations(
        **{"sensors.position_sigma_m": 1.5}
    )
    begins = time_step * np.flatnonzero(beyond[1:] & ~beyond[:-1])
    # It crosses a level many times when it comes there: what begins within a time constant is one
    # event.
    events = 1 + np.count_nonzero(np.diff(begins) > NAVIGATION_TIME)
    # Some 150 are counted, to 8 %. The rate that k follows from is that of large k, too high for
    # such a small one.
    assert 0.5 * TOUCHES < events / hours < TOUCHES


def test_errors_of_reports_exceed_it_at_some_age_no_oftener():
    k = deviations(**{"reports.interval_s": [6.0, 6.0]})
    place, velocity = np.random.default_rng(20261126).standard_normal((2, 2, 3_000_000))
    # As a report ages, its error goes from place to velocity: place cos(angle) + velocity
    # sin(angle), over a quarter of a circle.
    squares, both = (
        (np.sum(place**2, axis=0), np.sum(velocity**2, axis=0)),
        np.sum(place * velocity, axis=0),
    )
    within = 0.5 * (squares[0] + squares[1]) + np.hypot(0.5 * (squares[0] - squares[1]), both)
    largest = np.where(both > 0.0, within, np.maximum(*squares))
    per_hour = 600.0 * float(np.mean(largest > k * k))
    # Some 2,500 are counted, to 2 %.
    assert per_hour == pytest.approx(TOUCHES, rel=0.1)
