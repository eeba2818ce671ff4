"""Faults of the vehicle: found in the time that their means take, and none of a sound one."""

import math

import pytest
from thrust_cases import AIRSPEED, LEVEL, MODEL, PARAMETERS, accelerations

from gnc.estimation.health import (
    PATIENCE,
    SERVO_PATIENCE,
    UNCONTROLLED,
    Fault,
    HealthMonitor,
    HealthParameters,
)
from gnc.estimation.navigation import EngineReadings, SensorReadings

TIME_STEP, LAG = 0.05, 0.4


def at_each_step(lag=LAG):
    """Return a monitor that checks at each step."""
    parameters = HealthParameters(
        thrust=PARAMETERS, heading_rate_max=0.2 / UNCONTROLLED, lag=lag, time_step=TIME_STEP
    )
    return HealthMonitor(parameters, check_interval=TIME_STEP)


def readings(*, heading_rate=0.0, servo_error=0.0, thrust=LEVEL):
    """Return what is read at the throttle of level flight."""
    throttle = LEVEL / MODEL.settled_thrust(AIRSPEED, 1.0)
    engine = EngineReadings(throttle, *accelerations(thrust))
    return SensorReadings(None, AIRSPEED, 0.0, 0.0, heading_rate, servo_error, engine)


def check(health, command=0.0, **read):
    """Return the fault after a check."""
    before = health.fault
    changed = health.check(readings(**read), command)
    assert changed == (health.fault is not before)
    return health.fault


def checks_until_a_fault(health, limit=4000, **read):
    for step in range(1, limit):
        if check(health, **read) is not Fault.NONE:
            return step * TIME_STEP
    return math.inf


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_turn_that_is_not_flown_is_lost_control(sign):
    health = at_each_step(lag=0.0)
    # As above: 0.5 (1 - e^(-t/2)) is above 0.2 from t = -2 ln 0.6 on.
    assert checks_until_a_fault(health, command=sign * 0.5) == pytest.approx(
        -PATIENCE * math.log(0.6), abs=TIME_STEP
    )
    assert health.fault is Fault.CONTROL_LOST


def test_a_surface_that_stays_away_from_its_command_is_stuck_before_the_vehicle_has_turned():
    health = at_each_step()
    # 0.3 (1 - e^(-t/0.1)) is above 0.1 from t = -0.1 ln(2/3) on.
    found = checks_until_a_fault(health, servo_error=0.3)
    assert found == pytest.approx(-SERVO_PATIENCE * math.log(2.0 / 3.0), abs=TIME_STEP)
    assert health.fault is Fault.ACTUATOR_STUCK


def test_a_stuck_surface_is_named_before_the_thrust_that_has_gone_with_it():
    health = at_each_step()
    while check(health, thrust=0.0) is Fault.NONE:
        pass
    assert health.fault is Fault.THRUST_LOST
    assert check(health, thrust=0.0, servo_error=5.0) is Fault.ACTUATOR_STUCK
    # It stays when thrust is there again.
    for _ in range(400):
        assert check(health) is Fault.ACTUATOR_STUCK
