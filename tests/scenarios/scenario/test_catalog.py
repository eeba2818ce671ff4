"""The catalog and its bases."""

import tomllib

import pytest

from scenarios.scenario.files import catalog, load_study


def own(path):
    """Return what a file itself says."""
    return tomllib.loads(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", catalog())
def test_every_scenario_of_the_catalog_is_valid_and_says_what_it_is(name):
    study = load_study(name)
    assert study.title
    assert study.description.endswith(".")
    # By today's words.
    assert own(catalog()[name]).get("study", "flights") == study.study
