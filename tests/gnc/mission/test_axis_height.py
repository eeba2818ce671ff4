"""The height at which the guidance expects the plume."""

import pytest

from gnc.mission.axis_height import AxisHeight

RISING = AxisHeight(source=35.0, momentum_flux=124.0, buoyancy_flux=49.6)
"""A two-stroke engine of 10 MW: w = 20 m/s out of d = 1.5 m at Ts = 523 K into Ta = 288 K, by
Briggs' Fm = (Ta/Ts) w^2 d^2/4 and F = g w (d^2/4) (1 - Ta/Ts)."""


@pytest.mark.parametrize(
    ("speed", "distance", "height"),
    [
        (5.0, 200.0, 77.0),
        (5.0, 500.0, 111.0),
        (10.0, 200.0, 57.0),
        (10.0, 500.0, 73.0),
        (20.0, 200.0, 47.0),
        (20.0, 500.0, 55.0),
    ],
)
def test_it_is_that_of_the_worked_example(speed, distance, height):
    # The table is printed to a metre.
    assert RISING.at(distance, speed) == pytest.approx(height, abs=0.5)


def test_without_heat_it_is_a_straight_line():
    assert AxisHeight(source=60.0).at(1234.0, 0.1) == 60.0
    assert AxisHeight(source=60.0, climb=0.25).at(200.0, 12.0) == 110.0


def test_it_stays_within_what_is_flown():
    assert AxisHeight(source=35.0, buoyancy_flux=50.0, highest=60.0).at(500.0, 5.0) == 60.0
    assert AxisHeight(source=12.0, lowest=20.0).at(100.0, 5.0) == 20.0


def test_a_calm_does_not_send_the_aircraft_to_the_sky():
    assert RISING.at(300.0, 0.0) == RISING.at(300.0, 1.0) < 400.0
