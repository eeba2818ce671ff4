"""What is still to come of commands that a vehicle has been given."""

import math

import numpy as np
import pytest
from common.physics.turn_tube import CHANGED, FORGOTTEN, LEAST_CHANGE, SLOW_LAG_ERROR
from gnc.safety.given_commands import GivenCommands, commands_under_way
from gnc_cases import HEADING_RATE_MAX
from guard_cases import TIME_STEP, moved


def commands(lag, delay, *, sooner=0.0):
    """Return the commands to a vehicle of that lag and dead time that follows slow commands by so
    much sooner than they say.
    """
    return GivenCommands(
        lag=lag,
        delay=delay,
        slow_lag=lag + delay - sooner,
        time_step=TIME_STEP,
        heading_rate_max=HEADING_RATE_MAX,
    )


def give(given, told, rate):
    for command in told:
        given.since.append(command)
        given.rates.append(rate)


@pytest.mark.parametrize(
    ("lag", "delay"), [(0.0, 0.0), (0.4, 0.0), (0.25, 5.0 * TIME_STEP), (0.4, 2.5 * TIME_STEP)]
)
def test_of_a_vehicle_with_just_that_dead_time_and_lag_nothing_is_to_come(lag, delay):
    generator = np.random.default_rng(1)
    given = commands(lag, delay)
    late, first = commands_under_way(delay, TIME_STEP)
    state, told = (0.0, 0.0, 3.0, 0.2), [0.2] * (late + 1)
    given.still_to_come(state[3])
    for _ in range(60):
        for _ in range(int(generator.integers(1, 30))):
            command = float(generator.uniform(-1.0, 1.0)) * HEADING_RATE_MAX
            give(given, [command], state[3])
            told.append(command)
            # A command may begin to act within a step.
            state = moved(state, told[-1 - late], lag, first)
            if first < TIME_STEP:
                state = moved(state, told[-late], lag, TIME_STEP - first)
        # Sums of thirty numbers below 1, rounded.
        assert given.still_to_come(state[3]) == pytest.approx(0.0, abs=1e-12)


def test_a_vehicle_that_has_not_begun_to_turn_has_all_of_it_to_come():
    # One that flies on straight for n steps: the commanded course, n h u, over the lag, in which it
    # is to be turned.
    given = commands(0.4, 0.0)
    given.still_to_come(0.0)
    give(given, [-0.3] * 4, 0.0)
    assert given.still_to_come(0.0) == pytest.approx(-0.3 * 4 * TIME_STEP / 0.4, rel=1e-12)


def test_commands_under_way_are_not_to_come_twice():
    # With a dead time of two steps the first command has acted for a step after three, and no other
    # has.
    given = commands(0.4, 2.0 * TIME_STEP)
    given.still_to_come(0.0)
    give(given, [0.3, 0.4, 0.5], 0.0)
    assert given.still_to_come(0.0) == pytest.approx(0.3 * TIME_STEP / 0.4, rel=1e-12)
    assert list(given.under_way) == [0.4, 0.5]


def test_a_lack_that_stays_is_forgotten():
    # A vehicle that a steady wrong trim keeps from turning, and commands that end: by exp(-t/(8
    # lag)) of what it lacked.
    given = commands(0.4, 0.0)
    given.still_to_come(0.0)
    give(given, [0.3], 0.0)
    lacking = given.still_to_come(0.0)
    give(given, [0.0] * 100, 0.0)
    assert given.still_to_come(0.0) == pytest.approx(
        lacking * math.exp(-100 * TIME_STEP / (FORGOTTEN * 0.4)), rel=1e-9
    )


def test_of_a_vehicle_that_follows_slow_commands_sooner_nothing_is_to_come_in_a_slow_turn():
    # A command that rises slowly, and a heading rate that is it, 0.3 s ago: dead time and lag say
    # 0.5 s.
    given, rise = commands(0.4, 0.1, sooner=0.2), 0.01
    given.still_to_come(-0.3 * rise)
    for step in range(200):
        give(given, [rise * (step + 0.5) * TIME_STEP], rise * (step * TIME_STEP - 0.3))
    # A ramp's integral over a step of the rates at its beginnings lacks half a step: 0.025 s, of
    # which lag makes 0.0002 rad/s.
    assert given.still_to_come(rise * (200 * TIME_STEP - 0.3)) == pytest.approx(0.0, abs=1e-3)


def test_as_much_as_slow_commands_may_be_followed_sooner_or_later_does_not_count():
    given = commands(0.4, 0.0)
    given.still_to_come(0.2)
    give(given, [0.2, 0.2], 0.2)
    # 0.008 rad are lacking, of which some per cent of the course that is turned in 0.4 s do not
    # count.
    give(given, [0.36], 0.2)
    assert given.still_to_come(0.2) == pytest.approx(
        (0.16 * TIME_STEP - SLOW_LAG_ERROR * 0.4 * 0.2) / 0.4, rel=1e-9
    )
    other = commands(0.4, 0.0)
    other.still_to_come(0.2)
    give(other, [0.2 + 0.9 * SLOW_LAG_ERROR * 0.4 * 0.2 / TIME_STEP], 0.2)
    assert other.still_to_come(0.2) == 0.0


def test_no_more_is_to_come_than_of_a_full_reversal():
    given = commands(0.4, 0.2)
    given.still_to_come(0.0)
    give(given, [HEADING_RATE_MAX] * 100, -HEADING_RATE_MAX)
    doubt = SLOW_LAG_ERROR * 0.6 * HEADING_RATE_MAX
    assert given.still_to_come(-HEADING_RATE_MAX) == pytest.approx(
        (2.0 * HEADING_RATE_MAX * 0.6 - doubt) / 0.4, rel=1e-12
    )


def test_the_largest_change_of_late_counts_less_with_time():
    given = commands(0.4, 0.0)
    assert given.change == LEAST_CHANGE
    given.still_to_come(0.0)
    give(given, [HEADING_RATE_MAX, -0.5 * HEADING_RATE_MAX], 0.0)
    given.still_to_come(0.0)
    # 1.5 of the 2 omega_max of a full reversal.
    assert given.change == pytest.approx(0.75, rel=1e-12)
    give(given, [-0.5 * HEADING_RATE_MAX] * 40, 0.0)
    given.still_to_come(0.0)
    assert given.change == pytest.approx(
        0.75 * math.exp(-40 * TIME_STEP / (CHANGED * 0.4)), rel=1e-12
    )
    give(given, [-0.5 * HEADING_RATE_MAX] * 2000, 0.0)
    given.still_to_come(0.0)
    assert given.change == LEAST_CHANGE
