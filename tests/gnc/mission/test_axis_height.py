"""The height at which the guidance expects the plume."""

import pytest

from gnc.mission.axis_height import AxisHeight
from measurement.emission.emission import emission_of
from measurement.emission.fuel import fuel_preset
from measurement.emission.ship import ship_preset
from measurement.plume.rise import rise

CONTAINER = emission_of(ship_preset("container"), fuel_preset("mgo"), speed=12.0)
RISING = AxisHeight(source=35.0, momentum_flux=CONTAINER.momentum_flux, buoyancy_flux=CONTAINER.buoyancy_flux)


@pytest.mark.parametrize(
    ("speed", "distance", "height"),
    # measurement.md, section 2, the worked example's column "axis m".
    [(5.0, 200.0, 77.0), (5.0, 500.0, 111.0), (10.0, 200.0, 57.0), (10.0, 500.0, 73.0), (20.0, 200.0, 47.0), (20.0, 500.0, 55.0)],
)
def test_it_is_that_of_the_worked_example(speed, distance, height):
    # The table is printed to a metre, and the container's fluxes are those of the example to a percent.
    assert RISING.at(distance, speed) == pytest.approx(height, abs=0.7)


@pytest.mark.parametrize("speed", [3.0, 8.0, 19.0])
def test_it_is_the_rise_of_the_measurement_in_neutral_air(speed):
    assert RISING.at(300.0, speed) - 35.0 == pytest.approx(float(rise_of(speed)), rel=1e-9)


def rise_of(speed):
    return rise(CONTAINER, speed, 300.0 / speed)


def test_without_heat_it_is_a_straight_line():
    assert AxisHeight(source=60.0).at(1234.0, 0.1) == 60.0
    assert AxisHeight(source=60.0, climb=0.25).at(200.0, 12.0) == 110.0


def test_it_stays_within_what_is_flown():
    assert AxisHeight(source=35.0, buoyancy_flux=50.0, highest=60.0).at(500.0, 5.0) == 60.0
    assert AxisHeight(source=12.0, lowest=20.0).at(100.0, 5.0) == 20.0


def test_a_calm_does_not_send_the_aircraft_to_the_sky():
    assert RISING.at(300.0, 0.0) == RISING.at(300.0, 1.0) < 400.0
