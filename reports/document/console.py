"""Tables on the console."""

import sys

from rich.console import Console
from rich.table import Table as ConsoleTable
from rich.text import Text

from reports.document.blocks import Table

_WIDTH = 140
"""Characters of a line where the output is not a terminal, which would give its width."""


def wide_console() -> Console:
    """Return a console on standard output that is as wide as the terminal, or as tables need where
    there is none.
    """
    return Console(width=None if sys.stdout.isatty() else _WIDTH)


def console_table(title: str, table: Table) -> ConsoleTable:
    """Return a table as the console prints it."""
    printed = ConsoleTable(title=Text(title), title_justify="left", box=None, pad_edge=False)
    for i, name in enumerate(table.head):
        printed.add_column(Text(name), justify="left" if i < table.left_columns else "right")
    for row in table.rows:
        printed.add_row(*(Text(cell) for cell in row))
    return printed
