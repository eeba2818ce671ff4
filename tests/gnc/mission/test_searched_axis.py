"""A plume that is searched for: what the guidance does before, while and after it detects
something.
"""

import math
from dataclasses import replace

import pytest
from exhaust_cases import SENSOR

from gnc.estimation.plume.passes import SensorState
from gnc.estimation.plume.prior import Expectation
from gnc.mission.mode import Mode
from gnc.mission.plume_axis import Climb
from gnc.mission.searched_axis import SearchedPlume
from tests.gnc.mission.axis_cases import PLAN_TIME, RISING, SPEED, situation

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
    height=RISING,
    altitude=60.0,
    climb=Climb(time=4.0, gradient=0.08),
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
        around.target.update(time, False)
        # Astern of a vessel that sails north, right of the plume is west.
        own.ground_north, own.ground_east = around.target.north - distance, -across
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


def test_on_the_way_it_flies_at_the_height_that_is_predicted_and_believes_nothing():
    axis, around = SEARCHED.begin(), situation()
    axis.take_readings(0.0, [(0.0, 420.0)])
    axis.plan(0.0, around, tracking=False)
    assert axis.demanded == RISING.at(around.centre.distance, 8.0)
    assert math.isnan(axis.estimate.height)
    assert math.isnan(axis.measurable())


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


def test_a_plume_above_the_limits_is_searched_for_within_them_and_found_to_be_out_of_reach():
    low = replace(SEARCHED, expected=replace(EXPECTED, highest=50.0), altitude=45.0)
    axis, fresh = low.begin(), low.begin()
    assert flown(axis, height=110.0, duration=120.0, sensor=noisy) == [Mode.SEARCHING]
    assert EXPECTED.lowest <= axis.demanded <= 50.0
    fresh.plan(0.0, situation(), tracking=True)
    assert axis.measurable() < 0.5 * fresh.measurable()
    assert axis.estimate.height > 60.0


@pytest.mark.parametrize(
    ("sensor", "state"),
    [(lambda *_: 420.0, SensorState.STUCK), (lambda *_: 20000.0, SensorState.SATURATED)],
)
def test_a_sensor_that_fails_is_recognised_and_adds_no_evidence(sensor, state):
    axis = SEARCHED.begin()
    modes = flown(axis, height=75.0, duration=40.0, sensor=sensor)
    assert modes[-1] is Mode.SENSOR_FAILED
    assert axis.sensor is state


def test_a_reading_counts_for_the_place_at_which_it_was_read():
    both = []
    for late in (False, True):
        axis, around = SEARCHED.begin(), situation()
        axis.flown = 60.0
        axis.plan(0.0, around, tracking=True)
        waiting = []
        for i in range(300):
            time = STEP * i
            across = HALF_WIDTH * math.sin(math.pi * time / INTERVAL)
            around.target.update(time, False)
            around.own.ground_north, around.own.ground_east = around.target.north - 220.0, -across
            waiting += [(time, noisy(time, reading(across, 60.0, 62.0)))] if i % 2 == 0 else []
            due = not late or i % 5 == 4
            axis.take_readings(time, waiting if due else [])
            waiting = [] if due else waiting
        both.append(axis.estimate)
    # Half a second late makes no difference but that of a straight line between places a tenth of a
    # second apart.
    assert both[1].height == pytest.approx(both[0].height, abs=0.2)
    assert both[1].offset == pytest.approx(both[0].offset, abs=0.5)
