"""Units, wind and coordinated turns, against their definitions."""

import math

import pytest

from common import physics
from common.physics import bank_for_heading_rate, heading_rate_for_bank, wind_towards, wind_velocity


def test_a_nautical_mile_of_6076_feet_is_1852_metres():
    # International nautical mile: 1852 m exactly (BIPM, SI brochure, 8th ed., table 8), or 6076.12
    # ft; tolerance: its last digit.
    assert pytest.approx(1852.0, abs=0.005 * 0.3048) == 6076.12 * physics.METRES_PER_FOOT


def test_a_knot_is_1_6878_feet_a_second():
    # MIL-F-8785C gives the winds of its turbulence in knots; 1.68781 ft/s is the conversion of NIST
    # SP 811, appendix B (half its last digit).
    assert pytest.approx(1.68781 * 0.3048, abs=5e-6 * 0.3048) == physics.METRES_PER_SECOND_PER_KNOT


def test_a_foot_is_twelve_inches_of_25_4_millimetres():
    # Inch of 25.4 mm exactly: international yard and pound agreement, 1959.
    assert (
        pytest.approx(12 * 0.0254, rel=1e-15) == physics.METRES_PER_FOOT
    )  # rounding of one product


def test_a_pound_force_is_a_pound_under_standard_gravity():
    # Pound of 0.45359237 kg (1959 agreement) times 9.80665 m/s^2 (CGPM 1901), both exact.
    assert (
        pytest.approx(0.45359237 * 9.80665, rel=1e-15) == physics.NEWTONS_PER_POUND
    )  # rounding of one product


def test_a_slug_gains_one_foot_per_second_squared_from_one_pound_force():
    assert (
        pytest.approx(physics.NEWTONS_PER_POUND, rel=1e-15)
        == physics.KG_PER_SLUG * physics.METRES_PER_FOOT
    )  # rounding


def test_a_slug_weighs_32_174_pounds():
    # Standard gravity is 32.17405 ft/s^2 (NIST SP 811, appendix B); tolerance: half its last digit.
    assert pytest.approx(32.17405, abs=5e-6) == physics.KG_PER_SLUG / 0.45359237


def test_sixty_revolutions_a_minute_are_one_turn_a_second():
    assert (
        pytest.approx(2.0 * math.pi, rel=1e-15) == 60.0 * physics.RAD_S_PER_RPM
    )  # rounding of one product


def test_sea_level_density_in_slugs_per_cubic_foot_is_1_225_kilograms_per_cubic_metre():
    # U.S. Standard Atmosphere 1976: 0.0023769 slug/ft^3 and 1.2250 kg/m^3; tolerance: half the last
    # digit of the former.
    density = 0.0023769 * physics.KG_PER_SLUG / physics.METRES_PER_FOOT**3
    assert density == pytest.approx(1.2250, rel=5e-8 / 0.0023769)


@pytest.mark.parametrize(
    ("from_deg", "velocity"),
    [(0.0, (-5.0, 0.0)), (90.0, (0.0, -5.0)), (225.0, (5.0 / math.sqrt(2.0),) * 2)],
)
def test_wind_blows_away_from_where_it_comes_from(from_deg, velocity):
    # Sines of multiples of pi are off by 1e-16 of a circle.
    assert wind_velocity(5.0, from_deg) == pytest.approx(velocity, abs=1e-14)
    assert math.cos(wind_towards(from_deg)) * 5.0 == pytest.approx(velocity[0], abs=1e-14)


def test_a_coordinated_turn_balances_gravity():
    # tan(bank) = V omega/g in a coordinated turn; at 45 degrees omega = g/V. Tolerances are
    # roundings.
    assert heading_rate_for_bank(math.radians(45.0), 20.0) == pytest.approx(
        9.80665 / 20.0, rel=1e-15
    )
    rate = heading_rate_for_bank(math.radians(30.0), 15.0)
    assert math.atan(15.0 * rate / 9.80665) == pytest.approx(math.radians(30.0), rel=1e-14)


@pytest.mark.parametrize("bank_deg", [0.0, 20.0, 45.0, 60.0])
def test_bank_and_heading_rate_of_a_coordinated_turn_are_each_others_inverse(bank_deg):
    bank = math.radians(bank_deg)
    # tan and atan, each to a rounding.
    assert bank_for_heading_rate(heading_rate_for_bank(bank, 19.42), 19.42) == pytest.approx(
        bank, abs=1e-15
    )
