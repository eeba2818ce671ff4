"""Navigation: own motion by satellites and by dead reckoning, and the estimated wind."""

import math

import numpy as np
import pytest

from gnc.estimation.navigation import (
    EstimatedNavigation,
    NavigationParameters,
    SatelliteFix,
    SensorReadings,
    WindFilter,
)

SPEED, TIME_STEP = 19.42, 0.05
WIND = (-4.0, 3.0)


def make(**changes):
    values = {"crab_banks": (-0.8, 0.0, 0.8), "crab_offsets": (0.03, 0.0, -0.05)}
    values |= {"airspeed_sigma": 0.5, "course_sigma": 0.03, "wind_drift": 0.02}
    values |= {"wind_interval": 5, "time_step": TIME_STEP}
    return EstimatedNavigation(NavigationParameters(**(values | changes)))


def sense(navigation, fix, airspeed, heading, roll=0.0):
    navigation.update(SensorReadings(fix and SatelliteFix(*fix), airspeed, heading, roll, 0.0, 0.0))


def course_at(time):
    return 0.3 + 1.5 * math.cos(0.33 * time)


def velocity_at(time):
    return SPEED * math.cos(course_at(time)) + WIND[0], SPEED * math.sin(course_at(time)) + WIND[1]


def fly(navigation, *, steps, lost_from=math.inf):
    """Fly a weave through steady wind with exact sensors; return where it truly is."""
    north = east = 0.0
    for step in range(steps):
        time = step * TIME_STEP
        v_north, v_east = velocity_at(time)
        position = (north, east, v_north, v_east) if time < lost_from else None
        sense(navigation, position, SPEED, course_at(time))
        # Simpson's rule over the step, 1e-9 m.
        middle, end = velocity_at(time + 0.5 * TIME_STEP), velocity_at(time + TIME_STEP)
        before = (north, east)
        north += TIME_STEP / 6.0 * (v_north + 4.0 * middle[0] + end[0])
        east += TIME_STEP / 6.0 * (v_east + 4.0 * middle[1] + end[1])
    return before


def test_dead_reckoning_with_exact_sensors_in_steady_wind_does_not_drift():
    navigation = make(wind_drift=0.0)
    where = fly(navigation, steps=3200, lost_from=100.0)
    assert navigation.lost == pytest.approx(60.0, abs=1e-9)
    # Position by the trapezoidal rule, which is off by dt^2/12 times how much the acceleration has
    # changed: twice 20 m/s times 0.5 rad/s make 4 mm. By one end of each step it was off by up to
    # 0.97 m.
    assert math.hypot(navigation.ground_north - where[0], navigation.ground_east - where[1]) < 0.01
    assert (navigation.velocity_north, navigation.velocity_east) == pytest.approx(
        velocity_at(159.95), abs=1e-3
    )


@pytest.mark.parametrize(
    ("roll", "offset"),
    # The table of ``make``, halfway between its points, and beyond its ends along the last piece.
    [(-0.8, 0.03), (-0.4, 0.015), (0.4, -0.025), (1.2, -0.075), (-1.2, 0.045)],
)
def test_the_course_through_the_air_is_the_heading_and_the_crab_of_the_bank(roll, offset):
    navigation = make()
    sense(navigation, None, SPEED, 0.7, roll)
    # There is no wind yet; rounding.
    found = math.atan2(navigation.velocity_east, navigation.velocity_north)
    assert found == pytest.approx(0.7 + offset, abs=1e-12)


def test_after_a_loss_of_satellites_the_wind_is_known_as_little_as_it_has_wandered():
    # Errors of a measurement are the same in every direction: the filter is a scalar one.
    error, drift = 0.5, 0.02
    navigation = make(airspeed_sigma=error, course_sigma=error / SPEED, wind_drift=drift)
    where = fly(navigation, steps=2000)
    before = navigation.wind.sigma
    for _ in range(1200):
        sense(navigation, None, SPEED, 0.3)
    for _ in range(5):
        sense(navigation, (*where, *velocity_at(0.0)), SPEED, course_at(0.0))
    # 60 s, and one interval of 0.25 s between measurements.
    wandered = before**2 + drift**2 * 60.25
    after = wandered * error**2 / (wandered + error**2)
    assert navigation.wind.sigma == pytest.approx(math.sqrt(after), rel=1e-9)


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
            heading = course_at(time) + generator.normal(0.0, noise)
            sense(navigation, (0.0, 0.0, *velocity_at(time)), SPEED, heading)
        wrong = math.hypot(navigation.wind.north - WIND[0], navigation.wind.east - WIND[1])
        exceeded += wrong > navigation.wind_error
    assert exceeded <= 20


@pytest.mark.parametrize(
    "course",
    # A circle, and a weave with eta = 1.52 and a period of 19 s, as at nu = 0.5.
    [lambda time: 0.5 * time, lambda time: 0.8 + 1.52 * math.cos(0.33 * time)],
)
def test_the_wind_filter_is_the_kalman_filter_of_the_textbook(course):
    rng, steady, interval = np.random.default_rng(7), np.array([-6.0, 3.5]), 0.25
    airspeed_sigma, course_sigma, drift = 0.5, 0.03, 0.02
    wind = WindFilter(airspeed_sigma=airspeed_sigma, course_sigma=course_sigma, drift=drift)
    state, p = np.zeros(2), np.zeros((2, 2))
    for step in range(400):
        chi = course(step * interval)
        airspeed = SPEED + airspeed_sigma * rng.standard_normal()
        seen = chi + course_sigma * rng.standard_normal()
        velocity = steady + SPEED * np.array([math.cos(chi), math.sin(chi)])
        wind.update(airspeed, seen, *velocity.tolist(), interval)
        p = p + drift**2 * interval * np.eye(2)
        along = np.array([math.cos(seen), math.sin(seen)])
        # Errors along the course and across it.
        axes = np.array([along, [-along[1], along[0]]])
        r = axes.T @ np.diag([airspeed_sigma**2, (airspeed * course_sigma) ** 2]) @ axes
        # Before the first measurement nothing is known.
        gain = p @ np.linalg.inv(p + r) if step else np.eye(2)
        state = state + gain @ (velocity - airspeed * along - state)
        p = (np.eye(2) - gain) @ p if step else r
        # The same filter, with both components at once: rounding.
        assert (wind.north, wind.east) == pytest.approx(state, rel=0.0, abs=1e-9)
        found = wind.variance_north, wind.covariance, wind.variance_east
        assert found == pytest.approx(p[np.triu_indices(2)], rel=1e-8, abs=1e-12)
        assert wind.sigma == pytest.approx(math.sqrt(np.linalg.eigvalsh(p)[-1]), rel=1e-8)
