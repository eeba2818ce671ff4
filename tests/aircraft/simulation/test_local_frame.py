"""North and east metres against the globe that JSBSim flies on."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from local_places import to_local

from aircraft.dynamics.trim import trim
from aircraft.fleet.x8 import X8
from aircraft.simulation.fdm import TIME_STEP, Fdm
from aircraft.simulation.local_frame import LocalFrame

METRES_PER_FOOT = 0.3048
metres = st.floats(-50e3, 50e3)


@given(north=metres, east=metres, latitude=st.floats(-1.3, 1.3), longitude=st.floats(-3.0, 3.0), altitude=st.floats(-100.0, 3000.0))
def test_places_come_back_from_the_globe(north, east, latitude, longitude, altitude):
    frame = LocalFrame(latitude, longitude, altitude)
    # An angle of 3 rad is kept to 4e-16, which is 3 nm on the ground; and back once more.
    assert to_local(frame, *frame.to_geodetic(north, east)) == pytest.approx((north, east), abs=2e-8)


@given(latitude=st.floats(-1.3, 1.3), longitude=st.floats(-3.0, 3.0))
def test_the_origin_is_the_origin(latitude, longitude):
    assert to_local(LocalFrame(latitude, longitude), latitude, longitude) == (0.0, 0.0)


def test_north_is_north_and_east_is_east():
    frame = LocalFrame(0.1, 0.2)
    assert to_local(frame, 0.1001, 0.2)[0] > 0.0
    assert to_local(frame, 0.1, 0.2001)[1] > 0.0


def test_a_degree_has_its_surveyed_length():
    # WGS 84: near the equator a degree of latitude is 110 574 m and near 45 degrees 111 132 m, a degree of longitude 111 319 m and
    # 78 847 m (tables after NIMA TR8350.2, in whole metres). Tolerance: that rounding, and a length against a radius of curvature.
    equator, middle = LocalFrame(0.0), LocalFrame(math.radians(45.0))
    degree = math.radians(1.0)
    assert equator.north_scale * degree == pytest.approx(110574.0, abs=1.0)
    assert middle.north_scale * degree == pytest.approx(111132.0, abs=1.0)
    assert equator.east_scale * degree == pytest.approx(111319.0, abs=1.0)
    assert middle.east_scale * degree == pytest.approx(78847.0, abs=1.0)


def test_higher_up_a_degree_is_longer():
    # By the ratio of radii: 1000 m in about 6378 km.
    assert LocalFrame(0.0, 0.0, 1000.0).east_scale - LocalFrame().east_scale == pytest.approx(1000.0, abs=1e-6)
    assert LocalFrame(0.0, 0.0, 1000.0).north_scale - LocalFrame().north_scale == pytest.approx(1000.0, abs=1e-6)


FLIGHTS = {
    "straight east": (math.pi / 2.0, lambda _: 0.0),
    "straight north": (0.0, lambda _: 0.0),
    "in circles": (1.0, lambda _: 0.1),
    "winding east": (math.pi / 2.0, lambda t: 0.1 * math.sin(0.1 * t)),
    "winding north-west": (-math.pi / 4.0, lambda t: 0.3 * math.sin(0.3 * t)),
}


@pytest.fixture(scope="module")
def start():
    return trim(Fdm(X8), airspeed=20.0, altitude=100.0)


@pytest.mark.parametrize("name", FLIGHTS)
def test_local_metres_are_the_integral_of_ground_velocity_over_a_long_flight(x8_aircraft, start, name):
    yaw, heading_rate = FLIGHTS[name]
    x8_aircraft.release(start.state(longitude=0.5, yaw=yaw), airspeed=20.0, altitude=100.0)
    fdm = x8_aircraft.fdm
    names = ("velocities/v-north-fps", "velocities/v-east-fps", "position/lat-geod-rad", "position/long-gc-rad")
    nodes = [fdm.node(n) for n in names]
    frame = LocalFrame(nodes[2].get_double_value(), nodes[3].get_double_value(), 100.0)
    steps = 200 * 120
    log = np.empty((steps + 1, 4))
    for i in range(steps + 1):
        log[i] = [node.get_double_value() for node in nodes]
        x8_aircraft.command_heading_rate(heading_rate(i * TIME_STEP))
        fdm.run()
    velocity = log[:, :2] * METRES_PER_FOOT
    integral = np.vstack([[0.0, 0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * TIME_STEP, axis=0)])
    local = np.array([to_local(frame, latitude, longitude) for latitude, longitude in log[:, 2:]])
    distance = 20.0 * 200.0
    # The class promises 1e-5 of the distance near the equator: here 4 cm in 4 km. Altitude moves by centimetres, no more.
    assert np.abs(local - integral).max() < 1e-5 * distance
    # And the flight went somewhere: circles of 200 m radius, or kilometres.
    assert np.hypot(*local.T).max() > 390.0
