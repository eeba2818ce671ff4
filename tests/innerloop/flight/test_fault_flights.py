"""The X8 under its autopilot when a part of it fails."""

import math

import numpy as np
import pytest
import x8_published as x8

from aircraft.fleet.x8 import X8
from common.physics import STANDARD_GRAVITY
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.part_failure import measure_part_failure

TIME_STEP = 1.0 / 120.0
FOOT = 0.3048
MIDDLE = 2
READ = (
    "propulsion/engine/thrust-lbs",
    "position/h-sl-ft",
    "velocities/vt-fps",
    "autopilot/heading-rate-rad_sec",
)
THRUST, ALTITUDE, AIRSPEED, HEADING_RATE = range(4)


@pytest.fixture
def failable(x8_root):
    return AutopilotedAircraft(X8, x8_root, failable=True)


def published_drag(bank):
    """Return the drag [N] of the published polynomials in level balance at a bank [rad], at 20 m/s
    under 90 m of standard atmosphere.
    """
    pressure = 0.5 * 1.2147 * 20.0**2 * x8.WING_AREA
    lift = x8.MASS * STANDARD_GRAVITY / math.cos(bank) / pressure
    alpha, elevator = np.linalg.solve(
        [[x8.CL_A, x8.CL_DE], [x8.CM_A, x8.CM_DE]], [lift - x8.CL_0, -x8.CM_0]
    )
    return x8.drag_coefficient(x8.Air(airspeed=20.0, alpha=alpha, elevator=elevator)) * pressure


def test_without_its_engine_it_glides_and_turns_at_the_commanded_airspeed_if_commanded_to_sink(
    x8_schedule, failable
):
    start = x8_schedule.level(MIDDLE)
    failable.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
    nodes = [failable.fdm.node(name) for name in READ]
    log, failed = np.empty((3000, len(nodes))), 360
    for i, row in enumerate(log):
        if i == 120:
            failable.command_heading_rate(0.3)
        if i == failed:
            failable.fail("engine")
            failable.command_altitude(-1000.0)
        row[:] = [node.get_double_value() for node in nodes]
        failable.run()
    assert log[0, THRUST] > 0.5
    assert np.all(log[failed + 60 :, THRUST] <= 0.0)  # the propeller stops within half a second
    # An altitude error beyond its limit is not integrated, so the integral of the airspeed error is
    # left to find the glide.
    assert log[-1, AIRSPEED] * FOOT == pytest.approx(start.airspeed, abs=0.2)
    assert log[-1, HEADING_RATE] == pytest.approx(0.3, abs=5e-3)
    drag, weight = (
        published_drag(math.atan(20.0 * 0.3 / STANDARD_GRAVITY)),
        x8.MASS * STANDARD_GRAVITY,
    )
    sink = (log[-480, ALTITUDE] - log[-1, ALTITUDE]) * FOOT / (479 * TIME_STEP)
    # The turn's rates and what is left of settling are left out.
    assert sink == pytest.approx(drag * 20.0 / weight, rel=0.03)


def test_without_its_engine_the_airspeed_falls_in_a_turn_by_drag_over_mass(x8_schedule, failable):
    start = x8_schedule.level(MIDDLE)
    found = measure_part_failure(failable, start, math.radians(45.0), 15.0)
    # Within the second of the measurement the aircraft becomes slower by a fifteenth; and the
    # propeller adds drag while it runs down.
    drag = published_drag(math.radians(45.0))
    assert found.airspeed_fall == pytest.approx(drag / x8.MASS, rel=0.05)


def test_the_push_over_to_a_glide_takes_from_a_turn_what_it_takes_from_the_lift(
    x8_schedule, failable
):
    # At one bank lift turns the aircraft by L sin(bank)/(m V), and pushes it over by L cos(bank)/m
    # less g. However long it takes, to sink with w costs the course omega w/g, until the
    # autopilot has banked more.
    start, bank = x8_schedule.level(MIDDLE), math.radians(45.0)
    level, climbing = (
        measure_part_failure(failable, start, bank, 15.0, gradient).glide_deviation
        for gradient in (0.0, 0.2)
    )
    rate = STANDARD_GRAVITY / start.airspeed
    lag = rate * 2.4 / STANDARD_GRAVITY
    # It is regained while the aircraft turns on, within a second or two of a turn of six.
    assert start.airspeed * lag < level < 2.0 * start.airspeed * lag
    # From a climb of 4 m/s it takes more, even though that has only begun.
    assert level < climbing < level * (2.4 + 4.0) / 2.4
