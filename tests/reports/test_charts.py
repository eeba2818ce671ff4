"""Axes, maps, plumes, colours and data of charts."""

import base64
import itertools
import math
import re
import tomllib
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import reports
from measurement.emission import emission_of, fuel_preset, ship_of
from measurement.plume.fluctuating_plume import FluctuatingPlume
from measurement.plume.spread import MarineAir, PlumeSettings
from reports.document.axes import in_kilometres, log_axis
from reports.document.chart import Chart, Line, Panel
from reports.document.palette import COLOURS, SERIES, Meaning
from reports.document.ship_map import area_outline, hull_line, hull_words, plume_lines
from reports.render.plotly_charts import draw
from reports.run.flight_config import ANY, HULLS, Hull, hull_of, outline_of, source_height
from reports.run.surroundings import LINE_HALF_WIDTH, plume_shape


@pytest.mark.parametrize(
    ("limits", "marks"),
    [
        ((0.1, 1000.0), [0.1, 1.0, 10.0, 100.0, 1000.0]),
        ((0.7, 130.0), [1.0, 10.0, 100.0]),
        ((2.0, 130.0), [3.0, 10.0, 30.0, 100.0]),
        ((1.5, 6.0), [2.0, 3.0, 4.0, 5.0, 6.0]),
        ((0.0121, 0.0149), [0.013, 0.014]),
    ],
)
def test_a_logarithmic_axis_has_three_marks_at_least_and_powers_of_ten_where_they_are_enough(
    limits, marks
):
    assert log_axis(limits, [])[1] == pytest.approx(marks)


def test_limits_that_are_not_given_hold_the_positive_data_with_room_to_spare():
    (low, high), _ = log_axis(None, [np.array([0.0, 2.0, np.nan]), np.array([50.0, -1.0])])
    assert 1.5 < low < 2.0
    assert 50.0 < high < 65.0
    low, high = log_axis(None, [np.zeros(2)])[0]
    assert 0.0 < low < high


@pytest.mark.parametrize(
    ("reach", "equal", "labels"),
    [
        ((9_999.0, 500.0), True, ("East [m]", "North [m]")),
        # Of two axes that are equally long, both.
        ((500.0, 10_000.0), True, ("East [km]", "North [km]")),
        ((500.0, 10_000.0), False, ("East [m]", "North [km]")),
    ],
)
def test_far_flights_are_shown_in_kilometres(reach, equal, labels):
    line = Line(x=np.array([-reach[0], 0.0]), y=np.array([0.0, -reach[1]]), label="", colour="blue")
    nothing = Line(x=np.array([]), y=np.array([]), label="", colour="blue")
    panel = in_kilometres(
        Panel(x_label="East [m]", y_label="North [m]", lines=[nothing, line], equal=equal)
    )
    assert (panel.x_label, panel.y_label) == labels
    shown = [1000.0 if "[km]" in label else 1.0 for label in labels]
    assert panel.lines[1].x[0] * shown[0] == pytest.approx(-reach[0], rel=1e-12)
    assert panel.lines[1].y[1] * shown[1] == pytest.approx(-reach[1], rel=1e-12)


@pytest.mark.parametrize("angle", [0.0, 0.7, math.pi, -2.0])
def test_a_hull_is_to_scale_with_its_bow_at_the_angle(angle):
    line = hull_line(Hull(title="a ship", length=150.0, beam=23.0), angle, x=10.0, y=-5.0)
    ahead = np.array([math.sin(angle), math.cos(angle)])
    beside = np.array([math.cos(angle), -math.sin(angle)])
    along, across = (
        np.column_stack([line.x - 10.0, line.y + 5.0]) @ side for side in (ahead, beside)
    )
    # The funnel is a fifth of the length from the stern.
    assert (along.min(), along.max()) == pytest.approx((-30.0, 120.0))
    assert (across.min(), across.max()) == pytest.approx((-11.5, 11.5))
    assert (line.x[0], line.y[0]) == pytest.approx((line.x[-1], line.y[-1]))


def test_a_plume_begins_at_the_funnel_and_is_as_wide_as_given():
    width, axis = plume_lines(
        np.array([0.0, 100.0]), np.array([2.0, 10.0]), math.radians(90.0), x=1.0
    )
    # Along x: its width lies across, along y.
    assert (axis.x.tolist(), axis.y) == (pytest.approx([1.0, 101.0]), pytest.approx([0.0, 0.0]))
    assert (width.y.min(), width.y.max()) == pytest.approx((-10.0, 10.0))
    assert [line.label for line in plume_lines(np.array([0.0, 100.0]), None)] == ["plume's axis"]


GIVEN = {
    "vessel": {
        "length_m": 120.0,
        "beam_m": 18.0,
        "stack_from_bow_m": 90.0,
        "stack_from_port_m": 12.0,
    }
}


def test_a_ship_of_a_given_size_is_drawn_so_about_its_stack():
    hull = hull_of(GIVEN)
    line = hull_line(hull, 0.0, x=10.0, y=-5.0)
    assert (line.label, line.style) == ("ship, to scale", "thin")
    # 90 m ahead of the funnel and 30 m astern; 12 m to port and 6 m to starboard.
    assert (line.y.min(), line.y.max()) == pytest.approx((-35.0, 85.0))
    assert (line.x.min(), line.x.max()) == pytest.approx((-2.0, 16.0))
    assert hull_words(hull) == "its hull is 120 m by 18 m"


def test_every_ship_that_is_known_has_a_hull():
    text = files("measurement").joinpath("ships.toml").read_text(encoding="utf-8")
    assert set(HULLS) == set(tomllib.loads(text))
    assert hull_of({"emission": {"ship": "coaster"}}) == HULLS["coaster"]
    assert hull_of({"emission": {"ship": None}}) == hull_of({}) == ANY


@pytest.mark.parametrize("angle", [0.0, 0.7, math.pi])
def test_the_area_about_a_hull_ends_r_min_from_its_outline(angle):
    about = SimpleNamespace(outline=outline_of(GIVEN), radius=200.0)
    x, y = area_outline(about, angle)
    assert (x[0], y[0]) == (x[-1], y[-1])
    # Back to places ahead of the funnel and to starboard of it.
    ahead = math.sin(angle) * x + math.cos(angle) * y
    starboard = math.cos(angle) * x - math.sin(angle) * y
    assert about.outline.distance(ahead, starboard) == pytest.approx(200.0)


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


# Machado, Oliveira and Fernandes, A physiologically-based model for simulation of color vision
# deficiency, IEEE TVCG 15 (2009), severity 1.0, for linear RGB.
DEFICIENCIES = {
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
}


def linear(name):
    """Return linear RGB of a colour, by the transfer function of sRGB, IEC 61966-2-1."""
    channel = np.array([int(COLOURS[name][i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    return np.where(channel <= 0.04045, channel / 12.92, ((channel + 0.055) / 1.055) ** 2.4)


def lab(rgb):
    """Return CIE L*a*b* of linear RGB, white of D65."""
    to_xyz = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    )
    ratio = to_xyz @ np.clip(rgb, 0.0, 1.0) / np.array([0.9505, 1.0, 1.089])
    f = np.where(ratio > (6 / 29) ** 3, np.cbrt(ratio), ratio / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])])


@pytest.mark.parametrize("deficiency", DEFICIENCIES)
def test_meanings_and_series_differ_to_eyes_without_red_or_green_cones(deficiency):
    # A difference of 10 in L*a*b* is seen at a glance; 2.3 is just noticeable (Mahy et al. 1994).
    seen = {name: lab(np.array(DEFICIENCIES[deficiency]) @ linear(name)) for name in COLOURS}
    for first, second in [*itertools.combinations(Meaning, 2), *itertools.combinations(SERIES, 2)]:
        assert np.linalg.norm(seen[first] - seen[second]) > 10.0, (first, second)


def test_limits_and_the_guard_have_their_colours_by_their_meaning_alone():
    package = Path(reports.__file__).parent
    named = [
        path.name
        for path in package.rglob("*.py")
        if re.search(r'"(vermillion|purple)"', path.read_text(encoding="utf-8"))
    ]
    assert named == ["palette.py"]


def drawn(**kinds):
    """Return a chart of one panel as the page reads it."""
    x = np.array([1.0, 10.0])
    line = Line(x=x, y=x, label="curve", colour="blue")
    panel = Panel(**{"x_label": "Time [s]", "y_label": "Distance [m]", "lines": [line]} | kinds)
    return draw(Chart(name="chart", caption="", panels=[panel]))


def test_numbers_come_back_to_single_precision():
    line = Line(
        x=np.array([0.1, np.nan, 3.0]),
        y=np.array([]),
        label="",
        colour="blue",
        error=np.array([1.0, 2.0, 3.0]),
    )
    (trace,) = drawn(lines=[line])["panels"][0]["data"]
    found = np.frombuffer(base64.b64decode(trace["x"]["bdata"]), dtype=trace["x"]["dtype"])
    np.testing.assert_array_equal(found, np.array([0.1, np.nan, 3.0], dtype=np.float32))
    assert trace["y"] == []
    bars = base64.b64decode(trace["error_y"]["array"]["bdata"])
    assert np.frombuffer(bars, dtype="<f4").tolist() == [1.0, 2.0, 3.0]
