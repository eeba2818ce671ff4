"""How values, distances, figures beside their limits and endings are written in a report's tables."""

import math

import pytest

from reports.document.tables import approach, beside_limit


@pytest.mark.parametrize(
    ("distance", "radius", "words"),
    [
        (212.345, 200.0, "212.3"), (199.96, 200.0, "199.9"), (199.9996, 200.0, "199.9"), (200.0, 200.0, "200.0"),
        (-0.04, 0.0, "−0.1"), (math.nan, 200.0, "–"),
    ],
)  # fmt: skip
def test_a_distance_is_written_on_the_side_of_the_radius_on_which_it_lies(distance, radius, words):
    assert approach(distance, radius) == words


@pytest.mark.parametrize(
    ("value", "bound", "words"),
    [
        (1.504, 1.5, "1.504"),
        (1.5, 1.5, "1.5"),
        (1.61, 1.5, "1.61"),
        (7.99996, 8.0, "7.99996"),
        (1234.0, 100.0, "1230"),
    ],
)
def test_a_figure_is_written_on_the_side_of_its_limit_on_which_it_lies(value, bound, words):
    assert beside_limit(value, bound) == words
