"""Thrust that is expected of the X8: by its published polynomials, in hard flights, and when its
engine fails.
"""

import itertools

import numpy as np
import pytest
import x8_published as x8

from aircraft.faults import ENGINE
from aircraft.state import EquatorFrame
from aircraft.weather import TURBULENCE, Weather
from common.physics import STANDARD_GRAVITY
from gnc.estimation.health import CHECK_INTERVAL
from gnc.estimation.thrust import ThrustMonitor
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.jsbsim.system import write_root
from scenarios.vehicles.jsbsim import Telemetry
from scenarios.vehicles.thrust_expectation import hard_flight, thrust_expectation

AIRSPEED = 20.0
MODERATE = TURBULENCE["moderate"]


@pytest.fixture(scope="module")
def schedule(designs):
    return designs("x8").design.schedule


@pytest.fixture(scope="module")
def aircraft(schedule, tmp_path_factory):
    root = write_root(schedule, tmp_path_factory.mktemp("x8"))
    return AutopilotedAircraft(schedule.spec, root, failable=True)


@pytest.fixture(scope="module")
def start(schedule):
    return schedule.level(schedule.middle)


@pytest.fixture(scope="module")
def expectation(aircraft, schedule, start):
    return thrust_expectation(aircraft, schedule, start)


@pytest.fixture(scope="module")
def tested(expectation):
    # The deviation of gusts along the path in moderate turbulence, at 60 m.
    sensors = {"airspeed_sigma": 0.3, "airspeed_bias": 0.5}
    return expectation.test(AIRSPEED, 17.5, gusts=expectation.gusts, **sensors)


def monitored(aircraft, schedule, start, tested, weather, seed):
    """Yield the monitor of a hard flight after each check."""
    monitor = ThrustMonitor(tested.parameters, CHECK_INTERVAL)
    read_engine = Telemetry(aircraft.fdm, EquatorFrame(start.altitude)).engine
    generator = np.random.default_rng(seed)
    for airspeed in hard_flight(aircraft, schedule.envelope, start, weather, generator):
        read = airspeed + 0.3 * generator.standard_normal()
        monitor.update(read, read_engine())
        yield monitor


@pytest.mark.parametrize(("airspeed", "lift"), [(17.0, 1.0), (20.0, 1.41), (24.0, 1.0)])
def test_drag_and_angle_of_attack_are_those_of_the_published_polynomials(
    expectation, airspeed, lift
):
    pressure, weight = 0.5 * 1.2147 * airspeed**2 * x8.WING_AREA, x8.MASS * STANDARD_GRAVITY
    alpha, elevator = np.linalg.solve(
        [[x8.CL_A, x8.CL_DE], [x8.CM_A, x8.CM_DE]], [lift * weight / pressure - x8.CL_0, -x8.CM_0]
    )
    air = x8.Air(airspeed=airspeed, alpha=alpha, elevator=elevator)
    drag = x8.drag_coefficient(air) * pressure / weight
    # Lift is taken along the body's axis, 2 % less than across the path, and damping adds some.
    assert expectation.model.drag(airspeed, lift) == pytest.approx(drag, rel=0.05)
    assert expectation.model.angle_of_attack(airspeed, lift) == pytest.approx(alpha, abs=0.01)


def test_a_sound_aircraft_that_is_flown_hard_in_turbulence_lacks_less_than_an_alarm(
    aircraft, schedule, start, tested
):
    weather = Weather(turbulence=MODERATE, seed=5)
    flight = monitored(aircraft, schedule, start, tested, weather, 5)
    largest = 0.0
    for monitor in itertools.islice(flight, round(120.0 / CHECK_INTERVAL)):
        assert not monitor.lost
        largest = max(largest, monitor.missing)
    # Measured: 0.16 in 17 h in calm air.
    assert largest < 0.5 * tested.parameters.energy_height


def test_an_engine_that_fails_in_level_flight_is_noticed_within_the_stated_time(
    aircraft, start, tested
):
    aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
    monitor = ThrustMonitor(tested.parameters, CHECK_INTERVAL)
    read_engine = Telemetry(aircraft.fdm, EquatorFrame(start.altitude)).engine
    checks = itertools.count(1)

    def check():
        for _ in range(round(CHECK_INTERVAL / aircraft.fdm.time_step)):
            aircraft.run()
        airspeed = aircraft.fdm.read("velocities/vt-fps") * 0.3048
        monitor.update(airspeed, read_engine())

    for _ in range(50):
        check()
    assert monitor.missing == 0.0
    aircraft.fail(ENGINE)
    noticed = next(i for i in checks if (check(), monitor.lost)[1])
    # The propeller brakes while it runs down: that is noticed the earlier.
    assert 0.5 < noticed * CHECK_INTERVAL <= tested.detection_time + 1e-9
