"""Faults of the vehicle: found in the time that their means take, and none of a sound one."""

import copy
import math

import pytest

from gnc.estimation.health import (
    CHECK_INTERVAL,
    PATIENCE,
    SERVO_PATIENCE,
    UNCONTROLLED,
    Fault,
    HealthMonitor,
    HealthParameters,
)
from gnc.estimation.navigation import SensorReadings

SPEED, HEADING_RATE_MAX, TIME_STEP, LAG = 19.42, 0.5, 0.05, 0.4


def monitor(lag=LAG, time_step=TIME_STEP):
    return HealthMonitor(
        HealthParameters(
            airspeed_error=2.0,
            speed=SPEED,
            heading_rate_max=HEADING_RATE_MAX,
            lag=lag,
            time_step=time_step,
        )
    )


def at_each_step(lag=LAG):
    """Return a monitor that checks at each step, and at any airspeed."""
    parameters = HealthParameters(
        airspeed_error=2.4,
        speed=math.inf,
        heading_rate_max=0.2 / UNCONTROLLED,
        lag=lag,
        time_step=TIME_STEP,
    )
    return HealthMonitor(parameters, check_interval=TIME_STEP)


def readings(*, airspeed=SPEED, heading_rate=0.0, servo_error=0.0):
    return SensorReadings(None, airspeed, 0.0, 0.0, heading_rate, servo_error)


def check(health, lack, airspeed, heading_rate, command, servo_error):
    """Return the fault after a check of a vehicle that lacks some of its commanded airspeed."""
    read = readings(airspeed=airspeed, heading_rate=heading_rate, servo_error=servo_error)
    found = health.check(read, airspeed + lack, command)
    assert found == (health.fault is not Fault.NONE)
    return health.fault


def checks_until_a_fault(
    health, lack=0.0, heading_rate=0.0, command=0.0, servo_error=0.0, limit=4000, gain=-0.01
):
    for step in range(1, limit):
        if (
            check(health, lack, 100.0 + gain * step, heading_rate, command, servo_error)
            is not Fault.NONE
        ):
            return step * TIME_STEP
    return math.inf


def test_a_lasting_lack_of_airspeed_is_lost_thrust():
    health = at_each_step()
    # The mean of 4 m/s rises as 4 (1 - e^(-t/2)) and is above 2.4 from t = -2 ln 0.4 on; looks are
    # 0.05 s apart.
    assert checks_until_a_fault(health, lack=4.0) == pytest.approx(
        -PATIENCE * math.log(0.4), abs=TIME_STEP
    )
    assert health.fault is Fault.THRUST_LOST


def test_an_aircraft_that_speeds_up_has_its_thrust_however_much_it_lacks():
    assert checks_until_a_fault(at_each_step(), lack=10.0, gain=0.01) == math.inf


@pytest.mark.parametrize("lack", [2.3, -10.0])
def test_a_smaller_lack_or_a_higher_airspeed_is_no_fault(lack):
    assert checks_until_a_fault(at_each_step(), lack=lack) == math.inf


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


def test_a_stuck_surface_is_named_before_the_airspeed_that_has_gone_with_it():
    health = at_each_step()
    # It slows down all the while: one that does not has its thrust, however much it lacks.
    for step in range(10):
        check(health, 2.0, SPEED - 0.1 * step, 0.0, 0.0, 0.0)
    without = copy.copy(health)
    assert check(without, 100.0, SPEED - 1.0, 0.0, 0.0, 0.0) is Fault.THRUST_LOST
    assert check(health, 100.0, SPEED - 1.0, 0.0, 0.0, 1.0) is Fault.ACTUATOR_STUCK


def test_a_single_servo_error_of_a_fifth_is_no_fault():
    health = at_each_step()
    # One look of 0.2 leaves a mean of 0.2 (1 - e^-0.5) = 0.079 at once, and less from then on.
    for step in range(400):
        assert check(health, 0.0, SPEED, 0.0, 0.0, 0.2 if step % 20 == 0 else 0.0) is Fault.NONE


def test_a_vehicle_with_the_expected_lag_is_sound_however_it_is_turned():
    health, rate = at_each_step(), 0.0
    kept = math.exp(-TIME_STEP / LAG)
    for step in range(2000):
        command = 0.5 if step % 40 < 20 else -0.5
        rate = kept * rate + (1.0 - kept) * command
        # Its heading rate answers the last command by the time of the look.
        assert check(health, 0.0, SPEED, rate, command, 0.0) is Fault.NONE


def test_a_fault_once_detected_stays():
    health = at_each_step()
    checks_until_a_fault(health, lack=4.0)
    for _ in range(400):
        assert check(health, 0.0, SPEED, 0.0, 0.0, 1.0) is Fault.THRUST_LOST


def test_gusts_that_come_and_go_are_no_fault():
    health = at_each_step()
    # 6 m/s at 0.1 Hz: the mean of 2 s keeps 1/sqrt(1 + (0.2 pi 2)^2) = 0.62 of it, 3.7 m/s, above
    # the limit; at 1 Hz 0.48 m/s. It slows down all the while, by a little: one that does not has
    # its thrust, however much it lacks.
    for step in range(2000):
        lack = 6.0 * math.sin(2.0 * math.pi * step * TIME_STEP)
        assert check(health, lack, 100.0 - 0.01 * step, 0.0, 0.0, 0.0) is Fault.NONE
    health = at_each_step()
    slower = (
        check(
            health,
            6.0 * math.sin(0.2 * math.pi * step * TIME_STEP),
            100.0 - 0.01 * step,
            0.0,
            0.0,
            0.0,
        )
        for step in range(200)
    )
    assert Fault.THRUST_LOST in slower


def found_after(made, seconds, *, airspeed_command=SPEED, heading_rate_command=0.0, **read):
    """Return when a fault is found [s], or nothing."""
    for step in range(round(seconds / TIME_STEP)):
        # A vehicle that speeds up, if by rounding alone, has its thrust.
        airspeed = read.get("airspeed", SPEED) - 0.001 * step
        if made.check(
            readings(**(read | {"airspeed": airspeed})), airspeed_command, heading_rate_command
        ):
            return step * TIME_STEP
    return None


def test_a_sound_vehicle_has_no_fault():
    made = monitor()
    assert found_after(made, 60.0) is None
    assert made.fault is Fault.NONE


@pytest.mark.parametrize(
    ("flown", "fault", "soonest"),
    [
        # Means with a time constant of 2 s; 5 m/s lacking pass 2 m/s after 2 ln(5/3) s.
        ({"airspeed": SPEED - 5.0}, Fault.THRUST_LOST, 1.0),
        # Twice omega_max off passes 0.8 omega_max after 2 ln(2/1.2) s, and later by the vehicle's
        # own lag.
        (
            {"heading_rate": -HEADING_RATE_MAX, "heading_rate_command": HEADING_RATE_MAX},
            Fault.CONTROL_LOST,
            1.0,
        ),
        # A servo's mean has a time constant of 0.1 s.
        ({"servo_error": 0.5}, Fault.ACTUATOR_STUCK, 0.0),
    ],
)
def test_each_fault_is_found_within_seconds_and_stays(flown, fault, soonest):
    made = monitor()
    assert soonest <= found_after(made, 10.0, **flown) < 5.0
    assert made.fault is fault
    found_after(made, 20.0)
    assert made.fault is fault


def test_a_vehicle_that_speeds_up_beyond_its_nominal_speed_lacks_nothing():
    # At V_r, and commanded 5 m/s more on the way to the reference.
    assert found_after(monitor(), 60.0, airspeed_command=SPEED + 5.0) is None


@pytest.mark.parametrize("rate_hz", [5, 20, 40])
def test_it_checks_every_fifth_of_a_second_alone(rate_hz):
    made, interval = monitor(time_step=1.0 / rate_hz), round(CHECK_INTERVAL * rate_hz)
    answers = [made.check(readings(servo_error=0.9), SPEED, 0.0) for _ in range(3 * interval)]
    assert any(answers)
    assert all(step % interval == 0 for step, answer in enumerate(answers) if answer)


def test_a_vehicle_without_lag_follows_commands_that_change_at_each_of_few_steps():
    # At 5 Hz: the mean over four of its steps is none of the heading rates that the vehicle has.
    made, heading_rate = monitor(lag=0.0, time_step=0.2), 0.0
    for step in range(300):
        assert not made.check(
            readings(airspeed=SPEED - 0.001 * step, heading_rate=heading_rate), SPEED, heading_rate
        )
        heading_rate = HEADING_RATE_MAX if step % 2 else -HEADING_RATE_MAX


def test_a_command_that_changes_its_sign_at_every_step_demands_no_turn():
    # At 20 Hz no aircraft follows that; it flies straight on, as its mean tells it to.
    made = monitor()
    for step in range(round(60.0 / TIME_STEP)):
        command = HEADING_RATE_MAX if step % 2 else -HEADING_RATE_MAX
        assert not made.check(
            readings(airspeed=SPEED - 0.001 * step), SPEED - 0.001 * step, command
        )
    assert made.fault is Fault.NONE
