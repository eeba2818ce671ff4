import math

import pytest

from gnc.errors import InfeasibleError
from scenarios.flights import flight_requests
from scenarios.planning.planner import plan_flight
from scenarios.schema.load import load_scenario


def plan(*overrides, nu=0.5, seed=1):
    return plan_flight(load_scenario("sweep_nu", overrides), flight_id="x", nu=nu, seed=seed, lag=0.3)


def test_starts_lie_where_they_were_asked_for():
    courses = []
    for seed in range(200):
        flight = plan(seed=seed)
        assert 400.0 <= math.hypot(flight.start_north, flight.start_east) <= 800.0
        # Vessel heading north: within 30 degrees of straight astern.
        assert abs(math.atan2(flight.start_east, -flight.start_north)) <= math.radians(30.0)
        courses.append(flight.start_course)
    # Any course: 200 uniform draws leave no gap of 60 degrees but with probability 200 (5/6)^199 < 1e-13.
    assert max(b - a for a, b in zip(sorted(courses), sorted(courses)[1:], strict=False)) < math.radians(60.0)


def test_starts_depend_on_the_seed_and_nu_alone():
    base = flight_requests(load_scenario("sweep_nu"))
    fewer = flight_requests(load_scenario("sweep_nu", ["sweep.nu=[0.5]", "comparison.variants=[]"]))
    other = flight_requests(load_scenario("sweep_nu", ["seed=2"]))
    by_id = {request.flight_id: request.seed for request in base}
    assert by_id["nu_0.50"] == fewer[0].seed
    assert by_id["nu_0.50"] == by_id["nu_0.50_no_preview"]
    assert by_id["nu_0.50"] != {request.flight_id: request.seed for request in other}["nu_0.50"]
    assert len({request.seed for request in base if request.variant == "study"}) == 20


def test_the_altitude_is_that_of_the_centre_of_oscillation():
    # Equation (9): z_CO = r_CO sin(alpha_P), above the funnel at 60 m.
    flight = plan("plume.elevation_deg=10")
    assert flight.altitude == pytest.approx(60.0 + flight.mission.centre_distance * math.sin(math.radians(10.0)), abs=1e-9)


def test_omega_max_is_the_coordinated_turn_at_the_bank_asked_for():
    # g tan(45 deg)/19.42 m/s = 0.50498 rad/s.
    assert plan().guidance.heading_rate_max == pytest.approx(9.80665 / 19.42, rel=1e-12)
    assert plan("guidance.heading_rate_max_rad_s=0.503").guidance.heading_rate_max == 0.503


def test_preview_and_airspeed_trim_can_be_switched_off():
    assert plan("guidance.preview=false").guidance.lag == 0.0
    assert plan().guidance.lag == 0.3
    assert plan("guidance.airspeed_trim=false").guidance.airspeed_gain == 0.0
    assert plan("guidance.keepout_guard=false").mission.guard is None


def test_a_start_from_which_no_command_keeps_out_is_refused():
    # 210 m astern of a vessel at rest, straight at it: a turn away takes 38 m, and its lag besides.
    start = ["start.place_m=[-210.0, 0.0]", "start.course_deg=0"]
    with pytest.raises(InfeasibleError, match=r"the start lies 210\.0 m from the vessel on course 0 deg, where the best turn away"):
        plan(*start, nu=0.0)
    # Away from it, or with nobody to mind, it is flown.
    plan(start[0], "start.course_deg=180", nu=0.0)
    plan(*start, "guidance.keepout_guard=false", nu=0.0)


def test_the_guard_keeps_its_share_of_what_the_orbit_keeps():
    # r_min and 0.75 of the allowance of 1 m: the clearance of a vehicle that recedes is its distance less that.
    guard = plan(nu=0.0).mission.guard
    assert guard.clearance(0.0, 300.0, 0.0, 0.0, math.pi / 2.0, 19.42, 0.0) == pytest.approx(300.0 - 200.75, abs=1e-9)


@pytest.mark.parametrize(
    ("overrides", "nu", "words"),
    [
        ([], 1.0, "nu is 1; it must be below 1"),
        ([], 1.3, "nu is 1.3"),
        (["guidance.look_ahead_m=40"], 0.5, "R is 40 m; it must exceed"),
    ],
)
def test_infeasible_flights_say_why(overrides, nu, words):
    with pytest.raises(InfeasibleError, match=words):
        plan(*overrides, nu=nu)
