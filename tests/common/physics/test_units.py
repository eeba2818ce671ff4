"""Conversion factors against the definitions they come from."""

import math

import pytest

from common.physics import units


def test_a_nautical_mile_of_6076_feet_is_1852_metres():
    # International nautical mile: 1852 m exactly (BIPM, SI brochure, 8th ed., table 8), or 6076.12
    # ft; tolerance: its last digit.
    assert pytest.approx(1852.0, abs=0.005 * 0.3048) == 6076.12 * units.METRES_PER_FOOT


def test_a_knot_is_1_6878_feet_a_second():
    # MIL-F-8785C gives the winds of its turbulence in knots; 1.68781 ft/s is the conversion of NIST
    # SP 811, appendix B (half its last digit).
    assert pytest.approx(1.68781 * 0.3048, abs=5e-6 * 0.3048) == units.METRES_PER_SECOND_PER_KNOT


def test_a_foot_is_twelve_inches_of_25_4_millimetres():
    # Inch of 25.4 mm exactly: international yard and pound agreement, 1959.
    assert pytest.approx(12 * 0.0254, rel=1e-15) == units.METRES_PER_FOOT  # rounding of one product


def test_a_pound_force_is_a_pound_under_standard_gravity():
    # Pound of 0.45359237 kg (1959 agreement) times 9.80665 m/s^2 (CGPM 1901), both exact.
    assert (
        pytest.approx(0.45359237 * 9.80665, rel=1e-15) == units.NEWTONS_PER_POUND
    )  # rounding of one product


def test_a_slug_gains_one_foot_per_second_squared_from_one_pound_force():
    assert (
        pytest.approx(units.NEWTONS_PER_POUND, rel=1e-15)
        == units.KG_PER_SLUG * units.METRES_PER_FOOT
    )  # rounding


def test_a_slug_weighs_32_174_pounds():
    # Standard gravity is 32.17405 ft/s^2 (NIST SP 811, appendix B); tolerance: half its last digit.
    assert pytest.approx(32.17405, abs=5e-6) == units.KG_PER_SLUG / 0.45359237


def test_sixty_revolutions_a_minute_are_one_turn_a_second():
    assert (
        pytest.approx(2.0 * math.pi, rel=1e-15) == 60.0 * units.RAD_S_PER_RPM
    )  # rounding of one product


def test_sea_level_density_in_slugs_per_cubic_foot_is_1_225_kilograms_per_cubic_metre():
    # U.S. Standard Atmosphere 1976: 0.0023769 slug/ft^3 and 1.2250 kg/m^3; tolerance: half the last
    # digit of the former.
    density = 0.0023769 * units.KG_PER_SLUG / units.METRES_PER_FOOT**3
    assert density == pytest.approx(1.2250, rel=5e-8 / 0.0023769)
