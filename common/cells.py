"""Text in cells of CSV tables, which spreadsheets open as well."""

import math

_FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""How a text begins that a spreadsheet computes."""

MARK = "'"
"""What is put before such a text, so that it is shown and not computed (OWASP, CSV injection)."""


def cell(value: object) -> object:
    """Return a value as it is written into a cell: what is missing is empty, numbers are numbers,
    and no text is a formula.
    """
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    return (
        f"{MARK}{value}"
        if isinstance(value, str) and value.lstrip(MARK).startswith(_FORMULA)
        else value
    )


def from_cell(value: object) -> object:
    """Return the value that ``cell`` wrote."""
    marked = (
        isinstance(value, str)
        and value.startswith(MARK)
        and value.lstrip(MARK).startswith(_FORMULA)
    )
    return str(value)[1:] if marked else value
