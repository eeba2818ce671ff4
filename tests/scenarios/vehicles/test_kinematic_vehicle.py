"""The paper's vehicle behind the closed loop of the aircraft."""

import math
from dataclasses import replace

import numpy as np
import pytest

from aircraft.wind import WindField, constant_wind
from gnc.guidance import Guidance
from scenarios.experiment.requests import Experiment
from scenarios.planning.missions import plan_flight
from scenarios.scenario.files import load_study
from scenarios.vehicles.kinematic import KinematicVehicle
from scenarios.vehicles.vehicle_setup import kinematic_setup

SPEED = 19.42


def make(lag=0.0, time_step=0.05, course=0.5, **wind):
    return KinematicVehicle(
        north=10.0,
        east=-20.0,
        altitude=60.0,
        course=course,
        speed=SPEED,
        time_step=time_step,
        lag=lag,
        **wind,
    )


def request_of(name, *overrides):
    """Return the first flight of a scenario in the catalog."""
    return Experiment(name, load_study(name, overrides)).request(0)


def test_it_flies_a_circle_of_speed_over_heading_rate():
    vehicle = make(time_step=2.0 * math.pi / 0.3 / 400)
    places = []
    for _ in range(400):
        vehicle.advance(0.3, SPEED)
        places.append(vehicle.motion()[:2])
    centre = np.mean(places, axis=0)
    radius = np.hypot(*(np.array(places) - centre).T)
    # Equation (1) at a constant heading rate: a circle of radius v/omega, closed after 2 pi/omega.
    # Roundings of 400 steps.
    assert radius == pytest.approx(np.full(400, SPEED / 0.3), rel=1e-10)
    assert places[-1] == pytest.approx((10.0, -20.0), abs=1e-9)


@pytest.mark.parametrize("lag", [0.0, 0.3])
def test_in_wind_it_flies_the_calm_path_carried_along(lag):
    calm, windy = make(lag), make(lag, wind=constant_wind(-6.0, 2.5))
    for _ in range(200):
        calm.advance(0.3, SPEED)
        windy.advance(0.3, SPEED)
    # 200 steps of 0.05 s in a wind of (-6, 2.5) m/s; roundings of 200 sums.
    difference = np.subtract(windy.motion(), calm.motion())
    assert difference == pytest.approx([-60.0, 25.0, -6.0, 2.5, 0.0], abs=1e-9)
    assert windy.air_data() == calm.air_data()


def test_in_a_wind_that_changes_it_is_carried_by_what_blows_at_its_time_and_height():
    # From rest to 10 m/s northward within 10 s, and twice that at twice the height of 50 m.
    wind = WindField(
        [[[0.0, 0.0], [0.0, 0.0]], [[10.0, 0.0], [20.0, 0.0]]],
        times=(0.0, 10.0),
        heights=(50.0, 100.0),
    )
    for height, speed in ((50.0, 10.0), (100.0, 20.0)):
        windy = make(wind=wind)
        windy.command_altitude(height)
        still = make()
        for _ in range(200):
            still.advance(0.3, SPEED)
            windy.advance(0.3, SPEED)
        # Velocity is held for a step of 0.05 s: the sum lags half a step behind the integral, 0.25
        # m at most.
        off_north, off_east, faster, *_ = np.subtract(windy.motion(), still.motion())
        assert (off_north, off_east) == pytest.approx((0.5 * speed * 10.0, 0.0), abs=0.6)
        assert faster == pytest.approx(speed, rel=1e-9)


def test_the_guidance_is_the_same_for_both_vehicles():
    # Fidelity does not enter the plan: the same start and the same guidance, but for the lag, which
    # is measured.
    scenarios = [
        request_of("sim3", f"fidelity={fidelity}").scenario for fidelity in ("kinematic", "six_dof")
    ]
    setup = kinematic_setup(scenarios[0])
    plans = [plan_flight(scenario, flight_id="x", seed=7, setup=setup) for scenario in scenarios]
    assert plans[0].start == plans[1].start
    # References are equal if they move alike.
    assert replace(plans[0].guidance, mission=None) == replace(plans[1].guidance, mission=None)
    commands = []
    for plan in plans:
        guidance = Guidance(plan.guidance)
        for step in range(100):
            guidance.step(step * plan.time_step, (-400.0, 30.0, 18.5, 5.7, 0.1))
        commands.append((guidance.heading_rate_command, guidance.airspeed_command))
    assert commands[0] == commands[1]
