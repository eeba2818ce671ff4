"""Units, wind and coordinated turns, against their definitions."""

import math

import pytest

from common import physics
from common.physics import bank_for_heading_rate, heading_rate_for_bank

# International foot and pound: agreement of 1959, exact; standard gravity: CGPM 1901, exact.
POUND = 0.45359237


@pytest.mark.parametrize(
    ("value", "expected", "tolerance"),
    [
        # Inch of 25.4 mm exactly.
        (physics.METRES_PER_FOOT, 12 * 0.0254, 1e-16),
        # 1852 m exactly (BIPM, SI brochure, 8th ed., table 8), or 6076.12 ft: its last digit.
        (6076.12 * physics.METRES_PER_FOOT, 1852.0, 0.005 * 0.3048),
        # MIL-F-8785C gives winds of its turbulence in knots; 1.68781 ft/s is the conversion of NIST
        # SP 811, appendix B: half its last digit.
        (physics.METRES_PER_SECOND_PER_KNOT, 1.68781 * 0.3048, 5e-6 * 0.3048),
        (physics.NEWTONS_PER_POUND, POUND * 9.80665, 1e-15),
        # One pound-force gives a slug one foot per second squared.
        (physics.KG_PER_SLUG * physics.METRES_PER_FOOT, physics.NEWTONS_PER_POUND, 4e-15),
        # 32.17405 ft/s^2 (NIST SP 811, appendix B): half its last digit.
        (physics.KG_PER_SLUG / POUND, 32.17405, 5e-6),
        # Sixty revolutions a minute are one turn a second.
        (60.0 * physics.RAD_S_PER_RPM, 2.0 * math.pi, 6e-15),
        # U.S. Standard Atmosphere 1976: 0.0023769 slug/ft^3 and 1.2250 kg/m^3; half the last digit.
        (
            0.0023769 * physics.KG_PER_SLUG / physics.METRES_PER_FOOT**3,
            1.2250,
            1.2250 * 5e-8 / 0.0023769,
        ),
    ],
)
def test_units_are_those_of_their_definitions(value, expected, tolerance):
    # Without another tolerance: rounding of a product.
    assert value == pytest.approx(expected, rel=0.0, abs=tolerance)


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
