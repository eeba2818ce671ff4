"""Orbits at the vehicle's limits of bank and roll rate: swing, fastest orbit and loiter."""

import functools
import math

import numpy as np
import pytest
from gnc_cases import SPEED, TIME_STEP, examples
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from common.physics import STANDARD_GRAVITY
from gnc.errors import InfeasibleError
from gnc.paper import PlumeAxis, distance_exact
from gnc.reference.oscillating import JoinedOrbit
from gnc.reference.shapes import BankSwing, Fastest, LoiterShape

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


LIMITS = {
    "speed": SPEED,
    "heading_rate_max": STANDARD_GRAVITY / SPEED,
    "reserve": 0.015,
    "vessel_heading_rate": 0.0,
    "roll_rate_max": math.radians(40.0),
}
"""Those of the issue's table: 45 degrees of bank, of which 1.5 % of the heading rate is kept, and
40 deg/s.
"""

FRACTION = Fastest().turn_rate_fraction_until_tracked


def fastest(nu=0.5, **changes):
    return Fastest().design(**({"nu": nu} | LIMITS | changes))


def reference_on(orbit, *, phase=0.0, turn_rate_fraction=1.0, vessel_course=0.3):
    joined = JoinedOrbit(
        shape=Fastest(), orbit=orbit, vessel_course=vessel_course, time_step=TIME_STEP
    )
    return joined.reference(phase, -214.0, 5.0, turn_rate_fraction=turn_rate_fraction)


def interval_by_integration(nu):
    """Return the shortest interval, from the bank's trapezoid and the heading rates that follow
    from it [s].
    """
    heading_rate = (1.0 - LIMITS["reserve"]) * LIMITS["heading_rate_max"]
    bank_max = math.atan(heading_rate * SPEED / STANDARD_GRAVITY)

    def excess(half):
        time = np.linspace(0.0, half, 20001)
        bank = np.minimum(
            np.minimum(LIMITS["roll_rate_max"] * time, LIMITS["roll_rate_max"] * (half - time)),
            bank_max,
        )
        rate = STANDARD_GRAVITY / SPEED * np.tan(bank)
        course = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * time[1])])
        return float(np.trapezoid(np.cos(course - 0.5 * course[-1]), time)) / half - nu

    return brentq(excess, 0.5, 13.0)


@pytest.mark.parametrize("nu", [0.0, 0.25, 0.5, 0.95])
def test_the_interval_is_that_of_the_trapezoid_integrated_step_by_step(nu):
    # The trapezoidal rule over 20,000 steps: 1e-8.
    assert fastest(nu).crossing_interval == pytest.approx(interval_by_integration(nu), rel=1e-6)


@pytest.mark.parametrize("nu", [0.0, 0.5, 0.9, 0.995])
def test_a_point_that_turns_so_flies_the_orbit(nu):
    orbit = fastest(nu)
    assert_a_point_that_turns_so_flies(orbit, nu, start=(0.0, 0.0, orbit.eta))
    widths = [
        float(np.abs(part).max()) for part in orbit.offset(np.linspace(0.0, orbit.period, 40001))
    ]
    # 40,000 points miss a peak by less than V omega (T/80,000)^2/2 = 2e-7 m.
    assert orbit.half_widths() == pytest.approx(widths, rel=0.0, abs=1e-5)


@pytest.mark.parametrize("share", [FRACTION, 0.5])
def test_a_reference_that_is_slowed_down_has_a_larger_orbit_about_the_same_centre(share):
    orbit = fastest()
    slow = reference_on(orbit, phase=1.0, turn_rate_fraction=share, vessel_course=0.0)
    full = reference_on(orbit, phase=1.0, vessel_course=0.0)
    # About the same centre, 1/share as far off, on the same course.
    assert slow.north + 214.0 == pytest.approx((full.north + 214.0) / share, rel=1e-12)
    assert slow.east - 5.0 == pytest.approx((full.east - 5.0) / share, rel=1e-12)
    assert (slow.course, slow.heading_rate) == (
        full.course,
        pytest.approx(share * full.heading_rate, rel=1e-15),
    )
    for _ in range(round(1.3 * orbit.period / TIME_STEP)):
        slow.step()
        assert abs(slow.heading_rate) <= share * orbit.amplitude * (1.0 + 1e-12)
    # Asked to spend all, it does so from the next passage through the centre on, where it does not
    # turn.
    slow.set_turn_rate_fraction(1.0)
    while slow.turn_rate_fraction != 1.0:
        before = slow.heading_rate
        slow.step()
    # A step of 0.05 s of rolling at 40 deg/s changes it by 0.5 rad/s^2 times that, 0.018 rad/s.
    assert abs(slow.heading_rate - before) < 0.02


def loiter(nu, *, heading_rate=HEADING_RATE, roll_rate=ROLL_RATE):
    return LoiterShape().design(
        nu=nu,
        speed=SPEED,
        heading_rate_max=heading_rate,
        reserve=0.0,
        vessel_heading_rate=0.0,
        roll_rate_max=roll_rate,
    )


ratios = st.floats(0.0, 0.499)  # beside faster vessels there is none at an infinite roll rate


@given(nu=ratios, heading_rate=st.floats(0.1, 0.9), roll_rate=st.floats(0.2, 5.0))
@examples(60)
def test_its_course_goes_round_once_at_the_mean_velocity_of_the_vessel_within_the_limits(
    nu, heading_rate, roll_rate
):
    orbit = loiter(nu, heading_rate=heading_rate, roll_rate=roll_rate)
    phases = 2.0 * math.pi * (np.arange(2000) + 0.5) / 2000
    courses = np.array([orbit.course(phase) for phase in phases.tolist()])
    # The midpoint rule over a period of a course whose slope jumps at most: (2 pi/2000)^2 times a
    # few.
    assert np.mean(np.cos(courses)) == pytest.approx(nu, abs=1e-4)
    assert np.mean(np.sin(courses)) == pytest.approx(0.0, abs=1e-10)
    assert orbit.course(phases[3] + 2.0 * math.pi) == pytest.approx(
        courses[3] + 2.0 * math.pi, rel=1e-13
    )
    rates = np.array([orbit.heading_rate(phase) for phase in phases.tolist()])
    assert rates.max() <= heading_rate * (1.0 + 1e-12)
    assert rates.min() >= 0.0
    banks = np.arctan(rates * SPEED / STANDARD_GRAVITY)
    # Rounding.
    assert np.abs(np.diff(banks)).max() <= roll_rate * orbit.period / 2000 * (1.0 + 1e-6)


@pytest.mark.parametrize("nu", [0.0, 0.05, 0.25, 0.5])
def test_a_point_that_turns_so_flies_the_orbit_and_meets_the_plume_every_half_turn(nu):
    orbit = loiter(nu)
    along, right = orbit.offset(np.zeros(1))
    assert_a_point_that_turns_so_flies(orbit, nu, start=(float(along[0]), float(right[0]), 0.0))
    # On the plume's axis a quarter of a period before and after phase 0.
    crossings = orbit.offset(np.array([0.25, 0.75]) * orbit.period)[1]
    assert crossings == pytest.approx([0.0, 0.0], abs=1e-4)
    widths = [
        float(np.abs(part).max()) for part in orbit.offset(np.linspace(0.0, orbit.period, 20001))
    ]
    assert orbit.half_widths() == pytest.approx(widths, rel=0.0, abs=1e-4)
    along, right = orbit.offset(np.linspace(0.0, orbit.period, 20001))
    # Its halves are not alike: a plume abeam shows whether the near one keeps off.
    for heading in (math.pi, 0.5 * math.pi):
        distance = distance_exact(orbit, PlumeAxis(heading=heading), 200.0)
        ahead, abeam = distance * math.cos(heading), distance * math.sin(heading)
        closest = np.hypot(ahead + along, abeam + right).min()
        assert closest == pytest.approx(200.0, abs=1e-4)


@pytest.mark.parametrize(("nu", "roll_rate"), [(0.54, ROLL_RATE), (0.499, math.inf)])
def test_up_to_about_half_the_speed_it_crosses_the_plume_and_beside_faster_vessels_it_is_refused(
    nu, roll_rate
):
    orbit = loiter(nu, roll_rate=roll_rate)
    # Within two thousandths of the limit it just reaches both sides: at phase 0 the left, half a
    # period later the right.
    left, right = orbit.offset(np.array([0.0, 0.5]) * orbit.period)[1]
    assert left <= 0.0 < right
    assert orbit.straight == pytest.approx(0.5 * orbit.crossing_interval, rel=0.05)
    # The straight leg takes nu of the time at an infinite roll rate; at 40 deg/s half of it at
    # 0.546.
    for faster in (nu + 0.01, 0.6, 0.9):
        with pytest.raises(
            InfeasibleError,
            match=r"stays on one side of the plume.*: set reference\.shape to 'fastest'",
        ):
            loiter(faster, roll_rate=roll_rate)


def assert_a_point_that_turns_so_flies(orbit, nu, start):
    """Integrate a point from a place and course, turning at the orbit's heading rate; its path is
    that of the orbit's offsets.
    """

    def motion(time, state):
        return (
            SPEED * math.cos(state[2]),
            SPEED * math.sin(state[2]),
            orbit.heading_rate(orbit.omega_0 * time),
        )

    times = np.linspace(0.0, orbit.period, 41)
    along, right = orbit.offset(times)
    flown = solve_ivp(
        motion, (0.0, orbit.period), start, t_eval=times, max_step=0.02, rtol=1e-9, atol=1e-9
    ).y
    # Steps of 0.02 s over corners of the roll rate of 0.7 rad/s^2: 1e-5 m each, and that of the
    # path's spline.
    assert along + nu * SPEED * times == pytest.approx(flown[0], rel=0.0, abs=1e-3)
    assert right == pytest.approx(flown[1], rel=0.0, abs=1e-3)
