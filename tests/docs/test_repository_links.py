"""Links of pages that lead out of the documentation."""

from pathlib import Path

from repository_links import PAGES, with_links

DOCS = Path(__file__).parents[2] / "docs"


def test_a_folder_is_named_and_not_linked():
    assert with_links("see [`gnc/mission`](../gnc/mission).", DOCS, DOCS) == "see `gnc/mission`."


def test_a_file_stays_a_link():
    text = "[spec](../aircraft/spec.py), [page](results.md)"
    assert with_links(text, DOCS, DOCS) == text


def test_a_page_of_the_repository_is_the_page_of_the_documentation():
    text = with_links("[map](../../gnc/EQUATIONS.md)", DOCS / "explanation", DOCS)
    assert text == "[map](/equations.md)"


def test_every_such_page_exists():
    for source, page in PAGES.items():
        assert (DOCS.parent / source).is_file()
        assert (DOCS / page).is_file()
