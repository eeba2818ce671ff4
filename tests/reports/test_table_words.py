"""How values, distances, figures beside their limits and endings are written in a report's tables."""

import math

import pytest

from reports.document.parameters import parameter_value
from reports.document.tables import approach, beside_limit


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ([], "none"),
        ({}, "none"),
        ("", "none"),
        (None, "not set"),
        ([1.0, 2.5], "1, 2.5"),
        ("/home/somebody/tracks/ship.csv", "ship.csv"),
        ([{"name": "calm_air", "set": {}}, {"name": "wind"}], "calm air, wind"),
        ({"wind.speed_mps": 4.0, "draws": [{"key": "wind.from_deg", "uniform": [0.0, 360.0]}]},
         "wind.speed_mps = 4, draws = wind.from_deg uniform 0, 360"),
        ({"title": "own", "channels": {"so2": {"t90_s": 15.0}}}, "title = own, channels = { so2 = { t90_s = 15 } }"),
    ],
)  # fmt: skip
def test_a_parameter_is_written_in_words(value, words):
    assert parameter_value(value) == words


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("fault.at_s", "100 to 250"),
        ("fault.1.at_s", "100 to 250"),
        ("start.place_m", "100, 250"),
        ("sweep.keepout.radius_m", "100, 250"),
    ],
)
def test_two_figures_are_a_range_where_their_key_has_limits(key, words):
    assert parameter_value([100.0, 250.0], key) == words


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
