"""Distances from a hull, against a search over its outline."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.hull import ShipHull, ship_frame

HULL = ShipHull(length=120.0, beam=18.0, stack=(90.0, 12.0), antenna=(5.0, 9.0))


def outline(hull, points=4001):
    """Return points along the edge, ahead of the funnel and to starboard: from the corner at bow
    and port.
    """
    share = np.linspace(0.0, 1.0, points)[:, None]
    from_bow, from_port = hull.stack
    corners = np.array(
        [
            [from_bow, -from_port],
            [from_bow, hull.beam - from_port],
            [from_bow - hull.length, hull.beam - from_port],
            [from_bow - hull.length, -from_port],
        ]
    )
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


def test_the_antenna_is_seen_from_the_funnel():
    # 85 m ahead of it, and 3 m to port.
    assert HULL.antenna_offset == (85.0, -3.0)
    assert HULL.antenna_distance == pytest.approx(math.hypot(85.0, 3.0))


def test_a_place_north_of_a_ship_that_heads_east_is_to_port():
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
