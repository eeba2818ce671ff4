"""Steering laws that return no number, or cannot be called: a failed row that names the law."""

from dataclasses import dataclass

import numpy as np
import pytest
from flight_cases import ASTERN, fly

from gnc.laws import STEERING_LAWS


@dataclass(frozen=True)
class Answers:
    answer: object = 0.0
    after: int = 3

    def start(self, _):
        return _Started(self.answer, self.after)


class _Started:
    def __init__(self, answer, after):
        self._answer, self._until = answer, after

    def heading_rate(self, *_):
        self._until -= 1
        return 0.0 if self._until > 0 else self._answer


@dataclass(frozen=True)
class NotANumber(Answers):
    answer: object = float("nan")


@dataclass(frozen=True)
class ArrayOfOne(Answers):
    answer: object = (0.1,)

    def start(self, _):
        return _Started(np.array(self.answer), self.after)


@dataclass(frozen=True)
class Wrong:
    def heading_rate(self, *_):
        return 1.0 + "one"


@pytest.mark.parametrize("mission", ["track", "follow", "standoff"])
@pytest.mark.parametrize(
    ("law", "words"),
    [
        (NotANumber, "returned nan; it has to be a number, the heading rate [rad/s]"),
        (ArrayOfOne, "returned array([0.1]); it has to be a number"),
        # An error inside the law is told where it is.
        (Wrong, "failed: TypeError: "),
    ],
)
def test_a_law_without_an_answer_ends_its_flight_with_a_reason_that_names_it(mission, law, words):
    with STEERING_LAWS.temporarily_registered("own", law):
        flown = fly(
            guidance={"law": "own", "mission": mission, "keepout_guard": False},
            start=ASTERN,
            flight={"duration_max_s": 20.0},
        )
    assert (flown.row["outcome"], flown.row["criteria_met"]) == ("failed", False)
    message = flown.row["message"]
    assert message.startswith(f"steering law '{law.__name__}': heading_rate() ")
    assert words in message
    assert ("(test_laws_without_an_answer.py:" in message) == (law is Wrong)
