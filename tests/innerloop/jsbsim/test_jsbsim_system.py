"""The autopilot as a file, the JSBSim root that flies it, and each kind of XML tried in JSBSim."""

import math
import shutil
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from innerloop_flights import TIME_STEP, fly

from aircraft.fdm import Fdm
from aircraft.fleet.x8 import X8
from aircraft.spec import MODELS
from aircraft.state import RigidBodyState
from innerloop.jsbsim.system import (
    RESET,
    function,
    integrator,
    minus,
    number,
    operation,
    read,
    system_name,
    system_xml,
    times,
    total,
)

LEVEL = RigidBodyState(altitude=100.0, roll=0.0, pitch=0.0, velocity_body=(20.0, 0.0, 0.0))


def test_the_system_is_xml_with_numbers_in_every_table(x8_schedule):
    root = ET.fromstring(system_xml(x8_schedule).encode())
    assert root.tag == "system"
    assert root.get("name") == "x8_autopilot"
    numbers = [word for table in root.iter("tableData") for word in table.text.split()]
    numbers += [value.text for value in root.iter("v")]
    assert len(numbers) > 500  # nine tables over nine banks and five airspeeds alone
    assert all(math.isfinite(float(word)) for word in numbers)


def test_the_written_model_differs_from_the_original_by_the_system_alone(x8_root):
    def parts(path):
        root = ET.parse(path / "aircraft" / "x8" / "x8.xml").getroot()
        return [
            ET.tostring(element).strip() for element in root if element.tag != "system"
        ], root.findall("system")

    original, none = parts(MODELS)
    written, systems = parts(x8_root)
    assert none == []
    assert [s.get("file") for s in systems] == [system_name(X8)]
    assert written == original


def test_the_measured_heading_rate_is_the_rate_of_the_flown_course(x8_schedule, x8_aircraft):
    flight = fly(
        x8_aircraft,
        x8_schedule.level(2),
        12.0,
        [(1.0, "heading_rate", 0.3), (6.0, "heading_rate", -0.2)],
    )
    course = np.unwrap(np.arctan2(flight["east_speed"], flight["north_speed"]))
    differentiated = (course[2:] - course[:-2]) / (2.0 * TIME_STEP)
    # Calm air: the air-relative course is the ground's. The autopilot measures forces a step or two
    # before the motion they make, at up to 2 rad/s^2 of course acceleration; the earth's rotation
    # adds 1e-4.
    assert np.abs(differentiated - flight["heading_rate"][1:-1]).max() < 2.0 * 1.5 * TIME_STEP
    # Where it turns steadily the two agree to a thousandth of the rate.
    steady = slice(round(5.0 / TIME_STEP), round(5.9 / TIME_STEP))
    assert np.abs(differentiated - flight["heading_rate"][1:-1])[steady].max() < 3e-4


def test_the_autopilot_computes_once_in_a_period_and_integrates_over_it(x8_schedule, x8_aircraft):
    start, period = x8_schedule.level(2), x8_schedule.period
    x8_aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
    x8_aircraft.command_heading_rate(0.3)
    names = ("autopilot/model-jerk", "autopilot/model-acceleration", "autopilot/model-rate")
    nodes = [x8_aircraft.fdm.node(name) for name in names]
    rows = [[0.0, 0.0, 0.0]]
    for _ in range(40 * period):
        x8_aircraft.fdm.step()
        rows.append([node.get_double_value() for node in nodes])
    # It computed in the last step before the release, so that the command acts at the end of a
    # whole period.
    moved = np.nonzero(np.any(np.diff(rows, axis=0), axis=1))[0] + 1
    np.testing.assert_array_equal(moved, period * np.arange(1, 41))
    jerk, acceleration, rate = np.array(rows)[::period].T
    for integral, integrand in ((acceleration, jerk), (rate, acceleration)):
        # The trapezoidal rule over the period, to rounding of sums of values near 1.
        np.testing.assert_allclose(
            np.diff(integral),
            0.5 * period * TIME_STEP * (integrand[1:] + integrand[:-1]),
            atol=1e-12,
        )


@pytest.fixture
def run(tmp_path):
    """A function that loads an X8 with components that may use properties test/x and test/y."""

    def load(*components):
        shutil.copytree(MODELS, tmp_path, dirs_exist_ok=True)
        (tmp_path / "systems").mkdir()
        properties = "".join(
            f'<property value="0">{name}</property>' for name in ("test/x", "test/y", RESET)
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


def test_an_integrator_is_held_at_zero_by_its_reset_and_starts_from_there(run):
    fdm = run(integrator("test/out", "test/x"))
    for _ in range(30):
        value_at(fdm, 1.0)
    # The first step is a trapezium from 0.
    assert fdm.read("test/out") == pytest.approx(29.5 * TIME_STEP, abs=1e-14)
    fdm.write(RESET, -1.0)
    assert value_at(fdm, 1.0) == 0.0
    assert value_at(fdm, 1.0) == 0.0
    fdm.write(RESET, 0.0)
    # One step, or half of one by the trapezium.
    assert value_at(fdm, 1.0) == pytest.approx(TIME_STEP, rel=0.51)
    assert value_at(fdm, 1.0) == pytest.approx(2.0 * TIME_STEP, rel=0.26)
