import math

import numpy as np
import pytest
from scipy.stats import chi2

from gnc.estimation.wind_filter import WindFilter

SPEED = 19.42
WIND = np.array([-6.0, 3.5])
TIME_STEP = 0.25
AIRSPEED_SIGMA, COURSE_SIGMA, DRIFT = 0.5, 0.03, 0.02


def make(**changes):
    sigmas = {"airspeed_sigma": AIRSPEED_SIGMA, "course_sigma": COURSE_SIGMA, "drift": DRIFT}
    return WindFilter(**(sigmas | changes))


def weave(time):
    """Return the course of a weave with eta = 1.52 and a period of 19 s: the reference at nu = 0.5."""
    return 0.8 + 1.52 * math.cos(0.33 * time)


def circle(time):
    return 0.5 * time


def feed(wind_filter, course, wind, airspeed=SPEED, measured_airspeed=None, measured_course=None):
    velocity = wind + airspeed * np.array([math.cos(course), math.sin(course)])
    measured = airspeed if measured_airspeed is None else measured_airspeed
    seen = course if measured_course is None else measured_course
    wind_filter.update(measured, seen, float(velocity[0]), float(velocity[1]), TIME_STEP)
    return velocity


def covariance(wind_filter):
    return np.array(
        [[wind_filter._p_nn, wind_filter._p_ne], [wind_filter._p_ne, wind_filter._p_ee]]
    )


@pytest.mark.parametrize("course", [circle, weave])
def test_exact_sensors_find_a_steady_wind(course):
    wind_filter = make()
    for step in range(240):
        feed(wind_filter, course(step * TIME_STEP), WIND)
    # Every measurement is the wind itself: rounding.
    assert (wind_filter.north, wind_filter.east) == pytest.approx(WIND, abs=1e-12)


def test_the_first_measurement_is_the_first_estimate_however_noisy_it_is_taken_to_be():
    # By moderate turbulence, or at 300 m/s, single measurements are taken to be wrong by 9 m/s.
    # With a likely wind of 10 m/s before them the first estimate was 0.58 of the wind.
    wind_filter = make(airspeed_sigma=9.0, course_sigma=9.0 / SPEED)
    feed(wind_filter, 0.8, WIND)
    assert (wind_filter.north, wind_filter.east) == pytest.approx(WIND, abs=1e-12)
    assert wind_filter.sigma == pytest.approx(9.0)


def test_a_bias_of_the_airspeed_averages_out_in_circles_and_stays_along_a_straight_course():
    round_about, straight = make(drift=0.0), make(drift=0.0)
    # 50.27 s are four circles at 0.5 rad/s.
    steps = round(8.0 * math.pi / 0.5 / TIME_STEP)
    for step in range(steps):
        feed(round_about, circle(step * TIME_STEP), WIND, measured_airspeed=SPEED + 1.0)
        feed(straight, 0.0, WIND, measured_airspeed=SPEED + 1.0)
    # The triangle: an airspeed that reads 1 m/s high takes 1 m/s from the wind along the course.
    assert (straight.north, straight.east) == pytest.approx(WIND - [1.0, 0.0], abs=1e-3)
    # The mean of a unit vector round whole circles is 0; 201 samples are not quite whole ones.
    assert (round_about.north, round_about.east) == pytest.approx(WIND, abs=0.02)


@pytest.mark.parametrize("course", [circle, weave])
def test_it_is_the_kalman_filter_of_the_textbook(course):
    rng = np.random.default_rng(7)
    wind_filter = make()
    state, p = np.zeros(2), np.zeros((2, 2))
    for step in range(400):
        chi = course(step * TIME_STEP)
        airspeed = SPEED + AIRSPEED_SIGMA * rng.standard_normal()
        seen = chi + COURSE_SIGMA * rng.standard_normal()
        velocity = feed(wind_filter, chi, WIND, measured_airspeed=airspeed, measured_course=seen)
        p = p + DRIFT**2 * TIME_STEP * np.eye(2)
        along = np.array([math.cos(seen), math.sin(seen)])
        across = np.array([-along[1], along[0]])
        r = AIRSPEED_SIGMA**2 * np.outer(along, along) + (airspeed * COURSE_SIGMA) ** 2 * np.outer(
            across, across
        )
        # Before the first measurement nothing is known.
        gain = p @ np.linalg.inv(p + r) if step else np.eye(2)
        state = state + gain @ (velocity - airspeed * along - state)
        p = (np.eye(2) - gain) @ p if step else r
        # The same filter, with both components at once: rounding.
        assert (wind_filter.north, wind_filter.east) == pytest.approx(state, rel=0.0, abs=1e-9)
        assert covariance(wind_filter) == pytest.approx(p, rel=1e-8, abs=1e-12)
        assert wind_filter.sigma == pytest.approx(math.sqrt(np.linalg.eigvalsh(p)[-1]), rel=1e-8)


def test_its_covariance_stays_positive_on_a_course_that_never_changes():
    wind_filter = make()
    for _ in range(20_000):
        feed(wind_filter, 0.3, WIND)
    assert np.linalg.eigvalsh(covariance(wind_filter))[0] > 0.0
    # Both components settle where drift and noise balance: p^2 = q r, with q = DRIFT^2 dt for each
    # measurement, and p from after it to before it p + q. The worst direction is across, where r =
    # (V sigma)^2.
    q, r = DRIFT**2 * TIME_STEP, (SPEED * COURSE_SIGMA) ** 2
    after = 0.5 * (math.sqrt(q * q + 4.0 * q * r) - q)
    assert wind_filter.sigma == pytest.approx(math.sqrt(after), rel=1e-6)


@pytest.mark.parametrize("course", [circle, weave])
def test_it_knows_how_wrong_it_is(course):
    rng = np.random.default_rng(11)
    flights, normalised = 200, []
    for _ in range(flights):
        wind_filter = make()
        wind = 5.0 * rng.standard_normal(2)
        for step in range(80):
            wind = wind + DRIFT * math.sqrt(TIME_STEP) * rng.standard_normal(2)
            chi = course(step * TIME_STEP)
            airspeed = SPEED - AIRSPEED_SIGMA * rng.standard_normal()
            seen = chi - COURSE_SIGMA * rng.standard_normal()
            feed(wind_filter, chi, wind, measured_airspeed=airspeed, measured_course=seen)
        error = np.array([wind_filter.north, wind_filter.east]) - wind
        normalised.append(error @ np.linalg.solve(covariance(wind_filter), error))
    # Independent flights: the sum is chi-squared with two degrees of freedom each; the limits hold
    # for all but one set of seeds in 500. The airspeed is the truth less its error, so that the
    # course error acts on the true V_a: a second-order effect.
    low, high = chi2.ppf([0.001, 0.999], 2 * flights) / flights
    assert low < np.mean(normalised) < high
