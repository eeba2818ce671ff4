"""Results of a user's shape become Python's numbers; the project's own shapes are left alone."""

import copy

import numpy as np
from gnc_cases import paper_oscillation

from gnc.reference.builtin_floats import with_builtin_floats


class Single:
    """Returns single precision, and lists."""

    nu, limit, symmetric = np.float32(0.5), "roll rate", np.bool_(False)

    def course(self, phase):
        return np.float32(0.25 * phase)

    def slopes(self, eta, phase):
        return [np.float32(eta), np.array(phase)]

    def offset(self, time):
        return np.float32(time), np.float32([0.5, 0.25])

    def design(self, *, nu):
        return Single() if nu else None


def test_numbers_are_pythons_and_several_of_them_a_tuple():
    converted = with_builtin_floats(Single())
    answers = [converted.nu, converted.course(2.0), *converted.slopes(1.0, 0.5)]
    assert answers == [0.5, 0.5, 1.0, 0.5]
    assert {type(answer) for answer in answers} == {float}
    assert type(converted.slopes(1.0, 0.5)) is tuple
    assert (converted.limit, bool(converted.symmetric)) == ("roll rate", False)


def test_arrays_are_of_double_precision():
    along, right = with_builtin_floats(Single()).offset(1.5)
    assert type(along) is float
    assert right.dtype == np.float64
    np.testing.assert_array_equal(right, [0.5, 0.25])


def test_what_a_shape_makes_is_plain_too():
    made = with_builtin_floats(Single()).design(nu=0.5)
    assert type(made.course(1.0)) is float
    assert with_builtin_floats(Single()).design(nu=0.0) is None


def test_what_is_the_projects_own_is_left_as_it_is():
    oscillation = paper_oscillation(0.5)
    assert with_builtin_floats(oscillation) is oscillation


def test_a_copy_answers_likewise():
    assert copy.deepcopy(with_builtin_floats(Single())).course(2.0) == 0.5
