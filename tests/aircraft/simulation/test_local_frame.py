"""North and east metres against the globe that JSBSim flies on."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aircraft.dynamics.trim import trim
from aircraft.fleet.x8 import X8
from aircraft.simulation.fdm import TIME_STEP, Fdm
from aircraft.simulation.local_frame import EquatorFrame
from common.physics.geodesy import LocalFrame

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


def test_a_degree_has_its_surveyed_length():
    # WGS 84: near the equator a degree of latitude is 110 574 m, one of longitude 111 319 m (tables
    # after NIMA TR8350.2, in whole metres). Tolerance: that rounding, and a length against a radius
    # of curvature.
    frame, degree = EquatorFrame(), math.radians(1.0)
    assert frame.north_scale * degree == pytest.approx(110574.0, abs=1.0)
    assert frame.east_scale * degree == pytest.approx(111319.0, abs=1.0)


def test_higher_up_a_degree_is_longer():
    # By the ratio of radii: 1000 m in about 6378 km.
    assert EquatorFrame(1000.0).east_scale - EquatorFrame().east_scale == pytest.approx(
        1000.0, abs=1e-6
    )
    assert EquatorFrame(1000.0).north_scale - EquatorFrame().north_scale == pytest.approx(
        1000.0, abs=1e-6
    )


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
def test_local_metres_are_the_integral_of_ground_velocity_over_a_long_flight(
    x8_aircraft, start, name
):
    yaw, heading_rate = FLIGHTS[name]
    x8_aircraft.release(start.state(yaw=yaw), airspeed=20.0, altitude=100.0)
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
        x8_aircraft.command_heading_rate(heading_rate(i * TIME_STEP))
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
    # And the flight went somewhere: circles of 200 m radius, or kilometres.
    assert np.hypot(*local.T).max() > 390.0
