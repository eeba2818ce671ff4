"""Where a plume is expected: by prediction, as it is given, and as it is searched for."""

import math
from dataclasses import replace

import numpy as np
import pytest
from exhaust_cases import PRIOR, SENSOR, MadePlume
from gnc_cases import SPEED, centre_parameters
from hypothesis import given
from hypothesis import strategies as st

from gnc.estimation.navigation import AirMotion
from gnc.estimation.plume.estimator import PlumeEstimator
from gnc.estimation.plume.prior import Expectation
from gnc.estimation.vessel import SteadyTarget
from gnc.mission.axis import AxisHeight, AxisInputs, Climb, HeightSearch, SearchedPlume, trail
from gnc.mission.mission import Mode
from gnc.reference.moving_centre import MovingCentre

PLAN_TIME = 0.5
CLIMB = Climb(time=4.0, gradient=0.08)


def situation(*, wind=(0.0, 0.0), vessel=(8.0, 0.0)):
    """Return a vehicle astern of a vessel, whose centre of oscillation has found its place."""
    own = AirMotion(
        ground_north=-230.0, ground_east=0.0, course=0.0, wind_north=wind[0], wind_east=wind[1]
    )
    centre = MovingCentre(centre_parameters(along=(10.0,) * 3, across=(20.0,) * 3))
    target = SteadyTarget(*vessel)
    centre.move(PLAN_TIME, own, target, additional_range=0.0)
    return AxisInputs(own=own, vessel=target, centre=centre, speed=SPEED, plan_time=PLAN_TIME)


EXHAUST = AxisHeight(source=35.0, momentum_flux=124.0, buoyancy_flux=49.6)
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
    assert EXHAUST.at(distance, speed) == pytest.approx(height, abs=0.5)


altitudes = st.floats(20.0, 120.0)


@given(
    altitude=altitudes, demanded=altitudes, gradient=st.floats(0.01, 0.2), time=st.floats(1.0, 20.0)
)
def test_the_command_climbs_no_steeper_than_the_gradient_and_never_beyond_what_is_demanded(
    altitude, demanded, gradient, time
):
    following = Climb(time=time, gradient=gradient).step(altitude, demanded, SPEED, PLAN_TIME)
    # Rounding alone.
    assert abs(following - altitude) <= gradient * SPEED * PLAN_TIME + 1e-9
    assert min(altitude, demanded) - 1e-9 <= following <= max(altitude, demanded) + 1e-9


@given(altitude=altitudes, demanded=altitudes, flown=altitudes)
def test_the_command_stays_within_reach_of_the_altitude_that_is_flown(altitude, demanded, flown):
    following = Climb(time=4.0, gradient=0.08, reach=1.2).step(
        altitude, demanded, SPEED, PLAN_TIME, flown=flown
    )
    assert abs(following - flown) <= 1.2 + 1e-9


def test_the_plume_trails_behind_the_vessels_motion_through_the_air():
    around = situation(wind=(0.0, 8.0), vessel=(8.0, 0.0))
    # A wind to the east as fast as the ship sails north carries its smoke to the south-east.
    assert trail(around.own, around.vessel) == pytest.approx(math.radians(135.0), abs=1e-12)


LOW, HIGH = 20.0, 120.0

PASS_TIME = 9.0


def _search(climb_rate: float = 1.5, lowest: float = LOW, highest: float = HIGH) -> HeightSearch:
    return HeightSearch(lowest=lowest, highest=highest, climb_rate=climb_rate)


def test_the_demanded_height_has_the_least_expected_time_to_find() -> None:
    """Against the definition: passes on the way and there, misses independent given a cell."""
    estimator, climb = PlumeEstimator(PRIOR), 1.5 * PASS_TIME
    MadePlume(height=100.0, peak=0.0).fly(estimator, [62.0] * 2)
    heights = np.linspace(LOW, HIGH, 18)

    def still_searching(target: float) -> float:
        missed, total = 1.0, 0.0
        for k in range(1, 9):
            altitude = 62.0 + min(max(target - 62.0, -climb * k), climb * k)
            nearest = heights[int(np.abs(heights - altitude).argmin())]
            weights, chances = estimator.prospects(np.array([nearest]))
            missed = missed * (1.0 - chances[0])
            total += float(np.sum(weights * missed))
        return total

    best = min(heights.tolist(), key=still_searching)
    assert _search().next_altitude(estimator, 62.0, PASS_TIME) == pytest.approx(best)


FAST = replace(SENSOR, saturated=20000.0)
EXPECTED = Expectation(
    source_height=35.0,
    source_deviation=8.0,
    stack_diameter=1.5,
    exhaust_speed=18.0,
    momentum_flux=124.0,
    buoyancy_flux=49.6,
    co2_rate=37.4,
    load_deviation=0.4,
    wind_deviation=0.5,
    sensor=FAST,
    lowest=23.0,
    highest=117.0,
)
SEARCHED = SearchedPlume(
    height=replace(EXHAUST, lowest=23.0, highest=117.0),
    altitude=60.0,
    climb=CLIMB,
    expected=EXPECTED,
    climb_rate=0.08 * SPEED,
)
CLEAN, PEAK, WIDTH = 420.0, 150.0, 12.0
"""CO2 of clean air, in the plume's centre [ppm], and its spread across and in height [m]: an
example of the fast preset.
"""

STEP, INTERVAL, HALF_WIDTH = 0.1, 6.0, 50.0
"""Between looks [s], between crossings [s], and how far to the side it swings [m]."""


def reading(across, altitude, height):
    return CLEAN + PEAK * math.exp(-0.5 * (across**2 + (altitude - height) ** 2) / WIDTH**2)


def flown(axis, *, height, duration, sensor=lambda _, ppm: ppm, distance=220.0, offset=0.0):
    """Fly back and forth across a plume at a height, with a vehicle that follows its altitude;
    return the modes in their order.

    At a distance astern of the vessel; the plume is offset to the right there.
    """
    around, modes = situation(), []
    own, altitude, swings = around.own, SEARCHED.altitude, []
    for i in range(round(duration / STEP)):
        time = STEP * i
        across = HALF_WIDTH * math.sin(math.pi * time / INTERVAL)
        around.vessel.update(time, False)
        # Astern of a vessel that sails north, right of the plume is west.
        own.ground_north, own.ground_east = around.vessel.north - distance, -across
        altitude += max(-0.15, min(0.15, axis.demanded - altitude))
        axis.flown = altitude
        swings.append(reading(across - offset, altitude, height))
        late = swings[max(0, len(swings) - 1 - round(FAST.delay / STEP))]
        axis.take_readings(time, [(time, sensor(time, late))] if i % 2 == 0 else [])
        if i % round(PLAN_TIME / STEP) == 0:
            axis.plan(time, around, tracking=time > 2.0)
        modes += [axis.mode] if not modes or modes[-1] is not axis.mode else []
    return modes


def noisy(time, ppm):
    """Return a reading with a noise that is no random number: of the data sheet's size, and never
    twice the same.
    """
    return ppm + FAST.noise * math.sqrt(2.0) * math.sin(37.7 * time)


@pytest.mark.parametrize("distance", [130.0, 220.0, 300.0])
def test_the_bearing_is_that_from_the_funnel_wherever_the_plume_is_crossed(distance):
    axis = SEARCHED.begin()
    flown(
        axis, height=60.0, duration=150.0, sensor=noisy, distance=distance, offset=0.08 * distance
    )
    # The prior of 0.06 rad about 0 draws the estimate inwards by a tenth; the centre of the orbit
    # is 213 m astern in each case.
    assert 0.055 < axis.bearing < 0.09


@pytest.mark.parametrize("ladder", [False, True])
def test_a_plume_is_searched_for_found_and_followed(ladder):
    axis = replace(SEARCHED, ladder=ladder).begin()
    modes = flown(axis, height=75.0, duration=180.0, sensor=noisy)
    assert modes == [Mode.SEARCHING, Mode.FOUND]
    # To about its own spread: strength and height off the axis look alike.
    assert abs(axis.estimate.height - 75.0) < WIDTH
    assert axis.estimate.height_deviation < WIDTH
