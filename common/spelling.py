"""The known name that is spelt most like an unknown one."""

import difflib
from collections.abc import Iterable

_SHORT = 3
"""Letters of a name that counts as short."""


def nearest(name: str, known: Iterable[str]) -> str | None:
    """Return the known name that is spelt most like ``name``, whatever its case, or None if none is similar."""
    by_lower_case = {each.lower(): each for each in known}
    # Of a short name one letter is much.
    cutoff = 0.5 if len(name) <= _SHORT else 0.6
    close = difflib.get_close_matches(name.lower(), by_lower_case, n=1, cutoff=cutoff)
    return by_lower_case[close[0]] if close else None


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return ``; did you mean 'x'?`` for the known name nearest to ``name``, or nothing if none is similar."""
    found = nearest(name, known)
    return f"; did you mean '{found}'?" if found else ""
