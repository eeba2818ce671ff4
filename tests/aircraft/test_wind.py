"""The mean wind over time and height, and how it moves the air in JSBSim."""

import math

import numpy as np
import pytest

from aircraft.fdm import Fdm
from aircraft.fleet.x8 import X8
from aircraft.spec import AircraftError
from aircraft.trim import trim
from aircraft.weather import Gust, Weather
from aircraft.wind import CALM, WindField, constant_wind, over_the_sea

CHANGING = WindField(
    [[[2.0, -1.0], [4.0, -3.0]], [[6.0, 1.0], [8.0, 5.0]], [[0.0, 0.0], [1.0, 1.0]]],
    times=(100.0, 200.0, 500.0),
    heights=(10.0, 100.0),
)


def test_its_largest_change_within_an_interval_is_that_of_every_pair_of_times():
    wind = WindField(
        [[[0.0, 0.0]], [[0.0, 0.0]], [[6.0, 0.0]], [[6.0, -8.0]]], times=(0.0, 100.0, 110.0, 190.0)
    )
    time = np.linspace(0.0, 180.0, 1801)
    north, east = wind.at(time, 10.0)
    for interval in (5.0, 20.0, 300.0):
        near = np.abs(np.subtract.outer(time, time)) <= interval + 1e-9
        apart = np.hypot(np.subtract.outer(north, north), np.subtract.outer(east, east))[near].max()
        assert wind.largest_change(interval, 180.0, [10.0]) == pytest.approx(apart, abs=1e-9)
    # 0.6 m/s each second for 10 s, then 0.1 for 10 s across.
    assert wind.largest_change(20.0, 180.0, [10.0]) == pytest.approx(math.hypot(6.0, 1.0))
    # What comes after the flight does not count, and nothing changes where the table has one time.
    assert wind.largest_change(20.0, 90.0, [10.0]) == 0.0
    steady = over_the_sea(np.array([[5.0, 0.0]]), [0.0], roughness=2e-4, height=10.0)
    assert steady.largest_change(20.0, 90.0, [10.0, 100.0]) == 0.0
    # At any of the heights: at 100 m it changes by (4, 8) m/s in 100 s, at 10 m by (4, 2).
    for heights, change in (([10.0], (4.0, 2.0)), ([10.0, 100.0], (4.0, 8.0))):
        found = CHANGING.largest_change(50.0, 190.0, heights)
        assert found == pytest.approx(0.5 * math.hypot(*change))


def test_its_largest_shear_is_that_of_every_pair_of_heights():
    wind = WindField(
        [[[8.0, 0.0], [8.0, 0.0], [-10.0, 0.0], [-10.0, 4.0]]], heights=(1.0, 38.0, 45.0, 200.0)
    )
    height = np.linspace(20.0, 120.0, 2001)
    north, east = wind.at(0.0, height)
    for apart in (3.0, 18.0, 500.0):
        near = np.abs(np.subtract.outer(height, height)) <= apart + 1e-9
        shear = np.hypot(np.subtract.outer(north, north), np.subtract.outer(east, east))[near].max()
        assert wind.largest_shear(apart, 20.0, 120.0, 60.0) == pytest.approx(shear, abs=0.01)
    # At any time of the flight; and none where one height is flown, or the table has one.
    late, early = (CHANGING.largest_shear(90.0, 10.0, 100.0, end) for end in (500.0, 100.0))
    assert late > early
    assert wind.largest_shear(18.0, 60.0, 60.0, 60.0) == 0.0
    assert WindField([3.0, 0.0]).largest_shear(18.0, 20.0, 120.0, 60.0) == 0.0


def test_it_is_the_table_at_its_points_and_linear_between_them():
    assert CHANGING.now(100.0, 10.0) == (2.0, -1.0)
    assert CHANGING.now(200.0, 100.0) == (8.0, 5.0)
    # Half-way in time; and at the geometric mean of the heights, half-way in the logarithm of
    # height.
    assert CHANGING.now(150.0, 10.0) == pytest.approx((4.0, 0.0), abs=1e-12)
    assert CHANGING.now(100.0, math.sqrt(1000.0)) == pytest.approx((3.0, -2.0), abs=1e-12)


@pytest.mark.parametrize(
    "wind",
    [
        CHANGING,
        constant_wind(3.0, -2.0),
        over_the_sea(np.array([[5.0, 1.0]]), [0.0], roughness=2e-4, height=10.0),
    ],
)
def test_displacement_is_the_integral_of_the_wind(wind):
    times = np.linspace(0.0, 700.0, 7001)
    for height in (5.0, 40.0, 300.0):
        velocity = np.column_stack(wind.at(times, height))
        integral = np.vstack([[0.0, 0.0], np.cumsum(0.05 * (velocity[1:] + velocity[:-1]), axis=0)])
        # The trapezoidal rule is exact between points of the table, which are times of the sum.
        np.testing.assert_allclose(
            np.column_stack(wind.displacement(times, height)), integral, rtol=0.0, atol=1e-8
        )
    # At many heights at once, and from time 0 on backwards.
    north, east = wind.displacement(np.array([-10.0]), np.array([5.0, 40.0]))
    np.testing.assert_allclose(
        np.stack([north, east]), -10.0 * np.stack(wind.at(-5.0, np.array([5.0, 40.0]))), atol=1e-9
    )


def test_a_constant_wind_is_the_same_to_the_last_bit():
    wind = constant_wind(0.1, -0.7)
    assert wind.constant
    assert CALM.constant
    assert not CHANGING.constant
    north, east = wind.at(np.arange(5.0), 60.0)
    assert north.tolist() == [0.1] * 5
    assert east.tolist() == [-0.7] * 5
    assert wind == constant_wind(0.1, -0.7) != CALM


def test_over_the_sea_it_follows_the_logarithm_of_height():
    wind = over_the_sea(np.array([[-6.0, 8.0]]), [0.0], roughness=2e-4, height=10.0)
    for height in (0.5, 10.0, 60.0, 999.0):
        # V(z) = V(10 m) ln(z/z0)/ln(10 m/z0).
        expected = 10.0 * math.log(height / 2e-4) / math.log(10.0 / 2e-4)
        assert math.hypot(*wind.now(0.0, height)) == pytest.approx(expected, rel=1e-12)
    assert wind.now(0.0, 1e-4) == pytest.approx((0.0, 0.0), abs=1e-12)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"velocity": [math.nan, 0.0]}, "wind is nan m/s"),
        ({"velocity": np.zeros((2, 1, 2)), "times": (5.0, 5.0)}, "times of the wind do not ascend"),
        (
            {"velocity": np.zeros((1, 2, 2)), "heights": (20.0, 10.0)},
            "heights of the wind do not ascend",
        ),
    ],
)
def test_what_is_no_wind_is_refused(values, message):
    with pytest.raises(AircraftError, match=message):
        WindField(**values)


def test_jsbsim_feels_the_wind_of_the_time_and_the_height(x8_aircraft):
    wind = WindField([[[0.0, 0.0]], [[6.0, 0.0]]], times=(0.0, 6.0), heights=(10.0,))
    gust = Gust(start=100.0, rise=1.0, fall=1.0, velocity_ned=(0.0, 1.0, 0.0))
    start = trim(Fdm(X8), airspeed=20.0, altitude=100.0).state()
    weather = Weather(wind=wind, gusts=(gust,))
    x8_aircraft.release(start, airspeed=20.0, altitude=100.0, weather=weather)
    for _ in range(3 * 120):
        x8_aircraft.run()
    # The last of 360 steps was made in the wind of 2.99 s: 1 m/s^2 of 120 steps a second.
    for name, tolerance in (("wind", 1e-9), ("total-wind", 1e-6)):
        north = x8_aircraft.fdm.read(f"atmosphere/{name}-north-fps") * 0.3048
        assert north == pytest.approx(3.0 - 1.0 / 120.0, abs=tolerance)
