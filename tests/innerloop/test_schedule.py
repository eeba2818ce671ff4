"""The tables of the autopilot: their signs and symmetry, and the bank for a turn."""

import math
from dataclasses import replace

import numpy as np
import pytest

from aircraft.envelope import TABLE_REACH
from aircraft.fdm import Fdm
from aircraft.fleet.x8 import X8
from aircraft.spec import AircraftError
from aircraft.trim import trim
from common.physics import STANDARD_GRAVITY
from innerloop.designer import Grid, linear_grid, schedule_at
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.responses import flown_step
from innerloop.jsbsim.system import write_root
from innerloop.schedule import GAIN_BANKS, LEVEL, TRIM_BANKS


def even_and_odd(table):
    """Even and odd part over bank, relative to level flight."""
    change = table - table[LEVEL]
    return 0.5 * (change + change[::-1]), 0.5 * (change - change[::-1])


@pytest.mark.parametrize("shares", [TRIM_BANKS, GAIN_BANKS])
def test_banks_are_symmetric_about_level(shares):
    assert [-b for b in reversed(shares)] == list(shares)


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


def test_level_is_the_straight_equilibrium_of_each_airspeed(x8_schedule):
    for index, airspeed in enumerate(X8.envelope.design_airspeeds):
        found = x8_schedule.level(index)
        assert (found.airspeed, found.yaw_rate, found.altitude) == (
            airspeed,
            0.0,
            x8_schedule.altitude,
        )


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


def test_a_turn_asks_for_more_lift_and_more_power(x8_schedule):
    banks = np.abs(TRIM_BANKS)
    order = np.argsort(banks[: LEVEL + 1])
    for side in (slice(None, LEVEL + 1), slice(None, LEVEL - 1 if LEVEL else None, -1)):
        elevator, throttle, pitch_rate = (
            x8_schedule.over_bank(name)[side][order] for name in ("elevator", "throttle", "q")
        )
        assert (np.diff(elevator, axis=0) < 0.0).all()  # trailing edge up pitches up
        assert (np.diff(throttle, axis=0) > 0.0).all()
        assert (np.diff(pitch_rate, axis=0) > 0.0).all()  # nose up in a turn to either side


def test_a_turn_goes_where_the_aircraft_banks(x8_schedule):
    yaw_rates = x8_schedule.over_bank("yaw_rate")
    assert (np.sign(yaw_rates) == np.sign(TRIM_BANKS)[:, None]).all()
    assert (np.diff(yaw_rates, axis=0) > 0.0).all()


def test_faster_flight_needs_less_angle_of_attack_and_more_throttle(x8_schedule):
    assert (np.diff(x8_schedule.over_bank("pitch")[LEVEL]) < 0.0).all()
    assert (np.diff(x8_schedule.over_bank("throttle")[LEVEL]) > 0.0).all()


@pytest.mark.parametrize("index", range(5))
def test_the_bank_for_a_turn_is_that_of_the_equilibrium_with_this_yaw_rate(x8_schedule, index):
    airspeed = x8_schedule.airspeeds[index]
    turns = np.array([airspeed * t.yaw_rate / STANDARD_GRAVITY for t in x8_schedule.trims[index]])
    banks = x8_schedule.bank_for_turn(turns)[:, index]
    # At the nodes: rounding.
    np.testing.assert_allclose(banks, [t.roll for t in x8_schedule.trims[index]], atol=1e-12)


@pytest.mark.parametrize("bank", [-50.0, -28.0, -11.0, 11.0, 28.0, 50.0])
def test_between_equilibria_the_bank_for_a_turn_is_within_a_tenth_of_a_degree(x8_schedule, bank):
    found = trim(Fdm(X8), airspeed=20.0, altitude=100.0, bank=math.radians(bank))
    turn = np.array([20.0 * found.yaw_rate / STANDARD_GRAVITY])
    # tan(bank) is nearly proportional to V omega/g; half-way between two equilibria it is off by
    # second order of that "nearly".
    assert math.degrees(float(x8_schedule.bank_for_turn(turn)[0, 2])) == pytest.approx(
        bank, abs=0.1
    )


def test_past_the_steepest_equilibrium_the_bank_goes_on_growing_and_stays_short_of_a_right_angle(
    x8_schedule,
):
    turns = np.linspace(-3.0, 3.0, 61)
    banks = x8_schedule.bank_for_turn(turns)
    assert banks.shape == (61, 5)
    assert (np.diff(banks, axis=0) > 0.0).all()
    assert np.abs(banks).max() < 0.5 * math.pi


def test_a_table_has_a_row_for_each_bank_and_a_column_for_each_airspeed(x8_schedule):
    table = x8_schedule.over_bank("aileron")
    assert table.shape == (len(TRIM_BANKS), len(X8.envelope.design_airspeeds))
    assert table[2, 3] == x8_schedule.trims[3][2].inputs["aileron"]
    # A trim's quantities by their names.
    assert x8_schedule.over_bank("q")[1, 0] == x8_schedule.trims[0][1].rates_body[1]
    assert x8_schedule.over_bank("pitch")[1, 0] == x8_schedule.trims[0][1].pitch


def test_a_slower_heading_rate_model_is_designed_when_asked_for(x8_design, tmp_path):
    old = x8_design.schedule
    grid = Grid(
        spec=X8,
        envelope=old.envelope,
        altitude=old.altitude,
        trims=old.trims,
        models=old.models,
        edges=old.edges,
    )
    schedule = schedule_at(grid, replace(x8_design.bandwidths, lateral=3.0))
    aircraft = AutopilotedAircraft(X8, write_root(schedule, tmp_path))
    flown = flown_step(aircraft, schedule.level(1), "heading_rate", 0.1, 6.0)
    # From 10 to 90 % a second-order answer with a damping of 0.9 takes 2.9/omega_n (1.8 at 0.5, 3.4
    # at 1: control textbooks); the aircraft follows within a fifth.
    assert schedule.weights.model_frequency == pytest.approx(3.0)
    assert flown.rise_time() == pytest.approx(2.9 / 3.0, rel=0.2)


def test_a_design_condition_that_cannot_be_flown_is_refused():
    too_slow = replace(X8, envelope=replace(X8.envelope, airspeed_min=5.0))
    with pytest.raises(AircraftError, match="5 m/s"):
        linear_grid(too_slow, 100.0)
