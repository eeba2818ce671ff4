"""Flights that track the paper's reference."""

import math
from dataclasses import replace

import pytest

from gnc.errors import InfeasibleError
from innerloop.flight.turn_reversal import TurnReversalResponse
from scenarios.planning.missions import plan_flight
from scenarios.scenario.files import load_study, with_values
from scenarios.vehicles.vehicle_setup import VehicleSetup

SETUP = VehicleSetup(
    lag=0.275,
    reversal=TurnReversalResponse(delay=0.0, lag=0.3),
    response_error=0.0,
    airspeed_bandwidth=1.0,
    airspeed_min=15.0,
    airspeed_max=25.0,
)


def plan(*overrides, nu=0.5, seed=1, setup=SETUP):
    scenario = with_values(load_study("sweep_nu", overrides), {"vessel.speed_ratio": nu})
    return plan_flight(scenario, flight_id="x", seed=seed, setup=setup)


def test_a_start_from_which_no_command_keeps_out_is_refused():
    # 210 m astern of a vessel at rest, straight at it: a turn away takes 38 m, and its lag besides.
    start = ["start.place_m=[-210.0, 0.0]", "start.course_deg=0"]
    with pytest.raises(
        InfeasibleError,
        match=r"the start lies 210\.0 m from the vessel on course 0 deg, where the best turn away",
    ):
        plan(*start, nu=0.0)
    # Away from it, or with no guard, it is flown.
    plan(start[0], "start.course_deg=180", nu=0.0)
    plan(*start, "guidance.keepout_guard=false", nu=0.0)


def test_the_guard_keeps_the_disc_that_the_keep_out_sphere_cuts_out_at_the_height_of_the_flight():
    flight = plan("plume.elevation_deg=20")
    above = flight.altitude - 60.0
    assert flight.guidance.guard.radius == pytest.approx(math.sqrt(200.0**2 - above**2), rel=1e-12)
    # An aircraft that sinks by a metre in a turn is where the sphere is wider; with the sphere's
    # top just below it, too.
    sinking = replace(SETUP, altitude_error=1.0)
    assert plan("plume.elevation_deg=20", setup=sinking).guidance.guard.radius == pytest.approx(
        math.hypot(flight.guidance.guard.radius, math.sqrt(above**2 - (above - 1.0) ** 2))
    )
    over_the_top = ("plume.elevation_deg=60", "guidance.tracking_allowance_m=24.5")
    assert 200.0 < plan(*over_the_top).altitude - 60.0 < 201.0
    assert plan(*over_the_top).guidance.guard is None
    assert plan(*over_the_top, setup=sinking).guidance.guard.radius > 0.0
    # Above the whole sphere there is nothing to keep out of.
    assert (
        plan("plume.elevation_deg=60", "guidance.tracking_allowance_m=400").guidance.guard is None
    )
