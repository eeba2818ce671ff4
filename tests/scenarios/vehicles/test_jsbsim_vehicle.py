"""The aircraft behind the closed loop: where it is put, and what its sensors read."""

import math

import numpy as np
import pytest

from aircraft.fleet.x8 import X8
from aircraft.weather import Weather
from aircraft.wind import constant_wind
from gnc.estimation.health import CHECK_INTERVAL, STUCK
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from scenarios.vehicles.jsbsim import JsbsimVehicle

MIDDLE = 2
WIND = (4.0, -9.0)


@pytest.fixture
def place(x8_schedule, x8_root):
    """A function from a weather to the X8 at (10, -20) m with an air-relative course of 0.7 rad."""

    def make(weather, *, time_step=0.05, **how):
        return JsbsimVehicle(
            AutopilotedAircraft(X8, x8_root, **how),
            x8_schedule.level(MIDDLE),
            X8.envelope,
            north=10.0,
            east=-20.0,
            altitude=60.0,
            course=0.7,
            time_step=time_step,
            weather=weather,
        )

    return make


def test_it_starts_with_its_course_against_the_air_and_the_wind_on_top(place, x8_schedule):
    airspeed = x8_schedule.level(MIDDLE).airspeed
    north, east, velocity_north, velocity_east, _ = place(
        Weather(wind=constant_wind(*WIND))
    ).motion()
    assert (north, east) == pytest.approx(
        (10.0, -20.0), abs=0.1
    )  # of plumes and tracks of hundreds of metres
    ground = (airspeed * math.cos(0.7) + WIND[0], airspeed * math.sin(0.7) + WIND[1])
    assert (velocity_north, velocity_east) == pytest.approx(
        ground, abs=1e-5
    )  # 1e-6 ft/s of north wind, and a globe's roundings


def test_it_climbs_and_sinks_to_a_commanded_altitude(place):
    vehicle = place(None)
    vehicle.command_altitude(65.0)
    for _ in range(400):
        vehicle.advance(0.0, 20.0)
    assert vehicle.sample()[0] == pytest.approx(
        65.0, abs=0.1
    )  # 20 s, of a loop that settles within 10 (its design's record)


@pytest.mark.parametrize("rate_hz", [5.0, 6.0, 8.0, 10.0, 20.0, 40.0])
def test_sound_elevons_are_where_they_were_commanded_to_be_however_slow_the_guidance_is(
    place, rate_hz
):
    flown = place(None, time_step=1.0 / rate_hz, failable=True)
    generator = np.random.default_rng(1)

    def errors(seconds, turns=(-0.5, 0.5)):
        # Hard over at random, and up and down: commands of the elevons come and go between two
        # steps of the guidance.
        for second in range(seconds):
            flown.command_altitude(68.0 if second % 2 else 52.0)
            for _ in range(round(rate_hz)):
                yield flown.servo_error()
                flown.advance(float(generator.choice(turns)), 18.0 if second % 3 else 22.0)

    # Those that the monitor of the vehicle's health looks at.
    looks = slice(None, None, max(1, round(CHECK_INTERVAL * rate_hz)))
    assert max(list(errors(30))[looks]) < STUCK
    flown.fail("left_elevon")
    assert max(list(errors(2, turns=(0.5,)))[looks]) > STUCK
