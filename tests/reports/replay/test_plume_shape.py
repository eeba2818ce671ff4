"""The shape that a plume is drawn with, against the plume model itself."""

import math

import numpy as np
import pytest

from measurement.emission.emission import emission_of
from measurement.emission.fuel import fuel_preset
from measurement.emission.ship import ship_preset
from measurement.plume.air import MarineAir
from measurement.plume.fluctuating_plume import FluctuatingPlume
from measurement.plume.settings import PlumeSettings
from reports.run.plume_shape import LINE_HALF_WIDTH, plume_shape

SPEED, WIND, HEIGHT, LENGTH = 10.0, 7.0, 35.0, 600.0
CONFIG = {
    "plume": {"model": "fluctuating", "source_height_m": HEIGHT, "elevation_deg": 0.0},
    "emission": {"ship": "container", "fuel": "mgo", "sulphur_percent": 0.1, "load": None},
    "wind": {"temperature_c": 15.0, "stability_per_s": 0.0},
}


def shape_of(config, apparent_wind):
    return plume_shape(config, speed=SPEED, wind=WIND, apparent_wind=apparent_wind, length=LENGTH)


def test_at_its_edge_the_mean_plume_has_exp_of_minus_two_of_its_axis():
    # A ship on a course to the north in wind from there: the smoke trails to the south in the apparent wind of both.
    apparent = SPEED + WIND
    shape = shape_of(CONFIG, apparent)
    time = np.arange(-120.0, 1.0, 0.5)
    plume = FluctuatingPlume(
        emission_of(ship_preset("container"), fuel_preset("mgo", 0.1), speed=SPEED),
        MarineAir(wind_speed=WIND, temperature=288.15),
        time=time,
        north=apparent * time,
        east=np.zeros(len(time)),
        source_height=HEIGHT,
        settings=PlumeSettings(mean=True),
    )
    # Away from the funnel, where the axis is not level.
    far = slice(4, None)
    now, south = np.zeros(len(shape.distance[far])), -shape.distance[far]
    edge = plume.sample(now, south, shape.half_width[far], shape.height[far])
    # To 1 %: the tables of the shape and of the plume are linear between ages 0.1 s apart.
    assert edge.dilution / edge.axis_dilution == pytest.approx(math.exp(-2.0), rel=0.01)
    assert edge.axis_height == pytest.approx(shape.height[far], abs=0.05)


def test_smoke_widens_and_rises():
    shape = shape_of(CONFIG, SPEED + WIND)
    assert shape.smoke
    assert np.all(np.diff(shape.half_width) > 0.0)
    assert np.all(np.diff(shape.height) > 0.0)
    assert shape.distance[[0, -1]] == pytest.approx([0.0, LENGTH])


@pytest.mark.parametrize(
    ("changes", "apparent_wind"),
    [({"emission": {"ship": None}}, 17.0), ({"plume": {**CONFIG["plume"], "model": "straight"}}, 17.0), ({}, 0.0)],
)
def test_without_smoke_or_an_apparent_wind_it_is_an_axis(changes, apparent_wind):
    shape = shape_of({**CONFIG, **changes}, apparent_wind)
    assert not shape.smoke
    assert np.all(shape.half_width == LINE_HALF_WIDTH)
    assert np.all(shape.height == HEIGHT)


def test_an_axis_rises_at_its_elevation():
    shape = shape_of({**CONFIG, "plume": {"model": "straight", "source_height_m": HEIGHT, "elevation_deg": 30.0}}, 17.0)
    assert shape.height[-1] - HEIGHT == pytest.approx(LENGTH * math.tan(math.radians(30.0)))


def test_a_speed_that_the_ship_does_not_make_leaves_the_axis():
    shape = plume_shape(CONFIG, speed=30.0, wind=WIND, apparent_wind=37.0, length=LENGTH)
    assert not shape.smoke
