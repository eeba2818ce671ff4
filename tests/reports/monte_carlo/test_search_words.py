"""What a report says of the methods of a search."""

import pandas as pd
import pytest

from reports.monte_carlo.driver_charts import not_shown
from reports.monte_carlo.falsification import _in_words, _methods


def test_only_methods_that_had_a_turn_are_said_to_have_searched():
    asked = ["corners", "differential_evolution", "local", "cma"]
    assert _methods(asked, {"corners", "local"}) == (
        "corner sampling, local climb (no point of differential evolution, CMA-ES was flown)"
    )
    assert (
        _methods(asked, set(asked))
        == "corner sampling, differential evolution, local climb, CMA-ES"
    )


VIOLATED = [(190.0, 1, "")] * 2 + [(250.0, 0, "")] * 38 + [(180.0, 1, "short_00000")] * 3
"""40 flights that were measured, 2 with a violation, and 3 repeats with one: closest approach,
violations, and what is repeated.
"""


def in_words(proposed, rows=VIOLATED):
    """Return what is said of flights that were measured, of which the search says 8 more."""
    flights = pd.DataFrame(rows, columns=["min_distance_m", "keepout_violations", "confirms"])
    flights = flights.assign(keepout_radius_m=200.0, search_method="corners")
    config = {
        "search": {"methods": ["corners"], "generations": 2, "population": 16, "time_s": None},
        "draws": [{}] * 4,
    }
    methods = {"corners": {"flights": 48}, "confirmation": {"flights": 3}}
    return _in_words(config, {"proposed": proposed, "methods": methods}, flights)


def test_repeats_are_no_violations_of_the_search_and_flights_without_a_measurement_not_beyond_what_is_declared():
    words = in_words(48)
    assert (
        "3 turns of 16 points, 40 flights; 8 more were not flown or not measured. 2 of the flights violated"
        in words
    )
    assert "the deepest by 10.0 m" in words
    assert "beyond what the scenario declares" not in words
    assert (
        "; 2 more points were not flown, as they lie beyond what the scenario declares. 2 of"
        in in_words(50)
    )
    assert (
        "; 1 more point was not flown, as it lies beyond what the scenario declares. 2 of"
        in in_words(49)
    )
    one = in_words(48, [*VIOLATED, *[(250.0, 0, "")] * 7])
    assert "47 flights; 1 more was not flown or not measured." in one


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (0, ""),
        (1, " 1 input with a smaller distance is not shown."),
        (3, " 3 inputs with a smaller distance are not shown."),
    ],
)
def test_inputs_that_a_figure_leaves_out_are_counted_in_words(more, words):
    assert not_shown(more, "distance") == words


def test_a_repeat_that_came_closer_than_the_search_is_told_beside_it():
    kept = [(265.1, 0, "")] * 40
    words = in_words(48, [*kept, (263.4, 0, "short_00000")])
    assert (
        "stayed 65.1 m outside the keep-out area. The closest repeat with fresh noise stayed 63.4 m outside. A search"
        in words
    )
    assert "repeat" not in in_words(48, [*kept, (270.0, 0, "short_00000")])
