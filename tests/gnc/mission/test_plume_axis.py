"""How high a plume's axis is flown: the altitude follows slowly, and never farther ahead than the
autopilot can follow.
"""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gnc.mission.mode import Mode
from gnc.mission.plume_axis import Climb, PredictedPlume, trail
from tests.gnc.mission.axis_cases import PLAN_TIME, RISING, SPEED, situation

altitudes = st.floats(20.0, 120.0)


@given(
    altitude=altitudes, demanded=altitudes, gradient=st.floats(0.01, 0.2), time=st.floats(1.0, 20.0)
)
def test_the_command_climbs_no_steeper_than_the_gradient_and_never_beyond_what_is_demanded(
    altitude, demanded, gradient, time
):
    following = Climb(time=time, gradient=gradient).step(altitude, demanded, SPEED, PLAN_TIME)
    # Rounding alone.
    assert abs(following - altitude) <= gradient * SPEED * PLAN_TIME + 1e-9
    assert min(altitude, demanded) - 1e-9 <= following <= max(altitude, demanded) + 1e-9


@given(altitude=altitudes, demanded=altitudes, flown=altitudes)
def test_the_command_stays_within_reach_of_the_altitude_that_is_flown(altitude, demanded, flown):
    following = Climb(time=4.0, gradient=0.08, reach=1.2).step(
        altitude, demanded, SPEED, PLAN_TIME, flown=flown
    )
    assert abs(following - flown) <= 1.2 + 1e-9


def test_a_vehicle_that_has_fallen_behind_is_led_back_up():
    climb, altitude, flown = Climb(time=4.0, gradient=0.08, reach=1.2), 80.0, 40.0
    for _ in range(200):
        altitude = climb.step(altitude, 80.0, SPEED, PLAN_TIME, flown=flown)
        # It closes half of its distance from the command in a plan.
        flown += 0.5 * (altitude - flown)
    assert flown == pytest.approx(80.0, abs=0.1)


def test_a_plume_is_where_it_is_predicted_until_the_true_axis_is_set():
    axis, around = PredictedPlume(height=RISING, altitude=60.0).begin(), situation(wind=(0.0, 3.0))
    axis.plan(0.0, around, tracking=False)
    assert axis.demanded == RISING.at(around.centre.distance, math.hypot(8.0, 3.0))
    assert (axis.bearing, axis.mode) == (0.0, Mode.TRACKING)
    axis.set_true_axis(52.5, trail(around.own, around.target) + 0.1)
    axis.plan(0.5, around, tracking=True)
    assert axis.demanded == 52.5
    assert axis.bearing == pytest.approx(0.1, abs=1e-12)


@pytest.mark.parametrize(("given", "flown"), [(300.0, 117.0), (3.0, 23.0)])
def test_the_true_height_is_flown_within_the_limits_alone(given, flown):
    axis = PredictedPlume(height=RISING, altitude=60.0).begin()
    axis.set_true_axis(given, math.pi)
    axis.plan(0.0, situation(), tracking=True)
    assert axis.demanded == flown


def test_the_plume_trails_behind_the_vessels_motion_through_the_air():
    around = situation(wind=(0.0, 8.0), vessel=(8.0, 0.0))
    # A wind to the east as fast as the ship sails north carries her smoke to the south-east.
    assert trail(around.own, around.target) == pytest.approx(math.radians(135.0), abs=1e-12)


def test_a_bearing_turns_the_centre_to_the_right_of_where_the_plume_would_trail():
    around, still = (
        situation(),
        {"acceleration_north": 0.0, "acceleration_east": 0.0, "additional_range": 0.0},
    )
    for _ in range(400):
        around.centre.move(
            PLAN_TIME,
            vessel_north=8.0,
            vessel_east=0.0,
            wind_north=0.0,
            wind_east=0.0,
            bearing=math.radians(10.0),
            **still,
        )
    # Astern is 180 degrees; to the right of it, seen along the plume, is west. It comes there
    # asymptotically.
    assert math.degrees(around.centre.axis) % 360.0 == pytest.approx(190.0, abs=0.1)
