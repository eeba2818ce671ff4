import math

import numpy as np
import pytest

from scenarios.measures.crossings import find_crossings


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
