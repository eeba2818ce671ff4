import numpy as np
import pytest

from scenarios.interventions import interventions


def test_each_stretch_of_the_guard_is_one_row():
    time = 0.1 * np.arange(10)
    guard = np.array([0, 1, 1, 0, 0, 1, 2, 1, 0, 1], dtype=float)
    distance = np.array([230, 225, 221, 219, 240, 212, 205, 207, 209, 216], dtype=float)
    found = interventions(time, guard, distance)
    # Read off the lists above: samples 1-2, 5-7 and 9, a tenth of a second each.
    assert [row["time_s"] for row in found] == pytest.approx([0.1, 0.5, 0.9], abs=1e-12)
    assert [row["duration_s"] for row in found] == pytest.approx([0.2, 0.3, 0.1], abs=1e-12)
    assert [row["distance_min_m"] for row in found] == [221.0, 205.0, 216.0]
    assert [row["lost"] for row in found] == [False, True, False]


def test_a_flight_that_the_guard_left_alone_has_none():
    assert interventions(np.arange(5.0), np.zeros(5), np.full(5, 300.0)) == []
