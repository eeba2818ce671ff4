"""One stuck elevon of the X8: what servos report, and the other elevon with the elevator held."""

import numpy as np
import pytest

from aircraft.fleet.x8 import X8
from aircraft.weather import TURBULENCE, Weather
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.servo_monitor import ServoMonitor

TIME_STEP = 0.05
STEPS = range(6)
"""Of the simulation at 120 Hz in one of the watch at 20 Hz."""
MIDDLE = 2
RATE = 0.3
BOTH = pytest.mark.parametrize("fault", ["left_elevon", "right_elevon"])


@pytest.fixture
def failable(x8_root):
    return AutopilotedAircraft(X8, x8_root, failable=True)


def release(aircraft, x8_schedule, weather=None):
    start = x8_schedule.level(MIDDLE)
    aircraft.release(
        start.state(), airspeed=start.airspeed, altitude=start.altitude, weather=weather
    )
    return ServoMonitor(aircraft.fdm, TIME_STEP)


def watched(aircraft, watch, turn, duration):
    """Fly with the heading rate ``turn(time)``; return errors and flown heading rates."""
    log = []
    for step in range(round(duration / TIME_STEP)):
        log.append((watch.error(), aircraft.fdm.read("autopilot/heading-rate-rad_sec")))
        aircraft.command_heading_rate(turn(step * TIME_STEP))
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
    assert 0.4 <= TIME_STEP * int(np.argmax(errors > 0.1)) <= 0.6


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
