"""The scenario file of the short search."""

import pytest

from tests.scenarios.short_search import SEARCH


@pytest.fixture(scope="module")
def search(tmp_path_factory):
    path = tmp_path_factory.mktemp("search") / "short.toml"
    path.write_text(SEARCH, encoding="utf-8")
    return path
