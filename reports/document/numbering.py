"""Numbers of figures and tables, the same on the screen and in print, and the size of page 1's
picture.
"""

from collections.abc import Iterable
from dataclasses import replace
from itertools import count

from reports.document.blocks import Block, Heading, Section, Table
from reports.document.chart import Chart

PICTURE_HEIGHT = 0.7
"""Height of the panels of page 1's picture, over its width: what a printed page has room for below
the figures [-].
"""


def numbered(
    picture: Chart | None, sections: Iterable[Section]
) -> tuple[Chart | None, list[Section]]:
    """Return the picture of page 1 and sections with their figures and tables numbered in reading
    order.

    A table without a caption takes that of the heading right before it, which then is no heading
    any more, or else the last heading's or its section's title. Flights of a picker are numbered by
    what prints them: only some are printed.
    """
    figures, tables = count(1), count(1)
    if picture:
        picture = replace(
            picture,
            name="first",
            panel_height=(PICTURE_HEIGHT - picture.last_height) / picture.rows,
            number=f"Figure {next(figures)}",
        )
    return picture, [
        replace(section, blocks=_numbered(section, figures, tables)) for section in sections
    ]


def _numbered(section: Section, figures: "count[int]", tables: "count[int]") -> list[Block]:
    blocks: list[Block] = []
    title = section.title
    for block in section.blocks:
        if isinstance(block, Chart):
            blocks.append(replace(block, number=f"Figure {next(figures)}"))
        elif isinstance(block, Table):
            if not block.caption and blocks and isinstance(blocks[-1], Heading):
                blocks.pop()
            blocks.append(
                replace(block, number=f"Table {next(tables)}", caption=block.caption or title)
            )
        else:
            title = block.text if isinstance(block, Heading) else title
            blocks.append(block)
    return blocks


def figures_in(picture: Chart | None, sections: Iterable[Section]) -> int:
    """Return how many figures have numbers."""
    return bool(picture) + sum(
        isinstance(block, Chart) for section in sections for block in section.blocks
    )
