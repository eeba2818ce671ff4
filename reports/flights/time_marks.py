"""Marks of the time along a track, with words where they hide little."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from reports.document.chart import Line, Note
from reports.document.palette import Meaning
from reports.run.columns import Array

_LETTER, _HEIGHT, _OFF = 0.028, 0.05, 0.02
"""Width of a letter, height of a word, and its distance from its mark, over the size of what is
shown.
"""

_APART, _UNDER = 0.12, 0.012
"""Distance of words in a row at least, and of a word from the end of the line that leads to it from
its mark, over the length of the row.
"""

TIMES = "time since the start"
"""What the legend calls the marks."""


class _Word(NamedTuple):
    """Where a word may stand: its middle, half its size, and the end of it that stands at
    ``at``.
    """

    middle: tuple[float, float]
    half: tuple[float, float]
    at: float
    align: Literal["left", "center", "right"]

    def hides(self, places: Array) -> int:
        """Return how many of some places, shape (n, 2), the word covers."""
        return int(np.all(np.abs(places - self.middle) < self.half, axis=1).sum())

    def touches(self, other: "_Word") -> bool:
        """Return whether it overlaps another word."""
        return all(
            abs(self.middle[i] - other.middle[i]) < self.half[i] + other.half[i] for i in (0, 1)
        )


def marks_beside(
    x: Array, y: Array, words: Sequence[str], drawn: Sequence[Line], size: float
) -> tuple[list[Line], list[Note]]:
    """Return marks, each with its word to that side of it where it covers the least; a mark whose
    word has no room is left out.

    Parameters
    ----------
    x, y : of the marks, shape (n,)
    words : of each
    drawn : what is drawn besides
    size : of what is shown, in the units of the axes
    """
    places = np.concatenate([np.empty((0, 2)), *(np.column_stack([of.x, of.y]) for of in drawn)])
    taken: dict[int, _Word] = {}
    for i, text in enumerate(words):
        half = 0.5 * _LETTER * len(text) * size, 0.5 * _HEIGHT * size
        off, right, up = _OFF * size, float(x[i]), float(y[i])
        sides = (
            _Word((right + off + half[0], up), half, right + off, "left"),
            _Word((right - off - half[0], up), half, right - off, "right"),
            _Word((right, up + off + half[1]), half, right, "center"),
            _Word((right, up - off - half[1]), half, right, "center"),
        )
        free = [word for word in sides if not any(word.touches(of) for of in taken.values())]
        if free:
            taken[i] = min(free, key=lambda word: word.hides(places))
    notes = [
        Note(x=word.at, y=word.middle[1], text=words[i], align=word.align)
        for i, word in taken.items()
    ]
    return _dots(x[list(taken)], y[list(taken)]), notes


def marks_in_a_row(
    x: Array, y: Array, words: Sequence[str], height: float, length: float
) -> tuple[list[Line], list[Note]]:
    """Return marks along a track that goes across the page, and their words at a height above it,
    as many as there is room for.

    A line leads from a mark to its word.
    """
    notes: list[Note] = []
    lines = _dots(x, y)
    for right, above, text in zip(x.tolist(), y.tolist(), words, strict=True):
        if all(abs(right - of.x) > _APART * length for of in notes):
            notes.append(Note(x=right, y=height, text=text))
            # From far above its mark a word could be that of any.
            leads = np.array([above, height - _UNDER * length])
            lines.append(
                Line(x=np.full(2, right), y=leads, label="", colour=Meaning.SHIP, style="thin")
            )
    return lines, notes


def _dots(x: Array, y: Array) -> list[Line]:
    return [Line(x=x, y=y, label=TIMES, colour=Meaning.SHIP, style="dots")] if len(x) else []
