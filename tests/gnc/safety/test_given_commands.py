"""What is still to come of commands that a vehicle has been given."""

import math

import numpy as np
import pytest
from gnc_cases import HEADING_RATE_MAX
from guard_cases import TIME_STEP, moved

from common.turn_tube import FORGOTTEN
from gnc.safety.given_commands import GivenCommands, commands_under_way


def give(given, commands, rate):
    for command in commands:
        given.since.append(command)
        given.rates.append(rate)


@pytest.mark.parametrize(("lag", "delay"), [(0.0, 0.0), (0.4, 0.0), (0.25, 5.0 * TIME_STEP), (0.4, 2.5 * TIME_STEP)])
def test_of_a_vehicle_with_just_that_dead_time_and_lag_nothing_is_to_come(lag, delay):
    generator = np.random.default_rng(1)
    given = GivenCommands(lag=lag, delay=delay, time_step=TIME_STEP)
    late, first = commands_under_way(delay, TIME_STEP)
    state, commands = (0.0, 0.0, 3.0, 0.2), [0.2] * (late + 1)
    given.still_to_come(state[3])
    for _ in range(60):
        for _ in range(int(generator.integers(1, 30))):
            command = float(generator.uniform(-1.0, 1.0)) * HEADING_RATE_MAX
            give(given, [command], state[3])
            commands.append(command)
            # A command may begin to act within a step.
            state = moved(state, commands[-1 - late], lag, first)
            if first < TIME_STEP:
                state = moved(state, commands[-late], lag, TIME_STEP - first)
        # Sums of thirty numbers below 1, rounded.
        assert given.still_to_come(state[3]) == pytest.approx(0.0, abs=1e-12)


def test_a_vehicle_that_has_not_begun_to_turn_has_all_of_it_to_come():
    # One that flies on straight for n steps: the commanded course, n h u, over the lag, in which it is to be turned.
    given = GivenCommands(lag=0.4, delay=0.0, time_step=TIME_STEP)
    given.still_to_come(0.0)
    give(given, [-0.3] * 4, 0.0)
    assert given.still_to_come(0.0) == pytest.approx(-0.3 * 4 * TIME_STEP / 0.4, rel=1e-12)


def test_commands_under_way_are_not_to_come_twice():
    # With a dead time of two steps the first command has acted for a step after three, and no other has.
    given = GivenCommands(lag=0.4, delay=2.0 * TIME_STEP, time_step=TIME_STEP)
    given.still_to_come(0.0)
    give(given, [0.3, 0.4, 0.5], 0.0)
    assert given.still_to_come(0.0) == pytest.approx(0.3 * TIME_STEP / 0.4, rel=1e-12)
    assert list(given.under_way) == [0.4, 0.5]


def test_a_lack_that_stays_is_forgotten():
    # A vehicle that a steady wrong trim keeps from turning, and commands that end: by exp(-t/(8 lag)) of what it lacked.
    given = GivenCommands(lag=0.4, delay=0.0, time_step=TIME_STEP)
    given.still_to_come(0.0)
    give(given, [0.3], 0.0)
    lacking = given.still_to_come(0.0)
    give(given, [0.0] * 100, 0.0)
    assert given.still_to_come(0.0) == pytest.approx(lacking * math.exp(-100 * TIME_STEP / (FORGOTTEN * 0.4)), rel=1e-9)
