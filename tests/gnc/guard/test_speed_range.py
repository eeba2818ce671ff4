"""The range of speeds that follows from the commanded paces contains the vehicle's speed."""

import math

import numpy as np
import pytest

from gnc.guard.guard import SpeedRange

SPEED, BANDWIDTH, TIME_STEP = 19.42, 1.3, 0.05


def speed_range(*, bandwidth=BANDWIDTH, overshoot=0.13):
    return SpeedRange(speed=SPEED, bandwidth=bandwidth, overshoot=overshoot, time_step=TIME_STEP)


@pytest.mark.parametrize("pace", [SPEED, 21.0, 15.0])
def test_a_vehicle_that_flew_v_r_rises_to_the_faster_of_v_r_and_its_pace(pace):
    assert speed_range(overshoot=0.0).fastest(pace) == max(SPEED, pace)
    # It overshoots the rise, or the return from a slower pace, and undershoots a fall, or the
    # return from a faster one.
    assert speed_range().fastest(pace) == pytest.approx(max(SPEED, pace) + 0.13 * abs(pace - SPEED))
    assert speed_range().slowest(pace) == pytest.approx(min(SPEED, pace) - 0.13 * abs(pace - SPEED))


def test_a_slow_pace_adds_the_overshoot_of_the_return_and_is_forgotten():
    speeds = speed_range()
    speeds.note(15.0)
    assert speeds.fastest(15.0) == pytest.approx(SPEED + 0.13 * (SPEED - 15.0))
    surpluses = []
    for _ in range(round(6.0 / TIME_STEP)):
        speeds.note(SPEED)
        surpluses.append(speeds.fastest(SPEED) - SPEED)
    assert np.all(np.diff(surpluses) < 0.0)
    # After 6 s, 3.9 of its time constants of 2/1.3 s.
    assert surpluses[-1] == pytest.approx(0.13 * (SPEED - 15.0) * math.exp(-0.5 * 6.0 * BANDWIDTH))


@pytest.mark.parametrize("damping", [1.0, 0.55])
def test_a_pace_counts_for_as_long_as_the_vehicle_may_be_as_fast_or_slow(damping):
    # A second-order airspeed, commanded up and down at random and to V_r in the end, stays within
    # the range at that time.
    generator = np.random.default_rng(3)
    overshoot = (
        0.0 if damping == 1.0 else math.exp(-math.pi * damping / math.sqrt(1.0 - damping**2))
    )
    pieces, frequency = 10, BANDWIDTH * (2.0 if damping == 1.0 else 1.0)
    for _ in range(40):
        speeds, airspeed, rate, pace = speed_range(overshoot=overshoot), SPEED, 0.0, SPEED
        for step in range(int(generator.integers(40, 300))):
            if step % 17 == 0:
                pace = generator.uniform(15.0, 25.0)
            fastest, slowest = speeds.fastest(pace), speeds.slowest(pace)
            speeds.note(pace)
            airspeed, rate = second_order(airspeed, rate, pace, damping, frequency, pieces)
            assert speeds.highest >= SPEED
        fastest, slowest = max(fastest, airspeed), min(slowest, airspeed)
        for _ in range(200):
            airspeed, rate = second_order(airspeed, rate, SPEED, damping, frequency, pieces)
            assert slowest - 0.02 * 10.0 <= airspeed <= fastest + 0.02 * 10.0


def second_order(value, rate, command, damping, frequency, pieces):
    """Return value and rate after one time step, flown in pieces."""
    for _ in range(pieces):
        rate += (
            TIME_STEP
            / pieces
            * (frequency**2 * (command - value) - 2.0 * damping * frequency * rate)
        )
        value += TIME_STEP / pieces * rate
    return value, rate
