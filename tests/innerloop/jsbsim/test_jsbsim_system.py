"""The autopilot as a file, the JSBSim root that flies it, and each kind of XML tried in JSBSim."""

import xml.etree.ElementTree as ET

import numpy as np
from innerloop_flights import TIME_STEP, fly

from aircraft.fleet.x8 import X8
from aircraft.spec import MODELS
from innerloop.jsbsim.system import system_name


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
