"""A vehicle's speed stays within what is reckoned with, whatever pace it was commanded."""

import math

import numpy as np
import pytest
from gnc.safety.speed_reckoning import SpeedReckoning

SPEED, BANDWIDTH, TIME_STEP = 19.42, 1.3, 0.05


def made(**changes):
    return SpeedReckoning(
        **(
            {"speed": SPEED, "bandwidth": BANDWIDTH, "overshoot": 0.13, "time_step": TIME_STEP}
            | changes
        )
    )


@pytest.mark.parametrize("pace", [SPEED, 21.0, 15.0])
def test_a_vehicle_that_flew_v_r_is_reckoned_with_at_the_faster_of_that_and_its_pace(pace):
    assert made(overshoot=0.0).fastest(pace) == max(SPEED, pace)
    # And it overshoots the rise, or the return from a slower pace; as it undershoots a fall, or the
    # return from a faster one.
    assert made().fastest(pace) == pytest.approx(max(SPEED, pace) + 0.13 * abs(pace - SPEED))
    assert made().slowest(pace) == pytest.approx(min(SPEED, pace) - 0.13 * abs(pace - SPEED))


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


def test_a_fall_from_a_fast_pace_is_none_that_a_vehicle_could_rise_beyond():
    reckoning = made()
    for pace in [25.0] * 400:
        reckoning.note(pace)
    assert reckoning.fastest(25.0) == pytest.approx(25.0, abs=1e-3)
    assert reckoning.fastest(SPEED) == reckoning.fastest(25.0)
    reckoning.note(SPEED)
    assert reckoning.fastest(SPEED) < 25.0
    assert reckoning.slowest(SPEED) == pytest.approx(SPEED - 0.13 * (25.0 - SPEED), rel=1e-2)


@pytest.mark.parametrize("damping", [1.0, 0.55])
def test_a_pace_is_reckoned_with_for_as_long_as_the_vehicle_may_be_as_fast_or_slow(damping):
    # A second-order airspeed, commanded up and down at random and to V_r in the end, stays within
    # what was reckoned with then.
    generator = np.random.default_rng(3)
    overshoot = (
        0.0 if damping == 1.0 else math.exp(-math.pi * damping / math.sqrt(1.0 - damping**2))
    )
    pieces, frequency = 10, BANDWIDTH * (2.0 if damping == 1.0 else 1.0)
    for _ in range(40):
        reckoning, airspeed, rate, pace = made(overshoot=overshoot), SPEED, 0.0, SPEED
        for step in range(int(generator.integers(40, 300))):
            if step % 17 == 0:
                pace = generator.uniform(15.0, 25.0)
            fastest, slowest = reckoning.fastest(pace), reckoning.slowest(pace)
            reckoning.note(pace)
            airspeed, rate = second_order(airspeed, rate, pace, damping, frequency, pieces)
            assert reckoning.highest >= SPEED
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
