"""Marks of the time along a track, with words where they hide nothing."""

import itertools

import numpy as np
import pytest

from reports.document.chart import Line
from reports.flights.time_marks import TIMES, marks_beside, marks_in_a_row

SIZE = 100.0


def line(x, y):
    return Line(
        x=np.array(x, dtype=float), y=np.array(y, dtype=float), label="flown", colour="blue"
    )


def upright(x):
    """Return four curves up and down the page, beside a mark at 50, 50."""
    return [line(np.full(41, x + 0.5 * i), np.linspace(0.0, 100.0, 41)) for i in range(4)]


def marked(drawn, words=("1 min",)):
    x = np.full(len(words), 50.0)
    return marks_beside(x, 50.0 + 0.5 * np.arange(len(words)), words, drawn, SIZE)


@pytest.mark.parametrize(
    ("drawn", "align", "above"),
    [
        ([], "left", 0),
        (upright(57.0), "right", 0),
        (upright(57.0) + upright(41.0), "center", 1),
    ],
)
def test_a_word_stands_where_the_fewest_curves_are(drawn, align, above):
    lines, (note,) = marked(drawn)
    assert (note.align, np.sign(note.y - 50.0)) == (align, above)
    assert (lines[0].x.tolist(), lines[0].y.tolist()) == ([50.0], [50.0])


def test_words_of_marks_that_are_near_each_other_do_not_overlap():
    _, notes = marked([], [f"{i} min" for i in range(1, 9)])
    assert 1 < len(notes) < 8
    # A letter is a hundredth of the page wide at least.
    shift = {"left": 0.5, "right": -0.5, "center": 0.0}
    for one, other in itertools.combinations(notes, 2):
        (middle, half), (its, its_half) = (
            (
                note.x + shift[note.align] * 0.01 * SIZE * len(note.text),
                0.005 * SIZE * len(note.text),
            )
            for note in (one, other)
        )
        assert abs(one.y - other.y) >= 0.045 * SIZE or abs(middle - its) >= half + its_half


def test_words_in_a_row_are_apart_and_every_mark_is_kept():
    x = np.arange(0.0, 100.0, 5.0)
    lines, notes = marks_in_a_row(
        x, np.zeros(len(x)), [f"{i} min" for i in range(len(x))], 10.0, SIZE
    )
    assert lines[0].x.tolist() == x.tolist()
    assert np.min(np.diff([note.x for note in notes])) > 0.12 * SIZE
    assert {note.y for note in notes} == {10.0}
    # The legend names the marks, and a line leads from the mark of each word to just below it.
    assert [line.label for line in lines] == [TIMES] + [""] * len(notes)
    assert [(line.x.tolist(), line.y[0]) for line in lines[1:]] == [
        ([note.x] * 2, 0.0) for note in notes
    ]
    assert all(8.0 < line.y[1] < 10.0 for line in lines[1:])
    assert marks_in_a_row(x[:0], x[:0], [], 10.0, SIZE) == ([], [])
