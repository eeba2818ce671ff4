"""What is still to come of commands that a vehicle has been given."""

import math

import numpy as np
import pytest
from gnc_cases import HEADING_RATE_MAX
from guard_cases import LAGS, TIME_STEP, moved

from common.turn_tube import FORGOTTEN
from gnc.estimation.own_motion import KnownMotion
from gnc.numeric import wrap
from gnc.safety.given_commands import GivenCommands


def told(given, state):
    return given.still_to_come(KnownMotion(ground_north=0.0, ground_east=0.0, course=wrap(state[2]), heading_rate=state[3]))


@LAGS
def test_of_a_vehicle_with_just_that_dead_time_and_lag_nothing_is_to_come(lag, delay):
    generator = np.random.default_rng(1)
    given = GivenCommands(lag=lag, delay=delay, time_step=TIME_STEP)
    state, late = (0.0, 0.0, 3.0, 0.2), round(delay / TIME_STEP)
    commands = [0.2] * late
    told(given, state)
    for _ in range(60):
        # Looked at now and then; between two looks it turns by less than half a turn.
        for _ in range(int(generator.integers(1, 30))):
            command = float(generator.uniform(-1.0, 1.0)) * HEADING_RATE_MAX
            given.since.append(command)
            commands.append(command)
            state = moved(state, commands[-1 - late], lag, TIME_STEP)
        # Sums of thirty numbers below 1, rounded.
        assert told(given, state) == pytest.approx(0.0, abs=1e-12)


def test_a_vehicle_that_has_not_begun_to_turn_has_all_of_it_to_come():
    # One that flies on straight for n steps: the commanded course, n h u, over the lag, in which it is to be turned.
    given = GivenCommands(lag=0.4, delay=0.0, time_step=TIME_STEP)
    state = (0.0, 0.0, 1.0, 0.0)
    told(given, state)
    given.since += [-0.3] * 4
    assert told(given, state) == pytest.approx(-0.3 * 4 * TIME_STEP / 0.4, rel=1e-12)


def test_commands_under_way_are_not_to_come_twice():
    # With a dead time of 2.5 steps the first command has acted for half a step after three, and no other has.
    given = GivenCommands(lag=0.4, delay=2.5 * TIME_STEP, time_step=TIME_STEP)
    state = (0.0, 0.0, 1.0, 0.0)
    told(given, state)
    given.since += [0.3, 0.4, 0.5]
    assert told(given, state) == pytest.approx(0.3 * 0.5 * TIME_STEP / 0.4, rel=1e-12)
    assert list(given.under_way) == [0.3, 0.4, 0.5]


def test_a_lack_that_stays_is_forgotten():
    # A vehicle that a steady wrong trim keeps from turning, and commands that end: by exp(-t/(8 lag)) of what it lacked.
    given = GivenCommands(lag=0.4, delay=0.0, time_step=TIME_STEP)
    state = (0.0, 0.0, 1.0, 0.0)
    told(given, state)
    given.since.append(0.3)
    lacking = told(given, state)
    given.since += [0.0] * 100
    assert told(given, state) == pytest.approx(lacking * math.exp(-100 * TIME_STEP / (FORGOTTEN * 0.4)), rel=1e-9)
