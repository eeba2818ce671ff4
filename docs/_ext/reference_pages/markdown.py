"""Tables and texts in Markdown."""

from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Return the lines of a table.

    Parameters
    ----------
    head : names of the columns
    rows : cells, in Markdown; what would end a cell is escaped
    """
    lines = [_row(head), _row(["---"] * len(head))]
    return [*lines, *(_row(row) for row in rows), ""]


def literal(value: object) -> str:
    """Return a value in the type of code; nothing for nothing."""
    text = str(value)
    fence = "``" if "`" in text else "`"
    return f"{fence}{text}{fence}" if text else ""


def plain(text: str) -> str:
    """Return a text in which no character is markup."""
    return "".join(f"\\{letter}" if letter in r"\`*_[]<>#$" else letter for letter in text)


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", r"\|").replace("\n", " ") for cell in cells) + " |"
