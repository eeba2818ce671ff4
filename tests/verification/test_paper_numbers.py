"""The numbers of the paper and of reference/paper-notes.md ("the notes"), each at the precision at
which it is printed there.
"""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from common.physics import STANDARD_GRAVITY, heading_rate_for_bank
from gnc.paper import (
    PlumeAxis,
    centre_of_oscillation,
    design_oscillation,
    distance_by_paper,
    distance_exact,
    eta_for_speed_ratio,
    half_widths,
    offset,
)

SPEED = 19.42
HEADING_RATE_MAX = 0.503
ASTERN = PlumeAxis(heading=math.pi)


def oscillation_at(nu, **changes):
    return design_oscillation(
        **({"nu": nu, "speed": SPEED, "heading_rate_max": HEADING_RATE_MAX} | changes)
    )


@pytest.mark.parametrize(
    ("nu", "eta", "interval", "d_x", "d_y"),
    [
        # The notes, "Facts to test against". Tolerances: half of the last digit printed there, in
        # each column.
        (0.10, 2.2187, 13.86, 34.35, 104.63),
        (0.30, 1.8687, 11.67, 23.33, 89.32),
        (0.50, 1.5211, 9.50, 13.95, 68.40),
        (0.70, 1.1412, 7.13, 6.43, 43.37),
        (0.90, 0.6406, 4.00, 1.23, 15.13),
    ],
)
def test_the_table_of_orbits(nu, eta, interval, d_x, d_y):
    oscillation = oscillation_at(nu)
    assert oscillation.eta == pytest.approx(eta, abs=5.1e-5)
    assert oscillation.crossing_interval == pytest.approx(interval, abs=5.1e-3)
    assert half_widths(oscillation) == pytest.approx((d_x, d_y), abs=5.1e-3)


def test_sim_3_crosses_every_9_5_seconds_214_metres_from_the_vessel():
    oscillation = oscillation_at(0.5)
    # Section V: every 9.5 s at 214 m with r_min = 200 m, printed to 0.1 s and 1 m.
    assert oscillation.crossing_interval == pytest.approx(9.5, abs=0.05)
    assert distance_by_paper(oscillation, ASTERN, 200.0) == pytest.approx(214.0, abs=0.5)
    # The notes: 9.5006 s, 13.953 m and 68.395 m. Half of the last digit.
    assert oscillation.crossing_interval == pytest.approx(9.5006, abs=5e-5)
    assert half_widths(oscillation) == pytest.approx((13.953, 68.395), abs=5e-4)


def test_the_two_numbers_of_sim_3_give_the_speed_and_heading_rate_that_the_paper_does_not_print():
    # The notes, "Parameters the paper does not print"; half of the last digit of each.
    omega_0 = math.pi / 9.5
    assert omega_0 == pytest.approx(0.3307, abs=5e-5)
    eta = eta_for_speed_ratio(0.5)
    assert eta == pytest.approx(1.521144, abs=5e-7)
    omega_max = eta * omega_0
    assert omega_max == pytest.approx(0.503, abs=5e-4)
    # The orbit scales with V_r at given omega_0, so 14 m along gives V_r: 19.49 m/s for 14.000 m.
    # The notes say 19.4; 14 m has but two digits, and at the 19.42 m/s that they settle on the
    # orbit is 13.953 m.
    speed = brentq(
        lambda v: half_widths(oscillation_at(0.5, speed=v, heading_rate_max=omega_max))[0] - 14.0,
        5.0,
        50.0,
    )
    assert speed == pytest.approx(19.4, abs=0.1)
    assert math.degrees(math.atan(0.503 * 19.4 / STANDARD_GRAVITY)) == pytest.approx(45.0, abs=0.5)
    assert heading_rate_for_bank(math.radians(45.0), 19.4) == pytest.approx(0.503, abs=0.003)


def slack(nu, heading_deg):
    """By how much equation (10) places the CO farther than necessary [m], at r_min = 200 m."""
    oscillation, axis = oscillation_at(nu), PlumeAxis(heading=math.radians(heading_deg))
    return distance_by_paper(oscillation, axis, 200.0) - distance_exact(oscillation, axis, 200.0)


def test_equation_11_is_conservative_by_up_to_ten_metres():
    # The notes, care 4: 9.9 m at nu = 0.1 and 165 degrees. Half of the last digit.
    assert slack(0.1, 165.0) == pytest.approx(9.9, abs=0.05)
    # The notes call that the largest; searched for more finely the largest is 9.985 m, at nu = 0.14
    # and 163.5 degrees.
    assert slack(0.14, 163.5) == pytest.approx(9.985, abs=5e-4)
    slacks = [
        slack(nu, heading)
        for nu in np.linspace(0.02, 0.94, 7)
        for heading in np.linspace(90.0, 180.0, 10)
    ]
    # The search stops within 1e-6 m; none of a grid of 0.15 and 10 degrees is larger than that.
    assert min(slacks) >= -1e-6
    assert 9.0 < max(slacks) <= 9.985 + 5e-4


@pytest.mark.parametrize("elevation", [0.0, 0.3, 0.8])
@pytest.mark.parametrize("nu", [0.1, 0.5])
def test_equation_10_keeps_a_sphere_with_a_margin_for_elevated_plumes(nu, elevation):
    oscillation, axis = oscillation_at(nu), PlumeAxis(heading=0.5 * math.pi, elevation=elevation)
    _, d_y = half_widths(oscillation)
    distance = distance_by_paper(oscillation, axis, 200.0)
    ahead, right, above = centre_of_oscillation(distance, axis)
    along, across = offset(oscillation, np.linspace(0.0, oscillation.period, 4001))
    closest = np.min(np.sqrt((ahead + along) ** 2 + (right + across) ** 2 + above**2))
    # The notes, care 3: the margin left is sqrt(r_min^2 + d^2 sin^2 alpha_P) - r_min. Abeam the
    # orbit's end is that point exactly, and one of the samples, at three quarters of the period.
    # Rounding.
    assert closest - 200.0 == pytest.approx(
        math.sqrt(200.0**2 + (d_y * math.sin(elevation)) ** 2) - 200.0, abs=1e-10
    )
    # And the horizontal distance is r_CO cos alpha_P - d there, which a vertical cylinder of 200 m
    # would not allow.
    assert np.min(np.hypot(ahead + along, right + across)) == pytest.approx(
        distance * math.cos(elevation) - d_y, abs=1e-10
    )


def test_the_reference_respects_the_roll_rate_where_equation_8_does_not():
    # The notes, care 5: eta omega_0^2 is g/V times the roll rate near level. At nu = 0.95 equation
    # (8) alone asks for 0.503^2/0.45 rad/s^2, which is 64 deg/s of roll.
    roll_rate = math.radians(40.0)
    free, limited = oscillation_at(0.95), oscillation_at(0.95, roll_rate_max=roll_rate)
    assert math.degrees(free.eta * free.omega_0**2 * SPEED / STANDARD_GRAVITY) == pytest.approx(
        64.0, abs=1.0
    )
    assert limited.eta * limited.omega_0**2 * SPEED / STANDARD_GRAVITY == pytest.approx(
        roll_rate, rel=1e-13
    )
