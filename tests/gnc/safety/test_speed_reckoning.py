"""A vehicle's speed never exceeds what is reckoned with, whatever pace it was commanded."""

import math

import numpy as np
import pytest

from gnc.safety.speed_reckoning import SpeedReckoning

SPEED, BANDWIDTH, TIME_STEP = 19.42, 1.3, 0.05


def made(**changes):
    return SpeedReckoning(**({"speed": SPEED, "bandwidth": BANDWIDTH, "overshoot": 0.13, "time_step": TIME_STEP} | changes))


@pytest.mark.parametrize("pace", [SPEED, 21.0, 15.0])
def test_a_vehicle_that_flew_v_r_is_reckoned_with_at_the_faster_of_that_and_its_pace(pace):
    assert made(overshoot=0.0).fastest(pace) == max(SPEED, pace)
    # And it overshoots the rise, or the return from a slower pace.
    assert made().fastest(pace) == pytest.approx(max(SPEED, pace) + 0.13 * abs(pace - SPEED))


def test_a_slow_pace_adds_the_overshoot_of_the_return_and_is_forgotten():
    reckoning = made()
    reckoning.note(15.0)
    assert reckoning.fastest(15.0) == pytest.approx(SPEED + 0.13 * (SPEED - 15.0))
    surpluses = []
    for _ in range(round(6.0 / TIME_STEP)):
        reckoning.note(SPEED)
        surpluses.append(reckoning.fastest(SPEED) - SPEED)
    assert np.all(np.diff(surpluses) < 0.0)
    # After 6 s, 3.9 of its time constants of 2/1.3 s.
    assert surpluses[-1] == pytest.approx(0.13 * (SPEED - 15.0) * math.exp(-0.5 * 6.0 * BANDWIDTH))


def test_a_fast_pace_is_reckoned_with_for_as_long_as_the_vehicle_may_be_as_fast():
    # A first-order airspeed that was commanded up and down at random never becomes faster than was reckoned at any time before.
    generator = np.random.default_rng(3)
    reckoning, airspeed, pace = made(overshoot=0.0), SPEED, SPEED
    for step in range(4000):
        if step % 17 == 0:
            pace = generator.uniform(15.0, 25.0)
        fastest = reckoning.fastest(pace)
        reckoning.note(pace)
        airspeed = pace + (airspeed - pace) * math.exp(-BANDWIDTH * TIME_STEP)
        assert airspeed <= fastest + 1e-9
        assert reckoning.highest >= SPEED


def test_a_vehicle_that_answers_at_once_has_nothing_to_be_reckoned_with_but_its_pace():
    reckoning = made(bandwidth=math.inf)
    for pace in (25.0, 15.0, 20.0):
        reckoning.note(pace)
        assert (reckoning.highest, reckoning.lowest) == (max(pace, SPEED), pace)


def test_what_is_flown_in_place_of_a_pace_counts_as_well():
    reckoning = made()
    reckoning.include(24.0)
    reckoning.include(17.0)
    assert (reckoning.highest, reckoning.lowest) == (24.0, 17.0)
