"""Marks of the time along a track, with words where they hide nothing and nothing hides them."""

from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple

import numpy as np

from reports.document.chart import Line, Note
from reports.document.palette import Meaning
from reports.run.columns import Array

_LETTER, _HEIGHT = 0.028, 0.05
"""Width of a letter and height of a word, over the size of what is shown."""

_OFF = 0.02
"""Distance of a word from its mark, over the same."""

_PASSES_MAX = 1
"""Curves that may go through a word; one that would hide or be hidden by more has no mark either.
"""

_POINTS = 200
"""Points of a curve at least that are looked at: a straight line has two."""

_APART = 0.12
"""Distance of words in a row at least, over its length."""

_UNDER = 0.012
"""Distance of a word in a row from the end of the line that leads to it from its mark, over the
length of the row.
"""

TIMES = "time since the start"
"""What the legend calls the marks."""


class _Word(NamedTuple):
    """Where a word may stand: its middle, half its size, and the end of it that stands at ``at``."""

    middle: tuple[float, float]
    half: tuple[float, float]
    at: float
    align: Literal["left", "center", "right"]


def marks_beside(
    x: Array, y: Array, words: Sequence[str], drawn: Sequence[Line], size: float
) -> tuple[list[Line], list[Note]]:
    """Return marks, each with its word to a side or a corner of it, where the fewest curves are.

    Parameters
    ----------
    x, y : of the marks, shape (n,)
    words : of each
    drawn : what is drawn besides
    size : of what is shown, in the units of the axes
    """
    kept: list[int] = []
    notes: list[Note] = []
    taken: list[_Word] = []
    # Beyond all curves the figure may end, and cut a word off.
    points = np.concatenate(
        [np.empty((0, 2)), *(np.column_stack([line.x, line.y]) for line in drawn)]
    )
    points = points[np.isfinite(points).all(axis=1)]
    corners = (points.min(axis=0), points.max(axis=0)) if len(points) else None
    for i, text in enumerate(words):
        free = [
            word
            for word in _places(float(x[i]), float(y[i]), text, size)
            if not any(_touch(word, of) for of in taken)
        ]
        passes = {word: sum(_passes(line, word) for line in drawn) for word in free}
        if bearable := [word for word in free if passes[word] <= _PASSES_MAX]:
            word = min(
                bearable,
                key=lambda word: (corners is None or not _within(word, *corners), passes[word]),
            )
            taken.append(word)
            kept.append(i)
            notes.append(Note(x=word.at, y=word.middle[1], text=text, align=word.align))
    return _dots(x[kept], y[kept]), notes


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


def _places(x: float, y: float, text: str, size: float) -> Iterable[_Word]:
    half = 0.5 * _LETTER * len(text) * size, 0.5 * _HEIGHT * size
    off = _OFF * size
    yield _Word((x + off + half[0], y), half, x + off, "left")
    yield _Word((x - off - half[0], y), half, x - off, "right")
    yield _Word((x, y + off + half[1]), half, x, "center")
    yield _Word((x, y - off - half[1]), half, x, "center")
    # Beside a track that goes up or down at an angle.
    for side in (off + half[1], -off - half[1]):
        yield _Word((x + half[0], y + side), half, x, "left")
        yield _Word((x - half[0], y + side), half, x, "right")


def _within(word: _Word, least: Array, most: Array) -> bool:
    """Return whether a word stands between two corners, shape (2,) each."""
    inside = (least <= np.subtract(word.middle, word.half)) & (
        np.add(word.middle, word.half) <= most
    )
    return bool(inside.all())


def _touch(one: _Word, other: _Word) -> bool:
    return all(abs(one.middle[i] - other.middle[i]) < one.half[i] + other.half[i] for i in (0, 1))


def _passes(line: Line, word: _Word) -> int:
    """Return how often a curve goes through a word."""
    x, y = _filled(line)
    inside = (np.abs(x - word.middle[0]) < word.half[0]) & (
        np.abs(y - word.middle[1]) < word.half[1]
    )
    return int(np.count_nonzero(inside[1:] & ~inside[:-1])) + int(inside[:1].any())


def _filled(line: Line) -> tuple[Array, Array]:
    """Return points of a curve, also between those of a coarse one; marks that stand alone are as
    they are.
    """
    count = len(line.x)
    if line.style not in ("solid", "thin", "broad", "dash", "dot") or not 1 < count < _POINTS:
        return line.x, line.y
    at, every = np.arange(count), np.linspace(0.0, count - 1.0, _POINTS)
    return np.interp(every, at, line.x), np.interp(every, at, line.y)
