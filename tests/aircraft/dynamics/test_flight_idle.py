"""The throttle of most braking, against accelerations that are read one by one."""

import pytest

from aircraft.dynamics.flight_idle import flight_idle, idling_at
from aircraft.dynamics.trim import trim
from aircraft.fleet.x8 import X8
from aircraft.simulation.fdm import Fdm


@pytest.fixture(scope="module")
def cruise():
    fdm = Fdm(X8)
    return fdm, trim(fdm, airspeed=20.0, altitude=60.0)


def deceleration(fdm, level, throttle):
    fdm.command({**level.inputs, "throttle": throttle})
    fdm.place(level.state())
    with fdm.frozen():
        fdm.step(600)
    return -fdm.acceleration_body()[0]


def test_an_electric_propeller_brakes_most_while_it_still_turns(cruise):
    fdm, level = cruise
    idle = flight_idle(fdm, level)
    # Read at 5 s after each throttle, many times the propeller's 0.04 s: a twentieth of the way to
    # either side brakes less, and closed throttle, where the propeller stands, by almost half.
    at_idle = deceleration(fdm, level, idle)
    assert at_idle > deceleration(fdm, level, idle - 0.05)
    assert at_idle > deceleration(fdm, level, idle + 0.05)
    assert at_idle > 1.8 * deceleration(fdm, level, 0.0)


def test_an_aircraft_that_idles_keeps_the_rest_of_its_throttle():
    throttle = idling_at(X8, 0.4).input("throttle")
    assert (throttle.lower, throttle.upper) == (0.4, 1.0)
    assert idling_at(X8, 0.4).input("elevator") == X8.input("elevator")
