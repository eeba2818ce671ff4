"""The tables of the autopilot: their signs and symmetry, and the bank for a turn."""

import math
from dataclasses import replace

import numpy as np
import pytest

from aircraft.envelope import TABLE_REACH
from aircraft.fleet.x8 import X8
from aircraft.spec import AircraftError
from common.physics import STANDARD_GRAVITY
from innerloop.designer import linear_grid
from innerloop.schedule import LEVEL


def even_and_odd(table):
    """Even and odd part over bank, relative to level flight."""
    change = table - table[LEVEL]
    return 0.5 * (change + change[::-1]), 0.5 * (change - change[::-1])


def test_the_tables_reach_past_the_largest_commanded_bank_and_gains_are_those_of_equilibria(
    x8_schedule,
):
    # The X8's guidance banks by 45 degrees, its autopilot by 5 more, and a tenth more than that is
    # in the tables.
    assert math.degrees(x8_schedule.banks[-1]) == pytest.approx(TABLE_REACH * 50.0)
    assert set(x8_schedule.gain_banks) < set(x8_schedule.banks)
    for i, row in enumerate(x8_schedule.trims):
        # Level: 0.3 mrad against the propeller's torque.
        assert [t.roll for t in row] == pytest.approx(x8_schedule.banks, abs=1e-3)
        for j in range(len(x8_schedule.gains[i])):
            at = x8_schedule.gain_trim(i, j)
            assert at.airspeed == x8_schedule.airspeeds[i]
            assert at.roll == pytest.approx(x8_schedule.gain_banks[j], abs=1e-3)


@pytest.mark.parametrize("quantity", ["elevator", "throttle", "pitch", "q"])
def test_what_a_turn_asks_for_in_the_plane_of_symmetry_is_nearly_even_over_bank(
    x8_schedule, quantity
):
    even, odd = even_and_odd(x8_schedule.over_bank(quantity))
    # Odd is what the propeller does: its torque, and its gyroscopic moment H r of 0.1 N m at most
    # against 8 N m a unit of elevator. A fifth of the even part in the elevator and in pitch.
    assert np.abs(odd).max() < 0.25 * np.abs(even).max()


@pytest.mark.parametrize(
    ("quantity", "share"), [("r", 0.05), ("yaw_rate", 0.05), ("p", 0.15), ("aileron", 0.6)]
)
def test_what_a_turn_asks_for_across_it_is_nearly_odd_over_bank(x8_schedule, quantity, share):
    even, odd = even_and_odd(x8_schedule.over_bank(quantity))
    # Even is what the propeller does: its gyroscopic moment H q of 0.15 N m makes sideslip to the
    # same side in either turn, and without rudder the aileron answers the rolling moment of that:
    # half of the little aileron that a slow steep turn needs.
    assert np.abs(even).max() < share * np.abs(odd).max()


@pytest.mark.parametrize("index", range(5))
def test_the_bank_for_a_turn_is_that_of_the_equilibrium_with_this_yaw_rate(x8_schedule, index):
    airspeed = x8_schedule.airspeeds[index]
    turns = np.array([airspeed * t.yaw_rate / STANDARD_GRAVITY for t in x8_schedule.trims[index]])
    banks = x8_schedule.bank_for_turn(turns)[:, index]
    # At the nodes: rounding.
    np.testing.assert_allclose(banks, [t.roll for t in x8_schedule.trims[index]], atol=1e-12)


def test_a_design_condition_that_cannot_be_flown_is_refused():
    too_slow = replace(X8, envelope=replace(X8.envelope, airspeed_min=5.0))
    with pytest.raises(AircraftError, match="5 m/s"):
        linear_grid(too_slow, 100.0)
