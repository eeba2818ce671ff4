"""Flights whose reference is steered."""

import math

import pytest
from flight_cases import SPEED, plan, scenario

from gnc.mission.plume_following import FollowingParameters


def test_such_a_flight_has_sensing_margin_and_health():
    flight = plan(scenario())
    assert isinstance(flight.guidance.mission, FollowingParameters)
    assert flight.sensing.received is None  # the vessel is known exactly
    assert flight.guidance.health is not None
    assert flight.guidance.navigation is not None
    # What is kept at least, in still air and with exact knowledge; the guard holds half of it.
    assert (flight.margin.total, flight.margin.guard) == pytest.approx((3.0, 1.5))
    assert flight.guidance.guard.radius == pytest.approx(201.5)
    assert flight.guidance.mission.centre.distance_min == pytest.approx(203.0)


def test_reports_are_received_beforehand_and_the_filter_knows_their_errors():
    flight = plan(scenario(reports={"interval_s": (2.0, 10.0), "position_sigma_m": 7.0}))
    assert len(flight.sensing.received) > 50
    assert flight.guidance.vessel.position_sigma == 7.0
    assert plan(scenario()).guidance.vessel.position_sigma == 0.0
    # A vessel that is not known exactly takes more margin.
    assert flight.margin.total > 3.0


def test_a_vessel_data_fault_silences_its_reports():
    fault = {"kind": "vessel_data", "at_s": (100.0, 100.0), "vessel_data_s": 60.0}
    times = [when for when, _ in plan(scenario(reports={"interval_s": (2.0, 4.0)}, fault=fault)).sensing.received]
    assert not [when for when in times if 100.0 <= when < 160.0]
    assert [when for when in times if when >= 160.0]


def test_periods_are_those_of_the_speed_ratio():
    flight = plan(scenario())
    assert flight.nu == pytest.approx(8.0 / SPEED)
    # The oscillation at the start's ratio, of which the table has the nearest of 49.
    assert flight.period(flight.nu) == pytest.approx(flight.oscillation.period, rel=0.02)
    assert flight.period(0.9) < flight.period(0.1)


def test_the_plumes_elevation_makes_the_altitude_rise_with_distance():
    mission = plan(scenario(plume={"elevation_deg": 10.0})).guidance.mission
    assert (mission.climb, mission.source_altitude) == (pytest.approx(math.tan(math.radians(10.0)), rel=1e-12), 60.0)


def test_following_can_do_without_the_keep_out_guard():
    assert plan(scenario(guidance={"keepout_guard": False})).guidance.guard is None
