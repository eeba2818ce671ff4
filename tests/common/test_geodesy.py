"""North and east metres anywhere on the ellipsoid, against GeographicLib."""

import math

import numpy as np
import pytest
from geographiclib.geodesic import Geodesic
from hypothesis import given
from hypothesis import strategies as st

from common.geodesy import EQUATORIAL_RADIUS, FLATTENING, LocalFrame

PLACES = [
    (0.0, 0.0),
    (57.5, 11.3),
    (-33.0, 179.99),
    (78.2, -180.0),
    (89.95, 12.0),
    (90.0, 0.0),
    (-90.0, 45.0),
    (1e-7, 180.0),
]
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
            back = [
                math.degrees(float(angle)) for angle in frame.to_geodetic(*along(azimuth, distance))
            ]
            assert Geodesic.WGS84.Inverse(*back, there["lat2"], there["lon2"])["s12"] < 2e-4


@pytest.mark.parametrize(("latitude", "longitude"), PLACES)
def test_true_north_is_where_the_geodesic_arrives_from(latitude, longitude):
    frame = LocalFrame(math.radians(latitude), math.radians(longitude))
    for azimuth in range(5, 360, 35):
        there = Geodesic.WGS84.Direct(latitude, longitude, azimuth, 20e3)
        # A geodesic is straight in this frame: its azimuth there is from true north.
        north = float(frame.true_north(math.radians(there["lat2"]), math.radians(there["lon2"])))
        # Vectors are projected, not carried along: d^2/(4 R^2), 2.5e-6 rad at 20 km.
        assert math.remainder(
            north - math.radians(azimuth - there["azi2"]), math.tau
        ) == pytest.approx(0.0, abs=3e-6)


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
    assert [float(x) for x in frame.to_local(*frame.to_geodetic(north, east))] == pytest.approx(
        [north, east], abs=0.02
    )


def test_arrays_of_places_are_the_places_one_by_one():
    frame = LocalFrame(1.0, 3.1)
    north, east = np.linspace(-5e3, 5e3, 7), np.linspace(9e3, -2e3, 7)
    together = np.column_stack(frame.to_geodetic(north, east))
    one_by_one = [
        [float(angle) for angle in frame.to_geodetic(n, e)]
        for n, e in zip(north, east, strict=True)
    ]
    np.testing.assert_array_equal(together, one_by_one)
    np.testing.assert_allclose(
        np.column_stack(frame.to_local(*together.T)),
        np.column_stack([north, east]),
        rtol=0.0,
        atol=1e-3,
    )


def test_the_ellipsoid_is_wgs_84():
    assert (Geodesic.WGS84.a, pytest.approx(Geodesic.WGS84.f, rel=1e-15)) == (
        EQUATORIAL_RADIUS,
        FLATTENING,
    )
