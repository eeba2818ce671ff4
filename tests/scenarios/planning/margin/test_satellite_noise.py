"""How much nearer noise of satellite navigation takes a vehicle: against a vehicle that is steered
by it, and in flight.
"""

import math

import numpy as np
import pytest

from gnc.reference.reference import CirclingReference
from gnc.tracker import Tracker
from scenarios.planning.guidance import speed_hold, tracking_parameters
from scenarios.planning.margin.keepout_margin import (
    GUARDED_PER_HOUR,
    noise_allowance,
    position_scatter,
)
from scenarios.scenario.files import load_study, with_values
from scenarios.vehicles.sensors import NAVIGATION_TIME
from scenarios.vehicles.vehicle_setup import KINEMATIC_BANDWIDTH, kinematic_setup

pytestmark = pytest.mark.slow

KINEMATIC = {"fidelity": "kinematic", "kinematic.heading_rate_lag_s": 0.4}
MINUTES = 40.0


def given(**values):
    """Return a scenario of a kinematic vehicle, and what flights need of it."""
    scenario = with_values(load_study("sea_wind"), KINEMATIC | values)
    return scenario, kinematic_setup(scenario)


def seen_errors(tracking, hold, turn, speed, lag):
    """Return errors along and right that a vehicle sees whose position has noise of 1 m, on a
    circle, over time [m].
    """
    step, noise, course, rate, faster = tracking.time_step, np.zeros(2), 0.0, turn, 0.0
    tracker = Tracker(
        tracking,
        CirclingReference(
            speed=speed,
            heading_rate=turn,
            time_step=step,
        ),
    )
    north, east, found = 0.0, 0.0, []
    kept, answered, sped = (
        math.exp(-step * of) for of in (1.0 / NAVIGATION_TIME, 1.0 / lag, KINEMATIC_BANDWIDTH)
    )
    generator = np.random.default_rng(1)
    kicks = math.sqrt(1.0 - kept**2) * generator.standard_normal((round(60.0 * MINUTES / step), 2))
    for kick in kicks.tolist():
        noise = kept * noise + kick
        at_north, at_east = north + float(noise[0]), east + float(noise[1])
        cos, sin = math.cos(tracker.reference.course), math.sin(tracker.reference.course)
        off_north, off_east = tracker.reference.north - at_north, tracker.reference.east - at_east
        found.append((off_north * cos + off_east * sin, off_east * cos - off_north * sin))
        command = tracker.step(
            at_north, at_east, math.remainder(course, 2.0 * math.pi), speed + faster, rate
        )
        then = answered * rate + (1.0 - answered) * command
        middle = course + 0.25 * (rate + then) * step
        north += (speed + faster) * math.cos(middle) * step
        east += (speed + faster) * math.sin(middle) * step
        course += 0.5 * (rate + then) * step
        rate, faster = then, faster + (1.0 - sped) * (hold.gain * found[-1][0] - faster)
    return np.array(found[round(60.0 / step) :])


@pytest.mark.parametrize("turn", [1e-6, 0.3])
def test_the_error_that_a_vehicle_sees_scatters_as_predicted(turn):
    scenario, setup = given()
    tracking, hold, speed = (
        tracking_parameters(scenario, setup),
        speed_hold(scenario, setup),
        scenario.guidance.airspeed_mps,
    )
    predicted = position_scatter(
        tracking,
        hold,
        [turn],
        speed=speed,
        lag=setup.lag,
        airspeed_bandwidth=KINEMATIC_BANDWIDTH,
        noise_time=NAVIGATION_TIME,
    )
    found = seen_errors(tracking, hold, turn, speed, setup.lag)
    # 40 minutes are some 500 time constants of the loop, 4 to 5 s: one deviation of the deviation
    # is 3 %.
    assert math.sqrt(np.linalg.eigvalsh(np.cov(found.T)).max()) == pytest.approx(predicted, rel=0.1)
    assert 0.2 < predicted < 0.4


def test_the_allowance_is_exceeded_no_oftener_than_allowed():
    # The probability that a normal error exceeds it, times the steps of an hour at 20 Hz.
    deviations = noise_allowance(0.3, 0.4, time_step=0.05) / 0.5
    assert 72_000.0 * 0.5 * math.erfc(deviations / math.sqrt(2.0)) < GUARDED_PER_HOUR
