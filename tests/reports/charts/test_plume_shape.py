"""How wide and how high a plume is drawn, also against the plume model itself."""

import math

import numpy as np
import pytest

from measurement.emission import emission_of, fuel_preset, ship_of
from measurement.plume.fluctuating_plume import FluctuatingPlume
from measurement.plume.spread import MarineAir, PlumeSettings
from reports.run.flight_config import source_height
from reports.run.surroundings import LINE_HALF_WIDTH, plume_shape

SPEED, WIND, HEIGHT, LENGTH = 12.0, 7.0, 35.0, 800.0
LINE = {
    "plume": {"model": "straight", "elevation_deg": 10.0, "source_height_m": HEIGHT},
    "emission": {"ship": None},
}
SMOKE = {
    "plume": {"model": "fluctuating", "elevation_deg": 0.0, "source_height_m": HEIGHT},
    "emission": {"ship": "container", "fuel": "mgo", "sulphur_percent": 0.1, "load": None},
    "wind": {"temperature_c": 15.0, "stability_per_s": 0.0},
}


def shape_of(config, apparent_wind=10.0, speed=SPEED):
    return plume_shape(config, speed=speed, wind=WIND, apparent_wind=apparent_wind, length=LENGTH)


def test_an_axis_alone_has_the_width_of_a_line_and_rises_as_configured():
    shape = shape_of(LINE)
    assert not shape.smoke
    assert shape.half_width == pytest.approx(np.full(len(shape.distance), LINE_HALF_WIDTH))
    assert shape.height[-1] == pytest.approx(HEIGHT + LENGTH * math.tan(math.radians(10.0)))


def test_at_its_edge_the_mean_plume_has_exp_of_minus_two_of_its_axis():
    # A ship on a course to the north in wind from there: the smoke trails to the south in the
    # apparent wind of both.
    apparent = SPEED + WIND
    shape = shape_of(SMOKE, apparent)
    time = np.arange(-120.0, 1.0, 0.5)
    plume = FluctuatingPlume(
        emission_of(ship_of("container"), fuel_preset("mgo", 0.1), speed=SPEED),
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


def test_smoke_begins_at_the_funnel_of_its_ship_unless_a_height_is_given():
    # measurement/ships.toml: 16 m.
    coaster = SMOKE["emission"] | {"ship": "coaster", "load": 0.5}
    for given, height in ((None, 16.0), (35.0, 35.0)):
        config = SMOKE | {"emission": coaster, "plume": SMOKE["plume"] | {"source_height_m": given}}
        assert source_height(config) == height
        # Downwash in the funnel's wake is a metre at most.
        assert shape_of(config).height[0] == pytest.approx(height, abs=1.0)
    assert source_height(LINE | {"plume": LINE["plume"] | {"source_height_m": None}}) == 60.0


@pytest.mark.parametrize(
    ("changes", "situation"),
    [
        ({"emission": {"ship": None}}, {}),
        ({"plume": SMOKE["plume"] | {"model": "straight"}}, {}),
        # No direction in too weak a wind, a fuel that this version does not take, and a speed that
        # the ship does not make.
        ({}, {"apparent_wind": 0.0}),
        ({}, {"apparent_wind": 0.5}),
        ({"emission": SMOKE["emission"] | {"sulphur_percent": 50.0}}, {}),
        ({}, {"speed": 30.0, "apparent_wind": 37.0}),
    ],
)
def test_what_has_no_plume_is_drawn_as_its_axis(changes, situation):
    shape = shape_of(SMOKE | changes, **situation)
    assert not shape.smoke
    assert np.all(shape.half_width == LINE_HALF_WIDTH)
    assert np.all(shape.height == HEIGHT)
