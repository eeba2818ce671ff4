"""Where flights of both missions begin."""

import math

import pytest
from flight_cases import plan, scenario

from gnc.errors import InfeasibleError
from scenarios.scenario.scenario import Scenario


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


def test_a_vehicle_whose_lag_keeps_a_turn_away_from_leading_away_is_refused():
    # At 0.5 rad/s and 4 s late it overshoots by two radians: it came within 28 m of a ship from
    # which it had to keep 50 m.
    with pytest.raises(
        InfeasibleError,
        match=r"lags by 4 s overshoots, and then leaves at only -.* of its .*: slow the vessel, .* shorter lag",
    ):
        plan(tracking(kinematic={"heading_rate_lag_s": 4.0}))
    plan(tracking(kinematic={"heading_rate_lag_s": 0.4}))
