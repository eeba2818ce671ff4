"""Tables of text: what separates their columns."""

_OTHER_SEPARATORS = {";": "semicolons", "\t": "tabs"}
"""Of tables that are not separated by commas, and what they are called."""


def other_separator(head: str) -> str:
    """Return that a table is not separated by commas, by its head line, and the remedy; nothing of one that is."""
    for separator, name in _OTHER_SEPARATORS.items():
        if head.count(separator) > head.count(","):
            return f"is separated by {name}; separate its columns by commas, and write decimals with a point, as in 108.2"
    return ""
