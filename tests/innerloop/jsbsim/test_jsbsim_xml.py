"""The words of JSBSim's XML, each tried in JSBSim itself."""

import shutil
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from aircraft.fdm import Fdm
from aircraft.fleet.x8 import X8
from aircraft.spec import MODELS
from aircraft.state import RigidBodyState
from innerloop.jsbsim.xml import (
    clipped,
    function,
    integrator,
    minus,
    number,
    operation,
    read,
    table_1d,
    table_2d,
    times,
    total,
    within,
)

LEVEL = RigidBodyState(altitude=100.0, roll=0.0, pitch=0.0, velocity_body=(20.0, 0.0, 0.0))
TIME_STEP = 1.0 / 120.0
DIGITS = 1e-8  # numbers are written with nine digits


@pytest.fixture
def run(tmp_path):
    """A function that loads an X8 with components in a system, with properties test/x and test/y to
    play with.
    """

    def load(*components):
        shutil.copytree(MODELS, tmp_path, dirs_exist_ok=True)
        (tmp_path / "systems").mkdir()
        properties = "".join(
            f'<property value="0">test/{name}</property>' for name in ("x", "y", "reset")
        )
        body = "".join(components)
        document = (
            f'<system name="probe">{properties}<channel name="probe">{body}</channel></system>'
        )
        (tmp_path / "systems" / "probe.xml").write_text(document, encoding="utf-8")
        model_file = tmp_path / "aircraft" / "x8" / "x8.xml"
        model = ET.parse(model_file)
        model.getroot().insert(2, ET.Element("system", file="probe"))
        model.write(model_file)
        fdm = Fdm(X8, tmp_path)
        fdm.place(LEVEL)
        return fdm

    return load


def value_at(fdm, x, y=0.0, name="test/out"):
    fdm.write("test/x", x)
    fdm.write("test/y", y)
    fdm.step()
    return fdm.read(name)


def test_expressions_compute_what_they_say(run):
    x, y = read("test/x"), read("test/y")
    fdm = run(
        function("test/sum", total(x, y, number(0.25))),
        function("test/product", times(x, y, number(-2.0))),
        function("test/difference", minus(x, y, number(1.5))),
        function("test/quotient", operation("quotient", x, y)),
        function("test/cosine", operation("cos", x)),
    )
    found = {
        name: value_at(fdm, 3.0, 4.0, f"test/{name}")
        for name in ("sum", "product", "difference", "quotient", "cosine")
    }
    assert found == pytest.approx(
        {
            "sum": 7.25,
            "product": -24.0,
            "difference": -2.5,
            "quotient": 0.75,
            "cosine": np.cos(3.0),
        },
        abs=1e-14,
    )


@pytest.mark.parametrize("value", [0.3048, -1.0 / 3.0, 1e-12, 123456.789, 0.0])
def test_a_number_keeps_nine_digits(run, value):
    assert value_at(run(function("test/out", number(value))), 0.0) == pytest.approx(
        value, rel=DIGITS, abs=0.0
    )


@pytest.mark.parametrize(
    ("x", "kept"), [(-3.0, -0.5), (-0.5, -0.5), (0.2, 0.2), (2.0, 2.0), (7.0, 2.0)]
)
def test_a_clipped_value_stays_within_its_limits(run, x, kept):
    assert value_at(
        run(function("test/out", clipped(read("test/x"), -0.5, 2.0))), x
    ) == pytest.approx(kept, abs=1e-15)


@pytest.mark.parametrize(
    ("x", "inside"), [(-1.2, 0.0), (-0.9, 1.0), (0.0, 1.0), (0.9, 1.0), (1.1, 0.0)]
)
def test_within_is_one_inside_the_limit_and_zero_outside(run, x, inside):
    assert value_at(run(function("test/out", within(read("test/x"), 1.0))), x) == inside


@pytest.mark.parametrize("x", [-5.0, 1.0, 1.4, 2.0, 3.9, 4.0, 50.0])
def test_a_table_is_linear_between_its_rows_and_constant_past_its_ends(run, x):
    rows, values = (1.0, 2.0, 4.0), (10.0, -5.0, 7.0)
    # numpy's interpolation, which is also constant past the ends.
    assert value_at(
        run(function("test/out", table_1d("test/x", rows, values))), x
    ) == pytest.approx(np.interp(x, rows, values))


@pytest.mark.parametrize(
    ("x", "y"),
    [(0.0, 10.0), (0.5, 10.0), (0.0, 15.0), (0.25, 12.5), (1.7, 19.0), (-9.0, 12.0), (9.0, 99.0)],
)
def test_a_table_over_two_properties_is_bilinear_with_rows_first(run, x, y):
    rows, columns = (0.0, 1.0, 2.0), (10.0, 20.0)
    values = np.array([[1.0, 2.0], [4.0, -3.0], [0.5, 7.0]])
    by_column = [np.interp(y, columns, line) for line in values]
    expected = np.interp(x, rows, by_column)
    assert value_at(
        run(function("test/out", table_2d("test/x", "test/y", rows, columns, values))), x, y
    ) == pytest.approx(expected)


def test_a_function_writes_its_outputs_as_well(run):
    both = ("fcs/elevator-cmd-norm", "fcs/throttle-cmd-norm")
    fdm = run(function("test/out", read("test/x"), both))
    assert value_at(fdm, 0.37) == 0.37
    assert [fdm.read(name) for name in both] == [0.37, 0.37]


def test_an_integrator_integrates_by_the_trapezoidal_rule(run):
    fdm = run(integrator("test/out", "test/x", "test/reset"))
    assert value_at(fdm, 0.0) == 0.0
    inputs = np.sin(np.arange(1, 60))
    found = [value_at(fdm, float(x)) for x in inputs]
    before = np.concatenate([[0.0], inputs[:-1]])
    np.testing.assert_allclose(
        found, np.cumsum(0.5 * (inputs + before) * TIME_STEP), atol=1e-14
    )  # rounding


def test_an_integrator_is_held_at_zero_by_its_reset_and_starts_from_there(run):
    fdm = run(integrator("test/out", "test/x", "test/reset"))
    for _ in range(30):
        value_at(fdm, 1.0)
    # The first step is a trapezium from 0.
    assert fdm.read("test/out") == pytest.approx(29.5 * TIME_STEP, abs=1e-14)
    fdm.write("test/reset", -1.0)
    assert value_at(fdm, 1.0) == 0.0
    assert value_at(fdm, 1.0) == 0.0
    fdm.write("test/reset", 0.0)
    assert value_at(fdm, 1.0) == pytest.approx(
        TIME_STEP, rel=0.51
    )  # one step, or half of one by the trapezium
    assert value_at(fdm, 1.0) == pytest.approx(2.0 * TIME_STEP, rel=0.26)
