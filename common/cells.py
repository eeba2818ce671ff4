"""Text in cells of CSV tables, which spreadsheets open as well."""

import math

_FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""How a text begins that a spreadsheet computes."""

_TEXT = "'"
"""What is put before such a text, so that it is shown and not computed (OWASP, CSV injection)."""


def cell(value: object) -> object:
    """Return a value as it is written into a cell: what is missing is empty, numbers are numbers, and no text is a formula."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    return f"{_TEXT}{value}" if isinstance(value, str) and value.lstrip(_TEXT).startswith(_FORMULA) else value


def from_cell(value: object) -> object:
    """Return the value that ``cell`` wrote."""
    marked = isinstance(value, str) and value.startswith(_TEXT) and value.lstrip(_TEXT).startswith(_FORMULA)
    return str(value)[1:] if marked else value
