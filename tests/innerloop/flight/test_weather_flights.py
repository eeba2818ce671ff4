"""Flights under the autopilot in wind, turbulence and gusts."""

import math

import numpy as np
import pytest

from aircraft.fdm import EARTH_RATE
from aircraft.fleet.x8 import X8
from aircraft.state import EquatorFrame
from aircraft.weather import TURBULENCE, Gust, Weather
from aircraft.wind import constant_wind
from common.physics import STANDARD_GRAVITY
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft

TIME_STEP = 1.0 / 120.0
FOOT = 0.3048
MIDDLE = 2
YAW = 0.6
TURN = 0.2
FRAME = EquatorFrame(100.0)
READ = (
    ("velocities/vt-fps", FOOT),
    ("position/h-sl-ft", FOOT),
    ("attitude/phi-rad", 1.0),
    ("velocities/v-north-fps", FOOT),
    ("velocities/v-east-fps", FOOT),
    ("position/lat-geod-rad", FRAME.north_scale),
    ("position/long-gc-rad", FRAME.east_scale),
)
AIRSPEED, ALTITUDE, ROLL, NORTH_SPEED, EAST_SPEED, NORTH, EAST = range(7)


def fly(aircraft, start, weather, duration, turn_at=5.0):
    """Fly, and turn from ``turn_at`` [s] on; return what was read at each step, (steps, 7)."""
    aircraft.release(
        start.state(yaw=YAW), airspeed=start.airspeed, altitude=start.altitude, weather=weather
    )
    nodes = [(aircraft.fdm.node(name), scale) for name, scale in READ]
    log = np.empty((round(duration / TIME_STEP), len(nodes)))
    for i, row in enumerate(log):
        if i == round(turn_at / TIME_STEP):
            aircraft.command_heading_rate(TURN)
        row[:] = [node.get_double_value() * scale for node, scale in nodes]
        aircraft.run()
    return log


@pytest.mark.parametrize("toward", [0.0, -90.0, 135.0])
def test_in_wind_an_aircraft_flies_the_calm_path_carried_along(x8_schedule, x8_root, toward):
    start, wind = (
        x8_schedule.level(MIDDLE),
        (10.0 * math.cos(math.radians(toward)), 10.0 * math.sin(math.radians(toward))),
    )
    calm = fly(AutopilotedAircraft(X8, x8_root), start, None, 25.0)
    windy = fly(AutopilotedAircraft(X8, x8_root), start, Weather(wind=constant_wind(*wind)), 25.0)
    course = YAW + start.course_offset()
    # The velocity triangle at the release, to the last digits that are left of a globe's
    # coordinates and 1e-6 ft/s of north wind.
    ground = (
        start.airspeed * math.cos(course) + wind[0],
        start.airspeed * math.sin(course) + wind[1],
    )
    assert windy[0, [NORTH_SPEED, EAST_SPEED]] == pytest.approx(ground, abs=1e-6)
    assert windy[0, AIRSPEED] == pytest.approx(start.airspeed, abs=1e-6)
    # No more of a transient in the first 5 s than in calm air. The earth turns: an aircraft that
    # goes 10 m/s faster eastward weighs 2 x 7.3e-5 x 10 m/s^2 less, 1.5e-4 of its weight, so
    # altitude and airspeed settle as much elsewhere: 0.1 mm and 0.02 mm/s were measured; and the
    # same is allowed of roll [rad], where 5e-7 were.
    first = slice(0, round(5.0 / TIME_STEP))
    transients = [
        np.ptp(flight[first, [AIRSPEED, ALTITUDE, ROLL]], axis=0) for flight in (windy, calm)
    ]
    lighter = 2.0 * EARTH_RATE * 10.0 / STANDARD_GRAVITY
    assert np.all(transients[0] < transients[1] + lighter)
    # And its turns are as much wider, so the path is off by that part of their radius, 15 mm, at
    # most twice across a circle.
    times = TIME_STEP * np.arange(len(calm))
    drift = windy[:, [NORTH, EAST]] - calm[:, [NORTH, EAST]] - np.outer(times, wind)
    assert np.abs(drift).max() < 2.0 * lighter * start.airspeed / TURN


def test_a_used_aircraft_flies_a_weather_as_a_fresh_one_does(x8_schedule, x8_root):
    start = x8_schedule.level(MIDDLE)
    gusts = [
        Gust(start=1.0, rise=0.5, hold=0.5, fall=0.5, velocity_ned=v)
        for v in ((0.0, 3.0, 0.0), (2.0, 0.0, -1.0))
    ]
    rough, other = (
        Weather(
            wind=constant_wind(3.0, -5.0),
            turbulence=TURBULENCE["moderate"],
            gusts=(gust,),
            seed=seed,
        )
        for seed, gust in enumerate(gusts)
    )
    used = AutopilotedAircraft(X8, x8_root)
    for weather in (rough, None):
        # Ends in a turn, in the middle of a gust, and of a period of the autopilot.
        fly(used, start, other, 181 * TIME_STEP, turn_at=0.5)
        fresh = fly(AutopilotedAircraft(X8, x8_root), start, weather, 5.0)
        # Servos and propeller come to rest from elsewhere, to a millionth.
        np.testing.assert_allclose(fly(used, start, weather, 5.0), fresh, atol=1e-5)
