"""Where printed pages break: figures are whole, and tables go on over pages."""

from dataclasses import replace

import pypdfium2

from reports.document.blocks import Section, Table, Text
from reports.render.pdf import write_pdf
from tests.reports.test_blocks import a_chart, a_report


def pages_of(blocks, path):
    """Return the text of each page of a report, the second of which begins with these blocks."""
    # The first section is long enough to fill what page 1 has left.
    write_pdf(a_report([tall("filler", 0.9), *blocks]), path)
    document = pypdfium2.PdfDocument(path)
    texts = [page.get_textpage().get_text_range() for page in document]
    document.close()
    return texts


def tall(name, height):
    """Return a chart so high, over the width of the page; a page is 1.44 such widths high."""
    return replace(a_chart(name), panel_height=height)


def page_with(texts, words):
    return next(number for number, text in enumerate(texts, 1) if words in text)


def test_a_figure_goes_with_its_caption_on_the_next_page_where_it_does_not_fit(tmp_path):
    # With marks and captions 1.3 and 2.1 widths in all.
    for second, together in ((0.4, True), (1.2, False)):
        texts = pages_of([tall("one", 0.7), tall("two", second)], tmp_path / "report.pdf")
        assert (
            page_with(texts, "Caption of one") == page_with(texts, "Caption of two")
        ) is together


def test_what_follows_a_table_begins_below_its_last_row(tmp_path):
    rows = [[f"row {i}", "word " * (1 + 60 * (i % 3 == 0))] for i in range(78)]
    table = Table(
        head=["Row", "Words"], rows=rows, widths=[1.0, 3.0], breakable=True, caption="Table of rows"
    )
    texts = pages_of([tall("one", 0.5), table, tall("two", 0.5)], tmp_path / "report.pdf")
    begin, end = page_with(texts, "Table of rows"), page_with(texts, "row 77")
    assert begin == page_with(texts, "Caption of one")
    assert end == begin + 2
    # Each page repeats the head.
    assert all("Words" in text for text in texts[begin - 1 : end])
    assert page_with(texts, "Caption of two") in (end, end + 1)


def test_no_row_of_a_table_goes_on_over_the_next_page(tmp_path):
    rows = [[f"row {i}", f"begin{i} " + "word " * 300 + f"end{i}"] for i in range(20)]
    table = Table(
        head=["Row", "Words"], rows=rows, widths=[1.0, 3.0], breakable=True, caption="Table of rows"
    )
    texts = pages_of([table], tmp_path / "report.pdf")
    assert page_with(texts, "end19") > page_with(texts, "begin0")
    assert all(page_with(texts, f"begin{i} ") == page_with(texts, f"end{i}") for i in range(20))


def test_words_that_a_section_ends_with_stay_on_its_page_if_the_next_section_does_not_fit_there(
    tmp_path,
):
    # What failed, below the figures of the verdict: a section without words of its own, whose
    # figure fills a page, comes next.
    report = a_report([tall("filler", 0.9), tall("one", 0.5), Text("The words. " * 60)])
    following = Section(anchor="next", title="The next section", blocks=[tall("two", 1.1)])
    write_pdf(replace(report, sections=[*report.sections, following]), tmp_path / "report.pdf")
    document = pypdfium2.PdfDocument(tmp_path / "report.pdf")
    texts = [page.get_textpage().get_text_range() for page in document]
    document.close()
    assert page_with(texts, "The words.") == page_with(texts, "Caption of one")
    # Its heading goes along with its figure.
    assert "The next section" in texts[page_with(texts, "Caption of two") - 1]
    assert page_with(texts, "Caption of two") == page_with(texts, "Caption of one") + 1
