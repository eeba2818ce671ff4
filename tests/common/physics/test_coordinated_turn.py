"""Coordinated turns: heading rate and bank."""

import math

import pytest

from common.physics.coordinated_turn import bank_for_heading_rate, heading_rate_for_bank


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
