"""Names that are nearly right: the known name spelt most like an unknown one, names with another
unit; and words in one line.
"""

import difflib
from collections.abc import Iterable

_SHORT = 3
"""Letters of a name that counts as short."""


def one_line(words: str) -> str:
    """Return words in one line, without letters that a terminal takes for orders."""
    joined = " ".join(part for line in words.splitlines() if (part := line.strip()))
    return "".join(
        letter if letter.isprintable() else letter.encode("unicode_escape").decode()
        for letter in joined
    )


def nearest(name: str, known: Iterable[str]) -> str | None:
    """Return the known name that is spelt most like ``name``, whatever its case, or None if none is
    similar.

    One that only has a letter more at its end comes before others that are as similar.
    """
    by_lower_case = {each.lower(): each for each in known}
    begun = [
        each
        for each in by_lower_case
        if each.startswith(name.lower()) and len(each) == len(name) + 1
    ]
    if begun and name.lower() not in by_lower_case:
        return by_lower_case[min(begun)]
    # Of a short name one letter is much.
    cutoff = 0.5 if len(name) <= _SHORT else 0.6
    close = difflib.get_close_matches(name.lower(), by_lower_case, n=1, cutoff=cutoff)
    return by_lower_case[close[0]] if close else None


def other_units(heads: Iterable[str], columns: Iterable[str]) -> str:
    """Return, as a remedy, which of ``heads`` are those of missing ``columns`` but for the unit at
    their end, or nothing.
    """
    known = set(heads)
    missing = {
        column.rpartition("_")[0]: column
        for column in columns
        if "_" in column and column not in known
    }
    pairs = [
        (head, missing[stem]) for head in heads if (stem := head.rpartition("_")[0]) in missing
    ]
    return "; ".join(
        f"'{head}' is in another unit than '{column}': convert its values before you rename it"
        for head, column in pairs
    )


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return ``; did you mean 'x'?`` for the known name nearest to ``name``, or nothing if none is
    similar.
    """
    found = nearest(name, known)
    return f"; did you mean '{found}'?" if found else ""
