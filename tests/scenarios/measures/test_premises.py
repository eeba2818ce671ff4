"""Ratios of actual errors to what is reckoned with, of records whose ratios are known, and of flights
whose premises are made to fail.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from flight_cases import plan as planned
from flight_cases import record, scenario

from common.premises import EXCEEDED, ratio_column, time_column
from gnc.estimation.error_budget import Bias, ErrorBudget, Process
from scenarios.flight.closed_loop import fly, release
from scenarios.flight.guard_belief import GuardBelief
from scenarios.flight.outcome import Outcome
from scenarios.flight.record import COLUMNS
from scenarios.measures.figures import flight_figures
from scenarios.measures.premises import premise_figures
from scenarios.vehicles.vehicle_setup import kinematic_setup
from scenarios.world.faults import SATELLITES

STEP = 0.1
NAMES = (*COLUMNS, *GuardBelief.COLUMNS)
VESSEL_NORTH = 1e7
"""So far off that its direction is the same all along [m]."""


@pytest.fixture(scope="module")
def plan():
    """A flight in still air, all of whose errors are those of its reports and sensors."""
    return planned(scenario())


def with_budget(plan, **terms):
    guard = replace(plan.guidance.guard, errors=ErrorBudget(**terms))
    return replace(plan, guidance=replace(plan.guidance, guard=guard))


def made(values, outcome=Outcome.COMPLETED):
    """Return a record of straight flight north at 20 m/s with exact figures, but for ``values``."""
    time = np.arange(0.0, 60.0 + 0.5 * STEP, STEP)
    straight = {
        "time_s": time, "north_m": 20.0 * time, "velocity_north_mps": 20.0, "altitude_m": 100.0,
        "airspeed_mps": 20.0, "vessel_north_m": VESSEL_NORTH, "own_seen_north_m": 20.0 * time,
        "own_seen_speed_mps": 20.0, "disc_north_m": VESSEL_NORTH, "speed_fastest_mps": 20.0,
        "speed_slowest_mps": 20.0, "command_change": 1.0,
    }  # fmt: skip
    history = np.zeros((len(time), len(NAMES)))
    for name, value in (straight | values).items():
        history[:, NAMES.index(name)] = value
    return record(history, NAMES, outcome)


def ratio(plan, values, term):
    return premise_figures(plan, made(values))[ratio_column(term)]


def test_the_own_position_is_compared_with_k_standard_deviations_of_the_discs(plan):
    budget = with_budget(plan, own_position=Process(sigma=1.5, correlation_time=60.0))
    k = plan.guidance.vessel.limits.deviations
    assert ratio(budget, {"own_seen_east_m": 0.4 * k * 1.5}, "position") == pytest.approx(0.4)


def turn(plan, *, towards_vessel=0.0, begins=10.0):
    """Return a half turn at omega_max behind the lag of a vehicle, which jumps towards the vessel by
    some metres where it flies across the direction of the vessel.
    """
    lag, rate = plan.guidance.guard.lag, plan.guidance.guard.heading_rate_max
    at = begins + 0.5 * math.pi / rate + lag
    fine = STEP / 100.0
    time = np.arange(0.0, 60.0 + 0.5 * fine, fine)
    command = np.where((time >= begins - 0.5 * fine) & (time < begins + math.pi / rate), rate, 0.0)
    rates = np.zeros_like(time)
    kept = math.exp(-fine / lag) if lag > 0.0 else 0.0
    for i in range(len(time) - 1):
        rates[i + 1] = command[i] + kept * (rates[i] - command[i])
    course = np.concatenate([[0.0], np.cumsum(0.5 * fine * (rates[1:] + rates[:-1]))])
    v_north, v_east = 20.0 * np.cos(course), 20.0 * np.sin(course)
    north = np.concatenate([[0.0], np.cumsum(0.5 * fine * (v_north[1:] + v_north[:-1]))])
    east = np.concatenate([[0.0], np.cumsum(0.5 * fine * (v_east[1:] + v_east[:-1]))])
    commanded = np.concatenate([[0.0], np.cumsum(fine * command[:-1])])
    sampled = slice(None, None, 100)
    moved = north[sampled] + np.where(time[sampled] > at - 0.5 * STEP, towards_vessel, 0.0)
    return {
        "north_m": moved, "east_m": east[sampled], "own_seen_north_m": moved,
        "own_seen_east_m": east[sampled], "velocity_north_mps": v_north[sampled],
        "velocity_east_mps": v_east[sampled], "own_seen_course_rad": course[sampled],
        "heading_rate_rad_s": rates[sampled], "course_commanded_rad": commanded[sampled],
        "guard": np.where(command[sampled] > 0.0, 1.0, 0.0),
    }  # fmt: skip


def test_a_turn_is_compared_with_its_response(plan):
    budget = with_budget(plan, response=Bias(size=10.0))
    # As commanded: what samples at 10 Hz leave of a path of 120 m is 3 cm, and counts as none.
    assert math.isnan(ratio(budget, turn(budget), "response"))
    nearer = turn(budget, towards_vessel=5.0)
    # The jump makes the way of its step of 2 m longer, which counts as speed: ahead, where the
    # vehicle is not.
    missing_ahead = math.hypot(2.0, 5.0) - 2.0
    expected = 0.1 * math.hypot(5.0, missing_ahead)
    assert ratio(budget, nearer, "response") == pytest.approx(expected, rel=0.01)
    # What leads away is not counted, but for what is missing ahead, where the disc closes in.
    ahead = missing_ahead * math.cos(math.radians(30.0)) - 5.0 * math.sin(math.radians(30.0))
    assert ratio(budget, turn(budget, towards_vessel=-5.0), "response") < 0.1 * ahead
    assert math.isnan(ratio(budget, nearer, "turning"))


def test_a_turn_that_is_faster_than_predicted_turns_away_all_the_same(plan):
    budget = with_budget(plan, response=Bias(size=1.0))
    values = turn(budget)
    # It turns on by 0.2 rad at once, after a radian: to the inner side.
    rate = plan.guidance.guard.heading_rate_max
    later = np.arange(0.0, 60.05, STEP) >= 10.0 + 1.0 / rate
    for north, east in (("north_m", "east_m"), ("velocity_north_mps", "velocity_east_mps")):
        about = values[north][later][0] + 1j * values[east][later][0]
        about = about if north == "north_m" else 0.0
        turned = about + (values[north] + 1j * values[east] - about) * np.exp(0.2j)
        values[north] = np.where(later, turned.real, values[north])
        values[east] = np.where(later, turned.imag, values[east])
    # The vessel far ahead of the course at the end is nearer by metres, but no turn away leads there.
    behind = {"vessel_north_m": -VESSEL_NORTH, "disc_north_m": -VESSEL_NORTH}
    assert math.isnan(ratio(budget, values | behind, "response"))
    # One that slows down is no turn away: the guard commands V_r.
    late = turn(budget, towards_vessel=5.0)
    late |= {"guard": 0.0, "airspeed_command_mps": plan.guidance.speed}
    assert ratio(budget, late, "response") > 1.0
    slowing = late | {"airspeed_command_mps": 0.8 * plan.guidance.speed}
    assert math.isnan(ratio(budget, slowing, "response"))


def test_a_violation_is_explained_by_a_premise_or_is_the_error_of_the_theorem(plan):
    inside = {"north_m": 0.0, "own_seen_north_m": 0.0, "vessel_north_m": 10.0, "disc_north_m": 10.0}
    inside |= {"altitude_m": plan.source_height, "reference_north_m": 0.0}
    inside |= {"vessel_velocity_north_mps": 20.0}
    exact = with_budget(plan)
    row, _ = flight_figures(exact, made(inside))
    assert row["keepout_violations"] == 1
    assert row["outcome"] == Outcome.UNEXPLAINED_VIOLATION.value
    row, _ = flight_figures(exact, made(inside | {"own_seen_east_m": 1.0}))
    assert row["outcome"] == Outcome.COMPLETED.value
    # An error of the own place is one of the vessel in its disc, too.
    assert row[EXCEEDED] == "position, vessel"
    # An aircraft that is lost does not fly its commands.
    row, _ = flight_figures(exact, made(inside, Outcome.AIRCRAFT_LOST))
    assert row["outcome"] == Outcome.AIRCRAFT_LOST.value


def flown(setting, plan):
    return premise_figures(plan, fly(plan, release(plan, kinematic_setup(setting))))


def test_a_flight_shows_by_name_that_dead_reckoning_drifted_more_than_declared():
    setting = scenario(
        fault={"kind": SATELLITES, "at_s": (40.0, 40.0), "satellite_navigation_s": 60.0},
        sensors={"airspeed_bias_mps": 1.0},
        flight={"duration_max_s": 110.0, "crossings": 0},
        seed=3,
    )
    honest = planned(setting)
    row = flown(setting, honest)
    assert row[EXCEEDED] == "none"
    assert 0.0 < row[ratio_column("drift")] <= 1.0
    errors = honest.guidance.guard.errors
    drift = replace(errors.drift, rate=0.1 * row[ratio_column("drift")] * errors.drift.rate)
    guard = replace(honest.guidance.guard, errors=replace(errors, drift=drift))
    short = replace(honest, guidance=replace(honest.guidance, guard=guard))
    row = flown(setting, short)
    assert row[EXCEEDED] == "drift"
    assert row[ratio_column("drift")] > 1.0
    assert 40.0 < row[time_column("drift")] < 101.0
