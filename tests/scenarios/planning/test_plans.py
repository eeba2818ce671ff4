"""Starts, guards, orbits and circles that are planned."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from flight_cases import SPEED, plan, scenario
from scipy.optimize import brentq
from thrust_cases import MODEL

from benchmarks.crossing_limit import designed
from gnc.errors import InfeasibleError
from gnc.estimation.navigation import AirMotion, WindFilter
from gnc.estimation.vessel import Tube
from gnc.guard.guard import HeadingRateFilter
from gnc.paper import PlumeAxis, distance_by_paper
from innerloop.flight.part_failure import PartFailure
from innerloop.flight.turn_reversal import TurnReversalResponse
from measurement.plume.spread import downwash, rise
from scenarios.planning.air.wind import navigation_parameters, wind_followed
from scenarios.planning.declared_vessel import check_declared
from scenarios.planning.limits import omega_max
from scenarios.planning.missions import VesselCircle, plan_flight, vessel_circle
from scenarios.planning.plume import axis_height, plume_axis
from scenarios.planning.reference import distance_kept, oscillation_at
from scenarios.planning.theory import CROSSING_LIMITS
from scenarios.scenario.files import load_study, with_values
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.flight import ALTITUDE_MARGIN
from scenarios.scenario.sections.guidance import GuidanceConfig, ReferenceConfig
from scenarios.scenario.sections.world import KeepoutConfig
from scenarios.vehicles.thrust_expectation import ThrustErrors, ThrustExpectation
from scenarios.vehicles.vehicle_setup import VehicleSetup, kinematic_setup
from scenarios.world.plume import emission
from scenarios.world.vessel import SteadyVessel

PAPER = Scenario.model_validate({"title": "test", "fidelity": "kinematic"})


@pytest.mark.parametrize("made", [scenario(), PAPER], ids=["following", "tracking"])
def test_a_given_start_is_flown_from(made):
    # The vessel goes north in still air: its plume trails south, and bearings from it count
    # clockwise.
    start = {"range_m": 500.0, "aspect_deg": 30.0, "course_deg": -70.0}
    given = plan(with_values(made, {"start": start})).start
    bearing = math.radians(180.0 + 30.0)
    place = 500.0 * math.cos(bearing), 500.0 * math.sin(bearing)
    # Rounding of the vessel's track, a kilometre of it at most.
    assert (given.north, given.east) == pytest.approx(place, abs=1e-9)
    assert given.course == pytest.approx(math.radians(-70.0))


def test_a_vehicle_whose_lag_keeps_a_turn_away_from_leading_away_is_refused():
    # At 0.5 rad/s and 4 s late it overshoots by two radians: it came within 28 m of a ship from
    # which it had to keep 50 m.
    with pytest.raises(InfeasibleError, match=r"lags by 4 s overshoots, and then leaves at only -"):
        plan(with_values(PAPER, {"kinematic.heading_rate_lag_s": 4.0}))
    plan(with_values(PAPER, {"kinematic.heading_rate_lag_s": 0.4}))


SETUP = VehicleSetup(
    lag=0.275, reversal=TurnReversalResponse(delay=0.0, lag=0.3), response_error=0.0,
    airspeed_bandwidth=1.0, airspeed_min=15.0, airspeed_max=25.0,
)  # fmt: skip


def tracking(*overrides, nu=0.5, setup=SETUP):
    scenario = with_values(load_study("sweep_nu", overrides), {"vessel.speed_ratio": nu})
    return plan(scenario, setup=setup)


def test_a_start_from_which_no_command_keeps_out_is_refused():
    # 210 m astern of a vessel at rest, straight at it: a turn away takes 38 m, and its lag besides.
    start = ["start.place_m=[-210.0, 0.0]", "start.course_deg=0"]
    with pytest.raises(
        InfeasibleError,
        match=r"the start lies 210\.0 m from the vessel on course 0 deg, where the best turn away",
    ):
        tracking(*start, nu=0.0)
    # Away from it, or with no guard, it is flown.
    tracking(start[0], "start.course_deg=180", nu=0.0)
    tracking(*start, "guidance.keepout_guard=false", nu=0.0)


def test_the_guard_keeps_the_disc_that_the_keep_out_sphere_cuts_out_at_the_height_of_the_flight():
    flight = tracking("plume.elevation_deg=20")
    above = flight.altitude - 60.0
    assert flight.guidance.guard.radius == pytest.approx(math.sqrt(200.0**2 - above**2), rel=1e-12)
    # An aircraft that sinks by a metre in a turn is where the sphere is wider; with the sphere's
    # top just below it, too.
    sinking = replace(SETUP, altitude_error=1.0)
    assert tracking("plume.elevation_deg=20", setup=sinking).guidance.guard.radius == pytest.approx(
        math.hypot(flight.guidance.guard.radius, math.sqrt(above**2 - (above - 1.0) ** 2))
    )
    over_the_top = ("plume.elevation_deg=60", "guidance.tracking_allowance_m=24.5")
    assert 200.0 < tracking(*over_the_top).altitude - 60.0 < 201.0
    assert tracking(*over_the_top).guidance.guard is None
    assert tracking(*over_the_top, setup=sinking).guidance.guard.radius > 0.0
    # Above the whole sphere there is nothing to keep out of.
    assert (
        tracking("plume.elevation_deg=60", "guidance.tracking_allowance_m=400").guidance.guard
        is None
    )


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.8])
def test_the_point_on_the_circle_moves_at_airspeed_through_the_air_and_returns_after_a_period(nu):
    circle = VesselCircle(nu=nu, speed=SPEED, radius=200.0)
    time = np.linspace(0.0, circle.period, 400)
    step = 1e-2
    (x0, y0), (x1, y1) = circle.offset(time), circle.offset(time + step)
    through_air = np.hypot((x1 - x0) / step + nu * SPEED, (y1 - y0) / step)
    # The table has 720 points: half a degree of a turn, over which the speed changes by nu times
    # that, at most 1 %.
    assert through_air == pytest.approx(np.full(400, SPEED), rel=0.012)
    # The trapezoidal rule over a whole turn is exact to rounding; the closed form is an elliptic
    # integral.
    assert np.hypot(*circle.offset(circle.period) - np.array(circle.offset(0.0))) == pytest.approx(
        0.0, abs=1e-3
    )


def test_a_circle_that_is_too_tight_is_refused_with_the_radius_that_is_not():
    scenario = load_study("arena", ["reference.standoff_radius_m=50"], refusing=False)
    # omega_max = g tan 45 deg/V = 0.505 rad/s; (1 + 0.5)^2 V/omega_max = 86.5 m.
    with pytest.raises(
        InfeasibleError,
        match=r"circle of 50 m .* widen it to 87 m \(reference\.standoff_radius_m\)",
    ):
        vessel_circle(scenario, 0.5, 60.0)
    # Nor is one recommended that lies within the keep-out area and its margin.
    with pytest.raises(InfeasibleError, match="widen it to 203 m"):
        vessel_circle(scenario, 0.5, 203.0)
    assert vessel_circle(load_study("arena"), 0.5, 203.0).radius == 203.0


# Errors of a thousandth of the weight.
ERRORS = ThrustErrors(lack=1e-3, density=1e-6)
EXPECTATION = ThrustExpectation(model=MODEL, calm=ERRORS, gusty=ERRORS, gusts=2.0)


class Swerving:
    """A track of one's own, which accelerates by 0.4 m/s2."""

    manoeuvres_end = math.nan

    def course(self, time):
        return 0.5 * math.sin(0.1 * time)

    def motion(self, time):
        return 8.0 * time, 40.0 * (1.0 - math.cos(0.1 * time)), 8.0, 4.0 * math.sin(0.1 * time)


def test_a_users_track_that_accelerates_more_than_is_declared_is_refused():
    with pytest.raises(InfeasibleError, match=r"accelerates by 0\.4 m/s2.*: declare more"):
        check_declared(scenario(), Swerving())


def test_the_guard_allows_for_the_airspeed_to_which_a_vehicle_without_thrust_falls():
    failing = PartFailure(airspeed_fall=1.25, glide_deviation=4.3, glide_undershoot=0.5)
    how = {"airspeed_min": 15.0, "failing_level": failing, "thrust": EXPECTATION}
    setup = replace(kinematic_setup(scenario()), **how)
    given = scenario(guidance={"airspeed_mps": SPEED}, fault={"declared": ["engine"]})
    guarded = plan(given, setup=setup).guidance.guard
    # Noticed after a second, 0.2 s of an interval, and half of the 2 s in which the engine may run
    # down; another interval until it glides, and 0.5 m/s as it pushes over.
    slowest = SPEED - 1.25 * (1.0 + 0.2 + 0.5 * 2.0 + 0.2) - 0.5
    assert guarded.errors.slowest == pytest.approx(slowest)
    # Noticed earlier than that, it holds its height until it has fallen to the glide's airspeed.
    quick = replace(EXPECTATION, model=replace(MODEL, spool_time=0.1))
    at_once = plan(given, setup=replace(setup, thrust=quick)).guidance.guard
    assert at_once.errors.slowest == pytest.approx(0.5 * (SPEED + 15.0) - 1.25 * 0.2 - 0.5)
    # Then it pushes over to a glide, which takes it off its turn: the guard keeps as much more.
    assert (guarded.radius, guarded.errors.failed_part.size) == (204.3, 4.3)
    # Without the declaration nothing is kept: a list of trials has one setup.
    sound = plan(scenario(guidance={"airspeed_mps": SPEED}), setup=setup)
    errors = sound.guidance.guard.errors
    assert (errors.slowest, errors.failed_part.size) == (math.inf, 0.0)

    def total(deviation):
        failing_level = replace(failing, glide_deviation=deviation)
        return plan(given, setup=replace(setup, failing_level=failing_level)).margin.total

    # Beside an orbit of its least margin there is room for that much, and not for ten times that.
    assert total(0.0) == total(4.3) == sound.margin.total < total(43.0) - 20.0


def test_a_steady_vessel_that_is_faster_than_declared_is_refused():
    changes = {"reports": {"interval_s": (2.0, 10.0)}}
    # What is less by 0.05 % is not rounding: 1.2 m in 5 minutes.
    with pytest.raises(InfeasibleError, match=r"moves at up to 8 m/s .*speed_max_mps = 7\.996"):
        plan(scenario(following={"vessel_speed_max_mps": 7.996}, **changes))
    plan(scenario(following={"vessel_speed_max_mps": 8.0}, **changes))


@pytest.mark.parametrize(
    ("level", "speed", "turned"),
    [("none", SPEED, 0.02), ("moderate", SPEED, 0.02), ("none", 100.0, 0.0)],
)
def test_the_estimated_wind_follows_as_fast_as_the_guard_allows_for(level, speed, turned):
    # A wind that rises by 0.1 m/s each second, which gusts hide, or beside a fast vehicle the error
    # of its course, as it flies straight across the wind: the filter lags by no more than its time.
    air = {"turbulence": {"level": level}, "guidance": {"airspeed_mps": speed}}
    flown = scenario(fidelity="six_dof", **air)
    p = navigation_parameters(flown, kinematic_setup(scenario()))
    sigmas = {"airspeed_sigma": p.airspeed_sigma, "course_sigma": p.course_sigma}
    wind = WindFilter(**sigmas, drift=p.wind_drift)
    behind, period = 0.0, p.wind_interval * p.time_step
    for n in range(2000):
        blown, course = 0.1 * n * period, 0.5 * math.pi + turned * n
        ground = blown + speed * math.cos(course), speed * math.sin(course)
        wind.update(speed, course, *ground, period)
        behind = max(behind, blown - wind.north)
    assert 0.5 * wind_followed(flown) < behind / 0.1 <= wind_followed(flown)


VESSEL = SteadyVessel(8.0, 0.0)


def test_what_is_known_of_the_ship_is_the_middle_and_the_spread_of_the_ranges():
    scenario = load_study("plume_search", ["comparison.variants=[]", "turbulence.level=moderate"])
    axis = plume_axis(scenario, VESSEL)
    lowest, highest = axis.expected.lowest, axis.expected.highest
    assert (lowest, highest) == (
        20.0 + ALTITUDE_MARGIN["moderate"],
        120.0 - ALTITUDE_MARGIN["moderate"],
    )
    # Of a uniform distribution from 20 to 60 m: mean 40, deviation the range over the root of 12.
    assert axis.expected.source_height == 40.0
    assert axis.expected.source_deviation == pytest.approx(40.0 / math.sqrt(12.0), rel=1e-12)
    middle = emission(scenario, speed=math.nan, load=0.55)
    assert axis.expected.buoyancy_flux == middle.buoyancy_flux
    # The logarithm of a load that is uniform from 0.2 to 0.9 scatters by 0.4; fuel burnt goes
    # almost with the load.
    assert axis.expected.load_deviation == pytest.approx(0.4, abs=0.05)


@pytest.mark.parametrize("speed", [3.0, 8.0, 19.0])
def test_it_is_the_rise_of_the_measurement_in_neutral_air_less_its_downwash(speed):
    scenario = load_study("sulphur", ["emission.load=0.2", "flight.altitude_max_m=400"])
    expected = axis_height(scenario, SteadyVessel(12.0, 0.7))
    # The true load is another one, of which the guidance knows nothing.
    emitted = emission(scenario, speed=12.0)
    above_funnel = float(rise(emitted, speed, 300.0 / speed)) - float(downwash(emitted, speed))
    assert expected.at(300.0, speed) - 35.0 == pytest.approx(above_funnel, rel=1e-9)


GUIDANCE = GuidanceConfig()
KEEPOUT = KeepoutConfig(radius_m=200.0)
KEPT = 201.0
"""r_min and the allowance for tracking of 1 m that ``GuidanceConfig`` has [m]."""


def orbit_of(shape, nu):
    return oscillation_at(GUIDANCE, ReferenceConfig(shape=shape), nu)


def axis_at(heading_deg, elevation_deg=0.0):
    return PlumeAxis(heading=math.radians(heading_deg), elevation=math.radians(elevation_deg))


def nearest(orbit, axis, distance):
    """Return the smallest distance of 20,000 points of an orbit from the plume's origin [m]."""
    along, across = orbit.offset(np.linspace(0.0, orbit.period, 20001))
    level, up = distance * math.cos(axis.elevation), distance * math.sin(axis.elevation)
    north, east = level * math.cos(axis.heading) + along, level * math.sin(axis.heading) + across
    return float(np.sqrt(north**2 + east**2 + up**2).min())


@pytest.mark.parametrize("nu", [0.0, 0.1, 0.25, 0.5])
def test_a_loiter_keeps_out_in_every_direction_of_the_plume_and_lies_no_farther_off(nu):
    for heading in range(0, 360, 30):
        orbit, axis = orbit_of("loiter", nu), axis_at(heading)
        distance = distance_kept(GUIDANCE, KEEPOUT, orbit, axis)
        # Points are 0.025 m apart: by the square of that over 2 r_min, 2e-6 m, they miss the
        # nearest, and by 1e-5 m that lies beyond where the search for it stops.
        assert nearest(orbit, axis, distance) == pytest.approx(KEPT, rel=0.0, abs=2e-5)


@pytest.mark.parametrize("shape", ["sinusoid", "fastest"])
def test_a_figure_of_eight_is_placed_by_the_paper_to_the_last_bit(shape):
    for nu in (0.0, 0.3, 0.9, 0.97):
        for heading in range(0, 360, 30):
            orbit, axis = orbit_of(shape, nu), axis_at(heading, 10.0)
            distance = distance_kept(GUIDANCE, KEEPOUT, orbit, axis)
            assert distance == distance_by_paper(orbit, axis, KEPT)


DEVIATION = 3.1
DEVIATING = VehicleSetup(
    lag=0.39, reversal=TurnReversalResponse(delay=0.26, lag=0.26), response_error=DEVIATION,
    airspeed_bandwidth=1.0, airspeed_min=15.0, airspeed_max=25.0,
)  # fmt: skip


def planned(nu, *overrides):
    values = {"vessel.speed_ratio": nu, "start.distance_m": (500.0, 500.0)}
    scenario = with_values(load_study("sweep_nu", overrides), values)
    return plan_flight(scenario, flight_id="x", seed=1, setup=DEVIATING)


def least_clearance(plan):
    """Return what the guard has left at the worst point of the orbit where it is placed [m]."""
    guard = HeadingRateFilter(plan.guidance.guard)
    orbit, centre = plan.oscillation, plan.guidance.mission.centre
    vessel = Tube(0.0, 0.0, 0.0, orbit.nu * orbit.speed, 0.0)
    times, piece = np.linspace(0.0, orbit.period, 240, endpoint=False), 1e-3 * orbit.period
    (x, y), (ahead, right), (farther, more) = (orbit.offset(times + i * piece) for i in range(3))
    drift = orbit.nu * orbit.speed
    course = np.arctan2((right - y) / piece, (ahead - x) / piece + drift)
    after = np.arctan2((more - right) / piece, (farther - ahead) / piece + drift)
    rate = np.remainder(after - course + math.pi, 2.0 * math.pi) - math.pi
    names = ("ground_north", "ground_east", "course", "heading_rate")
    motions = zip(centre.x + x, centre.y + y, course, rate / piece, strict=True)
    places = [AirMotion(**dict(zip(names, motion, strict=True))) for motion in motions]
    return min(guard.clearance(0.0, place, (vessel,), orbit.speed) for place in places)


@pytest.mark.parametrize("placement", ["paper", "exact"])
@pytest.mark.parametrize("nu", [0.1, 0.5, 0.9, 0.965])
def test_an_orbit_leaves_the_guard_all_of_the_deviation(nu, placement):
    # When the guard kept less in place of moving the orbit, 16 of 32 flights of a law that flies at
    # the ship came in, by up to 0.6 m.
    plan = planned(nu, f"guidance.placement={placement}")
    assert plan.guidance.guard.errors.response.size == DEVIATION
    assert least_clearance(plan) > 0.0


@pytest.mark.parametrize(
    ("nu", "shape", "heading"),
    [
        (0.45, "sinusoid", 60),
        (0.45, "fastest", 90),
        (0.45, "fastest", -120),
        (0.2, "loiter", 90),
        (0.2, "loiter", 270),
    ],
)
def test_the_guard_leaves_an_orbit_alone_in_any_direction_of_the_plume(nu, shape, heading):
    # Placed as if the plume trailed astern, the orbit was 1.5 m too near abeam, and the guard acted
    # on it 197 times.
    plan = planned(nu, f"reference.shape={shape}", f"plume.heading_deg={heading}")
    assert least_clearance(plan) > 0.0


SOLVED = json.loads(CROSSING_LIMITS.read_text(encoding="utf-8"))


def rows(name):
    return [
        (nu, value / omega_max(GUIDANCE))
        for nu, value in zip(SOLVED["nu"], SOLVED[name], strict=True)
        if value is not None
    ]


@pytest.mark.parametrize(("name", "shape"), [("oscillating", "fastest"), ("going_round", "loiter")])
def test_the_shapes_are_the_optimum_that_was_solved_for_with_another_method(name, shape):
    for nu, interval in rows(name):
        # A roll rate that changes between 200 pieces of a period alone costs 1e-4; the loiter is
        # 7e-5 above its optimum (measured).
        assert designed(GUIDANCE, shape, nu) == pytest.approx(interval, rel=2e-4)


def test_no_solution_is_shorter_than_what_is_proven_for_an_infinite_roll_rate():
    # docs/fastest_oscillation.md: 2 A/omega_max with sin(A)/A = nu, and pi/(omega_max (1 - nu)).
    # IPOPT's tolerance is 1e-9.
    unit = omega_max(GUIDANCE)
    for nu, interval in rows("oscillating"):
        amplitude = brentq(lambda a, nu=nu: math.sin(a) / a - nu, 1e-9, 3.2)
        assert interval >= 2.0 * amplitude / unit * (1.0 - 1e-5)
    for nu, interval in rows("going_round"):
        assert interval >= math.pi / (1.0 - nu) / unit * (1.0 - 1e-5)
