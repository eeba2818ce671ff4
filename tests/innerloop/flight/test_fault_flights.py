"""The X8 under its autopilot when a part of it fails: engine, an elevon, and what servos report."""

import math

import numpy as np
import pytest
import x8_published as x8

from aircraft.fleet.x8 import X8
from aircraft.weather import TURBULENCE, Weather
from common.physics import METRES_PER_FOOT, STANDARD_GRAVITY
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.part_failure import measure_part_failure
from innerloop.flight.servo_monitor import ServoMonitor

TIME_STEP = 1.0 / 120.0
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
    assert log[-1, AIRSPEED] * METRES_PER_FOOT == pytest.approx(start.airspeed, abs=0.2)
    assert log[-1, HEADING_RATE] == pytest.approx(0.3, abs=5e-3)
    drag = published_drag(math.atan(20.0 * 0.3 / STANDARD_GRAVITY))
    sink = (log[-480, ALTITUDE] - log[-1, ALTITUDE]) * METRES_PER_FOOT / (479 * TIME_STEP)
    # The turn's rates and what is left of settling are left out.
    assert sink == pytest.approx(drag * 20.0 / (x8.MASS * STANDARD_GRAVITY), rel=0.03)


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


WATCH_STEP = 0.05
STEPS = range(6)
"""Of the simulation at 120 Hz in one of the watch at 20 Hz."""
RATE = 0.3
BOTH = pytest.mark.parametrize("fault", ["left_elevon", "right_elevon"])


def release(aircraft, x8_schedule, weather=None):
    start = x8_schedule.level(MIDDLE)
    aircraft.release(
        start.state(), airspeed=start.airspeed, altitude=start.altitude, weather=weather
    )
    return ServoMonitor(aircraft.fdm, WATCH_STEP)


def watched(aircraft, watch, turn, duration):
    """Fly with the heading rate ``turn(time)``; return errors and flown heading rates."""
    log = []
    for step in range(round(duration / WATCH_STEP)):
        log.append((watch.error(), aircraft.fdm.read("autopilot/heading-rate-rad_sec")))
        aircraft.command_heading_rate(turn(step * WATCH_STEP))
        for _ in STEPS:
            aircraft.run()
    return np.array(log).T


def reversals(time):
    """Hard over, the other way every second."""
    return 0.5 if time % 2.0 < 1.0 else -0.5


def test_a_sound_elevon_is_always_where_it_was_commanded_to_be_a_moment_ago(
    x8_aircraft, x8_schedule
):
    weather = Weather(turbulence=TURBULENCE["severe"], seed=3)
    errors, _ = watched(x8_aircraft, release(x8_aircraft, x8_schedule, weather), reversals, 20.0)
    # Commands between two samples are not seen: 0.08 at most in 32 flights of 500 s through
    # severe and light turbulence.
    assert max(errors) < 0.1
    assert min(errors) == 0.0


@BOTH
def test_a_stuck_elevon_is_noticed_half_a_second_after_a_turn_was_asked_of_it(
    failable, x8_schedule, fault
):
    watch = release(failable, x8_schedule)
    errors, _ = watched(failable, watch, lambda _: 0.0, 2.0)
    assert max(errors) < 0.1
    failable.fail(fault)
    errors, _ = watched(failable, watch, lambda _: 0.5, 2.0)
    # The watch waits for 0.4 s in case the servo is on its way, and the elevons are commanded
    # to move at once.
    assert 0.4 <= WATCH_STEP * int(np.argmax(errors > 0.1)) <= 0.6


def heading_rates(aircraft, x8_schedule, fault, *, held):
    """Turn right, left once an elevon fails after 3 s; return the heading rates from then on."""
    watch = release(aircraft, x8_schedule)
    watched(aircraft, watch, lambda _: RATE, 3.0)
    aircraft.fail(fault)
    aircraft.command_altitude(-1000.0)
    if held:
        aircraft.hold_elevator()
    return watched(aircraft, watch, lambda _: -RATE, 6.0)[1]


@BOTH
def test_with_the_elevator_held_the_other_elevon_turns_the_aircraft_round(
    failable, x8_schedule, fault
):
    # From 4 to 6 s after the failure; measured 0.41 and 0.32 rad/s to the left with the elevator
    # held, and 0.15 and 0.19 while elevator and aileron both work the elevon that is left. As it
    # slows down in the climb out of the turn it turns faster.
    assert np.mean(heading_rates(failable, x8_schedule, fault, held=True)[-40:]) < -RATE
    assert np.mean(heading_rates(failable, x8_schedule, fault, held=False)[-40:]) > -0.7 * RATE
