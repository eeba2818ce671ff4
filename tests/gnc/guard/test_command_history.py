"""What the guard remembers of commands: the course that is still to come of them, how much they
changed, and the speeds that follow from paces.
"""

import math

import numpy as np
import pytest
from gnc_cases import HEADING_RATE_MAX, SPEED
from guard_cases import TIME_STEP, moved

from gnc.guard.guard import CommandHistory, SpeedRange
from gnc.guard.turn import (
    CHANGE_DECAY,
    LEAST_CHANGE,
    PENDING_DECAY,
    SLOW_LAG_ERROR,
    commands_under_way,
)


def begun(lag, delay, *, rate=0.0, sooner=0.0):
    """Return the history of a vehicle at a heading rate [rad/s] that follows slow commands by a time
    [s] sooner than lag and dead time say.
    """
    history = CommandHistory(
        lag=lag,
        delay=delay,
        slow_lag=lag + delay - sooner,
        time_step=TIME_STEP,
        heading_rate_max=HEADING_RATE_MAX,
    )
    history.take_in(rate)
    return history


def append(history, commands, rate):
    for command in commands:
        history.append(command, rate)


@pytest.mark.parametrize(
    ("lag", "delay"), [(0.0, 0.0), (0.4, 0.0), (0.25, 5.0 * TIME_STEP), (0.4, 2.5 * TIME_STEP)]
)
def test_a_vehicle_with_just_that_dead_time_and_lag_lacks_no_course(lag, delay):
    generator = np.random.default_rng(1)
    history = begun(lag, delay, rate=0.2)
    count, first = commands_under_way(delay, TIME_STEP)
    state, commands = (0.0, 0.0, 3.0, 0.2), [0.2] * (count + 1)
    for _ in range(60):
        for _ in range(int(generator.integers(1, 30))):
            command = float(generator.uniform(-1.0, 1.0)) * HEADING_RATE_MAX
            history.append(command, state[3])
            commands.append(command)
            # A command may begin to act within a step.
            state = moved(state, commands[-1 - count], lag, first)
            if first < TIME_STEP:
                state = moved(state, commands[-count], lag, TIME_STEP - first)
        # Sums of thirty numbers below 1, rounded.
        assert history.take_in(state[3]) == pytest.approx(0.0, abs=1e-12)


def test_a_constant_lack_is_forgotten():
    # A steady wrong trim keeps the vehicle from turning, and the commands end: exp(-t/(64 lag)).
    history = begun(0.4, 0.0)
    append(history, [0.3], 0.0)
    pending = history.take_in(0.0)
    append(history, [0.0] * 100, 0.0)
    assert history.take_in(0.0) == pytest.approx(
        pending * math.exp(-100 * TIME_STEP / (PENDING_DECAY * 0.4)), rel=1e-9
    )


def test_a_vehicle_that_follows_slow_commands_sooner_lacks_no_course_in_a_slow_turn():
    # A command that rises slowly, and a heading rate that follows it by 0.3 s: dead time and lag
    # say 0.5 s.
    rise = 0.01
    history = begun(0.4, 0.1, rate=-0.3 * rise, sooner=0.2)
    for step in range(200):
        history.append(rise * (step + 0.5) * TIME_STEP, rise * (step * TIME_STEP - 0.3))
    # A ramp's integral from the rates at the beginnings of steps is off by half a step: 0.025 s,
    # which the lag turns into 0.0002 rad/s.
    pending = history.take_in(rise * (200 * TIME_STEP - 0.3))
    assert pending == pytest.approx(0.0, abs=1e-3)


def test_a_lack_within_the_error_of_the_slow_lag_does_not_count():
    doubt = SLOW_LAG_ERROR * 0.4 * 0.2
    history = begun(0.4, 0.0, rate=0.2)
    append(history, [0.2, 0.2, 0.36], 0.2)
    # 0.008 rad are lacking, less what slow commands may be followed sooner or later.
    assert history.take_in(0.2) == pytest.approx((0.16 * TIME_STEP - doubt) / 0.4, rel=1e-9)
    history = begun(0.4, 0.0, rate=0.2)
    append(history, [0.2 + 0.9 * doubt / TIME_STEP], 0.2)
    assert history.take_in(0.2) == 0.0


def test_the_lack_is_at_most_that_of_a_full_reversal():
    history = begun(0.4, 0.2)
    append(history, [HEADING_RATE_MAX] * 100, -HEADING_RATE_MAX)
    doubt = SLOW_LAG_ERROR * 0.6 * HEADING_RATE_MAX
    assert history.take_in(-HEADING_RATE_MAX) == pytest.approx(
        (2.0 * HEADING_RATE_MAX * 0.6 - doubt) / 0.4, rel=1e-12
    )


def test_the_largest_recent_change_counts_less_with_time():
    history = begun(0.4, 0.0)
    assert history.change == LEAST_CHANGE
    append(history, [HEADING_RATE_MAX, -0.5 * HEADING_RATE_MAX], 0.0)
    history.take_in(0.0)
    # 1.5 of the 2 omega_max of a full reversal.
    assert history.change == pytest.approx(0.75, rel=1e-12)
    # With a command that changes by less the former change counts, with a larger one that.
    assert history.change_with(0.5 * HEADING_RATE_MAX) == history.change
    assert history.change_with(1.5 * HEADING_RATE_MAX) == pytest.approx(1.0, rel=1e-12)
    append(history, [-0.5 * HEADING_RATE_MAX] * 40, 0.0)
    history.take_in(0.0)
    # The first of the commands is within the lag of the last one, 8 steps, for 6 steps more.
    faded = 0.75 * math.exp(-(40 - 6) * TIME_STEP / (CHANGE_DECAY * 0.4))
    assert history.change == pytest.approx(faded, rel=1e-12)
    append(history, [-0.5 * HEADING_RATE_MAX] * 2000, 0.0)
    history.take_in(0.0)
    assert history.change == LEAST_CHANGE


def test_a_slow_change_of_commands_is_none_however_rarely_the_guard_looks():
    # From one side to the other in 10 s: in a lag of 0.4 s 3.5 % of it, less than counts at all.
    commands = [HEADING_RATE_MAX * (1.0 - 0.01 * step) for step in range(200)]
    history = begun(0.4, 0.0, rate=HEADING_RATE_MAX)
    append(history, commands, 0.0)
    history.take_in(0.0)
    assert history.change == LEAST_CHANGE


BANDWIDTH = 1.3


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
