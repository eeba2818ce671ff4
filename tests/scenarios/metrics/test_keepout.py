import math

import numpy as np
import pytest

from scenarios.metrics.keepout import keepout_figures


def line(offset, speed=19.42, duration=40.0, step=0.1):
    """A straight path that passes ``offset`` metres beside the centre at half the duration."""
    time = np.arange(0.0, duration + step / 2, step)
    return time, np.column_stack([speed * (time - duration / 2), np.full(len(time), offset), 0.0 * time])


@pytest.mark.parametrize("offset", [0.0, 50.0, 199.0, 199.999])
def test_time_inside_is_the_chord_over_the_speed(offset):
    # A chord at distance a of a circle of radius r has the length 2 sqrt(r^2 - a^2). Straight between samples, so exact.
    figures = keepout_figures(*line(offset), radius=200.0)
    assert figures.time_inside == pytest.approx(2.0 * math.sqrt(200.0**2 - offset**2) / 19.42, rel=1e-9)
    assert figures.violations == 1
    assert figures.depth == pytest.approx(200.0 - offset, abs=1e-9)


def test_a_chord_shorter_than_a_sample_is_seen():
    # At 199.99995 m the chord is 0.28 m long; samples are 1.9 m apart.
    figures = keepout_figures(*line(199.99995), radius=200.0)
    assert figures.violations == 1
    assert figures.time_inside > 0.0


def test_passing_outside_is_no_violation():
    figures = keepout_figures(*line(200.001), radius=200.0)
    assert (figures.violations, figures.time_inside, figures.depth) == (0, 0.0, 0.0)
    assert figures.distance_min == pytest.approx(200.001, abs=1e-9)


def test_height_counts():
    time, position = line(0.0)
    position[:, 2] = 201.0
    assert keepout_figures(time, position, radius=200.0).violations == 0


def test_separate_stays_are_counted_apart():
    time, position = line(100.0)
    back_time, back = line(100.0)
    both = np.concatenate([position, back[::-1]])
    figures = keepout_figures(np.concatenate([time, time[-1] + 0.1 + back_time]), both, radius=200.0)
    assert figures.violations == 2


def test_a_path_that_starts_inside_counts_from_its_first_second():
    time, position = line(0.0)
    inside = slice(len(time) // 2, None)
    figures = keepout_figures(time[inside], position[inside], radius=200.0)
    assert figures.violations == 1
    assert figures.time_inside == pytest.approx(200.0 / 19.42, rel=1e-9)
