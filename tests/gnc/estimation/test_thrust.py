"""Thrust by its specific energy rate: no loss of a sound engine, delays in closed form, and the
rate of false alarms against simulated sums.
"""

import math

import numpy as np
import pytest
from thrust_cases import AIRSPEED, LEVEL, MODEL, PARAMETERS, SPOOL_TIME, accelerations

from gnc.estimation.navigation import EngineReadings
from gnc.estimation.thrust import (
    ThrustMonitor,
    height_for,
    time_between_false_alarms,
)

INTERVAL = 0.2


def updates_until(monitor, *, lost, throttle, thrust, airspeed=AIRSPEED, limit=1000):
    """Return the time [s] until thrust counts as lost or there, at a constant thrust."""
    for update in range(1, limit):
        monitor.update(airspeed, EngineReadings(throttle, *accelerations(thrust, airspeed)))
        if monitor.lost is lost:
            return update * INTERVAL
    return math.inf


def settled(throttle):
    """Return a monitor that has seen a sound engine at a throttle for longer than it spools."""
    monitor = ThrustMonitor(PARAMETERS, INTERVAL)
    for _ in range(100):
        thrust = MODEL.settled_thrust(AIRSPEED, throttle)
        monitor.update(AIRSPEED, EngineReadings(throttle, *accelerations(thrust)))
    assert not monitor.lost
    return monitor


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


def test_all_thrust_of_level_flight_is_missed_after_the_time_that_its_energy_takes():
    throttle = LEVEL / 0.4
    # Half of it is allowed for, the other half is summed up: 20 m/s 0.06 is 1.2 m a second.
    rate = AIRSPEED * 0.5 * LEVEL
    expected = PARAMETERS.energy_height / rate
    found = updates_until(settled(throttle), lost=True, throttle=throttle, thrust=0.0)
    assert expected < found <= expected + INTERVAL + 1e-9


@pytest.mark.parametrize("airspeed", [AIRSPEED, 16.0])
def test_more_than_half_of_the_thrust_of_level_flight_is_no_loss_and_less_is(airspeed):
    for share, lost in ((0.51, False), (0.45, True)):
        throttle = LEVEL / MODEL.settled_thrust(airspeed, 1.0)
        found = updates_until(
            settled(throttle), lost=True, throttle=throttle, thrust=share * LEVEL, airspeed=airspeed
        )
        assert (found < math.inf) == lost


def test_thrust_that_is_there_again_is_seen_after_the_time_that_its_energy_takes():
    throttle = LEVEL / 0.4
    monitor = settled(throttle)
    updates_until(monitor, lost=True, throttle=throttle, thrust=0.0)
    assert updates_until(monitor, lost=False, throttle=throttle, thrust=0.0) == math.inf
    found = updates_until(monitor, lost=False, throttle=throttle, thrust=LEVEL)
    expected = PARAMETERS.energy_height / (AIRSPEED * 0.5 * LEVEL)
    assert expected < found <= expected + INTERVAL + 1e-9


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
