import math

import pytest

from gnc.health import Health, Trouble

TIME_STEP, LAG, PATIENCE = 0.05, 0.4, 2.0


def make(lag=LAG):
    return Health(airspeed_error=2.4, heading_rate_error=0.2, lag=lag, time_step=TIME_STEP, patience=PATIENCE)


def looks_until_trouble(health, lack, heading_rate, command, limit=4000):
    for step in range(1, limit):
        if health.look(lack, heading_rate, command) is not Trouble.NONE:
            return step * TIME_STEP
    return math.inf


def test_a_lack_of_airspeed_that_lasts_is_no_thrust():
    health = make()
    # The mean of 4 m/s rises as 4 (1 - e^(-t/2)) and is above 2.4 from t = -2 ln 0.4 on; looks are 0.05 s apart.
    assert looks_until_trouble(health, 4.0, 0.0, 0.0) == pytest.approx(-PATIENCE * math.log(0.4), abs=TIME_STEP)
    assert health.trouble is Trouble.NO_THRUST


@pytest.mark.parametrize("lack", [2.3, -10.0])
def test_less_than_that_or_too_much_airspeed_is_none(lack):
    assert looks_until_trouble(make(), lack, 0.0, 0.0) == math.inf


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_turn_that_is_not_flown_is_no_control(sign):
    health = make(lag=0.0)
    # As above: 0.5 (1 - e^(-t/2)) is above 0.2 from t = -2 ln 0.6 on.
    assert looks_until_trouble(health, 0.0, 0.0, sign * 0.5) == pytest.approx(-PATIENCE * math.log(0.6), abs=TIME_STEP)
    assert health.trouble is Trouble.NO_CONTROL


def test_a_vehicle_with_the_lag_that_is_expected_is_well_however_it_is_turned():
    health, rate = make(), 0.0
    kept = math.exp(-TIME_STEP / LAG)
    for step in range(2000):
        command = 0.5 if step % 40 < 20 else -0.5
        rate = kept * rate + (1.0 - kept) * command
        # Its heading rate answers the last command by the time of the look.
        assert health.look(0.0, rate, command) is Trouble.NONE


def test_trouble_once_found_stays():
    health = make()
    looks_until_trouble(health, 4.0, 0.0, 0.0)
    for _ in range(400):
        assert health.look(0.0, 0.0, 0.0) is Trouble.NO_THRUST


def test_gusts_that_come_and_go_are_no_trouble():
    health = make()
    # 6 m/s at 0.1 Hz: the mean of 2 s keeps 1/sqrt(1 + (0.2 pi 2)^2) = 0.62 of it, 3.7 m/s, above the limit; at 1 Hz 0.48 m/s.
    for step in range(2000):
        assert health.look(6.0 * math.sin(2.0 * math.pi * step * TIME_STEP), 0.0, 0.0) is Trouble.NONE
