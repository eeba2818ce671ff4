import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gnc.estimation.antenna import AntennaReport, at_antenna, at_funnel, turned_offset
from gnc.estimation.vessel import VesselReport

OFFSET = (85.0, -3.0)
FUNNEL = VesselReport(10.0, 100.0, -50.0, 6.0, 3.0)


@given(st.floats(-math.pi, math.pi), st.floats(-0.05, 0.05))
def test_from_the_funnel_to_the_antenna_and_back_is_the_same(heading, rate):
    antenna = at_antenna(FUNNEL, OFFSET, heading, rate)
    assert at_funnel(AntennaReport(antenna, heading, rate), OFFSET) == pytest.approx(FUNNEL)


def test_an_antenna_at_the_bow_of_a_ship_that_heads_east_lies_east_of_the_funnel():
    antenna = at_antenna(FUNNEL, (85.0, 0.0), 0.5 * math.pi, 0.0)
    assert (antenna.north - FUNNEL.north, antenna.east - FUNNEL.east) == pytest.approx((0.0, 85.0))


def test_the_antennas_velocity_is_the_rate_of_its_place():
    rate, step = 0.01, 1e-4

    def place(time):
        return turned_offset(OFFSET, 0.4 + rate * time)

    north, east = ((place(step)[i] - place(-step)[i]) / (2.0 * step) for i in (0, 1))
    antenna = at_antenna(FUNNEL, OFFSET, 0.4, rate)
    found = antenna.velocity_north - 6.0, antenna.velocity_east - 3.0
    assert found == pytest.approx((north, east), abs=1e-6)
