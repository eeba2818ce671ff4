"""How a path keeps out of an area, and where it crosses the plume's axis: closed forms."""

import math

import numpy as np
import pytest

from common.hull import ShipHull
from scenarios.measures.crossings import find_crossings
from scenarios.measures.keepout import closest_approach, hull_keepout_figures, keepout_figures


def line(offset, speed=19.42, duration=40.0, step=0.1):
    """A straight path that passes ``offset`` metres beside the centre at half the duration."""
    time = np.arange(0.0, duration + step / 2, step)
    position = np.column_stack(
        [speed * (time - duration / 2), np.full(len(time), offset), 0.0 * time]
    )
    return time, position, np.tile([speed, 0.0, 0.0], (len(time), 1))


def turn(bearing, *, nearest=200.0, radius=38.6, speed=19.42, step=0.1):
    """A circle, flown at 45 degrees of bank, that comes as near as ``nearest`` when it has turned
    by ``bearing`` [rad].

    38.6 m is the radius V^2/g at 19.42 m/s.
    """
    time = np.arange(0.0, 10.0, step)
    angle = speed / radius * time - bearing
    position = np.column_stack(
        [nearest + radius * (1.0 - np.cos(angle)), radius * np.sin(angle), 0.0 * time]
    )
    velocity = speed * np.column_stack([np.sin(angle), np.cos(angle), 0.0 * time])
    return time, position, velocity


def test_time_inside_is_the_chord_over_the_speed():
    # A chord at distance a of a circle of radius r has the length 2 sqrt(r^2 - a^2). Straight
    # between samples, so exact. At 199.99995 m it is 0.28 m long, and samples are 1.9 m apart.
    for offset in (0.0, 50.0, 199.0, 199.999, 199.99995):
        figures = keepout_figures(*line(offset), radius=200.0)
        chord = 2.0 * math.sqrt(200.0**2 - offset**2)
        assert figures.time_inside == pytest.approx(chord / 19.42, rel=1e-5)
        assert figures.violations == 1
        assert figures.depth == pytest.approx(200.0 - offset, abs=1e-9)


def test_passing_outside_is_no_violation():
    figures = keepout_figures(*line(200.001), radius=200.0)
    assert (figures.violations, figures.time_inside, figures.depth) == (0, 0.0, 0.0)
    assert figures.distance_min == pytest.approx(200.001, abs=1e-9)


def test_a_cylinder_is_as_wide_at_every_height():
    # At 60 degrees of elevation the orbit is 200 m from the funnel, and 100 m beside it: outside
    # the sphere, inside the cylinder.
    time, position, velocity = line(100.0)
    position[:, 2] = 200.0 * math.sin(math.radians(60.0)) + 0.001
    assert keepout_figures(time, position, velocity, radius=200.0, shape="sphere").violations == 0
    figures = keepout_figures(time, position, velocity, radius=200.0, shape="cylinder")
    assert (figures.violations, figures.distance_min) == (1, pytest.approx(100.0, abs=1e-9))
    assert closest_approach(time, position[:, :2], velocity[:, :2]) == pytest.approx(
        100.0, abs=1e-9
    )


@pytest.mark.parametrize("bearing", [1.0, 1.0 + 0.5 * 0.1 * 19.42 / 38.6])
def test_closest_approach_is_exact_between_samples(bearing):
    # The samples are at multiples of 0.0503 rad, so that the circle is nearest somewhere between
    # two of them.
    figures = keepout_figures(*turn(bearing), radius=200.0)
    # The cubic follows a circle to h^4/384 r w^4 = 6e-7 m; the chord between two samples lies up to
    # 1.2 cm off.
    assert figures.distance_min == pytest.approx(200.0, abs=1e-6)


def test_a_dip_between_two_samples_outside_is_seen():
    # Midway between two samples: those are 1.2 cm farther out than the nearest point, and the chord
    # between them does not curve.
    bearing = 20.5 * 0.1 * 19.42 / 38.6
    figures = keepout_figures(*turn(bearing), radius=200.004)
    assert figures.violations == 1
    # It is inside for as long as r (1 - cos) stays below 4 mm, but for the curvature of the sphere,
    # which makes that 8 % shorter.
    duration = 2.0 * math.sqrt(2.0 * 0.004 / 38.6 / (1.0 + 38.6 / 200.0)) * 38.6 / 19.42
    assert figures.time_inside == pytest.approx(duration, rel=1e-3)


def test_separate_stays_are_counted_apart():
    time, position, velocity = line(100.0)
    there_and_back = np.concatenate([time, time[-1] + 0.1 + time])
    both = np.concatenate([position, position[::-1]])
    rates = np.concatenate([velocity, -velocity[::-1]])
    assert keepout_figures(there_and_back, both, rates, radius=200.0).violations == 2


@pytest.mark.parametrize("half", [slice(200, None), slice(None, 201)])
def test_a_path_that_starts_or_ends_inside_is_measured_to_its_end(half):
    figures = keepout_figures(*(values[half] for values in line(100.0)), radius=200.0)
    assert figures.violations == 1
    inside = math.sqrt(200.0**2 - 100.0**2) / 19.42
    assert figures.time_inside == pytest.approx(inside, rel=1e-9)
    assert figures.distance_min == pytest.approx(100.0, abs=1e-9)


HULL = ShipHull(length=400.0, beam=60.0, stack=(320.0, 30.0), antenna=(320.0, 30.0))


def beside(offset, *, height=0.0, heading=0.0, shape="sphere", radius=200.0):
    """Return the figures of a straight way north, ``offset`` metres to starboard of the funnel of a
    ship on a heading.
    """
    time, position, velocity = line(offset)
    position[:, 2] = height
    return hull_keepout_figures(
        time, position, velocity, radius, shape, HULL, lambda times: np.full(len(times), heading)
    )


def test_beside_a_hull_the_distance_is_that_from_its_side():
    # From 388.4 m south of the funnel to as far north of it, which is 68.4 m ahead of the bow.
    figures = beside(230.5)
    assert figures.distance_min == pytest.approx(200.5, abs=1e-9)
    assert (figures.violations, figures.time_inside, figures.depth) == (0, 0.0, 0.0)
    # Inside up to sqrt(200^2 - 170^2) = 105.4 m behind the stern, 80 m from the funnel, and as far
    # ahead of the bow, where the way has ended.
    inside = beside(200.0)
    assert inside.depth == pytest.approx(30.0, abs=1e-9)
    assert inside.violations == 1
    way = 388.4 + 80.0 + math.sqrt(200.0**2 - 170.0**2)
    # Where the way begins inside, that is a stay, too.
    assert beside(200.0, heading=math.pi).violations == 1
    assert inside.time_inside == pytest.approx(way / 19.42, abs=1e-4)

    # The height counts about a hull and not about a prism.
    assert beside(150.0, height=50.0).distance_min == pytest.approx(math.hypot(120.0, 50.0))
    assert beside(150.0, height=50.0, shape="cylinder").distance_min == pytest.approx(120.0)
    # Ahead of a ship that heads east: the bow is 320 m east of the funnel.
    assert beside(500.0, heading=0.5 * math.pi).distance_min == pytest.approx(180.0, abs=1e-9)


def test_about_a_hull_of_no_size_figures_are_those_about_a_point():
    small = ShipHull(length=1e-6, beam=1e-6, stack=(0.0, 0.0), antenna=(0.0, 0.0))
    way = line(150.0)
    about_hull = hull_keepout_figures(
        *way, 200.0, "sphere", small, lambda times: np.zeros(len(times))
    )
    about_point = keepout_figures(*way, radius=200.0)
    assert about_hull.distance_min == pytest.approx(about_point.distance_min, abs=1e-4)
    # Looks are 10 ms apart, and the edge between two of them is found on a straight line.
    assert about_hull.time_inside == pytest.approx(about_point.time_inside, abs=1e-4)
    assert about_hull.violations == about_point.violations


def axis(course=math.pi):
    """Return the unit vector along a plume that trails on a course [rad]."""
    return math.cos(course), math.sin(course)


def straight(start, velocity, duration=20.0, step=0.1):
    time = np.arange(0.0, duration, step)
    return time, np.array(start) + np.outer(time, velocity), np.tile(velocity, (len(time), 1))


def test_a_curved_path_is_timed_far_better_than_its_samples():
    # A circle of 38.6 m at 0.503 rad/s (45 degrees of bank), sampled at 10 Hz. It cuts the axis
    # where its phase says. A cubic through positions and velocities errs by R (omega dt)^4/384 =
    # 0.6 um, over 19.4 m/s: below 1e-6 s.
    radius, rate = 38.6, 0.503
    time = np.arange(0.0, 12.0, 0.1)
    angle = rate * time + 0.3
    position = np.column_stack(
        [-214.0 + radius * np.cos(angle), 10.0 + radius * np.sin(angle), 0.0 * time]
    )
    velocity = np.column_stack(
        [-radius * rate * np.sin(angle), radius * rate * np.cos(angle), 0.0 * time]
    )
    crossings = find_crossings(time, position, velocity, axis())
    down = math.pi - math.asin(-10.0 / radius)  # sin(angle) = -10/R on the way down
    up = 2.0 * math.pi + math.asin(-10.0 / radius)
    assert [c.time for c in crossings] == pytest.approx(
        [(down - 0.3) / rate, (up - 0.3) / rate], abs=1e-6
    )


def test_crossings_of_a_rising_plume_know_their_height_above_it():
    # 200 m astern on an axis that rises 10 degrees, the axis is 200 tan(10) above its origin, and
    # 200/cos(10) along it.
    elevation = math.radians(10.0)
    on_axis = 200.0 * math.tan(elevation)
    crossings = find_crossings(
        *straight((-200.0, -100.0, on_axis + 1.5), (0.0, 19.42, 0.0)), axis(), elevation
    )
    assert crossings[0].height == pytest.approx(1.5, abs=1e-9)
    assert crossings[0].axis_distance == pytest.approx(200.0 / math.cos(elevation), abs=1e-9)
    assert crossings[0].distance == pytest.approx(math.hypot(200.0, on_axis + 1.5), abs=1e-9)
