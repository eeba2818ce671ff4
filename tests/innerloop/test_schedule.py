"""The tables of the autopilot: their signs and symmetry, and the bank for a turn."""

from dataclasses import replace

import numpy as np
import pytest

from aircraft.fleet.x8 import X8
from aircraft.spec import AircraftError
from common.physics import STANDARD_GRAVITY
from innerloop.designer import linear_grid


@pytest.mark.parametrize("index", range(5))
def test_the_bank_for_a_turn_is_that_of_the_equilibrium_with_this_yaw_rate(x8_schedule, index):
    airspeed = x8_schedule.airspeeds[index]
    turns = np.array([airspeed * t.yaw_rate / STANDARD_GRAVITY for t in x8_schedule.trims[index]])
    banks = x8_schedule.bank_for_turn(turns)[:, index]
    # At the nodes: rounding.
    np.testing.assert_allclose(banks, [t.roll for t in x8_schedule.trims[index]], atol=1e-12)


def test_a_design_condition_that_cannot_be_flown_is_refused():
    too_slow = replace(X8, envelope=replace(X8.envelope, airspeed_min=5.0))
    with pytest.raises(AircraftError, match="5 m/s"):
        linear_grid(too_slow, 100.0)
