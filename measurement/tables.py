"""Tables of text: what separates their columns and decimals."""

from collections.abc import Iterable, Sequence

_OTHER_SEPARATORS = {";": "semicolons", "\t": "tabs"}
"""Of tables that are not separated by commas, and what they are called."""


def other_separator(head: str) -> str:
    """Return that a table is not separated by commas, by its head line, and the remedy; an empty
    text for one that is.
    """
    for separator, name in _OTHER_SEPARATORS.items():
        if head.count(separator) > head.count(","):
            return f"is separated by {name}; separate its columns by commas, and write decimals with a point, as in 108.2"
    return ""


def decimal_commas(row: Sequence[str], heads: Sequence[str], numbers: Iterable[int]) -> str:
    """Return that a row seems to have decimal commas, which separate its columns, too, and the
    remedy; otherwise an empty text.

    Parameters
    ----------
    row : its cells
    heads : names of the columns
    numbers : places of columns with numbers, of which one at least has decimals

    Such a row has more values than there are columns, and none with a point. One that ends in
    commas has no more.
    """
    ends = next((i for i in range(len(row), 0, -1) if row[i - 1].strip()), 0)
    if ends <= len(heads) or any("." in row[i] for i in numbers):
        return ""
    return f"has {ends} values for {len(heads)} columns; write decimals with a point, as in 108.2"
