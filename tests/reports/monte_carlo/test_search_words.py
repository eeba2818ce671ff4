"""What a report says of the methods of a search."""

from reports.monte_carlo.falsification import _methods


def test_only_methods_that_had_a_turn_are_said_to_have_searched():
    asked = ["corners", "differential_evolution", "local", "cma"]
    assert _methods(asked, {"corners", "local"}) == (
        "corner sampling, local climb (differential evolution, CMA-ES had no turn within the budget)"
    )
    assert _methods(asked, set(asked)) == "corner sampling, differential evolution, local climb, CMA-ES"
