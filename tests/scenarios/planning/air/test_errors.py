"""How fast dead reckoning is taken to go wrong: what is declared, and what the air of the scenario
adds.
"""

import math

import numpy as np
import pytest
from flight_cases import scenario

from aircraft.wind import CALM, WindField
from gnc.estimation.navigation import EstimatedNavigation, SatelliteFix, SensorReadings
from scenarios.planning.air.errors import drift_rate
from scenarios.planning.air.wind import navigation_parameters, wind_change
from scenarios.vehicles.vehicle_setup import kinematic_setup

TURN, OUTAGE = 7.0, 60.0
FAULT = {"kind": "satellite_navigation", "at_s": (80.0, 80.0), "satellite_navigation_s": OUTAGE}


def rate(wind=CALM, **changes):
    return drift_rate(scenario(fault=FAULT, **changes), wind, TURN)


def in_air(**turbulence):
    return rate(turbulence=turbulence, fidelity="six_dof") - rate()


def test_an_aircraft_reckons_no_better_than_to_two_per_cent_of_its_airspeed_whatever_is_declared():
    exact = {"drift_rate_mps": 0.0}
    assert rate(following=exact) == pytest.approx(0.02 * scenario().guidance.airspeed_mps)
    # What sensors add comes on top of it.
    assert rate(following=exact, sensors={"airspeed_bias_mps": 0.5}) == pytest.approx(
        rate(following=exact) + 1.0
    )


def test_in_a_climb_it_reckons_with_the_airspeed_along_it_which_leads_ahead_by_its_cosine():
    exact = {"drift_rate_mps": 0.0, "climb_gradient": 0.3}
    climbing = rate(following=exact, emission={"ship": "container"}) - rate(
        following={"drift_rate_mps": 0.0}
    )
    # Once in the wind, and once, after half a turn, in what is reckoned with it.
    assert climbing == pytest.approx(
        2.0 * (1.0 - math.cos(math.atan(0.3))) * scenario().guidance.airspeed_mps
    )


def test_a_wind_that_changes_adds_its_largest_change_in_an_outage_and_until_its_estimate_has_followed():
    # 0.1 m/s each second for 300 s: in 60 s and the 20.6 s before 8.06 m/s.
    changing = WindField([[[0.0, 0.0]], [[30.0, 0.0]]], times=(0.0, 300.0))
    assert rate(changing) == pytest.approx(
        1.0 + 0.1 * (60.0 + 0.03 * 19.42 * math.sqrt(0.5) / 0.02)
    )


@pytest.mark.parametrize(
    ("speed", "rise", "count"), [(8.0, 4.0, 7), (5.0, 10.0, 3), (8.0, 30.0, 1)]
)
def test_gusts_displace_by_no_more_than_is_reckoned_with(speed, rise, count):
    time = np.linspace(0.0, OUTAGE, 6001)
    gust = np.where(
        time <= 2.0 * rise * count, 0.5 * speed * (1.0 - np.cos(math.pi * time / rise)), 0.0
    )
    moved = np.concatenate([[0.0], np.cumsum(0.5 * (gust[1:] + gust[:-1]) * np.diff(time))])
    added = in_air(gusts=count, gust_speed_mps=speed, gust_length_s=rise)
    for begins in range(0, 6000, 100):
        since = moved[begins:] - moved[begins]
        assert (since <= added * (time[: len(since)] + TURN)).all()
    # The wind is taken to be what is left of a gust that the estimate has followed, and none may
    # blow: no more than both.
    assert added <= 2.0 * speed


@pytest.mark.parametrize("sigma_deg", [5.0, 15.0])
def test_a_compass_with_noise_makes_it_go_wrong_by_no_more_than_planned(sigma_deg):
    # Twenty flights that weave in a wind for 300 s, and then for 60 s without satellites.
    flown = scenario(
        fault=FAULT, sensors={"heading_sigma_deg": sigma_deg}, following={"drift_rate_mps": 0.0}
    )
    # Without what an aircraft adds to it, which is none.
    planned = drift_rate(flown, CALM, TURN) - rate(following={"drift_rate_mps": 0.0})
    generator = np.random.default_rng(int(sigma_deg))
    speed, time_step, (w_north, w_east) = (
        flown.guidance.airspeed_mps,
        1.0 / flown.guidance.rate_hz,
        (3.0, -4.0),
    )
    for _ in range(20):
        navigation = EstimatedNavigation(navigation_parameters(flown, kinematic_setup(flown)))
        phase, north, east = float(generator.uniform(0.0, 2.0 * math.pi)), 0.0, 0.0
        heading = np.radians(sigma_deg) * generator.standard_normal(7200)
        for step, error in enumerate(heading.tolist()):
            time = step * time_step
            course = phase + 1.5 * math.sin(0.33 * time)
            v_north, v_east = speed * math.cos(course) + w_north, speed * math.sin(course) + w_east
            lost = time >= 300.0
            fix = None if lost else SatelliteFix(north, east, v_north, v_east)
            navigation.update(SensorReadings(fix, speed, course + error, 0.0, 0.0, 0.0))
            north, east = north + time_step * v_north, east + time_step * v_east
            if lost:
                age = navigation.lost
                wrong = math.hypot(navigation.ground_north - north, navigation.ground_east - east)
                assert wrong <= (planned + navigation.wind_error) * (age + TURN)


def test_a_wind_that_turns_round_at_the_height_of_the_flight_counts_for_who_does_not_keep_it_exactly():
    # 8 m/s from north below 59.5 m, from south above 60.5 m.
    turning = WindField([[[-8.0, 0.0], [8.0, 0.0]]], heights=(59.5, 60.5))
    flown = scenario(plume={"source_height_m": 60.0})
    assert wind_change(flown, turning, 0.0) == 0.0
    assert wind_change(flown, turning, 0.25) == pytest.approx(8.0, rel=0.02)
    assert wind_change(flown, turning, 2.0) == pytest.approx(16.0)
