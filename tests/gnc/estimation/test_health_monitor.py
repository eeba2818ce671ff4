"""The vehicle's health as the guidance asks for it: every fifth of a second."""

import pytest

from gnc.estimation.health import Fault
from gnc.estimation.health_monitor import CHECK_INTERVAL, HealthMonitor, HealthParameters

SPEED, HEADING_RATE_MAX, TIME_STEP = 19.42, 0.5, 0.05


def monitor(lag=0.4, time_step=TIME_STEP):
    return HealthMonitor(
        HealthParameters(
            airspeed_error=2.0,
            speed=SPEED,
            heading_rate_max=HEADING_RATE_MAX,
            lag=lag,
            time_step=time_step,
        )
    )


def readings(*, airspeed=SPEED, heading_rate=0.0, servo_error=0.0):
    return None, airspeed, 0.0, 0.0, heading_rate, servo_error


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


def test_a_vehicle_that_is_asked_for_more_than_its_speed_lacks_nothing_on_the_way_there():
    # At V_r, and told to fly 5 m/s more on the way to the reference.
    assert found_after(monitor(), 60.0, airspeed_command=SPEED + 5.0) is None


@pytest.mark.parametrize("rate_hz", [5, 20, 40])
def test_it_looks_every_fifth_of_a_second_alone(rate_hz):
    made, interval = monitor(time_step=1.0 / rate_hz), round(CHECK_INTERVAL * rate_hz)
    answers = [made.check(readings(servo_error=0.9), SPEED, 0.0) for _ in range(3 * interval)]
    assert any(answers)
    assert all(step % interval == 0 for step, answer in enumerate(answers) if answer)


def test_a_vehicle_that_turns_at_once_follows_commands_that_change_from_step_to_step_at_few_steps():
    # At 5 Hz: the mean over four of its steps is none of the heading rates that the vehicle has.
    made, heading_rate = monitor(lag=0.0, time_step=0.2), 0.0
    for step in range(300):
        assert not made.check(
            readings(airspeed=SPEED - 0.001 * step, heading_rate=heading_rate), SPEED, heading_rate
        )
        heading_rate = HEADING_RATE_MAX if step % 2 else -HEADING_RATE_MAX


def test_a_command_that_changes_its_sign_at_every_step_asks_for_no_turn():
    # At 20 Hz no aircraft follows that; it flies straight on, as its mean tells it to.
    made = monitor()
    for step in range(round(60.0 / TIME_STEP)):
        command = HEADING_RATE_MAX if step % 2 else -HEADING_RATE_MAX
        assert not made.check(
            readings(airspeed=SPEED - 0.001 * step), SPEED - 0.001 * step, command
        )
    assert made.fault is Fault.NONE
