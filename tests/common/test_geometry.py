"""Distances from a hull, places on the ellipsoid, units and coordinated turns."""

import math

import numpy as np
import pytest
from geographiclib.geodesic import Geodesic
from hypothesis import given
from hypothesis import strategies as st

from common.geodesy import LocalFrame
from common.hull import ShipHull, ship_frame
from common.physics import bank_for_heading_rate, heading_rate_for_bank

HULL = ShipHull(length=120.0, beam=18.0, stack=(90.0, 12.0), antenna=(5.0, 9.0))


def outline(hull, points=4001):
    """Return points along the edge, ahead of the funnel and to starboard."""
    share = np.linspace(0.0, 1.0, points)[:, None]
    from_bow, from_port = hull.stack
    right, stern = hull.beam - from_port, from_bow - hull.length
    corners = [[from_bow, -from_port], [from_bow, right], [stern, right], [stern, -from_port]]
    after = np.roll(corners, -1, axis=0)
    return np.vstack([a + share * (b - a) for a, b in zip(corners, after, strict=True)])


@given(st.floats(-400.0, 400.0), st.floats(-300.0, 300.0))
def test_the_distance_is_that_of_the_nearest_point_of_the_outline(ahead, starboard):
    inside = -30.0 <= ahead <= 90.0 and -12.0 <= starboard <= 6.0
    nearest = np.hypot(*(outline(HULL) - (ahead, starboard)).T).min()
    found = float(HULL.distance(np.array(ahead), np.array(starboard)))
    # The points of the outline are 3 cm apart; one beside the nearest adds 15 mm at most.
    assert found == (0.0 if inside else pytest.approx(nearest, abs=0.016))


def test_the_farthest_point_is_a_corner():
    assert HULL.farthest == pytest.approx(np.hypot(*outline(HULL).T).max())
    assert np.hypot(*HULL.corners().T).max() == pytest.approx(HULL.farthest)


@given(st.floats(-math.pi, math.pi))
def test_the_reach_on_a_bearing_ends_on_the_outline(bearing):
    reach = HULL.reach(bearing)
    place = reach * np.array([math.cos(bearing), math.sin(bearing)])
    assert np.hypot(*(outline(HULL) - place).T).min() < 0.016
    assert float(HULL.distance(*(0.999 * place))) == 0.0


def test_places_are_seen_from_the_funnel():
    # The antenna is 85 m ahead of it, and 3 m to port.
    assert HULL.antenna_offset == (85.0, -3.0)
    assert HULL.antenna_distance == pytest.approx(math.hypot(85.0, 3.0))
    # A place north of a ship that heads east is to port.
    ahead, starboard = ship_frame(np.array(100.0), np.array(0.0), np.array(0.5 * math.pi))
    assert (float(ahead), float(starboard)) == pytest.approx((0.0, -100.0), abs=1e-9)


def test_the_edge_about_a_hull_is_as_far_from_it_everywhere_and_goes_once_round():
    bearing = np.append(np.linspace(0.0, 2.0 * np.pi, 181), 0.0)
    ahead, starboard = HULL.around(200.0, bearing)
    assert HULL.distance(ahead, starboard) == pytest.approx(200.0)
    assert (ahead[0], starboard[0]) == (ahead[-1], starboard[-1])
    # Around a rectangle: its sides and a whole circle, whose chords are short of the arcs by 5e-5.
    length = np.hypot(np.diff(ahead), np.diff(starboard)).sum()
    assert length == pytest.approx(2.0 * (120.0 + 18.0) + 2.0 * math.pi * 200.0, rel=1e-4)


PLACES = [
    (0.0, 0.0), (57.5, 11.3), (-33.0, 179.99), (78.2, -180.0), (89.95, 12.0), (90.0, 0.0), (-90.0, 45.0), (1e-7, 180.0),
]  # fmt: skip
"""Latitude and longitude [deg]: the equator, the Kattegat, the date line from both sides, near and
on the poles.
"""


def along(azimuth, distance):
    return distance * math.cos(math.radians(azimuth)), distance * math.sin(math.radians(azimuth))


@pytest.mark.parametrize(("latitude", "longitude"), PLACES)
def test_places_within_20_km_are_where_the_geodesic_leads(latitude, longitude):
    frame = LocalFrame(math.radians(latitude), math.radians(longitude))
    for distance in (1.0, 3e3, 11e3, 20e3):
        for azimuth in range(0, 360, 15):
            there = Geodesic.WGS84.Direct(latitude, longitude, azimuth, distance)
            local = frame.to_local(math.radians(there["lat2"]), math.radians(there["lon2"]))
            # Asked for is 1 cm; the arc's radius of curvature is the origin's: measured 0.11 mm at
            # 20 km.
            assert math.dist([float(x) for x in local], along(azimuth, distance)) < 2e-4
            back = np.degrees(frame.to_geodetic(*along(azimuth, distance)))
            assert Geodesic.WGS84.Inverse(*back, there["lat2"], there["lon2"])["s12"] < 2e-4


@pytest.mark.parametrize(("latitude", "longitude"), PLACES)
def test_true_north_is_where_the_geodesic_arrives_from(latitude, longitude):
    frame = LocalFrame(math.radians(latitude), math.radians(longitude))
    for azimuth in range(5, 360, 35):
        there = Geodesic.WGS84.Direct(latitude, longitude, azimuth, 20e3)
        # A geodesic is straight in this frame: its azimuth there is from true north.
        north = float(frame.true_north(math.radians(there["lat2"]), math.radians(there["lon2"])))
        # Vectors are projected, not carried along: d^2/(4 R^2), 2.5e-6 rad at 20 km.
        off = math.remainder(north - math.radians(azimuth - there["azi2"]), math.tau)
        assert off == pytest.approx(0.0, abs=3e-6)


@given(
    latitude=st.floats(-90.0, 90.0),
    longitude=st.floats(-180.0, 180.0),
    north=st.floats(-50e3, 50e3),
    east=st.floats(-50e3, 50e3),
)
def test_places_come_back(latitude, longitude, north, east):
    frame = LocalFrame(math.radians(latitude), math.radians(longitude))
    # There and back the same radius is taken; rounding of 6.4e6 m is 1e-9 m. Bowring's latitude is
    # good to 1e-11 rad here.
    back = [float(x) for x in frame.to_local(*frame.to_geodetic(north, east))]
    assert back == pytest.approx([north, east], abs=0.02)


def test_arrays_of_places_are_the_places_one_by_one():
    frame = LocalFrame(1.0, 3.1)
    north, east = np.linspace(-5e3, 5e3, 7), np.linspace(9e3, -2e3, 7)
    together = np.column_stack(frame.to_geodetic(north, east))
    places = zip(north, east, strict=True)
    one_by_one = [[float(angle) for angle in frame.to_geodetic(*place)] for place in places]
    np.testing.assert_array_equal(together, one_by_one)
    np.testing.assert_allclose(frame.to_local(*together.T), [north, east], rtol=0.0, atol=1e-3)


@pytest.mark.parametrize("bank_deg", [0.0, 20.0, 45.0, 60.0])
def test_a_coordinated_turn_balances_gravity(bank_deg):
    # tan(bank) = V omega/g; tan and atan, each to a rounding.
    bank, speed = math.radians(bank_deg), 19.42
    rate = heading_rate_for_bank(bank, speed)
    assert math.atan(speed * rate / 9.80665) == pytest.approx(bank, rel=1e-14)
    assert bank_for_heading_rate(rate, speed) == pytest.approx(bank, abs=1e-15)
