"""Steering laws that return no number, or cannot be called: a failed row that names the law."""

from dataclasses import dataclass

import numpy as np
import pytest
from flight_cases import ASTERN, fly

from gnc.laws import STEERING_LAWS
from scenarios.flight.ending import failure


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


def test_what_a_law_raises_in_several_lines_is_told_in_one():
    try:
        raise RuntimeError("first line\n  second \x1b[31m")
    except RuntimeError as error:
        told = failure(error)["message"]
    assert told.startswith(
        "RuntimeError: first line second \\x1b[31m (test_laws_without_an_answer.py:"
    )


@dataclass(frozen=True)
class NotANumber(Answers):
    answer: object = float("nan")


@dataclass(frozen=True)
class Nothing(Answers):
    answer: object = None


@dataclass(frozen=True)
class Word(Answers):
    answer: object = "0.3"


@dataclass(frozen=True)
class ArrayOfOne(Answers):
    answer: object = (0.1,)

    def start(self, _):
        return _Started(np.array(self.answer), self.after)


@dataclass(frozen=True)
class ArrayOfTwo(ArrayOfOne):
    answer: object = ((0.1,), (0.2,))


@dataclass(frozen=True)
class ComplexNumber(Answers):
    answer: object = np.complex128(0.1)


@dataclass(frozen=True)
class TooFew:
    def heading_rate(self, _):
        return 0.0


@dataclass(frozen=True)
class Wrong:
    def heading_rate(self, *_):
        return 1.0 + "one"


@dataclass(frozen=True)
class Frozen:
    last: float = 0.0

    def heading_rate(self, *_):
        self.last = 1.0
        return 0.0


MUST = "its method heading_rate(reference, own, air) has to return a number [rad/s]"


@pytest.mark.parametrize("mission", ["track", "follow", "standoff"])
@pytest.mark.parametrize(
    ("law", "words"),
    [
        (NotANumber, ("steering law 'NotANumber' returned nan: ", MUST)),
        (Nothing, ("steering law 'Nothing' returned None: ", MUST)),
        (Word, ("steering law 'Word' returned '0.3': ", MUST)),
        (ArrayOfOne, ("steering law 'ArrayOfOne' returned [0.1]: ", MUST)),
        (ArrayOfTwo, ("steering law 'ArrayOfTwo' returned [[0.1] [0.2]]: ", MUST)),
        (ComplexNumber, ("steering law 'ComplexNumber' returned (0.1+0j): ", MUST)),
        (
            TooFew,
            (
                "steering law 'TooFew' cannot be called (",
                "takes 2 positional arguments but 4 were given",
                MUST,
            ),
        ),
        # An error inside the law is told where it is.
        (Wrong, ("TypeError: ", "(test_laws_without_an_answer.py:")),
        (Frozen, ("FrozenInstanceError: ", "(test_laws_without_an_answer.py:")),
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
    for word in words:
        assert word in flown.row["message"]
    assert "tracker.py" not in flown.row["message"]


NUMBERS = {
    "float": 0.1,
    "scalar": np.float64(0.1),
    "array": np.array(0.1),
    "where": np.where(True, 0.1, 0.2),
}


@dataclass(frozen=True)
class Steady:
    kind: str = "float"

    def heading_rate(self, *_):
        return NUMBERS[self.kind]


@pytest.mark.parametrize("mission", ["track", "standoff"])
@pytest.mark.parametrize("kind", ["scalar", "array", "where"])
def test_a_law_may_return_a_number_of_numpy(mission, kind):
    guidance = {"law": "own", "mission": mission, "keepout_guard": False}
    with STEERING_LAWS.temporarily_registered("own", Steady):
        rows = [
            fly(
                guidance=guidance | {"kind": given}, start=ASTERN, flight={"duration_max_s": 20.0}
            ).row
            for given in (kind, "float")
        ]
    assert rows[0]["outcome"] == "not_settled"
    assert rows[0]["min_distance_m"] == rows[1]["min_distance_m"]
