"""What of a trial becomes one flight: where it starts, and the margin of the turbulence that it has."""

import math

import numpy as np
import pytest
from sea_cases import AIRFRAME, scenario

from scenarios.engine.run_directory import RunDirectory
from scenarios.experiment.draws import drawn_flight
from scenarios.margin.keepout_margin import STILL, SpreadTable
from scenarios.margin.tracking_spread import Spread
from scenarios.planning.sea_planner import plan_sea_flight
from scenarios.planning.spreads import SPREAD_RATIOS, predicted_spreads
from scenarios.vehicles.sea_airframe import airframe_of

LEVELS = ("none", "light", "moderate")


def plan(trial, *, seed=1, airframe=AIRFRAME, spreads=None):
    return plan_sea_flight(trial, flight_id="a", seed=seed, airframe=airframe, spreads=spreads or {})


def test_a_start_that_is_given_is_where_and_as_it_was_given():
    # The vessel goes north in calm air: its plume trails south, and bearings from it count clockwise.
    given = plan(scenario(start={"range_m": 500.0, "aspect_deg": 30.0, "course_deg": -70.0}))
    bearing = math.radians(180.0 + 30.0)
    # Rounding of the vessel's track, a kilometre of it at most.
    assert given.start_north == pytest.approx(500.0 * math.cos(bearing), abs=1e-9)
    assert given.start_east == pytest.approx(500.0 * math.sin(bearing), abs=1e-9)
    assert given.start_course == pytest.approx(math.radians(-70.0))


def start_of(flight):
    """Return distance [m], bearing and course [deg] of a flight's start."""
    bearing = math.degrees(math.atan2(flight.start_east, flight.start_north))
    return math.hypot(flight.start_north, flight.start_east), bearing % 360.0, math.degrees(flight.start_course)


@pytest.mark.parametrize(
    ("key", "value", "place", "found"),
    [
        ("range_m", 1000.0, 0, 1000.0),
        # Against the plume's axis, 180 degrees.
        ("aspect_deg", -45.0, 1, 135.0),
        ("course_deg", 90.0, 2, 90.0),
    ],
)
def test_nothing_else_of_a_flight_changes_with_a_start_that_is_given(key, value, place, found):
    changes = {
        "reports": {"interval_s": (2.0, 10.0)},
        "sensors": {"position_sigma_m": 2.0},
        "fault": {"kind": "vessel_data", "at_s": (10.0, 20.0)},
    }
    drawn, given = (plan(scenario(**changes, start=start)) for start in ({}, {key: value}))
    one, other = list(start_of(drawn)), list(start_of(given))
    assert other[place] == pytest.approx(found)
    assert one[place] != pytest.approx(found)
    del one[place], other[place]
    assert other == pytest.approx(one, rel=1e-12)
    assert given.heard == drawn.heard
    assert given.fault == drawn.fault
    for step in (0, 1, 100):
        one, other = (flight.errors.read(step, (0.0,) * 5, 0.0, 0.0, satellites=True) for flight in (drawn, given))
        assert other == one
        assert one[0][0] != 0.0


def test_starts_that_are_not_given_lie_within_their_limits():
    trial = scenario(start={"distance_m": [400.0, 500.0], "spread_deg": 20.0}, flight={"duration_max_s": 10.0})
    starts = [start_of(plan(trial, seed=seed)) for seed in range(40)]
    distance, bearing, course = np.transpose(starts)
    assert 400.0 <= distance.min() < 420.0
    assert 480.0 < distance.max() <= 500.0
    assert 160.0 <= bearing.min() < 170.0
    assert 190.0 < bearing.max() <= 200.0
    # Any course: both halves of the compass, and fore and aft.
    assert course.min() < -90.0
    assert course.max() > 90.0


TABLED = SpreadTable(
    speed_ratios=(0.2, 0.6),
    spreads=tuple(
        Spread(along=s, across=s, radial=s, radial_rate=s, airspeed=s, airspeed_rate=s, airspeed_limit=100.0) for s in (1.0, 2.0)
    ),
)


def test_a_flight_has_the_spread_of_its_own_turbulence_and_speed_ratio():
    # A quarter and three quarters of the way between 0.2 and 0.6; the nearest counts.
    for nu, sigma in ((0.3, 1.0), (0.5, 2.0)):
        trial = scenario(fidelity="six_dof", turbulence={"level": "light"}, vessel={"speed_mps": 19.42 * nu})
        assert plan(trial, spreads={"light": TABLED}).margin.tracking_sigma == sigma
        # Not that of another level: as in still air.
        assert plan(trial, spreads={"moderate": TABLED}).margin.tracking_sigma == STILL.radial == 0.0


@pytest.fixture(scope="module")
def x8(designs, tmp_path_factory):
    """The design that other tests have too, at 100 m, and what flights need of it."""
    found = designs("x8")
    airframe = airframe_of(gusty(level="none"), found, RunDirectory(tmp_path_factory.mktemp("x8")))
    return found, airframe


def gusty(**turbulence):
    return scenario(fidelity="six_dof", plume={"source_height_m": 100.0}, turbulence=turbulence)


def drawing(choice):
    draws = [{"key": "turbulence.level", "choice": list(choice)}]
    return scenario(fidelity="six_dof", plume={"source_height_m": 100.0}, draws=draws)


def test_a_trial_that_draws_its_turbulence_plans_each_levels_own_margin(x8, monkeypatch):
    found, airframe = x8
    # Two of five, for time's sake.
    monkeypatch.setattr("scenarios.planning.spreads.SPREAD_RATIOS", SPREAD_RATIOS[1:3])
    trial = drawing(LEVELS)
    spreads = predicted_spreads(trial, found, airframe)
    # Still air has no spread.
    assert set(spreads) == {"light", "moderate"}
    assert {table.speed_ratios for table in spreads.values()} == {SPREAD_RATIOS[1:3]}
    margins = {}
    for number, level in enumerate(LEVELS):
        drawn = drawn_flight("trial", trial, number)
        assert drawn.scenario.turbulence.level == level
        margins[level] = plan(drawn.scenario, seed=drawn.seed, airframe=airframe, spreads=spreads).margin
        # The same as of a trial that has this turbulence in every flight.
        alone = gusty(level=level)
        own = predicted_spreads(alone, found, airframe)
        assert set(own) == {level} - {"none"}
        assert plan(alone, airframe=airframe, spreads=own).margin == margins[level]
    # MIL-F-8785C: twice the wind at 20 feet has twice the intensity, and the loop is linear; in still air the least is kept.
    assert margins["none"].tracking_sigma == 0.0
    assert margins["moderate"].tracking_sigma == pytest.approx(2.0 * margins["light"].tracking_sigma, rel=1e-6)
    assert margins["none"].total < margins["light"].total < margins["moderate"].total
    assert margins["none"].guard < margins["light"].guard < margins["moderate"].guard


def test_a_kinematic_vehicle_has_no_spread(x8):
    assert predicted_spreads(scenario(), x8[0], x8[1]) == {}
    assert predicted_spreads(gusty(level="light"), None, x8[1]) == {}
