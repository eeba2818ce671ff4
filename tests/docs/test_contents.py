"""The contents of the documentation: every page is in them once, so that none is lost."""

import re
from pathlib import Path

import pytest
from generated_pages import FOLDER, pages

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.slow
def test_every_page_is_in_the_contents_once():
    """``make docs`` refuses a page that is not; this says so before."""
    blocks = re.findall(
        r"```\{toctree\}\n(.*?)```", (DOCS / "index.md").read_text("utf-8"), re.DOTALL
    )
    listed = [
        line for block in blocks for line in block.splitlines() if line and not line.startswith(":")
    ]
    written = {
        path.relative_to(DOCS)
        for path in DOCS.rglob("*.md")
        if not {FOLDER, "_build"} & set(path.relative_to(DOCS).parts)
    }
    made = {f"{FOLDER}/{name[:-3]}" for name in pages() if name.endswith(".md") and "/" not in name}
    assert sorted(listed) == sorted(
        made | {path.with_suffix("").as_posix() for path in written} - {"index"}
    )
