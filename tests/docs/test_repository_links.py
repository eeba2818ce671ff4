"""Links of pages that lead out of the documentation."""

from pathlib import Path

from repository_links import PAGES

DOCS = Path(__file__).parents[2] / "docs"


def test_every_such_page_exists():
    for source, page in PAGES.items():
        assert (DOCS.parent / source).is_file()
        assert (DOCS / page).is_file()
