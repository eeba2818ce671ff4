"""Kinematics of the rigid body, by identities and differentiation, and the local frame."""

import math

import numpy as np
import pytest
import x8_published as x8
from hypothesis import given
from hypothesis import strategies as st

from aircraft.fdm import TIME_STEP, Fdm
from aircraft.fleet.x8 import X8
from aircraft.state import EquatorFrame, body_velocity, course_rate, euler_rates, level, turn_rates
from aircraft.trim import trim
from common.geodesy import LocalFrame

components = st.floats(-50.0, 50.0)
vectors = st.tuples(components, components, components)
rolls = st.floats(-math.pi, math.pi)
pitches = st.floats(-1.4, 1.4)  # short of straight up, where Euler angles end
ROUNDING = 1e-12  # a few dozen operations on numbers up to 100


@given(vector=vectors, roll=rolls, pitch=pitches)
def test_level_is_the_rotation_back_from_body_to_ahead_right_down(vector, roll, pitch):
    expected = x8.body_from_ned(roll, pitch).T @ np.array(vector)
    np.testing.assert_allclose(level(vector, roll, pitch), expected, atol=ROUNDING)


@given(yaw_rate=st.floats(-3.0, 3.0), roll=rolls, pitch=pitches)
def test_the_rates_of_a_steady_turn_move_yaw_alone(yaw_rate, roll, pitch):
    roll_rate, pitch_rate, turned = euler_rates(turn_rates(yaw_rate, roll, pitch), roll, pitch)
    assert (roll_rate, pitch_rate, turned) == pytest.approx((0.0, 0.0, yaw_rate), abs=ROUNDING)


@given(rates=vectors, roll=rolls, pitch=pitches)
def test_euler_rates_put_together_again_are_the_body_rates(rates, roll, pitch):
    roll_rate, pitch_rate, yaw_rate = euler_rates(rates, roll, pitch)
    # omega = roll_rate x_body + pitch_rate y_between + yaw_rate z_down: the definition of 3-2-1
    # Euler angles.
    across = np.array([0.0, math.cos(roll), -math.sin(roll)])
    down = x8.body_from_ned(roll, pitch) @ np.array([0.0, 0.0, 1.0])
    # / cos 1.4.
    np.testing.assert_allclose(
        np.array([roll_rate, 0.0, 0.0]) + pitch_rate * across + yaw_rate * down, rates, atol=1e-10
    )


@given(
    velocity=vectors.filter(lambda v: v[0] > 5.0),
    acceleration=vectors,
    pull=st.floats(-20.0, 20.0),
    roll=rolls,
    pitch=st.floats(-0.5, 0.5),
)
def test_what_pulls_straight_down_does_not_turn_the_course(
    velocity, acceleration, pull, roll, pitch
):
    # Which is why specific force serves as well as acceleration.
    down = x8.body_from_ned(roll, pitch) @ np.array([0.0, 0.0, pull])
    pulled = tuple(float(a) for a in np.array(acceleration) + down)
    ahead, right, _ = level(velocity, roll, pitch)
    rounding = 1e-10 / max(1e-6, ahead**2 + right**2)
    if ahead**2 + right**2 > 1.0:
        assert course_rate(velocity, pulled, roll, pitch) == pytest.approx(
            course_rate(velocity, acceleration, roll, pitch), abs=rounding + 1e-10
        )


@pytest.mark.parametrize("time", [0.0, 0.4, 1.1, 2.7])
def test_course_rate_is_the_derivative_of_the_course_along_a_banking_turning_path(time):
    def roll(t):
        return 0.6 * math.sin(1.3 * t)

    def pitch(t):
        return 0.1 + 0.05 * math.cos(0.9 * t)

    def yaw(t):
        return 0.3 * t + 0.2 * math.sin(0.7 * t)

    def velocity(t):
        return np.array(
            body_velocity(
                20.0 + math.sin(t), 0.06 + 0.03 * math.sin(2.0 * t), 0.05 * math.cos(1.7 * t)
            )
        )

    def velocity_ned(t):
        return x8.body_from_ned(roll(t), pitch(t), yaw(t)).T @ velocity(t)

    def course(t):
        north, east, _ = velocity_ned(t)
        return math.atan2(east, north)

    h = 1e-5  # central differences: h^2 of truncation and 1e-16/h of rounding, both below 1e-9
    acceleration_ned = (velocity_ned(time + h) - velocity_ned(time - h)) / (2.0 * h)
    acceleration = x8.body_from_ned(roll(time), pitch(time), yaw(time)) @ acceleration_ned
    expected = (course(time + h) - course(time - h)) / (2.0 * h)
    found = course_rate(
        tuple(map(float, velocity(time))), tuple(map(float, acceleration)), roll(time), pitch(time)
    )
    assert found == pytest.approx(expected, abs=1e-8)


METRES_PER_FOOT = 0.3048


@given(
    north=st.floats(-50e3, 50e3), east=st.floats(-50e3, 50e3), altitude=st.floats(-100.0, 3000.0)
)
def test_places_come_back_from_the_globe(north, east, altitude):
    frame = EquatorFrame(altitude)
    # Four steps, each by 6e-5 nearer: rounding of 50 km is left, 7e-12 m a step.
    assert frame.to_local(*frame.to_geodetic(north, east)) == pytest.approx((north, east), abs=1e-9)


@pytest.mark.parametrize(("distance", "error"), [(3e3, 1e-6), (20e3, 2e-4), (50e3, 2e-2)])
def test_it_is_the_azimuthal_equidistant_frame_at_the_origin(distance, error):
    whole = LocalFrame(0.0, 0.0, 60.0)
    for azimuth in np.radians(range(0, 360, 10)):
        north, east = distance * math.cos(azimuth), distance * math.sin(azimuth)
        latitude, longitude = (float(angle) for angle in whole.to_geodetic(north, east))
        # The other frame is good to 2e-4 m at 20 km, growing as the fifth power; this one is
        # better.
        assert EquatorFrame(60.0).to_local(latitude, longitude) == pytest.approx(
            (north, east), abs=error
        )


@pytest.mark.slow
def test_local_metres_are_the_integral_of_ground_velocity_over_a_long_flight(x8_aircraft):
    # Winding to the north-west.
    start = trim(Fdm(X8), airspeed=20.0, altitude=100.0)
    x8_aircraft.release(start.state(yaw=-0.25 * math.pi), airspeed=20.0, altitude=100.0)
    fdm = x8_aircraft.fdm
    names = (
        "velocities/v-north-fps",
        "velocities/v-east-fps",
        "position/lat-geod-rad",
        "position/long-gc-rad",
    )
    nodes = [fdm.node(n) for n in names]
    frame = EquatorFrame(100.0)
    steps = 60 * 120
    log = np.empty((steps + 1, 4))
    for i in range(steps + 1):
        log[i] = [node.get_double_value() for node in nodes]
        x8_aircraft.command_heading_rate(0.3 * math.sin(0.3 * i * TIME_STEP))
        fdm.run()
    velocity = log[:, :2] * METRES_PER_FOOT
    integral = np.vstack(
        [[0.0, 0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * TIME_STEP, axis=0)]
    )
    local = np.array([frame.to_local(latitude, longitude) for latitude, longitude in log[:, 2:]])
    local -= local[0]
    distance = 20.0 * 60.0
    # Altitude moves by centimetres, no more; JSBSim's own steps make 1e-5 of the distance, here 1
    # cm in 1.2 km.
    assert np.abs(local - integral).max() < 1e-5 * distance
    # And the flight went somewhere.
    assert np.hypot(*local.T).max() > 390.0
