"""Where flights of both missions begin."""

import math

import pytest
from flight_cases import plan, scenario

from gnc.errors import InfeasibleError
from gnc.estimation.navigation import MeasuredMotion
from scenarios.scenario.scenario import Scenario


def start_of(flight):
    """Return distance [m], bearing and course [deg] of a flight's start."""
    start = flight.start
    bearing = math.degrees(math.atan2(start.east, start.north))
    return math.hypot(start.north, start.east), bearing % 360.0, math.degrees(start.course)


def tracking(**changes):
    return Scenario.model_validate({"title": "test", "fidelity": "kinematic"} | changes)


MISSIONS = pytest.mark.parametrize("made", [scenario, tracking], ids=["following", "tracking"])


@MISSIONS
def test_a_given_start_is_flown_from(made):
    # The vessel goes north in still air: its plume trails south, and bearings from it count
    # clockwise.
    given = plan(made(start={"range_m": 500.0, "aspect_deg": 30.0, "course_deg": -70.0})).start
    bearing = math.radians(180.0 + 30.0)
    # Rounding of the vessel's track, a kilometre of it at most.
    assert (given.north, given.east) == pytest.approx(
        (500.0 * math.cos(bearing), 500.0 * math.sin(bearing)), abs=1e-9
    )
    assert given.course == pytest.approx(math.radians(-70.0))


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
    sampled, given = (plan(scenario(**changes, start=start)) for start in ({}, {key: value}))
    one, other = list(start_of(sampled)), list(start_of(given))
    assert other[place] == pytest.approx(found)
    assert one[place] != pytest.approx(found)
    del one[place], other[place]
    assert other == pytest.approx(one, rel=1e-12)
    assert given.sensing.received == sampled.sensing.received
    assert given.world.faults == sampled.world.faults
    for step in (0, 1, 100):
        one, other = (
            flight.sensing.errors.read(
                step, MeasuredMotion(0.0, 0.0, 0.0, 0.0, 0.0), 0.0, 0.0, satellites=True
            )
            for flight in (sampled, given)
        )
        assert other == one
        assert one[0][0] != 0.0


def test_a_vehicle_whose_lag_keeps_a_turn_away_from_leading_away_is_refused():
    # At 0.5 rad/s and 4 s late it overshoots by two radians: it came within 28 m of a ship from
    # which it had to keep 50 m.
    with pytest.raises(
        InfeasibleError,
        match=r"lags by 4 s overshoots, and then leaves at only -.* of its .*: slow the vessel, .* shorter lag",
    ):
        plan(tracking(kinematic={"heading_rate_lag_s": 4.0}))
    plan(tracking(kinematic={"heading_rate_lag_s": 0.4}))
