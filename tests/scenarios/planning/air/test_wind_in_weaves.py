"""The error of the estimated wind by crab angles that are not those of steady turns."""

import math
from dataclasses import replace

import pytest
from flight_cases import scenario

from innerloop.flight.weave import Weave, WeaveSample
from scenarios.planning.air.wind import wind_error_in_weaves
from scenarios.vehicles.vehicle_setup import kinematic_setup

SPEED = 20.0


def sample(course, heading):
    return WeaveSample(
        airspeed=SPEED,
        heading=heading,
        roll=0.0,
        velocity_north=SPEED * math.cos(course),
        velocity_east=SPEED * math.sin(course),
    )


def error(entry, period):
    setting = scenario()
    return wind_error_in_weaves(
        setting, replace(kinematic_setup(setting), weaves=(Weave(entry, period),))
    )


def test_a_crab_angle_that_lasts_is_in_the_wind_in_the_end():
    exact = (sample(0.0, 0.0),)
    wrong = tuple(sample(0.0, 0.02) for _ in range(10))
    # The chord of 0.02 rad at 20 m/s.
    assert error(exact, wrong) == pytest.approx(2.0 * SPEED * math.sin(0.01))


def test_crab_angles_that_take_turns_cancel_but_for_the_filter_s_ripple():
    exact = (sample(0.0, 0.0),)
    one = 2.0 * SPEED * math.sin(0.01)
    wrong = tuple(sample(0.0, 0.02 * (-1) ** i) for i in range(10))
    assert 0.0 < error(exact, wrong) < 0.1 * one
