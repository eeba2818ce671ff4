"""CSV tables with the wrong separator of columns or decimals, found before they are misread."""

from collections.abc import Iterable, Sequence

_OTHER_SEPARATORS = {";": "semicolons", "\t": "tabs"}


def other_separator(head: str) -> str:
    """Return the problem of a head line that is not separated by commas, or an empty text.

    The text continues a sentence about the table and says what to do.
    """
    for separator, name in _OTHER_SEPARATORS.items():
        if head.count(separator) > head.count(","):
            return (
                f"is separated by {name}; separate its columns by commas, and write decimals with"
                " a point, as in 108.2"
            )
    return ""


def decimal_commas(row: Sequence[str], heads: Sequence[str], numbers: Iterable[int]) -> str:
    """Return the problem of a row that seems to have decimal commas, or an empty text.

    Such a row has more values than there are columns, and no point in any of its ``numbers``, the
    columns with decimals. Commas at the end of a row do not count.
    """
    ends = next((i for i in range(len(row), 0, -1) if row[i - 1].strip()), 0)
    if ends <= len(heads) or any("." in row[i] for i in numbers):
        return ""
    return f"has {ends} values for {len(heads)} columns; write decimals with a point, as in 108.2"
