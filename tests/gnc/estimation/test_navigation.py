import math

import numpy as np
import pytest

from gnc.estimation.navigation import Navigation, NavigationParameters

SPEED, TIME_STEP = 19.42, 0.05
WIND = (-4.0, 3.0)


def make(**changes):
    values = {
        "crab_banks": (-0.8, 0.0, 0.8),
        "crab_offsets": (0.03, 0.0, -0.05),
        "airspeed_sigma": 0.5,
        "course_sigma": 0.03,
        "wind_drift": 0.02,
        "wind_interval": 5,
        "time_step": TIME_STEP,
    }
    return Navigation(NavigationParameters(**(values | changes)))


def course_at(time):
    return 0.3 + 1.5 * math.cos(0.33 * time)


def velocity_at(time):
    return SPEED * math.cos(course_at(time)) + WIND[0], SPEED * math.sin(course_at(time)) + WIND[1]


def fly(navigation, *, steps, lost_from=math.inf, place=(0.0, 0.0), first=0):
    """Fly a weave through steady wind with exact sensors; return where it truly is."""
    north, east = place
    for step in range(first, first + steps):
        time = step * TIME_STEP
        v_north, v_east = velocity_at(time)
        position = (north, east, v_north, v_east) if time < lost_from else None
        navigation.update(position, SPEED, course_at(time), 0.0)
        # Simpson's rule over the step, 1e-9 m.
        middle, end = velocity_at(time + 0.5 * TIME_STEP), velocity_at(time + TIME_STEP)
        before = (north, east)
        north += TIME_STEP / 6.0 * (v_north + 4.0 * middle[0] + end[0])
        east += TIME_STEP / 6.0 * (v_east + 4.0 * middle[1] + end[1])
    return before


def test_with_satellites_it_is_where_they_say():
    navigation = make()
    where = fly(navigation, steps=100)
    assert (navigation.north, navigation.east) == where
    assert (navigation.velocity_north, navigation.velocity_east) == velocity_at(99 * TIME_STEP)
    assert navigation.lost == 0.0


def test_dead_reckoning_with_exact_sensors_in_steady_wind_does_not_drift():
    navigation = make(wind_drift=0.0)
    where = fly(navigation, steps=3200, lost_from=100.0)
    assert navigation.lost == pytest.approx(60.0, abs=1e-9)
    # Position by the trapezoidal rule, which is off by dt^2/12 times how much the acceleration has
    # changed: twice 20 m/s times 0.5 rad/s make 4 mm. By one end of each step it was off by up to
    # 0.97 m.
    assert math.hypot(navigation.north - where[0], navigation.east - where[1]) < 0.01
    assert (navigation.velocity_north, navigation.velocity_east) == pytest.approx(
        velocity_at(159.95), abs=1e-3
    )


def test_satellites_that_come_back_end_the_dead_reckoning():
    navigation = make()
    where = fly(navigation, steps=400, lost_from=10.0)
    assert navigation.lost == pytest.approx(10.0, abs=1e-9)
    navigation.update((*where, 1.0, 2.0), SPEED, 0.3, 0.0)
    assert navigation.lost == 0.0
    assert (navigation.north, navigation.east) == where


def test_the_air_frame_drifts_with_the_estimated_wind():
    navigation = make()
    total = [0.0, 0.0]
    for step in range(400):
        time = step * TIME_STEP
        navigation.update((0.0, 0.0, *velocity_at(time)), SPEED, course_at(time), 0.0)
        total[0] += TIME_STEP * navigation.wind.north
        total[1] += TIME_STEP * navigation.wind.east
    # Rounding.
    assert (navigation.drift_north, navigation.drift_east) == pytest.approx(total, abs=1e-9)
    # The wind is known to 2 % after the first look: each of 20 s at 5 m/s is 100 m.
    assert (navigation.drift_north, navigation.drift_east) == pytest.approx(
        (20.0 * WIND[0], 20.0 * WIND[1]), rel=0.02
    )


@pytest.mark.parametrize(
    ("roll", "offset"),
    # The table of ``make``, halfway between its points, and beyond its ends along the last piece.
    [
        (-0.8, 0.03),
        (-0.4, 0.015),
        (0.0, 0.0),
        (0.4, -0.025),
        (0.8, -0.05),
        (1.2, -0.075),
        (-1.2, 0.045),
    ],
)
def test_the_course_through_the_air_is_the_heading_and_the_crab_of_the_bank(roll, offset):
    navigation = make()
    navigation.update(None, SPEED, 0.7, roll)
    # There is no wind yet; rounding.
    found = math.atan2(navigation.velocity_east, navigation.velocity_north)
    assert found == pytest.approx(0.7 + offset, abs=1e-12)


def test_the_wind_is_measured_every_so_many_steps():
    navigation = make()
    seen = []
    for step in range(12):
        navigation.update((0.0, 0.0, SPEED - 2.0 - 0.1 * step, 1.0), SPEED, 0.0, 0.0)
        seen.append(navigation.wind.north)
    # Steps 0, 5 and 10.
    assert [i for i in range(1, 12) if seen[i] != seen[i - 1]] == [5, 10]
    assert seen[0] != 0.0


def test_the_wind_is_kept_as_it_was_while_satellites_are_lost():
    navigation = make()
    fly(navigation, steps=400, lost_from=10.0)
    kept = (navigation.wind.north, navigation.wind.east)
    for _ in range(50):
        navigation.update(None, SPEED + 5.0, 2.0, 0.3)
    assert (navigation.wind.north, navigation.wind.east) == kept


def test_after_a_loss_of_satellites_the_wind_is_known_as_little_as_it_has_wandered():
    navigation = make()
    where = fly(navigation, steps=2000)
    before = navigation.wind.sigma
    for _ in range(1200):
        navigation.update(None, SPEED, 0.3, 0.0)
    navigation.wind._speed_variance = navigation.wind._course_variance = (
        1e12  # what is measured then says nothing
    )
    for _ in range(5):
        navigation.update((*where, *velocity_at(0.0)), SPEED, course_at(0.0), 0.0)
    # 60 s at 0.02 m/s a root of a second, and at most one interval of 0.25 s more.
    assert navigation.wind.sigma == pytest.approx(
        math.hypot(before, 0.02 * math.sqrt(60.0)), rel=5e-3
    )


def test_a_wind_that_was_measured_seldom_may_be_wrong_by_as_much_as_its_filter_says():
    navigation = make(course_sigma=0.1, wind_noise=6.0, wind_error=0.4)
    fly(navigation, steps=1)
    first = navigation.wind_error
    assert first == 3.0 * navigation.wind.sigma - 0.4
    assert first == pytest.approx(3.0 * 0.1 * SPEED - 0.4, rel=0.02)
    fly(navigation, steps=40, first=1)
    assert 0.0 < navigation.wind_error < 0.6 * first
    assert navigation.wind_error == 3.0 * navigation.wind.sigma - 0.4


def test_no_more_is_wrong_than_a_measurement_by_its_noise():
    navigation = make(wind_noise=0.9, wind_error=0.1)
    fly(navigation, steps=1)
    assert navigation.wind_error == pytest.approx(0.8)
    quiet = make()
    fly(quiet, steps=1)
    assert quiet.wind_error == 0.0


def test_a_first_wind_that_is_wrong_by_the_vehicles_own_motion_is_averaged_out():
    navigation = make(first_wind_error=0.8)
    fly(navigation, steps=1)
    assert navigation.wind_error == pytest.approx(0.8)
    first = navigation.wind.sigma
    fly(navigation, steps=40, first=1)
    assert navigation.wind_error == pytest.approx(0.8 * (navigation.wind.sigma / first) ** 2)
    assert 0.0 < navigation.wind_error < 0.4


@pytest.mark.parametrize("measured", [1, 3, 20])
def test_a_noisy_compass_makes_the_wind_wrong_by_no_more_than_that(measured):
    # Of a normal error in a plane one in 90 exceeds three deviations of its worst direction; 1,000
    # winds were estimated.
    noise, generator, exceeded = 0.09, np.random.default_rng(measured), 0
    for _ in range(1000):
        navigation = make(
            course_sigma=noise, airspeed_sigma=0.5, wind_interval=1, wind_noise=3.0 * noise * SPEED
        )
        for step in range(measured):
            time = 0.5 * step
            navigation.update(
                (0.0, 0.0, *velocity_at(time)),
                SPEED,
                course_at(time) + generator.normal(0.0, noise),
                0.0,
            )
        wrong = math.hypot(navigation.wind.north - WIND[0], navigation.wind.east - WIND[1])
        exceeded += wrong > navigation.wind_error
    assert exceeded <= 20
