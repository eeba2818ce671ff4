"""Own motion, as it is and as it is estimated."""

import math

import pytest

from gnc.estimation.navigation import NavigationParameters
from gnc.estimation.own_motion import EstimatedNavigation, TrueNavigation

SPEED, TIME_STEP = 19.42, 0.05
WIND = (-4.0, 3.0)

NAVIGATION = NavigationParameters(
    crab_banks=(-1.0, 1.0),
    crab_offsets=(0.0, 0.0),
    airspeed_sigma=0.5,
    course_sigma=0.03,
    wind_drift=0.02,
    wind_interval=10,
    time_step=TIME_STEP,
)


def test_the_true_motion_has_course_and_speed_of_its_velocity_and_no_wind():
    own = TrueNavigation()
    own.update((100.0, -50.0, 12.0, -5.0, 0.2))
    assert (own.north, own.east, own.ground_north, own.ground_east) == (100.0, -50.0, 100.0, -50.0)
    # 5, 12, 13.
    assert (own.speed, own.course, own.heading_rate) == pytest.approx(
        (13.0, math.atan2(-5.0, 12.0), 0.2), rel=1e-15
    )
    assert (own.wind_north, own.wind_east, own.drift_north, own.drift_east, own.lost) == (0.0,) * 5
    # Nothing in its measurement says how fast the air goes by.
    assert own.air_ratio == 1.0
    assert math.isnan(own.airspeed)


def settled_in_wind(*, airspeed=SPEED, heading_rate=0.1):
    """Return the estimate after four minutes of a circle in a steady wind, and where the vehicle
    then is.
    """
    own = EstimatedNavigation(NAVIGATION)
    north = east = 0.0
    for step in range(4802):
        heading = 0.1 * step * TIME_STEP
        velocity = SPEED * math.cos(heading) + WIND[0], SPEED * math.sin(heading) + WIND[1]
        last = step == 4801  # between two measurements of the wind
        own.update(
            ((north, east, *velocity), airspeed if last else SPEED, heading, 0.0, heading_rate, 0.0)
        )
        place = north, east
        north, east = north + TIME_STEP * velocity[0], east + TIME_STEP * velocity[1]
    return own, place, math.remainder(heading, 2.0 * math.pi)


def test_the_estimated_motion_is_that_through_the_mean_air():
    own, place, heading = settled_in_wind()
    # Exact sensors and a steady wind: what is left of the first guess, 10 m/s, after four minutes
    # of circles; measured 2 mm/s.
    assert (own.wind_north, own.wind_east) == pytest.approx(WIND, abs=0.01)
    assert own.speed == pytest.approx(SPEED, abs=0.02)
    assert own.course == pytest.approx(heading, abs=1e-3)
    assert (own.ground_north, own.ground_east) == place
    # The air mass has drifted by as much as its frame lies from that of the ground; over 240 s of a
    # wind that was found soon.
    assert (own.north + own.drift_north, own.east + own.drift_east) == pytest.approx(
        place, abs=1e-9
    )
    assert (own.drift_north, own.drift_east) == pytest.approx(
        (240.0 * WIND[0], 240.0 * WIND[1]), rel=0.1
    )
    assert own.air_ratio == pytest.approx(1.0, abs=1e-3)


def test_a_turn_against_gusty_air_is_a_slower_one_over_the_mean_air_where_the_gust_is_a_tailwind():
    # A gust from behind takes a tenth of the airspeed: the same acceleration turns the motion over
    # the mean air by as much less.
    own, _, _ = settled_in_wind(airspeed=0.9 * SPEED, heading_rate=0.2)
    assert own.airspeed == 0.9 * SPEED
    assert own.heading_rate == pytest.approx(0.18, rel=2e-3)
    assert own.air_ratio == pytest.approx(0.9, rel=2e-3)


def test_without_satellite_navigation_it_counts_for_how_long():
    own, _, heading = settled_in_wind()
    assert own.lost == 0.0
    for _ in range(20):
        own.update((None, SPEED, heading, 0.0, 0.0, 0.0))
    assert own.lost == pytest.approx(1.0, abs=1e-9)
