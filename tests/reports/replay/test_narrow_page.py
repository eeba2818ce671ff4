"""The head of a page in a narrow window: nothing runs off its edge."""

import pytest
from browser import PROGRAM, Browser

from reports.document.blocks import Content, Section, Text, Verdict
from reports.render.html import write_html
from reports.run.letterhead import Letterhead

pytestmark = pytest.mark.skipif(PROGRAM is None, reason="no chromium is installed; .ci/run installs it")

TITLES = (
    "Trials",
    "Criteria",
    "Speed ratio",
    "Comparison",
    "Failed flights",
    "Single flights",
    "Autopilot",
    "Parameters",
    "Provenance",
)

WIDTHS = (320, 500, 1000)
"""Of windows [px]."""


def test_every_link_of_the_navigation_is_within_the_window(tmp_path):
    sections = [Section(anchor=f"s{i}", title=title, blocks=[Text("Words.")]) for i, title in enumerate(TITLES)]
    verdict = Verdict(holds=True, complete=True, headline="All well", detail="", failures=[], figures=[])
    head = Letterhead(run="run", when="2026-11-23 08:00 UTC")
    words = {"title": "Title", "description": "", "changes": "", "flown": ""}
    report = Content(**words, letterhead=head, verdict=verdict, picture=None, sections=sections)
    write_html(report, tmp_path / "report.html")
    browser = Browser(tmp_path / "profile")
    try:
        browser.open(tmp_path / "report.html", width=WIDTHS[0])
        for width in WIDTHS:
            browser.resize(width)
            rights = browser.run("[...document.querySelectorAll('nav a')].map((link) => link.getBoundingClientRect().right)")
            # The link to the summary beside those to the sections.
            assert len(rights) == 1 + len(TITLES)
            assert max(rights) <= width
    finally:
        browser.close()
