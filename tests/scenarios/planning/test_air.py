"""Winds and errors of dead reckoning that a plan allows for."""

import math
from dataclasses import replace

import numpy as np
import pytest
from flight_cases import SPEED, scenario

from aircraft.wind import CALM, WindField
from gnc.errors import InfeasibleError
from gnc.estimation.navigation import EstimatedNavigation, SatelliteFix, SensorReadings
from innerloop.flight.weave import Weave, WeaveSample
from scenarios.planning.air.errors import drift_rate
from scenarios.planning.air.wind import (
    check_not_outrun,
    navigation_parameters,
    wind_change,
    wind_error_in_weaves,
)
from scenarios.scenario.files import load_study, with_values
from scenarios.vehicles.vehicle_setup import kinematic_setup
from scenarios.world.world import mean_wind, vessel_of

TURN, OUTAGE = 7.0, 60.0
FAULT = {"kind": "satellite_navigation", "at_s": (80.0, 80.0), "satellite_navigation_s": OUTAGE}


def rate(wind=CALM, **changes):
    return drift_rate(scenario(fault=FAULT, **changes), wind, TURN)


def in_air(**turbulence):
    return rate(turbulence=turbulence, fidelity="six_dof") - rate()


def test_an_aircraft_reckons_no_better_than_to_two_per_cent_of_its_airspeed_whatever_is_declared():
    exact = {"drift_rate_mps": 0.0}
    assert rate(following=exact) == pytest.approx(0.02 * SPEED)
    biased = rate(following=exact, sensors={"airspeed_bias_mps": 0.5})
    assert biased == pytest.approx(0.02 * SPEED + 1.0)


def test_in_a_climb_it_reckons_with_the_airspeed_along_it_which_leads_ahead_by_its_cosine():
    exact, climbing = {"drift_rate_mps": 0.0}, {"climb_gradient": 0.3}
    added = rate(following=exact | climbing, emission={"ship": "container"}) - rate(following=exact)
    # Once in the wind, and once, after half a turn, in what is reckoned with it.
    assert added == pytest.approx(2.0 * (1.0 - math.cos(math.atan(0.3))) * SPEED)


def test_a_wind_that_changes_adds_its_largest_change_in_an_outage_and_until_its_estimate_has_followed():
    # 0.1 m/s each second for 300 s: in 60 s and the 20.6 s before 8.06 m/s.
    changing = WindField([[[0.0, 0.0]], [[30.0, 0.0]]], times=(0.0, 300.0))
    followed = 0.03 * SPEED * math.sqrt(0.5) / 0.02
    assert rate(changing) == pytest.approx(1.0 + 0.1 * (60.0 + followed))


@pytest.mark.parametrize(
    ("speed", "rise", "count"), [(8.0, 4.0, 7), (5.0, 10.0, 3), (8.0, 30.0, 1)]
)
def test_gusts_displace_by_no_more_than_is_reckoned_with(speed, rise, count):
    time = np.linspace(0.0, OUTAGE, 6001)
    blown = 0.5 * speed * (1.0 - np.cos(math.pi * time / rise))
    gust = np.where(time <= 2.0 * rise * count, blown, 0.0)
    moved = np.concatenate([[0.0], np.cumsum(0.5 * (gust[1:] + gust[:-1]) * np.diff(time))])
    added = in_air(gusts=count, gust_speed_mps=speed, gust_length_s=rise)
    for begins in range(0, 6000, 100):
        since = moved[begins:] - moved[begins]
        assert (since <= added * (time[: len(since)] + TURN)).all()
    # The wind is taken to be what is left of a gust that the estimate has followed, and none may
    # blow: no more than both.
    assert added <= 2.0 * speed


def test_a_compass_with_noise_makes_it_go_wrong_by_no_more_than_planned():
    # Twenty flights that weave in a wind for 300 s, and then for 60 s without satellites.
    sigma_deg, exact = 15.0, {"drift_rate_mps": 0.0}
    flown = scenario(fault=FAULT, sensors={"heading_sigma_deg": sigma_deg}, following=exact)
    # Without what an aircraft adds to it, which is none.
    planned = drift_rate(flown, CALM, TURN) - rate(following=exact)
    generator, (w_north, w_east) = np.random.default_rng(15), (3.0, -4.0)
    speed, time_step = flown.guidance.airspeed_mps, 1.0 / flown.guidance.rate_hz
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


def test_a_vessel_that_outruns_the_vehicle_where_it_climbs_to_is_refused(tmp_path):
    file = tmp_path / "wind.csv"
    file.write_text("height_m,speed_mps,from_deg\n1,10,0\n60,10,0\n250,26,0\n2000,26,0\n", "utf-8")
    circle = {
        "guidance.mission": "standoff", "keepout.shape": "cylinder", "keepout.radius_m": 20.0,
        "reference.standoff_radius_m": 150.0, "plume.elevation_deg": 45.0, "vessel.speed_mps": 4.0,
    }  # fmt: skip
    flown = with_values(load_study("sea_wind"), {"draws": [], "wind.table": str(file)} | circle)
    vessel = vessel_of(flown)
    # At the funnel the ship moves at 14 m/s through the air; at 60 + 150 m at 4 + 10 + 16 *
    # ln(210/60)/ln(250/60) = 28 m/s.
    with pytest.raises(InfeasibleError, match=r"height of 210 m, .* moves at up to 28\.\d m/s"):
        check_not_outrun(flown, vessel, mean_wind(flown, vessel), 150.0)
    check_not_outrun(flown, vessel, mean_wind(flown, vessel), 10.0)


@pytest.mark.parametrize(
    ("sign", "least", "most"),
    [(1, 1.0 - 1e-9, 1.0 + 1e-9), (-1, 1e-9, 0.1)],
    ids=["lasts", "alternates"],
)
def test_a_crab_angle_that_lasts_is_in_the_estimated_wind_and_others_cancel(sign, least, most):
    def sample(heading):
        motion = {"velocity_north": 20.0, "velocity_east": 0.0, "roll": 0.0}
        return WeaveSample(airspeed=20.0, heading=heading, **motion)

    weave = Weave((sample(0.0),), tuple(sample(0.02 * sign**i) for i in range(10)))
    setting = scenario()
    error = wind_error_in_weaves(setting, replace(kinematic_setup(setting), weaves=(weave,)))
    # The chord of 0.02 rad at 20 m/s; what alternates leaves the ripple of the filter.
    assert least < error / (2.0 * 20.0 * math.sin(0.01)) < most
