import functools
import math

import numpy as np
import pytest
from gnc_cases import SPEED, examples
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq

from common.physics import STANDARD_GRAVITY
from gnc.reference.shapes import BankSwing, CoursePath, fourier_coefficients

ROLL_RATE = math.radians(40.0)
HEADING_RATE = STANDARD_GRAVITY / SPEED
"""That of 45 degrees of bank [rad/s]."""


@functools.cache
def courses(*, roll_rate=ROLL_RATE, heading_rate=HEADING_RATE):
    return BankSwing(speed=SPEED, heading_rate=heading_rate, roll_rate_max=roll_rate)


COURSES = courses()

etas = st.floats(0.01, 3.1)
heading_rates, roll_rates = st.floats(0.1, 0.9), st.floats(0.1, 5.0)


def heading_rate_at(swing, eta, time):
    """Return the heading rate some time after the passage through the centre, at full rates
    [rad/s].
    """
    omega_0 = math.pi / swing.half_period(eta)
    return eta * omega_0 * swing.slopes(eta, omega_0 * time)[1]


@given(eta=etas, heading_rate=heading_rates, roll_rate=roll_rates, part=st.floats(0.0, 2.0))
@examples(80)
def test_neither_heading_rate_nor_roll_rate_ever_exceed_their_limits(
    eta, heading_rate, roll_rate, part
):
    swing = courses(heading_rate=heading_rate, roll_rate=roll_rate)
    half = swing.half_period(eta)
    step = 1e-4 * half
    rates = [heading_rate_at(swing, eta, part * half + i * step) for i in range(2)]
    banks = [math.atan(rate * SPEED / STANDARD_GRAVITY) for rate in rates]
    # Rounding, which a difference over a ten-thousandth of half a period magnifies ten thousand
    # times.
    assert max(map(abs, rates)) <= heading_rate * (1.0 + 1e-12)
    assert abs(banks[1] - banks[0]) <= roll_rate * step * (1.0 + 1e-9)


@pytest.mark.parametrize("roll_rate", [0.2, ROLL_RATE, math.inf])
@pytest.mark.parametrize("eta", [0.05, 1.7, 3.9])
def test_the_mean_speed_is_the_mean_of_the_cosine_of_the_course(eta, roll_rate):
    swing = courses(roll_rate=roll_rate)
    # The midpoint rule over a quarter of a period, with a corner in the course's second derivative.
    phases = 0.5 * math.pi * (np.arange(20_000) + 0.5) / 20_000
    mean = np.mean([math.cos(swing.course(eta, phase)) for phase in phases])
    assert swing.speed_ratio(eta) == pytest.approx(mean, rel=0.0, abs=1e-8)
    if swing.speed_ratio(eta) > -0.19:
        # Within the table, which ends at -0.2: 1e-5 by its docstring.
        assert swing.eta(swing.speed_ratio(eta)) == pytest.approx(eta, rel=0.0, abs=1e-5)


@given(
    rolls=st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=40),
    half=st.floats(0.5, 12.0),
    stretch=st.booleans(),
)
@examples(150)
def test_no_course_that_swings_evenly_to_both_sides_within_the_limits_is_slower_on_average(
    rolls, half, stretch
):
    """docs/fastest_oscillation.md: of all such courses of a period, the trapezoid of bank has the
    least mean of the cosine.
    """
    if stretch:
        rolls = [math.copysign(1.0, roll) for roll in rolls]
    # The roll rate is constant over each of the pieces; bank and course are their negatives half a
    # period later.
    points = 400
    time = np.linspace(0.0, half, points * len(rolls) + 1)
    step = time[1]
    bank = np.concatenate([[0.0], np.cumsum(np.repeat(rolls, points)) * ROLL_RATE * step])
    bank -= 0.5 * bank[-1]
    bank *= min(1.0, math.radians(45.0) / max(np.abs(bank).max(), 1e-12))
    rate = STANDARD_GRAVITY / SPEED * np.tan(bank)
    course = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * step)])
    course -= 0.5 * course[-1]
    mean = float(np.trapezoid(np.cos(course), time)) / half
    eta = brentq(lambda eta: COURSES.half_period(eta) - half, 1e-6, 4.0)
    if eta < math.pi:
        # The trapezoidal rule over 1,600 pieces and more: 0.5 rad/s^2 (12 s/1600)^2/12 = 2e-6.
        assert mean >= COURSES.speed_ratio(eta) - 1e-5


@pytest.mark.parametrize("eta", [0.1, 1.657, 2.85])
def test_the_orbit_is_that_of_its_fourier_series_and_of_its_path(eta):
    path = CoursePath(functools.partial(COURSES.course, eta))
    assert path.mean == pytest.approx(COURSES.speed_ratio(eta), abs=1e-8)
    for phase in (-2.0, 0.0, 0.4, 1.5, 3.0, 7.0):
        along, _ = quad(
            lambda at: math.cos(COURSES.course(eta, at)) - path.mean.real,
            0.0,
            phase,
            limit=400,
            epsabs=1e-10,
        )
        right, _ = quad(
            lambda at: math.sin(COURSES.course(eta, at)), 0.0, phase, limit=400, epsabs=1e-10
        )
        # A cubic over pieces of 0.006 rad: 1e-7 by its docstring.
        assert [float(x) for x in path.offset(phase)] == pytest.approx(
            [along, right], rel=0.0, abs=3e-7
        )
        # Eight pairs of terms, whose size falls with the fourth power: below 5e-4 of an orbit of
        # about 1.
        assert COURSES.offset(eta, phase) == pytest.approx((along, right), rel=0.0, abs=5e-4)
    # Parseval: the mean of |exp(i course)|^2 is 1.
    assert float(
        np.sum(np.abs(fourier_coefficients(functools.partial(COURSES.course, eta))) ** 2)
    ) == pytest.approx(1.0, rel=1e-12)
