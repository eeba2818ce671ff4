"""Hull and plume of a map."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from reports.document.ship_map import area_outline, hull_line, hull_words, plume_lines
from reports.run.flight_config import Hull, hull_of, outline_of


@pytest.mark.parametrize("angle", [0.0, 0.7, math.pi, -2.0])
def test_a_hull_is_to_scale_with_its_bow_at_the_angle(angle):
    line = hull_line(Hull(title="a ship", length=150.0, beam=23.0), angle, x=10.0, y=-5.0)
    ahead = np.array([math.sin(angle), math.cos(angle)])
    beside = np.array([math.cos(angle), -math.sin(angle)])
    along, across = (
        np.column_stack([line.x - 10.0, line.y + 5.0]) @ side for side in (ahead, beside)
    )
    # The funnel is a fifth of the length from the stern.
    assert (along.min(), along.max()) == pytest.approx((-30.0, 120.0))
    assert (across.min(), across.max()) == pytest.approx((-11.5, 11.5))
    assert (line.x[0], line.y[0]) == pytest.approx((line.x[-1], line.y[-1]))


def test_a_plume_begins_at_the_funnel_and_is_as_wide_as_given():
    width, axis = plume_lines(
        np.array([0.0, 100.0]), np.array([2.0, 10.0]), math.radians(90.0), x=1.0
    )
    # Along x: its width lies across, along y.
    assert (axis.x.tolist(), axis.y) == (pytest.approx([1.0, 101.0]), pytest.approx([0.0, 0.0]))
    assert (width.y.min(), width.y.max()) == pytest.approx((-10.0, 10.0))
    assert [line.label for line in plume_lines(np.array([0.0, 100.0]), None)] == ["plume's axis"]


GIVEN = {
    "vessel": {
        "length_m": 120.0,
        "beam_m": 18.0,
        "stack_from_bow_m": 90.0,
        "stack_from_port_m": 12.0,
    }
}


def test_a_ship_of_a_given_size_is_drawn_so_about_its_stack():
    hull = hull_of(GIVEN)
    line = hull_line(hull, 0.0, x=10.0, y=-5.0)
    assert (line.label, line.style) == ("ship, to scale", "thin")
    # 90 m ahead of the funnel and 30 m astern; 12 m to port and 6 m to starboard.
    assert (line.y.min(), line.y.max()) == pytest.approx((-35.0, 85.0))
    assert (line.x.min(), line.x.max()) == pytest.approx((-2.0, 16.0))
    assert hull_words(hull) == "its hull is 120 m by 18 m"


@pytest.mark.parametrize("angle", [0.0, 0.7, math.pi])
def test_the_area_about_a_hull_ends_r_min_from_its_outline(angle):
    about = SimpleNamespace(outline=outline_of(GIVEN), radius=200.0)
    x, y = area_outline(about, angle)
    assert (x[0], y[0]) == (x[-1], y[-1])
    # Back to places ahead of the funnel and to starboard of it.
    ahead = math.sin(angle) * x + math.cos(angle) * y
    starboard = math.cos(angle) * x - math.sin(angle) * y
    assert about.outline.distance(ahead, starboard) == pytest.approx(200.0)
