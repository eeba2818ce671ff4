"""Thrust by its specific energy rate: no loss of a sound engine, delays in closed form, and the
rate of false alarms against simulated sums.
"""

import math

import numpy as np
import pytest
from thrust_cases import AIRSPEED, MODEL, PARAMETERS, SPOOL_TIME, accelerations

from gnc.estimation.navigation import EngineReadings
from gnc.estimation.thrust import ThrustMonitor, height_for, time_between_false_alarms

INTERVAL = 0.2


@pytest.mark.parametrize("airspeed", [14.0, 20.0, 27.0])
@pytest.mark.parametrize("lift", [0.3, 1.0, 1.6])
@pytest.mark.parametrize("thrust", [-0.1, 0.0, 0.4])
def test_accelerometers_show_the_thrust_at_any_airspeed_and_lift(airspeed, lift, thrust):
    # By hand: drag and lift along and across a path that is the angle of attack below the axis.
    drag = 2e-4 * airspeed**2 + 8.0 * lift**2 / airspeed**2
    attack = -0.03 + 20.0 * lift / airspeed**2
    along = thrust - drag
    # Forces along and across the path that make the lift ``upward`` in the body's axes.
    across = (lift + along * math.sin(attack)) / math.cos(attack)
    forward = along * math.cos(attack) + across * math.sin(attack)
    upward = across * math.cos(attack) - along * math.sin(attack)
    assert upward == pytest.approx(lift, rel=1e-12)
    assert MODEL.measured_thrust(airspeed, forward, upward) == pytest.approx(thrust, abs=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_a_sound_engine_that_lags_lacks_nothing_whatever_its_throttle_does(seed):
    # A lag of the first order is within a tenth of its end after ln(10) time constants.
    rng, lag = np.random.default_rng(seed), SPOOL_TIME / math.log(10.0)
    monitor, thrust, throttle, left = ThrustMonitor(PARAMETERS, INTERVAL), 0.0, 0.0, 0
    for _ in range(5000):
        if left == 0:
            throttle, left = rng.choice((0.0, 1.0, rng.uniform())), int(rng.integers(1, 40))
        left -= 1
        settled_to = MODEL.settled_thrust(AIRSPEED, throttle)
        thrust += (settled_to - thrust) * -math.expm1(-INTERVAL / lag)
        monitor.update(AIRSPEED, EngineReadings(throttle, *accelerations(thrust)))
        assert not monitor.lost
        # What is left of a tenth is below the half that is allowed for.
        assert monitor.missing == 0.0


def test_false_alarms_come_as_often_as_computed():
    # Sums of normal steps, reflected at 0. Between two of its steps a Brownian motion goes 0.583
    # deviations of one higher than they show (D. Siegmund, "Sequential Analysis", 1985).
    drift, density, height, step = 1.0, 0.5, 0.6, 0.002
    rng = np.random.default_rng(3)
    sums, times = np.zeros(2000), np.zeros(2000)
    running = np.ones(2000, dtype=bool)
    deviation = math.sqrt(density * step)
    while running.any():
        kicks = deviation * rng.standard_normal(running.sum())
        sums[running] = np.maximum(0.0, sums[running] - drift * step + kicks)
        times[running] += step
        running &= sums < height - 2 * 0.583 * deviation
    # The times are nearly exponential, so that their mean is known to 1/sqrt(2000): 2.2 %.
    computed = time_between_false_alarms(drift, density, height)
    assert np.mean(times) == pytest.approx(computed, rel=4 * 0.022)


@pytest.mark.parametrize("hours", [1e-3, 1.0, 1e6])
def test_the_height_for_a_rate_of_false_alarms_has_that_rate(hours):
    time = 3600.0 * hours
    height = height_for(1.2, 0.05, time)
    assert time_between_false_alarms(1.2, 0.05, height) == pytest.approx(time, rel=1e-9)
